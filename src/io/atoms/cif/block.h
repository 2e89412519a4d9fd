// Finds values in a block of CIF by their tags, in any case.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "io/atoms/gemmi.h"

namespace raio::core::cif {

/// The values of a tag; none if the block does not have it.
class Column {
 public:
  Column() = default;
  Column(const Item& item, size_t at) : item_(&item), at_(at) {}

  explicit operator bool() const { return item_ != nullptr; }
  size_t size() const { return item_ ? item_->values.size() / item_->tags.size() : 0; }
  const std::string& operator[](size_t row) const {
    return item_->values[row * item_->tags.size() + at_];
  }
  const Item* item() const { return item_; }

 private:
  const Item* item_ = nullptr;
  size_t at_ = 0;
};

Column find_values(const Block& block, std::string_view tag);
inline bool has_tag(const Block& block, std::string_view tag) {
  return bool(find_values(block, tag));
}
/// The index of the item with the tag; their number if there is none.
size_t index_of(const Block& block, std::string_view tag);
/// Whether the tags of the item begin so; the prefix is in lower case.
bool has_prefix(const Item& item, std::string_view prefix);

/// Columns of one loop, or pairs, which are one row. Empty if a tag is missing, unless the tag
/// begins with '?'.
class Table {
 public:
  Table(const Block& block, std::string_view prefix, const std::vector<std::string>& tags);

  bool is_complete() const { return !columns_.empty(); }
  size_t rows() const { return columns_.empty() ? 0 : columns_[0].size(); }
  const std::string& at(size_t row, size_t column) const { return columns_[column][row]; }
  /// The text of a value, without quotes; empty if the value or its column is missing.
  std::string_view text(size_t row, size_t column) const;
  /// Whether the table has the item.
  bool has(const Item& item) const;

 private:
  std::vector<Column> columns_;
};

}  // namespace raio::core::cif
