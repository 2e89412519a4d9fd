#include "io/atoms/lammps_styles.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace raio::core {
namespace {

// https://docs.lammps.org/read_data.html; common styles come first.
constexpr LammpsStyle kLammpsStyles[] = {
    {"atomic", "itxyz"},
    {"charge", "itrxyz"},
    {"full", "imtrxyz"},
    {"molecular", "imtxyz"},
    {"bond", "imtxyz"},
    {"angle", "imtxyz"},
    {"sphere", "itdpxyz"},
    {"dipole", "itrxyzrrr"},
    {"body", "itnpxyz"},
    {"bpm/sphere", "imtdpxyz"},
    {"dielectric", "itrxyzrrrprrrr"},
    {"dpd", "itpxyz"},
    {"edpd", "itppxyz"},
    {"electron", "itrnpxyz"},
    {"ellipsoid", "itnpxyz"},
    {"line", "imtnpxyz"},
    {"mdpd", "itpxyz"},
    {"mesont", "imtnnppprxyz"},
    {"peri", "itppxyz"},
    {"rheo", "itnvxyz"},
    {"rheo/thermal", "itnvrxyz"},
    {"smd", "itmpppprrrxyz"},
    {"sph", "itprrxyz"},
    {"spin", "itxyzrrrr"},
    {"template", "imnntxyz"},
    {"tri", "imtnpxyz"},
    {"wavepacket", "itrnpnrrxyz"},
    {"tdpd", "itxyz*"},
    {"hybrid", "itxyz*"},
};

// The meaning of a letter of LammpsStyle::columns.
Word word_of_letter(char letter) {
  switch (letter) {
    case 'm':
      return Word::residue;
    case 't':
      return Word::type;
    case 'd':
      return Word::diameter;
    case 'x':
      return Word::x;
    case 'y':
      return Word::y;
    case 'z':
      return Word::z;
    default:
      return Word::skipped;
  }
}

bool is_open(const LammpsStyle& style) { return style.columns.ends_with('*'); }

// Properties shared by all words of a column.
struct StyleColumn {
  bool numbers = true, whole = true, labels = true;
  double least = std::numeric_limits<double>::infinity(), largest = -least;

  void add(std::string_view word, const LammpsHints& hints) {
    double number = 0;
    if (parse_number(word.data(), number))
      least = std::min(least, number), largest = std::max(largest, number);
    else
      numbers = false;
    const size_t sign = word[0] == '-' || word[0] == '+';
    whole = whole && word.size() > sign &&
            std::ranges::all_of(word.substr(sign), [](char c) { return c >= '0' && c <= '9'; });
    labels = labels && hints.labels && hints.labels->contains(word);
  }
};

class StyleGuess {
 public:
  StyleGuess(std::span<const std::vector<std::string_view>> rows, const LammpsHints& hints)
      : rows_(rows.size()), hints_(hints), columns_(rows.empty() ? 0 : rows[0].size()) {
    for (const auto& row : rows)
      for (size_t k = 0; k < std::min(row.size(), columns_.size()); ++k)
        columns_[k].add(row[k], hints);
  }

  bool fits(const LammpsStyle& style) const {
    const size_t count = style.columns.size();
    if (is_open(style) || !style.has(columns_.size()) || !has_sections(style)) return false;
    for (size_t k = 0; k < columns_.size(); ++k)
      if (!fits(columns_[k], k < count ? style.columns[k] : 'n')) return false;
    return true;
  }

  // Whether the atoms are in their box, at different positions.
  bool is_in_box(const LammpsStyle& style) const {
    const size_t x = style.columns.find('x');
    bool differ = rows_ < 2;
    for (size_t axis = 0; axis < 3; ++axis) {
      const StyleColumn& column = columns_[x + axis];
      differ = differ || column.least < column.largest;
      if (!hints_.cell) continue;
      double low = hints_.cell->origin[axis], high = low;
      for (const auto& side : hints_.cell->sides) (side[axis] < 0 ? low : high) += side[axis];
      constexpr double kBeyond = 0.01;  // atoms move slightly between reneighbourings
      const double margin = kBeyond * (high - low);
      if (column.least < low - margin || column.largest > high + margin) return false;
    }
    return differ;
  }

