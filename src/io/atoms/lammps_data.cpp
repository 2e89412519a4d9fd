// LAMMPS data files: a header, then sections such as Masses, Atoms and Bonds
// (https://docs.lammps.org/read_data.html).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <unordered_map>

#include "base/vec.h"
#include "io/atoms/colors.h"
#include "io/atoms/lammps_styles.h"
#include "io/atoms/read.h"
#include "io/atoms/rows.h"

namespace raio::core {
namespace {

using Done = std::expected<void, Diagnostics>;

// Masses are those of elements if any atom is heavier, else those of a model.
constexpr double kMinMass = 3, kMassTolerance = 0.5;
// Whole numbers up to here are masses of models.
constexpr double kMaxModelMass = 10;
// United atoms, such as CH4, are up to this much heavier than their element.
constexpr double kHydrogens = 4.5;
// The first rows, from which the style is guessed.
constexpr size_t kRowsOfGuess = 1000;

class DataReader {
 public:
  DataReader(const TextBuffer& text, std::string_view file, const ReadOptions& options,
             const std::array<double, 3>& origin)
      : index_(text.view()), lines_(index_), file_(file), style_(options.atom_style) {
    out_.origin = origin;
    if (options.labels) out_.marks.emplace();
  }

  std::expected<Atoms, Diagnostics> read() {
    (void)lines_.next();  // the title
    for (auto line = lines_.next_filled(); line; line = lines_.next_filled())
      if (auto done = read_line(*line); !done) return std::unexpected(done.error());
    if (out_.atoms.empty()) return fail("the file has no section Atoms");
    name_elements();
    tell_coincident();
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

  // Reads a line of the header, or a section after its name.
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
      constexpr std::string_view kOwnSections[] = {"ellipsoids", "lines", "triangles", "bodies"};
      if (std::ranges::count(kOwnSections, words[1]) > 0 && words[0] != "0")
        hints_.section = words[1];
      size_t* const into = words[1] == "atoms" ? &atoms_ : words[1] == "bonds" ? &bonds_ : nullptr;
      if (!into) return {};
      const auto [stop, error] = std::from_chars(words[0].begin(), words[0].end(), *into);
      if (error != std::errc() || stop != words[0].end())
        return wrong(line, words[0].data(), fmt::format("the number of {}", words[1]));
    }
    if (words.size() == 3 && words[1] == "atom" && words[2] == "types")
      (void)std::from_chars(words[0].begin(), words[0].end(), hints_.types);
    if (words.size() == 4 && words[3].size() == 4 && words[3].ends_with("vec") &&
        words[3][0] >= 'a' && words[3][0] <= 'c')
      return read_three(line, words, box().sides[size_t(words[3][0] - 'a')]);
    if (words.size() == 5 && words[3] == "abc" && words[4] == "origin")
      return read_three(line, words, box().origin);
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
      if (auto done = read_three(line, words, tilt); !done) return done;
      Cell& cell = box();
      cell.sides[1][0] = tilt[0], cell.sides[2][0] = tilt[1], cell.sides[2][1] = tilt[2];
    }
    return {};  // other sections and header lines are not used
  }

  Done read_three(std::string_view line, std::span<const std::string_view> words,
                  std::array<double, 3>& out) {
    for (size_t i = 0; i < 3; ++i)
      if (!parse_number(words[i].data(), out[i])) return wrong(line, words[i].data(), "a number");
    return {};
  }

  // Skips comment lines between the name of a section and its rows.
  void skip_comments() {
    LineReader ahead = lines_;
    for (auto line = ahead.next_filled(); line; line = ahead.next_filled()) {
      if (line->find_first_not_of(" \t") != line->find('#')) return;
      lines_ = ahead;
    }
  }

