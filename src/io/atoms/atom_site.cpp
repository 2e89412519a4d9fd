#include "io/atoms/atom_site.h"

#include <algorithm>
#include <map>
#include <unordered_map>

#include "base/parallel.h"
#include "io/atoms/element_names.h"
#include "io/atoms/site_values.h"

namespace raio::core {
namespace {

using cif::AtomAddress, cif::ResidueNumber, cif::drop_large_numbers, cif::number_of, cif::text_of;

// Insertion codes are compared without case.
bool is_same(const ResidueNumber& a, const ResidueNumber& b) {
  return a.number == b.number && (a.insertion | 0x20) == (b.insertion | 0x20);
}

std::string text_of(const ResidueNumber& number) {
  std::string out = number.number ? std::to_string(*number.number) : "?";
  if (number.insertion != ' ') out += number.insertion;
  return out;
}

// Identifies a residue within a chain.
struct ResidueKey {
  std::string_view name;
  ResidueNumber number;
  bool operator==(const ResidueKey& other) const {
    return name == other.name && is_same(number, other.number);
  }
};
struct HashOfKey {
  size_t operator()(const ResidueKey& key) const {
    const size_t number =
        size_t(key.number.number.value_or(-1)) << 8 | uint8_t(key.number.insertion | 0x20);
    return std::hash<std::string_view>()(key.name) ^ number * 0x9e3779b97f4a7c15u;
  }
};

// The columns that gemmi reads, by its names.
constexpr std::pair<SiteColumn, const char*> kSample[] = {
    {SiteColumn::id, "id"},
    {SiteColumn::symbol, "type_symbol"},
    {SiteColumn::name, "label_atom_id"},
    {SiteColumn::conformer, "label_alt_id"},
    {SiteColumn::residue, "label_comp_id"},
    {SiteColumn::part, "label_asym_id"},
    {SiteColumn::label_number, "label_seq_id"},
    {SiteColumn::insertion, "pdbx_PDB_ins_code"},
    {SiteColumn::x, "Cartn_x"},
    {SiteColumn::y, "Cartn_y"},
    {SiteColumn::z, "Cartn_z"},
    {SiteColumn::occupancy, "occupancy"},
    {SiteColumn::b_factor, "B_iso_or_equiv"},
    {SiteColumn::charge, "pdbx_formal_charge"},
    {SiteColumn::number, "auth_seq_id"},
    {SiteColumn::chain, "auth_asym_id"},
    {SiteColumn::model, "pdbx_PDB_model_num"}};

}  // namespace

template <class Use>
void AtomSite::for_rows(const Residue& residue, const Use& use) const {
  for (size_t run = residue.run; run != SIZE_MAX; run = runs_[run].next)
    for (const SiteRow* row = runs_[run].begin; row != runs_[run].end; ++row) use(*row);
}

void AtomSite::tell_of_parts(Notices& notices) const {
  ElementCases elements;
  for (const Part& part : parts_)
    for (const auto& [element, name] : part.guesses) elements.add(element, name);
  elements.tell(notices);
  Cases dropped;
  for (const SiteColumn of : kWholeNumbers)
    for (const Part& part : parts_)
      for (const auto& [column, value] : part.too_large)
        if (column == of) dropped.add(value);
  dropped.tell(notices, Severity::left_out,
               "serials, residue numbers and charges that do not fit in 32 bits");
}

void AtomSite::group(Notices& notices) {
  tell_of_parts(notices);
  for (const Part& part : parts_)
    for (size_t i = 0; i < part.runs.size(); ++i) {
      runs_.push_back(part.runs[i]);
      const size_t end = i + 1 < part.runs.size() ? part.runs[i + 1].first : part.rows.size();
      runs_.back().begin = part.rows.data() + part.runs[i].first;
      runs_.back().end = part.rows.data() + end;
    }
  // The residues since the chain last changed; their rows need not be contiguous.
  std::unordered_map<ResidueKey, size_t, HashOfKey> known;
  size_t chain = 0, model = 0;
  for (size_t i = 0; i < runs_.size(); ++i) {
    const SiteRun& run = runs_[i];
    const bool is_in_model = i > 0 && run.model == runs_[i - 1].model;
    if (!is_in_model) {
      model = size_t(std::ranges::find(models_, run.model) - models_.begin());
      if (model == models_.size()) models_.push_back(run.model);
    }
    if (!is_in_model || run.chain != runs_[i - 1].chain) ++chain, known.clear();
    const auto [at, is_new] = known.emplace(ResidueKey{run.residue, run.number}, residues_.size());
    if (is_new) {
      residues_.push_back({i, i, model, chain});
    } else {
      Residue& residue = residues_[at->second];
      runs_[residue.last_run].next = i;
      residue.last_run = i;
    }
  }
}

std::vector<std::string> AtomSite::sample_tags() {
  std::vector<std::string> out;
  for (const auto& [column, tag] : kSample) out.push_back(std::string("_atom_site.") + tag);
  return out;
}

std::vector<std::string> AtomSite::sample(bool of_residues) const {
  std::vector<std::string> out;
  // gemmi reads the label number of a residue from its first row only.
  const auto add = [&](const SiteRow& row, bool begins_residue) {
    SiteValues values = values_of(row);
    drop_large_numbers(values, [](SiteColumn, std::string_view) {});
    if (!begins_residue) values[SiteColumn::label_number] = "?";
    for (const auto& [column, tag] : kSample) out.emplace_back(values[column]);
  };
  std::vector<bool> has_model(models_.size());
  auto residue = residues_.begin();
  for (size_t i = 0; i < runs_.size(); ++i) {
    const SiteRun& run = runs_[i];
    const bool begins = residue != residues_.end() && residue->run == i;
    if (begins) {
      if (of_residues || !has_model[residue->model]) add(*run.begin, true);
      has_model[residue->model] = true;
      ++residue;
    }
    const auto is_unreadable = [&](const SiteRow& row) {
      return !row.is_readable || (begins && &row == run.begin && !run.has_label_number);
    };
    const SiteRow* const row = std::find_if(run.begin, run.end, is_unreadable);
    if (row == run.end) continue;
    add(*row, begins && row == run.begin);
    break;
  }
  return out;
}

std::string AtomSite::name_of(const Residue& residue) const {
  const SiteRun& run = runs_[residue.run];
  return std::string(run.residue).append(" ").append(run.chain) + text_of(run.number);
}

std::string AtomSite::name_of(const Atoms& atoms, uint32_t atom) const {
  return std::string(text_of(values_of(*rows_[atom])[SiteColumn::name])) + ' ' +
         name_of(*taken_[atoms.atoms[atom].residue]);
}

// In blocks, since rows are cut into words again, which is slow.
void AtomSite::add_marks(AtomMarks& marks) const {
  struct Mark {
    std::string_view name;
    std::optional<uint64_t> number;
  };
  constexpr size_t kBlock = 1 << 16;
  const auto is_in_file = [&](SiteColumn column) {
    return sources_[size_t(column)].column < width_;
  };
  const bool has_names = is_in_file(SiteColumn::name), has_numbers = is_in_file(SiteColumn::id);
  std::vector<Mark> block;
  for (size_t from = 0; from < rows_.size(); from += kBlock) {
    block.assign(std::min(kBlock, rows_.size() - from), {});
    for_each_index(block.size(), [&](size_t i) {
      const SiteValues values = values_of(*rows_[from + i]);
      if (has_names) block[i].name = text_of(values[SiteColumn::name]);
      if (has_numbers) block[i].number = whole_number(text_of(values[SiteColumn::id]));
    });
    for (const Mark& mark : block) marks.add(mark.name, mark.number);
  }
}

std::array<double, 3> AtomSite::place_of(uint32_t atom) const {
  const SiteValues values = values_of(*rows_[atom]);
  std::array<double, 3> out{};
  for (size_t k = 0; k < 3; ++k) out[k] = number_of(values[size_t(SiteColumn::x) + k]);
  return out;
}

void AtomSite::add_atoms(const Residue& residue, uint32_t chain, uint32_t part, Cases& conformers,
                         Atoms& out) {
  bool has_conformers = false;
  for_rows(residue, [&](const SiteRow& row) { has_conformers |= row.conformer != 0; });
  // By name, since some programs name several atoms by their element alone.
  std::map<std::string_view, char> chosen;
  for_rows(residue, [&](const SiteRow& row) {
    if (has_conformers) {
      const std::string_view name = text_of(values_of(row)[SiteColumn::name]);
      const char first = chosen.emplace(name, row.conformer).first->second;
      if (row.conformer && row.conformer != first) return conformers.add(name_of(residue));
    }
    out.atoms.push_back({.place = row.place,
                         .element = row.element,
                         .chain = chain,
                         .part = part,
                         .residue = uint32_t(out.residues.size()),
                         .occupancy = row.occupancy,
                         .b_factor = row.b_factor});
    rows_.push_back(&row);
  });
}

uint32_t AtomSite::atom_of(const AtomAddress& end, const Residue& residue,
                           size_t first_atom) const {
  const SiteRow* found = nullptr;
  for_rows(residue, [&](const SiteRow& row) {
    const bool is_conformer =
        row.conformer == 0 || end.conformer == '*' || row.conformer == end.conformer;
    if (!found && is_conformer && text_of(values_of(row)[SiteColumn::name]) == end.atom)
      found = &row;
  });
  const auto at = std::find(rows_.begin() + ptrdiff_t(first_atom), rows_.end(), found);
  return at == rows_.end() || end.atom.empty() ? kNoAtom : uint32_t(at - rows_.begin());
}

std::vector<uint32_t> AtomSite::fill(size_t model, Names& parts,
                                     const std::vector<AtomAddress>& ends, Atoms& out) {
  Names chains(out.chains);
  std::vector<uint32_t> atoms_of_ends(ends.size(), kNoAtom);
  std::unordered_multimap<int, size_t> ends_at;  // by residue number
  for (size_t i = 0; i < ends.size(); ++i) ends_at.emplace(ends[i].number.number.value_or(-1), i);
  Cases conformers, second_residues;
  const Residue* before = nullptr;
  for (const Residue& residue : residues_) {
    if (residue.model != model) continue;
    const SiteRun& run = runs_[residue.run];
    const size_t first_atom = out.atoms.size();
    if (before && stands_in_place_of(*before, residue)) {
      second_residues.add(name_of(residue));
    } else {
      const uint32_t chain = chains.number(run.chain), part = parts.number(run.part);
      add_atoms(residue, chain, part, conformers, out);
      out.residues.push_back(residue_of(run.residue, text_of(run.number)));
      taken_.push_back(before = &residue);
    }
    for (auto [at, last] = ends_at.equal_range(run.number.number.value_or(-1)); at != last;) {
      const AtomAddress& end = ends[at->second];
      if (end.chain != run.chain || end.residue != run.residue ||
          !is_same(end.number, run.number)) {
        ++at;
        continue;
      }
      // Takes the first of several such residues.
      atoms_of_ends[at->second] = atom_of(end, residue, first_atom);
      at = ends_at.erase(at);
    }
  }
  conformers.tell(out.notices, Severity::left_out, "atoms of alternate conformers");
  second_residues.tell(out.notices, Severity::left_out,
                       "residues with the number and position of another");
  return atoms_of_ends;
}

bool AtomSite::stands_in_place_of(const Residue& first, const Residue& second) const {
  const SiteRun &a = runs_[first.run], &b = runs_[second.run];
  const char conformer = a.begin->conformer, other = b.begin->conformer;
  return first.chain == second.chain && is_same(a.number, b.number) && conformer && other &&
         conformer != other;
}

}  // namespace raio::core
