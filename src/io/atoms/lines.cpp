#include "io/atoms/lines.h"

namespace raio::core {
namespace {

constexpr size_t kChunk = 1 << 16;

}  // namespace

LineIndex::LineIndex(std::string_view text) : text_(text) {
  const size_t chunks = (text.size() + kChunk - 1) / kChunk;
  before_.resize(chunks + 1);
  parallel_for(chunks, [&](size_t c) {
    const std::string_view chunk = text_.substr(c * kChunk, kChunk);
    // Faster than byte by byte, since lines are longer than a register.
    const char *p = chunk.data(), *const end = p + chunk.size();
    while ((p = static_cast<const char*>(std::memchr(p, '\n', size_t(end - p))))) {
      ++before_[c + 1];
      if (++p == end) break;
    }
  });
  for (size_t c = 0; c < chunks; ++c) before_[c + 1] += before_[c];
}

const char* LineIndex::begin_of(size_t line) const {
  if (line == 0) return text_.data();
  const char* const end = text_.data() + text_.size();
  if (line > before_.back()) return end;
  const size_t chunk = size_t(std::ranges::lower_bound(before_, line) - before_.begin()) - 1;
  const char* p = text_.data() + chunk * kChunk;
  for (size_t left = line - before_[chunk]; left > 0; --left)
    p = static_cast<const char*>(std::memchr(p, '\n', size_t(end - p))) + 1;
  return p;
}

std::string printable(std::string_view text) {
  std::string out(text.substr(0, 80));
  std::ranges::replace_if(out, [](unsigned char c) { return c < 32 || c > 126; }, '?');
  return out;
}

std::optional<std::string_view> LineReader::next_filled() {
  auto line = next();
  while (line && line->find_first_not_of(" \t") == std::string_view::npos) line = next();
  return line;
}

std::unexpected<Diagnostics> wrong_line(std::string_view file, size_t number, std::string_view line,
                                        const LineFault& fault) {
  const bool at_end = fault.at >= line.data() + line.size() || word_at(fault.at).empty();
  return std::unexpected(
      Diagnostics{{Severity::error, std::string(file), int(number), int(fault.at - line.data()) + 1,
                   fmt::format("expected {}, found {}", fault.expected,
                               at_end ? "the end of the line" : quoted(word_at(fault.at))),
                   printable(line)}});
}

}  // namespace raio::core
