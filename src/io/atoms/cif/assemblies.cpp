#include "io/atoms/cif/assemblies.h"

#include <algorithm>
#include <locale>
#include <sstream>
#include <stdexcept>

#include "io/atoms/cif/block.h"
#include "io/atoms/site_values.h"

namespace raio::core::cif {
namespace {

constexpr size_t kMaxCopies = 1000000;

std::vector<std::string> split(const std::string& list, char by) {
  std::vector<std::string> out;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, by);) {
    word.erase(std::remove_if(word.begin(), word.end(), [](char c) { return c <= ' '; }),
               word.end());
    if (!word.empty()) out.push_back(word);
  }
  return out;
}

// First `second`, then `first`.
Assemblies::Transform product(const Assemblies::Transform& first,
                              const Assemblies::Transform& second) {
  Assemblies::Transform out{};
  for (size_t i = 0; i < 3; ++i) {
    for (size_t k = 0; k < 4; ++k)
      out[i][k] =
          first[i][0] * second[0][k] + first[i][1] * second[1][k] + first[i][2] * second[2][k];
    out[i][3] += first[i][3];
  }
  return out;
}

}  // namespace

Assemblies::Assemblies(Block& block) {
  const Table table(block, "_pdbx_struct_assembly_gen.",
                    {"assembly_id", "oper_expression", "asym_id_list"});
  for (size_t row = 0; row < table.rows(); ++row)
    generators_.push_back({std::string(table.text(row, 0)), std::string(table.text(row, 1)),
                           std::string(table.text(row, 2))});
  std::vector<std::string> tags = {"id"};
  for (const char* row : {"1", "2", "3"}) {
    for (const char* column : {"1", "2", "3"})
      tags.push_back(std::string("matrix[") + row + "][" + column + "]");
    tags.push_back(std::string("vector[") + row + "]");
  }
  const Table list(block, "_pdbx_struct_oper_list.", tags);
  for (size_t row = 0; row < list.rows(); ++row) {
    Transform t;
    for (size_t i = 0; i < 3; ++i)
      for (size_t k = 0; k < 4; ++k) t[i][k] = number_of(list.at(row, 4 * i + k + 1));
    operations_.emplace(list.text(row, 0), t);
  }
  std::erase_if(block.items, [&](const Item& item) { return table.has(item); });
}

std::vector<Assembly> Assemblies::take(Names& parts) const {
  std::vector<Assembly> out;
  std::map<std::string, size_t> places;
  for (const Generator& from : generators_) {
    const auto [at, is_new] = places.emplace(from.assembly, out.size());
    if (is_new) out.emplace_back();
    Assembly::Copies copies;
    for (const std::string& name : split(from.parts, ','))
      copies.parts.push_back(parts.number(name));
    for (const Transform& t : operations_of(from.expression)) {
      std::array<float, 12> matrix{};
      for (size_t i = 0; i < matrix.size(); ++i) matrix[i] = float(t[i / 4][i % 4]);
      copies.matrices.push_back(matrix);
    }
    out[at->second].copies.push_back(copies);
  }
  return out;
}

std::vector<Assemblies::Transform> Assemblies::operations_of(const std::string& expression) const {
  std::vector<Transform> all = {{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}}};
  bool any = false;
  for (std::string list : split(expression, ')')) {
    list.erase(std::remove(list.begin(), list.end(), '('), list.end());
    std::vector<Transform> next;
    for (const std::string& word : split(list, ','))
      for (const Transform& last : named(word))
        for (const Transform& first : all) {
          if (next.size() == kMaxCopies)
            throw std::runtime_error("its assembly has more than a million instances");
          next.push_back(product(first, last));
        }
    all = std::move(next), any = true;
  }
  return any ? all : std::vector<Transform>();
}

// The operation, or all operations in a range of numbers.
std::vector<Assemblies::Transform> Assemblies::named(const std::string& word) const {
  std::vector<Transform> out;
  const auto at = operations_.find(word);
  if (at != operations_.end()) return {at->second};
  const size_t dash = word.find('-', 1);
  if (dash == std::string::npos) return out;
  const int64_t low = std::atoll(word.c_str()), high = std::atoll(word.c_str() + dash + 1);
  std::map<int64_t, Transform> found;
  for (const auto& [name, t] : operations_)
    if (const int64_t number = std::atoll(name.c_str());
        number >= low && number <= high && std::to_string(number) == name)
      found.emplace(number, t);
  for (const auto& [number, t] : found) out.push_back(t);
  return out;
}

}  // namespace raio::core::cif
