#include "io/nff/text_cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>
#include <new>

#include "base/executor.h"
#include "base/platform/files.h"
#include "io/diagnostics.h"

namespace raio::core {

void TextBuffer::reserve(size_t size) {
  if (size <= capacity_ && bytes_) return;
  auto grown = std::make_unique_for_overwrite<char[]>(size + kPadding);
  use_large_pages(grown.get(), size);
  if (size_ > 0) std::memcpy(grown.get(), bytes_.get(), size_);
  bytes_ = std::move(grown);
  capacity_ = size;
}

TextBuffer::TextBuffer(std::string_view text) {
  reserve(text.size());
  if (!text.empty()) std::memcpy(bytes_.get(), text.data(), text.size());
  size_ = text.size();
  std::memset(bytes_.get() + size_, 0, kPadding);
}

// Mapping the file would save the copy, a few per cent of the time to read a scene, but a file that
// is truncated while it is mapped ends the program.
std::expected<TextBuffer, std::string> TextBuffer::read_file(const std::filesystem::path& path) {
  auto file = InputFile::open(path);
  if (!file) return std::unexpected(fmt::format("cannot open the file: {}", file.error()));
  if (file->kind() == InputFile::Kind::folder)
    return std::unexpected("this is a folder, expected a file");
  if (file->kind() == InputFile::Kind::device)
    return std::unexpected("this is a device, expected a file");
  // A scene takes about as much memory again as its text, and a pipe may never end.
  const size_t most = available_memory_bytes() / 2;
  const auto too_large = [] { return std::unexpected(std::string(kNoMemory)); };
  if (file->rest() > most) return too_large();
  TextBuffer text;
  try {
    // One byte more than expected, so that the end is seen without growing.
    text.reserve(std::max<size_t>(file->rest() + 1, 4096));
    for (;;) {
      check_stop();
      if (text.size_ == text.capacity_) text.reserve(2 * text.capacity_);
      const auto got = file->read(text.bytes_.get() + text.size_, text.capacity_ - text.size_);
      if (!got) return std::unexpected(fmt::format("cannot read the file: {}", got.error()));
      if (*got == 0) break;
      text.size_ += *got;
      if (text.size_ > most) return too_large();
    }
  } catch (const std::bad_alloc&) {
    return too_large();
  }
  std::memset(text.bytes_.get() + text.size_, 0, kPadding);
  return text;
}

std::string not_text(std::string_view bytes) {
  if (bytes.starts_with("\xff\xfe") || bytes.starts_with("\xfe\xff"))
    return "this is UTF-16 text, expected ASCII or UTF-8";
  // Zero bytes are searched for everywhere, since a cursor takes one for the end of the text. Other
  // control characters are searched for at the beginning only, which is enough to detect a binary
  // file.
  size_t at = bytes.find('\0');
  for (size_t i = 0; i < std::min<size_t>(bytes.size(), 4096); ++i)
    if ((uint8_t(bytes[i]) < 32 || bytes[i] == 127) && !is_char(bytes[i], kBlank)) {
      at = std::min(at, i);
      break;
    }
  if (at == std::string_view::npos) return {};
  return fmt::format("this is not a text file: byte 0x{:02x} at offset {}", uint8_t(bytes[at]), at);
}

std::string quoted(std::string_view word) {
  constexpr size_t kLongest = 32;
  std::string out = "\"";
  for (const char c : word.substr(0, kLongest)) {
    if (uint8_t(c) < 32 || uint8_t(c) >= 127)
      out += fmt::format("\\x{:02x}", uint8_t(c));
    else
      out += c;
  }
  return out + (word.size() > kLongest ? "...\"" : "\"");
}

const char* parse_long_number(const char* begin, const char* end, int64_t written_exponent,
                              double& value) {
  const bool negative = *begin == '-';
  const char* const unsigned_begin = begin + (negative || *begin == '+');
  double magnitude = 0;
  const auto [stop, error] = std::from_chars(unsigned_begin, end, magnitude);
  if (error == std::errc::result_out_of_range) {
    // Out of range, too large or too small: the position of the first non-zero digit decides.
    const std::string_view word(unsigned_begin, size_t(end - unsigned_begin));
    const std::string_view digits = word.substr(0, word.find_first_of("eE"));
    const size_t first = digits.find_first_of("123456789");
    const size_t point = std::min(digits.find('.'), digits.size());
    const bool too_large =
        first != std::string_view::npos && int64_t(point) - int64_t(first) + written_exponent > 0;
    magnitude = too_large ? std::numeric_limits<double>::infinity() : 0;
  } else if (error != std::errc() || stop != end) {
    return nullptr;
  }
  value = negative ? -magnitude : magnitude;
  return end;
}

}  // namespace raio::core
