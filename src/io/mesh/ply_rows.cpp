#include "io/mesh/ply_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "io/atoms/rows.h"

namespace raio::core {
namespace {

constexpr std::array<std::string_view, 16> kTypeNames = {
    "char", "uchar", "short", "ushort", "int",   "uint",   "float",   "double",
    "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
constexpr size_t kTypes = 8;

template <class T>
T number_at(const char* p, bool swap) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), p, sizeof(T));
  if (swap) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

}  // namespace

double ply_number(const char* p, PlyType type, bool swap) {
  switch (type) {
    case PlyType::i8:
      return double(number_at<int8_t>(p, swap));
    case PlyType::u8:
      return double(number_at<uint8_t>(p, swap));
    case PlyType::i16:
      return double(number_at<int16_t>(p, swap));
    case PlyType::u16:
      return double(number_at<uint16_t>(p, swap));
    case PlyType::i32:
      return double(number_at<int32_t>(p, swap));
    case PlyType::u32:
      return double(number_at<uint32_t>(p, swap));
    case PlyType::f32:
      return double(number_at<float>(p, swap));
    case PlyType::f64:
      break;
  }
  return number_at<double>(p, swap);
}

bool PlyElement::has_lists() const {
  return std::ranges::any_of(properties, [](const PlyProperty& p) { return p.count.has_value(); });
}

size_t PlyElement::row_bytes() const {
  size_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += size_of(property.type);
  return bytes;
}

// --- sequences of numbers
double PlyCursor::next_binary(PlyType type) {
  const size_t size = size_of(type);
  if (bytes_left() < size) fail("the file ends within its elements");
  const double value = ply_number(p, type, encoding == PlyEncoding::big);
  p += size;
  return value;
}

const char* PlyCursor::parse_not_finite(PlyType type, double& value) const {
  if (p >= end) fail("expected a number, found the end of the file");
  const std::string_view word = word_at(p);
  std::string name(word.substr(0, 16));
  std::ranges::transform(name, name.begin(), [](char c) { return char(std::tolower(uint8_t(c))); });
  const bool negative = name.starts_with('-');
  if (negative || name.starts_with('+')) name.erase(0, 1);
  const bool is_nan = name == "nan" || name.starts_with("nan(");  // "nan(ind)" of Windows
  if (is_whole(type) || !(is_nan || name == "inf" || name == "infinity"))
    fail(fmt::format("expected a number, found {}", quoted(word)));
  value = is_nan ? NAN : negative ? -INFINITY : INFINITY;
  return p + word.size();
}

size_t PlyCursor::next_count(const PlyProperty& list) {
  const double count = next(*list.count);
  // A number takes at least one byte, in text two.
  if (!(count >= 0 && count <= double(end - p)))
    fail(fmt::format("a list of {} numbers does not fit in the file", count));
  return size_t(count);
}

void PlyCursor::next_list(const PlyProperty& property, std::vector<double>& out) {
  const size_t count = next_count(property);
  out.clear();
  if (encoding == PlyEncoding::text) {
    for (size_t k = 0; k < count; ++k) out.push_back(next(property.type));
    return;
  }
  const size_t size = size_of(property.type);
  if (count > bytes_left() / size) fail("the file ends within its elements");
  const bool swap = encoding == PlyEncoding::big;
  out.resize(count);
  if (property.type == PlyType::i32)  // the usual case
    for (size_t k = 0; k < count; ++k) out[k] = double(number_at<int32_t>(p + k * size, swap));
  else
    for (size_t k = 0; k < count; ++k) out[k] = ply_number(p + k * size, property.type, swap);
  p += count * size;
}

void PlyCursor::skip(const PlyProperty& property) {
  const size_t count = property.count ? next_count(property) : 1;
  if (encoding == PlyEncoding::text) {
    for (size_t k = 0; k < count; ++k) (void)next(property.type);
    return;
  }
  if (count > bytes_left() / size_of(property.type)) fail("the file ends within its elements");
  p += count * size_of(property.type);
}

void PlyCursor::skip(const PlyElement& element) {
  for (const PlyProperty& property : element.properties) skip(property);
}

// --- the header
PlyFile::PlyFile(const TextBuffer& bytes) : at_{bytes.begin(), bytes.end()} {
  read_header();
  ++at_.line;  // where the body begins
  body_ = at_.p, header_lines_ = at_.line;
}

