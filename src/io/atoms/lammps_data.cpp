// The data files that LAMMPS begins with: a header, then sections, such as Masses, Atoms and Bonds
// (https://docs.lammps.org/read_data.html).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <gemmi/elem.hpp>
#include <map>
#include <unordered_map>

#include "io/atoms/colors.h"
#include "io/atoms/read.h"
#include "io/atoms/rows.h"

namespace raio {
namespace {

using Done = std::expected<void, Diagnostics>;

// How atoms are written in each style that is read: id, molecule, type, charge, diameter, density.
struct Style {
  std::string_view name;
  std::vector<Word> words;
};
const Style kStyles[] = {
    {"atomic", {Word::skipped, Word::type, Word::x, Word::y, Word::z}},
    {"charge", {Word::skipped, Word::type, Word::skipped, Word::x, Word::y, Word::z}},
    {"bond", {Word::skipped, Word::residue, Word::type, Word::x, Word::y, Word::z}},
    {"angle", {Word::skipped, Word::residue, Word::type, Word::x, Word::y, Word::z}},
    {"molecular", {Word::skipped, Word::residue, Word::type, Word::x, Word::y, Word::z}},
    {"full", {Word::skipped, Word::residue, Word::type, Word::skipped, Word::x, Word::y, Word::z}},
    {"sphere",
     {Word::skipped, Word::type, Word::diameter, Word::skipped, Word::x, Word::y, Word::z}}};

// Atoms heavier than it have masses of elements, others those of a model.
constexpr double kLeastMass = 3, kMassTolerance = 0.5;
// United atoms, such as CH4, weigh up to this much more than their element.
constexpr double kHydrogens = 4.5;

double mass_of(int element) { return gemmi::Element(static_cast<gemmi::El>(element)).weight(); }

class DataReader {
 public:
  DataReader(const TextBuffer& text, std::string_view file)
      : index_(text.view()), lines_(index_), file_(file) {}

  std::expected<Atoms, Diagnostics> read() {
    (void)lines_.next();  // the title
    for (auto line = lines_.next_filled(); line; line = lines_.next_filled())
      if (auto done = read_line(*line); !done) return std::unexpected(done.error());
    if (out_.atoms.empty()) return fail("there is no section Atoms");
    name_elements();
    if (auto done = join_bonds(); !done) return std::unexpected(done.error());
    out_.finds_bonds = false;
    return std::move(out_);
  }

 private:
  std::unexpected<Diagnostics> fail(std::string message) const {
    return std::unexpected(
        Diagnostics{{Severity::error, std::string(file_), 0, 0, std::move(message), ""}});
  }
  std::unexpected<Diagnostics> wrong(std::string_view line, const char* at, std::string expected) {
    return wrong_line(file_, lines_.number(), line, {at, std::move(expected)});
  }

  // A line of the header, or the name of a section with all that is in it.
  Done read_line(std::string_view line) {
    const std::string_view plain = line.substr(0, line.find('#'));
    const auto words = words_of(plain);
    if (words.empty()) return {};
    const auto comment = words_of(line.substr(std::min(line.size(), plain.size() + 1)));
    if (words.size() == 3 && words[0] == "Atom" && words[1] == "Type" && words[2] == "Labels")
      return read_type_labels();
    if (words.size() == 1 && words[0] == "Masses") return read_masses();
    if (words.size() == 1 && words[0] == "Atoms") return read_atoms(line, comment);
    if (words.size() == 1 && words[0] == "Bonds") return read_bonds();
    if (words.size() == 2 && looks_like_number(words[0])) {
      size_t* const into = words[1] == "atoms" ? &atoms_ : words[1] == "bonds" ? &bonds_ : nullptr;
      if (!into) return {};
      const auto [stop, error] = std::from_chars(words[0].begin(), words[0].end(), *into);
      if (error != std::errc() || stop != words[0].end())
        return wrong(line, words[0].data(), fmt::format("the number of {}", words[1]));
    }
    if (words.size() == 4 && words[2].ends_with("lo") && words[3].ends_with("hi")) {
      const size_t axis = size_t(std::clamp(words[2][0] - 'x', 0, 2));
      double low = 0, high = 0;
      if (parse_number(words[0].data(), low) && parse_number(words[1].data(), high)) {
        Cell& cell = box();
        cell.origin[axis] = low, cell.sides[axis][axis] = high - low;
      }
    }
    if (words.size() == 6 && words[3] == "xy" && words[4] == "xz" && words[5] == "yz") {
      std::array<double, 3> tilt{};
      for (size_t i = 0; i < 3; ++i)
        if (!parse_number(words[i].data(), tilt[i])) return wrong(line, words[i].data(), "a tilt");
      Cell& cell = box();
      cell.sides[1][0] = tilt[0], cell.sides[2][0] = tilt[1], cell.sides[2][1] = tilt[2];
    }
    return {};  // of other sections and the header nothing is kept
  }