  // Numbers and names of types; other sections may use either.
  Done read_type_labels() {
    skip_comments();
    LineReader ahead = lines_;
    for (auto line = ahead.next_filled(); line; line = ahead.next_filled()) {
      const auto words = words_of(line->substr(0, line->find('#')));
      double type = 0;
      if (words.size() != 2 || !parse_number(words[0].data(), type) || !(type >= 1 && type < 1e6))
        return {};  // the next section
      lines_ = ahead;
      out_.types[std::string(words[1])] = uint32_t(type);
    }
    return {};
  }

  Done read_masses() {
    skip_comments();
    LineReader ahead = lines_;
    for (auto line = ahead.next_filled(); line; line = ahead.next_filled()) {
      const auto words = words_of(*line);
      double type = 0, mass = 0;
      const auto named = words.empty() ? out_.types.end() : out_.types.find(words[0]);
      if (named != out_.types.end()) type = named->second;
      if (words.size() < 2 || (named == out_.types.end() && !parse_number(words[0].data(), type)) ||
          !parse_number(words[1].data(), mass) || !(type >= 1 && type < 1e6))
        return {};  // the next section
      lines_ = ahead;
      masses_[uint32_t(type)] = mass;
      const auto comment = words_of(line->substr(std::min(line->find('#'), line->size())));
      // "# C" and "#C".
      std::string_view name = comment.empty() ? "" : comment[0].substr(1);
      if (name.empty() && comment.size() > 1) name = comment[1];
      if (name.empty() && named != out_.types.end()) name = words[0];
      if (const int element = element_number(name)) named_[uint32_t(type)] = element;
    }
    return {};
  }

  Done read_atoms(std::string_view line, std::span<const std::string_view> comment) {
    const size_t name = lines_.number();
    skip_comments();
    LineReader ahead = lines_;
    const auto first = ahead.next_filled();
    if (!first) return fail("the section Atoms has no rows");
    const size_t row = ahead.number();
    first_ = row - 1;
    const size_t left = index_.size() - first_;
    if (atoms_ == 0 || atoms_ > left)
      return fail(fmt::format("expected {} atoms, found {}", atoms_, left));
    const auto words = words_of(first->substr(0, first->find('#')));
    const LammpsStyle* style =
        find_lammps_style(style_.empty() && !comment.empty() ? comment[0] : style_);
    if (!style && !style_.empty())
      return fail(fmt::format("unknown `atom-style` '{}'; expected one of {}", printable(style_),
                              lammps_style_names()));
    if (!style) {
      const auto guessed = guess_style(name);
      if (!guessed)
        return std::unexpected(Diagnostics{
            {Severity::error, std::string(file_), int(name), 1, guessed.error(), printable(line)}});
      style = *guessed;
    }
    if (!style->has(words.size()))
      return wrong_line(
          file_, row, *first,
          {words.empty() ? first->data()
                         : words[std::min(words.size() - 1, style->columns.size())].data(),
           fmt::format("rows of {} columns, or of {} with image flags, for the style {}, "
                       "instead of {}",
                       style->columns.size(), style->columns.size() + 3, style->name,
                       words.size())});
    RowLayout layout;
    layout.words = style->layout(words.size());
    layout.number = style->columns.find('i');
    layout.types = out_.types;
    if (hints_.types > 0) layout.most_types = hints_.types;
    if (auto done = read_rows(index_, file_, first_, atoms_, layout, out_); !done) return done;
    lines_ = ahead;
    lines_.skip(atoms_ - 1);
    tell_rows_beyond("rows of Atoms beyond the header's number of atoms");
    return {};
  }

  void tell_rows_beyond(std::string_view message) {
    LineReader ahead = lines_;
    for (auto line = ahead.next_filled(); line; line = ahead.next_filled()) {
      const auto words = words_of(line->substr(0, line->find('#')));
      if (!words.empty() && !looks_like_number(words[0])) break;
      if (!words.empty()) out_.notices.add(Severity::left_out, message, words[0], ahead.number());
    }
  }