std::string_view PlyFile::header_line() {
  const char* const stop = std::find(at_.p, at_.end, ends_with_cr_ ? '\r' : '\n');
  if (stop == at_.end) fail("the header has no end_header");
  std::string_view line(at_.p, size_t(stop - at_.p));
  if (line.ends_with('\r')) line.remove_suffix(1);
  at_.p = stop + 1;
  ++at_.line;
  return line;
}

PlyType PlyFile::type_of(std::string_view name) const {
  const auto at = std::ranges::find(kTypeNames, name);
  if (at == kTypeNames.end())
    fail(fmt::format("expected a type such as float or uchar, found {}", quoted(name)));
  return PlyType(size_t(at - kTypeNames.begin()) % kTypes);
}

void PlyFile::read_header() {
  const std::string_view start(at_.p, std::min(at_.bytes_left(), size_t(5)));
  ends_with_cr_ = start.starts_with("ply\r") && !start.ends_with('\n');
  if (header_line() != "ply") fail("expected \"ply\"");
  std::optional<PlyEncoding> encoding;
  while (true) {
    const std::string_view line = header_line();
    const auto words = words_of(line);
    const std::string_view word = words.empty() ? "" : words[0];
    if (word == "end_header") break;
    if (word == "comment") comments_.push_back(line.substr(std::min(line.size(), size_t(8))));
    if (word.empty() || word == "comment" || word == "obj_info") continue;
    if (word == "format" && words.size() == 3) {
      constexpr std::array<std::string_view, 3> kEncodings = {"ascii", "binary_little_endian",
                                                              "binary_big_endian"};
      const auto at = std::ranges::find(kEncodings, words[1]);
      if (at == kEncodings.end()) fail(fmt::format("unknown format {}", quoted(words[1])));
      encoding = PlyEncoding(at - kEncodings.begin());
    } else if (word == "element" && words.size() == 3) {
      size_t count = 0;
      const auto [stop, error] =
          std::from_chars(words[2].data(), words[2].data() + words[2].size(), count);
      if (error != std::errc() || stop != words[2].data() + words[2].size())
        fail(fmt::format("expected a number of elements, found {}", quoted(words[2])));
      elements_.push_back({std::string(words[1]), count, {}});
    } else if (word == "property" && !elements_.empty() && words.size() == 3) {
      elements_.back().properties.push_back({std::string(words[2]), type_of(words[1]), {}});
    } else if (word == "property" && !elements_.empty() && words.size() == 5 &&
               words[1] == "list") {
      elements_.back().properties.push_back(
          {std::string(words[4]), type_of(words[3]), type_of(words[2])});
    } else {
      fail(fmt::format("expected format, element, property, comment or end_header, found {}",
                       quoted(word)));
    }
  }
  if (!encoding) fail("the header has no line \"format\"");
  at_.encoding = *encoding;
}

// --- rows
void PlyFile::check_count(const PlyElement& element) const {
  // An element takes at least one byte.
  if (element.properties.empty() || element.count > at_.bytes_left())
    fail(fmt::format("the header's {} elements {} do not fit in the file", element.count,
                     core::quoted(element.name)));
  if (element.count >= (size_t(1) << 29))
    fail(fmt::format("{} elements {} are too many", element.count, core::quoted(element.name)));
}

void PlyFile::skip(const PlyElement& element) {
  if (element.count > 0) check_count(element);
  for (size_t i = 0; i < element.count; ++i) at_.skip(element);
}

std::vector<PlyCursor> PlyFile::chunk_starts(const PlyElement& element) {
  const size_t chunks = chunks_of(element.count);
  if (chunks < 2) return {};
  std::vector<PlyCursor> starts;
  PlyCursor at = at_;
  if (at.encoding == PlyEncoding::text) {
    if (!lines_) lines_.emplace(std::string_view(body_, size_t(at.end - body_)));
    at.skip_blanks();
    const auto first = size_t(at.line - header_lines_);
    if (first + element.count > lines_->size()) return {};
    for (size_t c = 0; c < chunks; ++c) {
      starts.push_back(at);
      if (c == 0) continue;
      starts[c].p = lines_->begin_of(first + c * kLoopChunk);
      starts[c].line += int(c * kLoopChunk);
    }
    return starts;
  }
  const size_t row = element.has_lists() ? 0 : element.row_bytes();
  if (row * element.count > at.bytes_left()) return {};
  for (size_t i = 0; i < element.count; ++i) {
    if (i % kLoopChunk == 0) starts.push_back(at);
    if (row > 0)
      at.p += row;
    else
      at.skip(element);
  }
  return starts;
}

}  // namespace raio::core
