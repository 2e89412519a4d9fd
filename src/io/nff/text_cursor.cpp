#include "io/nff/text_cursor.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <limits>
#include <new>
#include <system_error>
#include <vector>

#include "base/memory.h"
#include "base/parallel.h"
#include "io/diagnostics.h"
#include "io/file.h"

namespace raio {
namespace {

/// Closes on every way out.
struct OpenFile {
  int id = -1;
  explicit OpenFile(int id_) : id(id_) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (id >= 0) ::close(id);
  }
};

std::string system_message(int code) { return std::generic_category().message(code); }

}  // namespace

void TextBuffer::reserve(size_t size) {
  if (size <= capacity_ && bytes_) return;
  auto grown = std::make_unique_for_overwrite<char[]>(size + kPadding);
  use_large_pages(grown.get(), size);
  if (size_ > 0) std::memcpy(grown.get(), bytes_.get(), size_);
  bytes_ = std::move(grown);
  capacity_ = size;
}

/// Reads from where the file stands, usually its beginning, as much as it has at most, on all
/// threads. Where a read fails or ends early (the file was cut meanwhile), it stops without an
/// error: the next read tells. A mapping of the file would save the copy, a few per cent of reading
/// a scene, but a file that is cut while it is mapped ends the program by SIGBUS.
void TextBuffer::read_known(int file, size_t file_size) {
  constexpr size_t kChunk = size_t(1) << 21;
  const off_t start = ::lseek(file, 0, SEEK_CUR);
  if (start < 0 || size_t(start) > file_size) return;
  const size_t size = file_size - size_t(start);
  reserve(size + 1);                    // so that the end is seen without growing
  const size_t chunks = size / kChunk;  // the rest is not worth it
  std::vector<size_t> read(chunks, 0);
  parallel_for(chunks, [&](size_t i) {
    while (read[i] < kChunk) {
      const size_t at = i * kChunk + read[i];
      const ssize_t got = ::pread(file, bytes_.get() + at, kChunk - read[i], start + off_t(at));
      if (got <= 0) break;
      read[i] += size_t(got);
    }
  });
  for (size_t i = 0; i < chunks && size_ == i * kChunk; ++i) size_ += read[i];
  ::lseek(file, start + off_t(size_), SEEK_SET);
}

TextBuffer::TextBuffer(std::string_view text) {
  reserve(text.size());
  if (!text.empty()) std::memcpy(bytes_.get(), text.data(), text.size());
  size_ = text.size();
  std::memset(bytes_.get() + size_, 0, kPadding);
}

std::expected<TextBuffer, std::string> TextBuffer::read_file(const std::filesystem::path& path) {
  const OpenFile file(open_for_reading(path));
  if (file.id < 0)
    return std::unexpected(fmt::format("cannot open the file: {}", system_message(errno)));
  struct stat status{};
  if (::fstat(file.id, &status) != 0)
    return std::unexpected(fmt::format("cannot read the file: {}", system_message(errno)));
  if (S_ISDIR(status.st_mode)) return std::unexpected("this is a folder, expected a file");
  if (S_ISBLK(status.st_mode) || (S_ISCHR(status.st_mode) && !::isatty(file.id)))
    return std::unexpected("this is a device, expected a file");
  // A scene takes about as much again as its text; and a pipe may never end.
  const size_t most = available_memory_bytes() / 2;
  const auto too_large = [] { return std::unexpected(std::string(kNoMemory)); };
  if (S_ISREG(status.st_mode) && size_t(status.st_size) > most) return too_large();
  TextBuffer text;
  try {
    if (S_ISREG(status.st_mode)) text.read_known(file.id, size_t(status.st_size));
    // What is left: pipes, whose size is not known, a file that grows, and in most cases only the
    // end.
    text.reserve(std::max<size_t>(text.capacity_, 4096));
    for (;;) {
      if (text.size_ == text.capacity_) text.reserve(2 * text.capacity_);
      const ssize_t got =
          ::read(file.id, text.bytes_.get() + text.size_, text.capacity_ - text.size_);
      if (got < 0 && errno == EINTR) continue;
      if (got < 0)
        return std::unexpected(fmt::format("cannot read the file: {}", system_message(errno)));
      if (got == 0) break;
      text.size_ += size_t(got);
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
  // Zero bytes are looked for everywhere, as a cursor would take one for the end; other control
  // bytes only at the beginning, which is enough to know a binary file.
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

const char* parse_long_number(const char* begin, const char* end, long written_exponent,
                              double& value) {
  const bool negative = *begin == '-';
  const char* const unsigned_begin = begin + (negative || *begin == '+');
  double magnitude = 0;
  const auto [stop, error] = std::from_chars(unsigned_begin, end, magnitude);
  if (error == std::errc::result_out_of_range) {
    // Too large or too small: the place of the first digit that is not zero tells.
    const std::string_view word(unsigned_begin, size_t(end - unsigned_begin));
    const std::string_view digits = word.substr(0, word.find_first_of("eE"));
    const size_t first = digits.find_first_of("123456789");
    const size_t point = std::min(digits.find('.'), digits.size());
    const bool too_large =
        first != std::string_view::npos && long(point) - long(first) + written_exponent > 0;
    magnitude = too_large ? std::numeric_limits<double>::infinity() : 0;
  } else if (error != std::errc() || stop != end) {
    return nullptr;
  }
  value = negative ? -magnitude : magnitude;
  return end;
}

}  // namespace raio
