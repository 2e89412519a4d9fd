// Words and numbers from text in memory, at memory speed. For the readers of this room.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <expected>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace raio::core {

/// A text followed by zero bytes, so that a cursor needs no end checks: a zero byte ends every
/// word, and eight bytes may be loaded anywhere. The text itself must contain no zero byte (see
/// not_text()).
class TextBuffer {
 public:
  static constexpr size_t kPadding = 16;

  explicit TextBuffer(std::string_view text);

  /// Reads a whole file; the error is one line with the reason.
  static std::expected<TextBuffer, std::string> read_file(const std::filesystem::path& path);

  const char* begin() const { return bytes_.get(); }
  const char* end() const { return bytes_.get() + size_; }
  std::string_view view() const { return {bytes_.get(), size_}; }

 private:
  TextBuffer() = default;
  void reserve(size_t size);

  std::unique_ptr<char[]> bytes_;
  size_t size_ = 0, capacity_ = 0;
};

/// One line that says why the bytes cannot be the text of a scene; empty if they may be.
std::string not_text(std::string_view bytes);

/// A word for messages: quoted, shortened, unprintable bytes as \xNN.
std::string quoted(std::string_view word);

enum CharClass : uint8_t { kWordChar = 0, kBlank = 1, kLineEnd = 2, kWordEnd = 4 };

inline constexpr std::array<uint8_t, 256> kCharClass = [] {
  std::array<uint8_t, 256> table{};
  for (const unsigned char c : {' ', '\t', '\v', '\f'}) table[c] = kBlank | kWordEnd;
  for (const unsigned char c : {'\n', '\r'}) table[c] = kBlank | kLineEnd | kWordEnd;
  for (const unsigned char c : {'#', '\0'}) table[c] = kWordEnd;
  return table;
}();

inline bool is_char(char c, uint8_t wanted) { return kCharClass[uint8_t(c)] & wanted; }

/// The next word, after comments; at the end of the text its closing zero byte.
inline const char* skip_blanks(const char* p) {
  for (;;) {
    while (is_char(*p, kBlank)) ++p;
    if (*p != '#') return p;
    while (*p != '\0' && !is_char(*p, kLineEnd)) ++p;
  }
}

/// The next word of the same line, or the end of the line.
inline const char* skip_blanks_in_line(const char* p) {
  while (is_char(*p, kBlank) && !is_char(*p, kLineEnd)) ++p;
  return p;
}

inline std::string_view word_at(const char* p) {
  const char* end = p;
  while (!is_char(*end, kWordEnd)) ++end;
  return {p, size_t(end - p)};
}

/// Appends the digits at `p` to `value` and returns their end. Eight at a time: carries into the
/// top bits find bytes that are not digits, and three multiplications join the digits in pairs.
/// `value` wraps after 19 digits.
inline const char* parse_digits(const char* p, uint64_t& value) {
  static constexpr std::array<uint32_t, 9> kPowers = {1,      10,      100,      1000,     10000,
                                                      100000, 1000000, 10000000, 100000000};
  static_assert(std::endian::native == std::endian::little);
  for (;;) {
    uint64_t chunk;
    std::memcpy(&chunk, p, 8);
    uint64_t digits = chunk ^ 0x3030303030303030u;
    const uint64_t others =
        (digits | ((digits & 0x7f7f7f7f7f7f7f7fu) + 0x7676767676767676u)) & 0x8080808080808080u;
    const int count = others ? std::countr_zero(others) / 8 : 8;
    if (count == 0) return p;
    digits <<= 8 * (8 - count);  // leading zeros
    digits = (digits * 10 + (digits >> 8)) & 0x00ff00ff00ff00ffu;
    digits = (digits * 100 + (digits >> 16)) & 0x0000ffff0000ffffu;
    digits = (digits * 10000 + (digits >> 32)) & 0xffffffffu;
    value = value * kPowers[count] + digits;
    p += count;
    if (count < 8) return p;
  }
}

/// The slow path of parse_number, for long mantissas and large exponents: the word from `begin` to
/// `end` with the exponent `written_exponent`.
const char* parse_long_number(const char* begin, const char* end, int64_t written_exponent,
                              double& value);

/// Parses a decimal number that fills its word, rounded to the nearest double (infinity if too
/// large). Returns its end, or nullptr if the word is not a number. Mantissas up to 2^53 and powers
/// of ten up to 10^22 are exact, so one rounding remains: Clinger 1990, "How to Read Floating Point
/// Numbers Accurately", PLDI.
inline const char* parse_number(const char* const begin, double& value) {
  static constexpr std::array<double, 23> kPowers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                                     1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                                     1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  const char* p = begin;
  const bool negative = *p == '-';
  p += negative || *p == '+';
  uint64_t mantissa = 0;
  const char* const whole = p;
  p = parse_digits(p, mantissa);
  int64_t digits = p - whole, exponent = 0;
  if (*p == '.') {
    const char* const fraction = ++p;
    p = parse_digits(p, mantissa);
    exponent = fraction - p;
    digits -= exponent;
  }
  if (digits == 0) return nullptr;
  int64_t written_exponent = 0;
  if (*p == 'e' || *p == 'E') {
    ++p;
    const bool negative_exponent = *p == '-';
    p += negative_exponent || *p == '+';
    if (!(*p >= '0' && *p <= '9')) return nullptr;
    for (; *p >= '0' && *p <= '9'; ++p)
      if (written_exponent < 1'000'000'000'000)
        written_exponent = written_exponent * 10 + (*p - '0');
    if (negative_exponent) written_exponent = -written_exponent;
    exponent += written_exponent;
  }
  if (!is_char(*p, kWordEnd)) return nullptr;
  if (digits > 19 || mantissa > (uint64_t(1) << 53) || exponent < -22 || exponent > 22)
    return parse_long_number(begin, p, written_exponent, value);
  const double exact = double(mantissa);
  const double magnitude = exponent < 0 ? exact / kPowers[-exponent] : exact * kPowers[exponent];
  value = negative ? -magnitude : magnitude;
  return p;
}

/// Whether the word may be meant as a number.
inline bool looks_like_number(std::string_view word) {
  const size_t sign = !word.empty() && (word[0] == '-' || word[0] == '+');
  const size_t at = sign + (word.size() > sign && word[sign] == '.');
  return word.size() > at && word[at] >= '0' && word[at] <= '9';
}

}  // namespace raio::core
