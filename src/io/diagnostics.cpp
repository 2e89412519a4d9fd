#include "io/diagnostics.h"

#include <fmt/format.h>

#include <algorithm>
#include <climits>
#include <cstdint>

#include "io/nff/text_report.h"

namespace raio::core {
namespace {

bool ends_line(char c) { return c == '\n' || c == '\r'; }

/// The line [begin, end) as one line of ASCII, at most about 80 characters around `at`.
std::string excerpt_around(std::string_view text, size_t begin, size_t end, size_t at) {
  constexpr size_t kWhole = 80, kBefore = 40, kAfter = 40;
  size_t from = begin, to = end;
  if (end - begin > kWhole) {
    if (at - begin > kBefore) from = at - kBefore;
    if (end - at > kAfter) to = at + kAfter;
  }
  std::string out = from > begin ? "..." : "";
  for (const char c : text.substr(from, to - from))
    out += c == '\t' ? ' ' : uint8_t(c) < 32 || uint8_t(c) >= 127 ? '?' : c;
  if (to < end) out += "...";
  const size_t first = out.find_first_not_of(' '), last = out.find_last_not_of(' ');
  return first == std::string::npos ? "" : out.substr(first, last - first + 1);
}

}  // namespace

std::string_view severity_name(Severity severity) {
  switch (severity) {
    case Severity::warning:
      break;
    case Severity::error:
      return "error";
    case Severity::guessed:
      return "guessed";
    case Severity::cut:
      return "cut";
    case Severity::left_out:
      return "left out";
  }
  return "warning";
}

void append(Diagnostics& out, const Notices& notices, std::string_view file) {
  for (const Notice& n : notices.list())
    out.push_back({n.severity, std::string(file), int(std::min<size_t>(n.line, INT_MAX)),
                   n.line > 0, n.message, "", n.count, n.names});
}

std::string Diagnostic::sentence() const {
  if (count == 0) return message;
  std::string out = fmt::format("{} ({}", message, count);
  for (const std::string& name : names)
    out += fmt::format("{}{}", &name == &names.front() ? ": " : ", ", name);
  return out + (names.size() == Notices::kNames && count > names.size() ? ", ...)" : ")");
}

std::string Diagnostic::text(std::string_view before_settings) const {
  std::string out = file;
  if (line > 0) out += fmt::format(":{}:{}", line, column);
  out +=
      fmt::format(": {}: {}", severity_name(severity), with_settings(sentence(), before_settings));
  if (!excerpt.empty()) out += "  | " + excerpt;
  return out;
}

Error error_of(const Diagnostic& d) {
  if (d.message == kStopped) return stopped_error();
  return {d.message == kNoMemory ? ErrorKind::no_resource : ErrorKind::bad_input,
          d.file,
          d.message,
          {d.line, d.column}};
}

void TextReport::add(Findings& findings, size_t offset, std::string message) const {
  if (++findings.count > most_) return;
  const auto later = std::upper_bound(findings.kept.begin(), findings.kept.end(), offset,
                                      [](size_t at, const Finding& f) { return at < f.offset; });
  findings.kept.insert(later, {offset, std::move(message)});
}

void TextReport::append(TextReport part) {
  for (const auto& [to, from] :
       {std::pair{&errors_, &part.errors_}, {&warnings_, &part.warnings_}}) {
    for (Finding& finding : from->kept) add(*to, finding.offset, std::move(finding.message));
    to->count += from->count - from->kept.size();
  }
}

int TextReport::line_of(size_t offset) {
  if (offset < counted_) counted_ = 0, line_ = 1;
  for (; counted_ < offset; ++counted_) {
    const char c = text_[counted_];
    // A line ends with LF, CR or CR LF; for the pair, the LF counts.
    const bool pair = c == '\r' && counted_ + 1 < text_.size() && text_[counted_ + 1] == '\n';
    line_ += ends_line(c) && !pair;
  }
  return line_;
}

Diagnostics TextReport::placed(Findings& findings, Severity severity) {
  Diagnostics out;
  for (const Finding& finding : findings.kept) {
    Diagnostic& d = out.emplace_back(Diagnostic{severity, file_, 0, 0, finding.message, ""});
    if (finding.offset == kWholeFile) continue;
    size_t begin = finding.offset, end = finding.offset;
    while (begin > 0 && !ends_line(text_[begin - 1])) --begin;
    while (end < text_.size() && !ends_line(text_[end])) ++end;
    d.line = line_of(finding.offset);
    d.column = 1 + int(std::count_if(text_.begin() + begin, text_.begin() + finding.offset,
                                     [](char c) { return (uint8_t(c) & 0xc0) != 0x80; }));
    d.excerpt = excerpt_around(text_, begin, end, finding.offset);
  }
  if (const size_t more = findings.count - findings.kept.size(); more > 0)
    out.push_back(
        {severity, file_, 0, 0,
         fmt::format("{} more {}{} not shown", more,
                     severity == Severity::error ? "error" : "warning", more == 1 ? "" : "s"),
         ""});
  return out;
}

std::unexpected<Diagnostics> failed(std::string_view file, std::string message, size_t line) {
  return std::unexpected(Diagnostics{
      {Severity::error, std::string(file), int(line), line > 0, std::move(message), ""}});
}

}  // namespace raio::core