  // Guesses from the first rows and other hints. `name` is the line of the section's name.
  std::expected<const LammpsStyle*, std::string> guess_style(size_t name) {
    std::vector<std::vector<std::string_view>> rows;
    LineReader ahead = lines_;
    while (rows.size() < std::min(atoms_, kRowsOfGuess)) {
      const auto line = ahead.next_filled();
      if (!line) break;
      rows.push_back(words_of(line->substr(0, line->find('#'))));
    }
    hints_.bonds = bonds_ > 0, hints_.cell = out_.cell, hints_.labels = &out_.types;
    const auto styles = guess_lammps_style(rows, hints_);
    if (!styles) return std::unexpected(styles.error());
    std::vector<std::string_view> names;
    for (const LammpsStyle* style : *styles) names.push_back(style->name);
    const std::string first(names[0]);
    names.erase(names.begin());
    out_.notices.add(Severity::guessed,
                     names.empty() ? fmt::format("atom style from the columns: {}", first)
                                   : fmt::format("atom style from the columns: {} (positions "
                                                 "and types are in the same columns in {})",
                                                 first, fmt::join(names, ", ")),
                     {}, name, 0);
    return (*styles)[0];
  }

  Done read_bonds() {
    skip_comments();
    if (bonds_ > index_.size())
      return fail(fmt::format("{} bonds are too many for the file", bonds_));
    for (size_t i = 0; i < bonds_; ++i) {
      const auto line = lines_.next_filled();
      if (!line) return fail(fmt::format("expected {} bonds, found {}", bonds_, i));
      const auto words = words_of(*line);
      std::array<uint64_t, 2> ids{};
      for (size_t k = 0; k < 2; ++k)
        if (words.size() < 4 ||
            std::from_chars(words[2 + k].begin(), words[2 + k].end(), ids[k]).ec != std::errc())
          return wrong(*line, line->data(), "the number, type and two atoms of a bond");
      listed_.push_back(ids);
    }
    tell_rows_beyond("rows of Bonds beyond the header's number of bonds");
    return {};
  }

  // If the style is wrong, many atoms coincide, among the first ones, too; then all are counted.
  void tell_coincident() {
    constexpr size_t kFirst = 10'000;
    std::vector<std::array<float, 3>> places;
    for (const Atom& atom : std::span(out_.atoms).first(std::min(kFirst, out_.atoms.size())))
      places.push_back(atom.place);
    std::ranges::sort(places);
    if (std::ranges::adjacent_find(places) != places.end())
      note_coincident(out_, [&](uint32_t i) {
        return std::string(word_at(skip_blanks_in_line(index_.begin_of(first_ + i))));
      });
  }

  // Bonds refer to atoms by their ids.
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
          return fail(fmt::format("a bond refers to atom {}, which does not exist", ids[k]));
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

  // The image of `b` that is nearest to `a`, in box sides from `b`. The sides form a lower
  // triangular matrix, so the last one is subtracted first; a general box needs fractional
  // coordinates.
  std::array<int, 3> cells_between(const Atom& a, const Atom& b) const {
    std::array<int, 3> cells{};
    std::array<double, 3> apart{};
    for (size_t i = 0; i < 3; ++i) apart[i] = double(a.place[i]) - double(b.place[i]);
    for (size_t k = 3; out_.cell && k-- > 0;) {
      const auto& side = out_.cell->sides[k];
      // Half a side rounds to none.
      const double count = is_general()  ? std::nearbyint(part_along(k, apart))
                           : side[k] > 0 ? std::nearbyint(apart[k] / side[k])
                                         : 0;
      if (!(std::abs(count) < 1e6)) continue;
      cells[k] = int(count);
      for (size_t i = 0; i < 3; ++i) apart[i] -= count * side[i];
    }
    return cells;
  }

  bool is_general() const {
    const auto& sides = out_.cell->sides;
    return sides[0][1] != 0 || sides[0][2] != 0 || sides[1][2] != 0;
  }