  // Numbers of types and their names, which the other sections may use instead.
  Done read_type_labels() {
    LineReader ahead = lines_;
    for (auto line = ahead.next_filled(); line; line = ahead.next_filled()) {
      const auto words = words_of(line->substr(0, line->find('#')));
      double type = 0;
      if (words.size() != 2 || !parse_number(words[0].data(), type) || !(type >= 1 && type < 1e6))
        return {};  // the next section
      lines_ = ahead;
      types_[std::string(words[1])] = uint32_t(type);
    }
    return {};
  }

  Done read_masses() {
    LineReader ahead = lines_;
    for (auto line = ahead.next_filled(); line; line = ahead.next_filled()) {
      const auto words = words_of(*line);
      double type = 0, mass = 0;
      const auto named = words.empty() ? types_.end() : types_.find(words[0]);
      if (named != types_.end()) type = named->second;
      if (words.size() < 2 || (named == types_.end() && !parse_number(words[0].data(), type)) ||
          !parse_number(words[1].data(), mass) || !(type >= 1 && type < 1e6))
        return {};  // the next section
      lines_ = ahead;
      masses_[uint32_t(type)] = mass;
      const auto comment = words_of(line->substr(std::min(line->find('#'), line->size())));
      // "# C" and "#C".
      std::string_view name = comment.empty() ? "" : comment[0].substr(1);
      if (name.empty() && comment.size() > 1) name = comment[1];
      if (name.empty() && named != types_.end()) name = words[0];
      if (const int element = element_number(name)) named_[uint32_t(type)] = element;
    }
    return {};
  }

  Done read_atoms(std::string_view line, std::span<const std::string_view> comment) {
    LineReader ahead = lines_;
    const auto first = ahead.next_filled();
    if (!first) return fail("there are no atoms in the section Atoms");
    const size_t words = words_of(first->substr(0, first->find('#'))).size();
    const std::string_view name = !comment.empty()           ? comment[0]
                                  : words == 5 || words == 8 ? std::string_view("atomic")
                                                             : std::string_view();
    const auto style = std::ranges::find(kStyles, name, &Style::name);
    if (style == std::end(kStyles))
      return wrong(
          line, line.data() + std::min(line.size(), line.find('#')),
          "the style of the atoms behind the section's name: Atoms # atomic, charge, bond, "
          "angle, molecular, full or sphere");
    first_ = ahead.number() - 1;
    const size_t left = index_.size() - first_;
    if (atoms_ == 0 || atoms_ > left)
      return fail(fmt::format("expected {} atoms, found {}", atoms_, left));
    RowLayout layout;
    layout.words = style->words;
    layout.types = types_;
    if (auto done = read_rows(index_, file_, first_, atoms_, layout, out_); !done) return done;
    lines_ = ahead;
    lines_.skip(atoms_ - 1);
    return {};
  }

  Done read_bonds() {
    if (bonds_ > index_.size()) return fail(fmt::format("there are no {} bonds", bonds_));
    for (size_t i = 0; i < bonds_; ++i) {
      const auto line = lines_.next_filled();
      if (!line) return fail(fmt::format("expected {} bonds, found {}", bonds_, i));
      const auto words = words_of(*line);
      std::array<uint64_t, 2> ids{};
      for (size_t k = 0; k < 2; ++k)
        if (words.size() < 4 ||
            std::from_chars(words[2 + k].begin(), words[2 + k].end(), ids[k]).ec != std::errc())
          return wrong(*line, line->data(), "number, type and two atoms of a bond");
      listed_.push_back(ids);
    }
    return {};
  }

