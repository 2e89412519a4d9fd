#include "io/atoms/cif/assemblies.h"

#include <algorithm>
#include <gemmi/numb.hpp>
#include <locale>
#include <sstream>
#include <stdexcept>

namespace raio::core {
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

}  // namespace

Assemblies::Assemblies(gemmi::cif::Block& block) {
  gemmi::cif::Table table =
      block.find("_pdbx_struct_assembly_gen.", {"assembly_id", "oper_expression", "asym_id_list"});
  for (const auto row : table) generators_.push_back({row.str(0), row.str(1), row.str(2)});
  if (table.ok()) table.erase();
  std::vector<std::string> tags = {"id"};
  for (const char* row : {"1", "2", "3"}) {
    for (const char* column : {"1", "2", "3"})
      tags.push_back(std::string("matrix[") + row + "][" + column + "]");
    tags.push_back(std::string("vector[") + row + "]");
  }
  for (const auto row : block.find("_pdbx_struct_oper_list.", tags)) {
    gemmi::Transform t;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k)
        t.mat[i][k] = gemmi::cif::as_number(row[4 * size_t(i) + size_t(k) + 1]);
      t.vec.at(i) = gemmi::cif::as_number(row[4 * size_t(i) + 4]);
    }
    operations_.emplace(row.str(0), t);
  }
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
    for (const gemmi::Transform& t : operations_of(from.expression)) {
      std::array<float, 12> matrix{};
      for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column)
          matrix[4 * size_t(row) + size_t(column)] = float(t.mat[row][column]);
        matrix[4 * size_t(row) + 3] = float(t.vec.at(row));
      }
      copies.matrices.push_back(matrix);
    }
    out[at->second].copies.push_back(copies);
  }
  return out;
}

std::vector<gemmi::Transform> Assemblies::operations_of(const std::string& expression) const {
  std::vector<gemmi::Transform> all = {gemmi::Transform()};
  bool any = false;
  for (std::string list : split(expression, ')')) {
    list.erase(std::remove(list.begin(), list.end(), '('), list.end());
    std::vector<gemmi::Transform> next;
    for (const std::string& word : split(list, ','))
      for (const gemmi::Transform& last : named(word))
        for (const gemmi::Transform& first : all) {
          if (next.size() == kMaxCopies)
            throw std::runtime_error("its assembly has more than a million instances");
          next.push_back(first.combine(last));
        }
    all = std::move(next), any = true;
  }
  return any ? all : std::vector<gemmi::Transform>();
}

// The operation, or all operations in a range of numbers.
std::vector<gemmi::Transform> Assemblies::named(const std::string& word) const {
  std::vector<gemmi::Transform> out;
  const auto at = operations_.find(word);
  if (at != operations_.end()) return {at->second};
  const size_t dash = word.find('-', 1);
  if (dash == std::string::npos) return out;
  const int64_t low = std::atoll(word.c_str()), high = std::atoll(word.c_str() + dash + 1);
  std::map<int64_t, gemmi::Transform> found;
  for (const auto& [name, t] : operations_)
    if (const int64_t number = std::atoll(name.c_str());
        number >= low && number <= high && std::to_string(number) == name)
      found.emplace(number, t);
  for (const auto& [number, t] : found) out.push_back(t);
  return out;
}

}  // namespace raio::core
