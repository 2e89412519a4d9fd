// The header of a PLY file, and its rows of numbers and lists.
#pragma once

#include <array>
#include <bit>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/parallel.h"
#include "io/atoms/lines.h"
#include "io/mesh/builder.h"

namespace raio::core {

enum class PlyType : uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
enum class PlyEncoding : uint8_t { text, little, big };

constexpr bool is_whole(PlyType type) { return type != PlyType::f32 && type != PlyType::f64; }
constexpr size_t size_of(PlyType type) {
  constexpr std::array<size_t, 8> kSizes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[size_t(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  std::optional<PlyType> count;  // the count's type if this is a list
};
struct PlyElement {
  std::string name;
  size_t count = 0;
  std::vector<PlyProperty> properties;

  bool has_lists() const;
  /// The size of a binary row without lists.
  size_t row_bytes() const;
};

/// Reads a binary number; `swap` reverses its bytes.
double ply_number(const char* p, PlyType type, bool swap);

/// A read position in the elements.
struct PlyCursor {
  const char* p;
  const char* end;
  PlyEncoding encoding = PlyEncoding::text;
  int line = 0;

  [[noreturn]] void fail(std::string message) const {
    const int known = encoding == PlyEncoding::text ? line : 0;
    throw ReadFailure{std::move(message), known, known > 0};
  }
  size_t bytes_left() const { return size_t(end - p); }

  void skip_blanks() {
    while (is_char(*p, kBlank) && p < end) line += *p++ == '\n';
  }
  double next(PlyType type) {
    if (encoding != PlyEncoding::text) return next_binary(type);
    skip_blanks();
    double value = 0;
    const char* stop = p < end ? parse_number(p, value) : nullptr;
    if (!stop) stop = parse_not_finite(type, value);
    p = stop;
    return value;
  }
  void next_list(const PlyProperty& property, std::vector<double>& out);
  void skip(const PlyProperty& property);
  void skip(const PlyElement& element);  // skips a row

 private:
  size_t next_count(const PlyProperty& list);
  double next_binary(PlyType type);
  /// Parses "nan" and "inf", which other programs write for unknown values; fails otherwise.
  const char* parse_not_finite(PlyType type, double& value) const;
};

/// The values of a row.
struct PlyRow {
  std::vector<double> values;  // by property; lists have none
  std::vector<double> list;    // the requested list
};

/// A PLY file whose elements are read in sequence; failures throw ReadFailure.
class PlyFile {
 public:
  /// Reads the header.
  explicit PlyFile(const TextBuffer& bytes);

  std::span<const PlyElement> elements() const { return elements_; }
  /// Comments of the header, after the word "comment".
  std::span<const std::string_view> comments() const { return comments_; }
  /// The position after what was read.
  PlyCursor& at() { return at_; }
  [[noreturn]] void fail(std::string message) const { at_.fail(std::move(message)); }

  /// Fails if the elements cannot fit in the file.
  void check_count(const PlyElement& element) const;
  void skip(const PlyElement& element);

  /// Calls take(i, row, cursor) for each row of an element, with the list of this property; the
  /// cursor is after the row. Runs in parallel if rows can be found without parsing. Otherwise, or
  /// on any failure, reads in sequence from the first row on, so that the first fault is reported.
  /// Rows of a loop chunk (kLoopChunk) are in order.
  template <class Take>
  void read_rows(const PlyElement& element, size_t list, const Take& take) {
    if (!read_on_threads(element, list, take)) {
      PlyRow row{std::vector<double>(element.properties.size()), {}};
      for (size_t i = 0; i < element.count; ++i) {
        read_row(at_, element, list, row);
        take(i, std::as_const(row), std::as_const(at_));
      }
    }
  }

 private:
  std::string_view header_line();
  PlyType type_of(std::string_view name) const;
  void read_header();
  // The start of each chunk of rows, in text only if each row is a line. Empty if parallel reading
  // is impossible or does not pay.
  std::vector<PlyCursor> chunk_starts(const PlyElement& element);

  static void read_row(PlyCursor& at, const PlyElement& element, size_t list, PlyRow& row) {
    for (size_t k = 0; k < element.properties.size(); ++k) {
      const PlyProperty& property = element.properties[k];
      if (!property.count) {
        row.values[k] = at.next(property.type);
        continue;
      }
      if (k == list)
        at.next_list(property, row.list);
      else
        at.skip(property);
    }
  }

  template <class Take>
  bool read_on_threads(const PlyElement& element, size_t list, const Take& take) try {
    std::vector<PlyCursor> starts = chunk_starts(element);
    if (starts.empty()) return false;
    const int line = starts[0].line;
    for_chunks(element.count, [&](size_t c, size_t first, size_t end) {
      PlyCursor at = starts[c];
      PlyRow row{std::vector<double>(element.properties.size()), {}};
      for (size_t i = first; i < end; ++i) {
        read_row(at, element, list, row);
        if (at.encoding == PlyEncoding::text && !(at.line == line + int(i) && ends_line(at)))
          at.fail("");
        take(i, std::as_const(row), std::as_const(at));
      }
      starts[c] = at;
    });
    at_ = starts.back();
    return true;
  } catch (const ReadFailure&) {
    return false;
  }
  static bool ends_line(const PlyCursor& at) {
    const char* const p = skip_blanks_in_line(at.p);
    return p == at.end || *p == '\n' || (*p == '\r' && p[1] == '\n');
  }

  PlyCursor at_;
  std::vector<PlyElement> elements_;
  std::vector<std::string_view> comments_;
  bool ends_with_cr_ = false;       // whether header lines end with CR alone
  std::optional<LineIndex> lines_;  // of a text, from body_ on
  const char* body_ = nullptr;
  int header_lines_ = 0;
};

}  // namespace raio::core
