#include "io/atoms/cif/block.h"

#include <algorithm>
#include <ranges>

#include "io/atoms/site_values.h"

namespace raio::core::cif {
namespace {

bool is_same(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c | 32) : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

Column column_of(const Item& item, std::string_view tag) {
  const auto at =
      std::ranges::find_if(item.tags, [&](const auto& own) { return is_same(own, tag); });
  return at == item.tags.end() ? Column() : Column(item, size_t(at - item.tags.begin()));
}

}  // namespace

Column find_values(const Block& block, std::string_view tag) {
  for (const Item& item : block.items)
    if (const Column column = column_of(item, tag)) return column;
  return {};
}

size_t index_of(const Block& block, std::string_view tag) {
  const auto has = [&](const Item& item) { return bool(column_of(item, tag)); };
  return size_t(std::ranges::find_if(block.items, has) - block.items.begin());
}

bool has_prefix(const Item& item, std::string_view prefix) {
  return !item.tags.empty() &&
         is_same(std::string_view(item.tags[0]).substr(0, prefix.size()), prefix);
}

Table::Table(const Block& block, std::string_view prefix, const std::vector<std::string>& tags) {
  const Column first = find_values(block, std::string(prefix) + tags[0]);
  const Item* const loop = first && first.item()->is_loop ? first.item() : nullptr;
  for (const std::string& tag : tags) {
    const bool is_optional = tag.starts_with('?');
    const std::string whole = std::string(prefix).append(tag, is_optional);
    Column column;
    if (loop)
      column = column_of(*loop, whole);
    else
      for (const Item& item : block.items)
        if (!item.is_loop && !column) column = column_of(item, whole);
    if (!column && !is_optional) {
      columns_.clear();
      return;
    }
    columns_.push_back(column);
  }
}

std::string_view Table::text(size_t row, size_t column) const {
  return columns_[column] ? text_of(at(row, column)) : std::string_view();
}

bool Table::has(const Item& item) const {
  return std::ranges::any_of(columns_, [&](const Column& c) { return c.item() == &item; });
}

}  // namespace raio::core::cif