  // The component of a vector along side k of the box, in sides.
  double part_along(size_t k, const std::array<double, 3>& way) const {
    const auto side = [&](size_t i) {
      const auto& s = out_.cell->sides[i % 3];
      return Vec3d(s[0], s[1], s[2]);
    };
    const Vec3d normal = cross(side(k + 1), side(k + 2));
    const double part = dot(Vec3d(way[0], way[1], way[2]), normal) / dot(side(k), normal);
    return std::isfinite(part) ? part : 0;
  }

  Cell& box() { return out_.cell ? *out_.cell : out_.cell.emplace(); }

  // The element with this mass; 0 if none. Carbon with three or more hydrogens is not oxygen.
  static int element_of_mass(double mass) {
    constexpr double kCarbon = 12.011, kHydrogen = 1.008, kNear = 0.006;
    for (int hydrogens = 1; hydrogens <= 4; ++hydrogens)
      if (std::abs(mass - kCarbon - hydrogens * kHydrogen) <= kNear) return 6;
    const auto difference = [&](int element) { return std::abs(atomic_mass(element) - mass); };
    int best = 1;
    for (int i = 2; i < kElements; ++i)
      if (difference(i) < difference(best)) best = i;
    return difference(best) <= kMassTolerance ? best : 0;
  }

  // Whether the masses may be those of elements: some are heavy, and not all are small whole
  // numbers.
  bool has_real_masses() const {
    const auto any = [&](const auto& is) {
      return std::ranges::any_of(masses_, [&](const auto& m) { return is(m.second); });
    };
    return any([](double m) { return m > kMinMass; }) &&
           any([](double m) { return m > kMaxModelMass || m != std::floor(m); });
  }

  // By the comment of a mass, unless the mass contradicts it: "CA" is a carbon in many force
  // fields. Otherwise by the masses, if all of them are those of elements.
  void name_elements() {
    const bool real = has_real_masses();
    std::map<uint32_t, uint8_t> elements;
    bool all = real;
    for (const auto& [type, mass] : masses_) {
      if (const auto named = named_.find(type); named != named_.end()) {
        const double more = mass - atomic_mass(named->second);
        if (!real || (more >= -kMassTolerance && more <= kHydrogens))
          elements[type] = uint8_t(named->second);
      }
      all = all && (elements.contains(type) || element_of_mass(mass) > 0);
    }
    for (const auto& [type, mass] : masses_) {
      if (elements.contains(type)) continue;
      if (!all && elements.empty() && named_.empty()) break;
      const int element = real ? element_of_mass(mass) : 0;
      if (element == 0) {
        out_.notices.add(Severity::warning, "types of unknown element", fmt::format("{}", type));
        continue;
      }
      elements[type] = uint8_t(element);
      out_.notices.add(Severity::guessed, "elements from the masses of types",
                       fmt::format("{} = {}", type, element_symbol(element)));
    }
    if (elements.empty() && !masses_.empty())
      out_.notices.add_whole(Severity::guessed,
                             "masses do not match elements; atoms are coloured by type, and radii "
                             "are half of the mean "
                             "spacing");
    for (Atom& atom : out_.atoms)
      if (const auto at = elements.find(atom.part); at != elements.end()) atom.element = at->second;
  }

  const LineIndex index_;
  LineReader lines_;
  std::string_view file_;
  const std::string_view style_;  // requested style, or empty
  LammpsHints hints_;
  size_t atoms_ = 0, bonds_ = 0, first_ = 0;
  std::map<uint32_t, double> masses_;  // by type
  std::map<uint32_t, int> named_;      // elements of types, from comments
  std::vector<std::array<uint64_t, 2>> listed_;
  Atoms out_;
};

}  // namespace

std::expected<ReadScene, Diagnostics> read_lammps_data(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options) {
  if (const std::string wrong = not_text(text.view()); !wrong.empty())
    return std::unexpected(Diagnostics{{Severity::error, std::string(file), 0, 0, wrong, ""}});
  return scene_about(
      [&](const auto& origin) { return DataReader(text, file, options, origin).read(); }, file,
      options);
}

}  // namespace raio::core