  // Bonds name atoms by the numbers that begin their lines.
  Done join_bonds() {
    if (listed_.empty()) return {};
    std::unordered_map<uint64_t, uint32_t> atom_of;
    const char* p = index_.begin_of(first_);
    for (uint32_t i = 0; i < out_.atoms.size(); ++i) {
      const char* const at =
          skip_blanks_in_line(take_line(p, index_.text().data() + index_.text().size()).data());
      uint64_t id = 0;
      (void)parse_digits(at, id);
      atom_of[id] = i;
    }
    for (const auto& ids : listed_) {
      std::array<uint32_t, 2> bond{};
      for (size_t k = 0; k < 2; ++k) {
        const auto at = atom_of.find(ids[k]);
        if (at == atom_of.end())
          return fail(fmt::format("a bond names atom {}, which there is not", ids[k]));
        bond[k] = at->second;
      }
      if (bond[0] == bond[1]) continue;
      const auto cells = cells_between(out_.atoms[bond[0]], out_.atoms[bond[1]]);
      if (cells == std::array<int, 3>())
        out_.bonds.push_back(bond);
      else
        out_.bonds_across.push_back({bond, cells});
    }
    return {};
  }

  // The copy of `b` that is nearest to `a`, in sides of the box from `b`. The sides are a lower
  // triangular matrix, so the last one is subtracted first.
  std::array<int, 3> cells_between(const Atom& a, const Atom& b) const {
    std::array<int, 3> cells{};
    std::array<double, 3> apart{};
    for (size_t i = 0; i < 3; ++i) apart[i] = double(a.place[i]) - double(b.place[i]);
    for (size_t k = 3; out_.cell && k-- > 0;) {
      const auto& side = out_.cell->sides[k];
      // Half a side is none.
      const double count = side[k] > 0 ? std::nearbyint(apart[k] / side[k]) : 0;
      if (!(std::abs(count) < 1e6)) continue;
      cells[k] = int(count);
      for (size_t i = 0; i < 3; ++i) apart[i] -= count * side[i];
    }
    return cells;
  }

  Cell& box() { return out_.cell ? *out_.cell : out_.cell.emplace(); }

  // By the comment of a mass, unless the mass contradicts it: "CA" is a carbon in many force
  // fields. Otherwise by the mass, unless the masses are those of a model.
  void name_elements() {
    const bool real =
        std::ranges::any_of(masses_, [](const auto& m) { return m.second > kLeastMass; });
    std::map<uint32_t, uint8_t> elements;
    for (const auto& [type, mass] : masses_) {
      const auto difference = [&](int element) { return std::abs(mass_of(element) - mass); };
      if (const auto named = named_.find(type); named != named_.end()) {
        const double more = mass - mass_of(named->second);
        if (!real || (more >= -kMassTolerance && more <= kHydrogens)) {
          elements[type] = uint8_t(named->second);
          continue;
        }
      }
      int best = 1;
      for (int i = 2; i < kElements; ++i)
        if (difference(i) < difference(best)) best = i;
      if (real && difference(best) <= kMassTolerance) elements[type] = uint8_t(best);
    }
    for (Atom& atom : out_.atoms)
      if (const auto at = elements.find(atom.part); at != elements.end()) atom.element = at->second;
  }

  const LineIndex index_;
  LineReader lines_;
  std::string_view file_;
  size_t atoms_ = 0, bonds_ = 0, first_ = 0;
  std::map<std::string, uint32_t, std::less<>> types_;  // by their names
  std::map<uint32_t, double> masses_;                   // of types
  std::map<uint32_t, int> named_;                       // elements of types, by comments
  std::vector<std::array<uint64_t, 2>> listed_;
  Atoms out_;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_lammps_data(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options) {
  if (const std::string wrong = not_text(text.view()); !wrong.empty())
    return std::unexpected(Diagnostics{{Severity::error, std::string(file), 0, 0, wrong, ""}});
  const auto atoms = DataReader(text, file).read();
  if (!atoms) return std::unexpected(atoms.error());
  return scene_of_atoms(*atoms, file, options);
}

}  // namespace raio
