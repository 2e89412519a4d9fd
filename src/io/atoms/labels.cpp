#include "io/atoms/labels.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "io/atoms/colors.h"

namespace raio::core {

std::optional<uint32_t> AtomLabels::atom(std::optional<uint32_t> prototype, uint32_t sphere) const {
  uint32_t atom = sphere;
  if (!prototype && !of_prototype.empty()) return std::nullopt;  // a corner of the cell
  if (prototype && *prototype < of_prototype.size() && !of_prototype[*prototype].empty()) {
    const auto& some = of_prototype[*prototype];
    if (sphere >= some.size()) return std::nullopt;
    atom = some[sphere];
  }
  return atom < atoms ? std::optional(atom) : std::nullopt;
}

const Residue* AtomLabels::residue(uint32_t atom) const {
  return atom < residues.size() && residues[atom] < residue_names.size()
             ? &residue_names[residues[atom]]
             : nullptr;
}

const std::string* AtomLabels::chain(uint32_t atom) const {
  if (!residue(atom) || residues[atom] >= chains.size()) return nullptr;
  const uint32_t chain = chains[residues[atom]];
  return chain < chain_names.size() ? &chain_names[chain] : nullptr;
}

std::string AtomLabels::label(uint32_t atom, std::string_view chain_word) const {
  std::string text;
  const auto add = [&](std::string_view part, std::string_view between = ", ") {
    if (part.empty()) return;
    if (!text.empty()) text += between;
    text += part;
  };
  if (atom < elements.size()) add(element_symbol(elements[atom]));
  const Residue* const at = residue(atom);
  if (at) add(fmt::format("{} {}", at->view(), at->number));
  if (at && at->insertion != ' ') text += at->insertion;
  add(marks.name(index(atom)), at ? " " : ", ");
  if (const std::string* name = chain(atom); name && !name->empty())
    add(fmt::format("{} {}", chain_word, *name));
  return text;
}

std::string AtomLabels::select(const std::vector<uint32_t>& chosen) const {
  std::vector<uint32_t> all;
  all.reserve(chosen.size());
  for (const uint32_t atom : chosen) all.push_back(index(atom));
  std::ranges::sort(all);
  all.erase(std::ranges::unique(all).begin(), all.end());
  std::string text;
  for (size_t i = 0; i < all.size();) {
    size_t last = i;
    while (last + 1 < all.size() && all[last + 1] == all[last] + 1) ++last;
    text += text.empty() ? "index " : ",";
    text += last == i ? fmt::format("{}", all[i]) : fmt::format("{}-{}", all[i], all[last]);
    i = last + 1;
  }
  return text;
}

template <class Is>
std::string AtomLabels::select_where(const Is& is) const {
  std::vector<uint32_t> chosen;
  for (uint32_t i = 0; i < residues.size(); ++i)
    if (is(residues[i])) chosen.push_back(i);
  return select(chosen);
}

std::string AtomLabels::select_chain(uint32_t atom) const {
  const std::string* const name = chain(atom);
  if (!name) return {};
  // Those that are no word of a selection.
  if (name->empty() || name->find_first_of(" \t(),;") != std::string::npos)
    return select_where([&](uint32_t i) { return chains[i] == chains[residues[atom]]; });
  return "chain " + *name;
}

std::string AtomLabels::select_residue(uint32_t atom) const {
  const Residue* const at = residue(atom);
  if (!at) return {};
  const uint32_t own = residues[atom];
  const auto chain_of = [&](uint32_t i) { return i < chains.size() ? chains[i] : 0; };
  // Its number is enough unless it is that of another residue, too: one with an insertion code, or
  // of numbers that begin anew.
  bool is_only = true;
  for (uint32_t i = 0; i < residue_names.size(); ++i)
    is_only &= i == own || residue_names[i].number != at->number ||
               (chain_of(i) != chain_of(own) && chain_of(i) != kNone);
  const std::string of_chain = chains.empty() ? "" : select_chain(atom);
  if (!is_only || of_chain.starts_with("index"))
    return select_where([&](uint32_t i) { return i == own; });
  return fmt::format("residue {}{}", at->number, of_chain.empty() ? "" : " and " + of_chain);
}

}  // namespace raio::core