  // The number of real-valued columns that contain whole numbers only.
  size_t whole_reals(const LammpsStyle& style) const {
    size_t count = 0;
    for (size_t k = 0; k < style.columns.size(); ++k)
      count += columns_[k].whole && std::string_view("dpvrxyz").contains(style.columns[k]);
    return count;
  }

 private:
  bool fits(const StyleColumn& column, char letter) const {
    switch (letter) {
      case 'i':
      case 'm':
        return column.numbers && column.whole && column.least >= 0;
      case 't':
        return column.labels || (column.numbers && column.whole && column.least >= 1 &&
                                 (hints_.types == 0 || column.largest <= double(hints_.types)));
      case 'n':
        return column.numbers && column.whole;
      case 'd':
      case 'p':
        return column.numbers && column.least >= 0;
      case 'v':
        return column.numbers && column.least > 0;
      default:
        return column.numbers;
    }
  }

  // Files with bonds have molecular styles; styles such as body need a separate section.
  bool has_sections(const LammpsStyle& style) const {
    if (hints_.bonds && !style.columns.contains('m')) return false;
    constexpr std::pair<std::string_view, std::string_view> kSections[] = {
        {"body", "bodies"}, {"ellipsoid", "ellipsoids"}, {"line", "lines"}, {"tri", "triangles"}};
    for (const auto& [name, section] : kSections)
      if (style.name == name || hints_.section == section)
        return style.name == name && hints_.section == section;
    return true;
  }

  const size_t rows_;
  const LammpsHints& hints_;
  std::vector<StyleColumn> columns_;
};

}  // namespace

bool LammpsStyle::has(size_t words) const {
  if (is_open(*this)) return words >= columns.size() - 1;
  return words == columns.size() || words == columns.size() + 3;
}

std::vector<Word> LammpsStyle::layout(size_t words) const {
  std::vector<Word> out;
  for (const char letter : columns)
    if (letter != '*') out.push_back(word_of_letter(letter));
  if (!is_open(*this) && words == columns.size() + 3) out.insert(out.end(), 3, Word::image);
  return out;
}

const LammpsStyle* find_lammps_style(std::string_view name) {
  const auto* const at = std::ranges::find(kLammpsStyles, name, &LammpsStyle::name);
  return at == std::end(kLammpsStyles) ? nullptr : at;
}

std::string lammps_style_names() {
  std::vector<std::string_view> names;
  for (const LammpsStyle& style : kLammpsStyles) names.push_back(style.name);
  std::ranges::sort(names);
  return fmt::format("{}", fmt::join(names, ", "));
}

std::expected<std::vector<const LammpsStyle*>, std::string> guess_lammps_style(
    std::span<const std::vector<std::string_view>> rows, const LammpsHints& hints) {
  const StyleGuess guess(rows, hints);
  std::vector<const LammpsStyle*> some;
  for (const LammpsStyle& style : kLammpsStyles)
    if (guess.fits(style)) some.push_back(&style);
  if (some.empty())
    return std::unexpected(
        fmt::format("the atom style is not given, and rows of {} such columns match no style; "
                    "give `atom-style`: {}",
                    rows.empty() ? 0 : rows[0].size(), lammps_style_names()));
  const auto keep = [&](const auto& is_good) {
    std::vector<const LammpsStyle*> good;
    std::ranges::copy_if(some, std::back_inserter(good), is_good);
    if (!good.empty()) some = std::move(good);
  };
  keep([&](const LammpsStyle* s) { return guess.is_in_box(*s); });
  size_t least = SIZE_MAX;
  for (const LammpsStyle* s : some) least = std::min(least, guess.whole_reals(*s));
  keep([&](const LammpsStyle* s) { return guess.whole_reals(*s) == least; });
  const auto family = [](const LammpsStyle* s) {
    return std::pair(s->columns.find('t'), s->columns.find('x'));
  };
  if (std::ranges::all_of(some, [&](auto* s) { return family(s) == family(some[0]); })) return some;
  std::vector<std::string_view> names;
  names.reserve(some.size());
  for (const LammpsStyle* s : some) names.push_back(s->name);
  return std::unexpected(fmt::format(
      "the atom style is not given, and several match: {}; give `atom-style`, or write it "
      "after the section's name: Atoms # {}",
      fmt::join(names, ", "), names[0]));
}

}  // namespace raio::core
