#include "io/atoms/rows.h"

#include <cmath>

#include "io/atoms/colors.h"

namespace raio::core {
namespace {

std::string_view name_of(Word word) {
  switch (word) {
    case Word::x:
    case Word::y:
    case Word::z:
      return "a coordinate";
    case Word::species:
      return "the symbol of an element";
    case Word::type:
      return "a type, a whole number from 1";
    case Word::residue:
      return "a whole number";
    case Word::image:
      return "an image flag, a whole number";
    case Word::radius:
    case Word::diameter:
      return "a number from 0";
    case Word::skipped:
      break;
  }
  return "a number";
}

// The element of a label such as "C1", "C_3" and "Fe3+", from its leading letters.
int element_of_label(std::string_view label) {
  const auto other =
      std::ranges::find_if(label, [](char c) { return (c & ~32) < 'A' || (c & ~32) > 'Z'; });
  return element_number(label.substr(0, size_t(other - label.begin())));
}

// Fortran numbers such as "0.15D+01".
bool parse_fortran(std::string_view text, double& number) {
  constexpr size_t kMost = 64;
  std::array<char, kMost + TextBuffer::kPadding> word{};
  if (text.size() > kMost || text.find_first_of("dD") == std::string_view::npos) return false;
  std::ranges::replace_copy_if(
      text, word.begin(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  return parse_number(word.data(), number) != nullptr;
}

class RowReader {
 public:
  // `odd` becomes true if a label is not a plain symbol.
  RowReader(const RowLayout& layout, Atoms& out, std::atomic<bool>& odd)
      : layout_(layout), to_place_(layout.to_place), out_(out), odd_(odd) {
    for (size_t row = 0; row < 3; ++row) to_place_[4 * row + 3] -= out.origin[row];
    for (size_t k = 0; k < layout.words.size(); ++k)
      if (layout.words[k] != Word::skipped || k == layout.value) last_ = k;
  }

  std::optional<LineFault> operator()(size_t i, std::string_view line) const {
    Atom& atom = out_.atoms[i];
    std::array<double, 3> place{};
    const char* p = line.data();
    const char* const line_end = p + line.size();
    for (size_t k = 0; k <= last_; ++k) {
      p = skip_blanks_in_line(p);
      const char* const at = p;
      while (!is_char(*p, kWordEnd)) ++p;
      const Word word = layout_.words[k];
      const bool is_value = k == layout_.value;
      if (at >= line_end || p == at) return LineFault{at, std::string(name_of(word))};
      if (word == Word::skipped && !is_value) continue;
      double number = 0;
      const bool is_number =
          parse_number(at, number) != nullptr || (word != Word::species && word != Word::type &&
                                                  parse_fortran({at, size_t(p - at)}, number));
      if (is_value) {
        if (!is_number) return LineFault{at, "a number"};
        out_.values[i] = float(number);
      }
      if (!take(word, {at, size_t(p - at)}, is_number, number, i, atom, place))
        return LineFault{at, std::string(name_of(word))};
    }
    const auto& m = to_place_;
    for (size_t row = 0; row < 3; ++row)
      atom.place[row] = float(m[4 * row] * place[0] + m[4 * row + 1] * place[1] +
                              m[4 * row + 2] * place[2] + m[4 * row + 3]);
    return std::nullopt;
  }

 private:
  bool take(Word word, std::string_view text, bool is_number, double number, size_t i, Atom& atom,
            std::array<double, 3>& place) const {
    const auto is_whole = [&](double least) {
      return is_number && number >= least && number <= 4e9 && number == std::floor(number);
    };
    switch (word) {
      case Word::x:
      case Word::y:
      case Word::z:
        place[size_t(word) - size_t(Word::x)] = number;
        return is_number;
      case Word::species:
        // Some programs write atomic numbers.
        atom.element =
            uint8_t(is_whole(1) && number < kElements ? int(number) : element_number(text));
        if (atom.element == 0) {
          atom.element = uint8_t(element_of_label(text));
          odd_.store(true, std::memory_order_relaxed);
        }
        return true;
      case Word::type:
        if (const auto named = layout_.types.find(text); named != layout_.types.end())
          return atom.part = named->second, true;
        atom.part = is_whole(1) && number <= layout_.most_types ? uint32_t(number) : 0;
        return atom.part > 0;
      case Word::image:
        return is_number && number == std::floor(number);
      case Word::residue:
        atom.residue = is_whole(0) ? uint32_t(number) : 0;
        return is_whole(0);
      case Word::radius:
      case Word::diameter:
        out_.radii[i] = float(word == Word::radius ? number : number / 2);
        return is_number && out_.radii[i] >= 0 && std::isfinite(out_.radii[i]);
      case Word::skipped:
        return true;
    }
    return true;
  }

  const RowLayout& layout_;
  std::array<double, 12> to_place_;  // relative to the origin
  Atoms& out_;
  std::atomic<bool>& odd_;
  size_t last_ = 0;
};

// Calls use(i, word) for the word in this column of each atom's row, in the order of the file.
template <class Use>
void for_words(const LineIndex& index, size_t first, size_t column, const Atoms& out,
               const Use& use) {
  const char* p = index.begin_of(first);
  const char* const end = index.text().data() + index.text().size();
  for (size_t i = 0; i < out.atoms.size(); ++i) {
    const char* at = take_line(p, end).data();
    for (size_t k = 0;; ++k) {
      at = skip_blanks_in_line(at);
      if (k == column) break;
      while (!is_char(*at, kWordEnd)) ++at;
    }
    use(i, word_at(at));
  }
}

// Adds notices about labels that are not plain symbols.
void describe_labels(const LineIndex& index, size_t first, const RowLayout& layout, Atoms& out) {
  const auto column = size_t(std::ranges::find(layout.words, Word::species) - layout.words.begin());
  for_words(index, first, column, out, [&](size_t i, std::string_view label) {
    const int element = out.atoms[i].element;
    if (element == 0)
      out.notices.add(Severity::warning, "labels that are not elements", label, first + i + 1);
    else if (element_number(label) == 0 && !looks_like_number(label))
      out.notices.add(Severity::guessed, "elements from the leading letters of labels", label,
                      first + i + 1);
  });
}

void add_marks(const LineIndex& index, size_t first, const RowLayout& layout, Atoms& out) {
  for_words(index, first, layout.number, out,
            [&](size_t, std::string_view word) { out.marks->add({}, whole_number(word)); });
}

}  // namespace

std::expected<void, Diagnostics> read_rows(const LineIndex& index, std::string_view file,
                                           size_t first, size_t count, const RowLayout& layout,
                                           Atoms& out) {
  out.atoms.resize(count);
  if (layout.has(Word::radius) || layout.has(Word::diameter)) out.radii.resize(count);
  if (layout.value < layout.words.size()) out.values.resize(count);
  out.has_residues = layout.has(Word::residue);
  std::atomic<bool> odd = false;
  auto done = for_lines(index, file, first, count, RowReader(layout, out, odd));
  if (done && odd) describe_labels(index, first, layout, out);
  if (done && out.marks && layout.number < layout.words.size())
    add_marks(index, first, layout, out);
  return done;
}

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  for (;;) {
    const size_t from = line.find_first_not_of(" \t");
    if (from == std::string_view::npos) return words;
    const size_t to = std::min(line.find_first_of(" \t", from), line.size());
    words.push_back(line.substr(from, to - from));
    line.remove_prefix(to);
  }
}

}  // namespace raio::core
