#include "io/atoms/select.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <climits>
#include <numeric>
#include <ranges>
#include <span>
#include <vector>

#include "base/spelling.h"
#include "io/atoms/atoms.h"
#include "io/atoms/colors.h"
#include "io/atoms/element_names.h"

namespace raio::core {
namespace {

using Mask = std::vector<bool>;  // one per atom

struct Term {
  enum class What : uint8_t {
    all,
    water,
    hydrogen,
    ion,
    ligand,
    protein,
    nucleic,
    element,
    type,
    chain,
    residue,
    index
  };
  What what = What::all;
  std::vector<std::string> names;
  std::vector<std::array<int, 2>> ranges;  // inclusive

  bool has(int number) const {
    return std::ranges::any_of(
        ranges, [&](const auto& range) { return range[0] <= number && number <= range[1]; });
  }
};

constexpr auto kTerms = std::to_array<std::string_view>(
    {"all", "water", "hydrogen", "ion", "ligand", "protein", "nucleic", "element", "type", "chain",
     "residue", "index"});  // in the order of Term::What

/// A step in evaluation order: operators follow their operands (postfix).
struct Step {
  enum class Op : uint8_t { term, both, either, negate };
  Op op = Op::term;
  Term term;
};

struct Problem {
  size_t column = 0;  // from 1
  std::string text;
};

class Parser {
 public:
  explicit Parser(std::string_view text) : text_(text) { next(); }

  std::expected<std::vector<Step>, Problem> parse() try {
    either(0);
    if (!word_.empty()) fail("expected 'and', 'or' or the end");
    return std::move(steps_);
  } catch (const Problem& problem) {
    return std::unexpected(problem);
  }

 private:
  static constexpr std::string_view kBlanks = " \t\r\n", kMarks = "(),";
  static constexpr int kDeepest = 100;  // parentheses and `not`

  [[noreturn]] void fail(std::string_view expected) const {
    throw Problem{at_ + 1, fmt::format("{}, found {}", expected,
                                       word_.empty() ? "the end" : fmt::format("'{}'", word_))};
  }

  // Advances to the next token: a parenthesis, a comma or a word.
  void next() {
    at_ = std::min(text_.find_first_not_of(kBlanks, at_ + word_.size()), text_.size());
    size_t size = 0;
    if (at_ < text_.size() && kMarks.contains(text_[at_])) {
      size = 1;
    } else {
      const size_t end =
          std::min(text_.find_first_of(kBlanks, at_), text_.find_first_of(kMarks, at_));
      size = std::min(end, text_.size()) - at_;
    }
    word_ = text_.substr(at_, size);
  }
  bool take(std::string_view word) {
    if (word_ != word) return false;
    next();
    return true;
  }

  void either(int depth) {
    both(depth);
    while (take("or") || take(",")) both(depth), steps_.push_back({Step::Op::either, {}});
  }
  void both(int depth) {
    one(depth);
    while (take("and")) one(depth), steps_.push_back({Step::Op::both, {}});
  }
  void one(int depth) {
    if (depth > kDeepest) fail("expected fewer parentheses and 'not'");
    if (take("not")) {
      one(depth + 1);
      steps_.push_back({Step::Op::negate, {}});
    } else if (take("(")) {
      either(depth + 1);
      if (!take(")")) fail("expected ')'");
    } else {
      term();
    }
  }

  void term() {
    const auto* const known = std::ranges::find(kTerms, word_);
    if (known == kTerms.end())
      fail(
          "expected water, hydrogen, ion, ligand, protein, nucleic, all, element, type, chain, "
          "residue or index");
    Term out{Term::What(known - kTerms.begin()), {}, {}};
    next();
    if (out.what >= Term::What::element) do {
        value(out);
        next();
      } while (take(","));
    steps_.push_back({Step::Op::term, std::move(out)});
  }

  // A number, two with a minus between them, or a name.
  void value(Term& out) const {
    if (word_.empty() || word_ == "," || word_ == "(" || word_ == ")") fail("expected a value");
    const bool is_name = out.what == Term::What::element || out.what == Term::What::chain;
    const char* const end = word_.data() + word_.size();
    std::array<int, 2> range{};
    const auto first = std::from_chars(word_.data(), end, range[0]);
    auto last = first;
    if (first.ec == std::errc() && first.ptr != end && *first.ptr == '-')
      last = std::from_chars(first.ptr + 1, end, range[1]);
    else
      range[1] = range[0];
    const bool is_range = last.ec == std::errc() && last.ptr == end;
    if (!is_name && is_range) {
      if (range[1] < range[0]) fail("expected a range that begins with its lower number");
      out.ranges.push_back(range);
      return;
    }
    if (out.what == Term::What::index) fail("expected a number or a range such as 1-5");
    if (out.what == Term::What::element && element_number(word_) == 0)
      fail("expected the symbol of an element");
    out.names.emplace_back(word_);
  }

  std::string_view text_, word_;
  size_t at_ = 0;  // of the current word
  std::vector<Step> steps_;
};

bool is_same(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, {}, [](char c) { return c & ~32; }, [](char c) { return c & ~32; });
}

// A selection that needs data that the file does not have.
struct Unfit {
  std::string text;
};

// Evaluates terms over the atoms.
class Chooser {
 public:
  explicit Chooser(const Atoms& atoms) : atoms_(atoms) {
    residue_sizes_.resize(atoms.residues.size());
    for (const Atom& atom : atoms.atoms)
      if (atom.residue < residue_sizes_.size()) ++residue_sizes_[atom.residue];
    for (const Residue& residue : atoms.residues) kinds_.push_back(residue_kind(residue.view()));
  }

  // Throws an Unfit that names the missing data.
  Mask chosen(const std::vector<Step>& steps) const {
    std::vector<Mask> stack;
    for (const Step& step : steps) {
      if (step.op == Step::Op::term) {
        stack.push_back(of_term(step.term));
        continue;
      }
      if (step.op == Step::Op::negate) {
        stack.back().flip();
        continue;
      }
      const Mask other = std::move(stack.back());
      stack.pop_back();
      Mask& mask = stack.back();
      for (size_t i = 0; i < mask.size(); ++i)
        mask[i] = step.op == Step::Op::both ? mask[i] && other[i] : mask[i] || other[i];
    }
    return stack.back();
  }

 private:
  template <class Has>
  Mask where(const Has& has) const {
    Mask out(atoms_.atoms.size());
    for (uint32_t i = 0; i < out.size(); ++i) out[i] = has(atoms_.atoms[i], i);
    return out;
  }
  static void need(bool is_there, std::string_view what) {
    if (!is_there) throw Unfit{fmt::format("needs {}, but the file has none", what)};
  }

  [[noreturn]] static void fail_unnamed(std::string_view what, std::string_view name,
                                        const auto& names) {
    constexpr size_t kMost = 20;
    throw Unfit{fmt::format("names {} {}; the file has {}{}", what, name,
                            fmt::join(names | std::views::take(kMost), ", "),
                            names.size() > kMost ? " and more" : "")};
  }

  // Whether it is a single metal or halogen atom.
  bool is_ion(const Atom& atom) const {
    constexpr std::array<uint8_t, 4> kHalogens = {9, 17, 35, 53};
    return residue_sizes_[atom.residue] == 1 &&
           (is_metal(atom.element) || std::ranges::count(kHalogens, atom.element) > 0);
  }

  Mask of_term(const Term& term) const {
    using enum Term::What;
    const auto in_residue = [&](ResidueKind kind) {
      return where([this, kind](const Atom& a, uint32_t) { return kinds_[a.residue] == kind; });
    };
    if (term.what >= water && term.what <= nucleic && term.what != hydrogen)
      need(!kinds_.empty(), "names of residues");
    switch (term.what) {
      case all:
        break;
      case water:
        return in_residue(ResidueKind::water);
      case protein:
        return in_residue(ResidueKind::protein);
      case nucleic:
        return in_residue(ResidueKind::nucleic);
      case ion:
        return where([this](const Atom& a, uint32_t) { return is_ion(a); });
      case ligand:
        return where([this](const Atom& a, uint32_t) {
          return kinds_[a.residue] == ResidueKind::other && !is_ion(a);
        });
      case hydrogen:
      case element:
        need(any_element(atoms_), "elements");
        return of_elements(term);
      case type:
        return of_types(term);
      case chain:
        return of_chains(term);
      case residue:
        return of_residues(term);
      case index:
        return where([&](const Atom&, uint32_t i) { return term.has(int(i)); });
    }
    return Mask(atoms_.atoms.size(), true);
  }

  Mask of_elements(const Term& term) const {
    std::array<bool, kElements> wanted{};
    wanted[1] = term.what == Term::What::hydrogen;
    for (const std::string& name : term.names) wanted[size_t(element_number(name))] = true;
    return where([&](const Atom& a, uint32_t) { return wanted[a.element]; });
  }

  Mask of_types(const Term& term) const {
    need(atoms_.chains.empty() && atoms_.atoms[0].part > 0, "types");
    need(!atoms_.types.empty() || term.names.empty(), "names of types");
    Term wanted = term;
    for (const std::string& name : term.names) {
      const auto at = atoms_.types.find(name);
      if (at == atoms_.types.end()) fail_unnamed("type", name, atoms_.types | std::views::keys);
      wanted.ranges.push_back({int(at->second), int(at->second)});
    }
    return where([&](const Atom& a, uint32_t) { return wanted.has(int(a.part)); });
  }

  Mask of_chains(const Term& term) const {
    need(!atoms_.chains.empty(), "chains");
    Mask wanted(atoms_.chains.size());
    for (const std::string& name : term.names) {
      const auto at = std::ranges::find(atoms_.chains, name);
      if (at == atoms_.chains.end()) fail_unnamed("chain", name, atoms_.chains);
      wanted[size_t(at - atoms_.chains.begin())] = true;
    }
    return where([&](const Atom& a, uint32_t) { return wanted[a.chain]; });
  }

  // By residue name and number; without names, numbers are molecule ids.
  Mask of_residues(const Term& term) const {
    need(atoms_.has_residues, "residues");
    need(!kinds_.empty() || term.names.empty(), "names of residues");
    if (kinds_.empty())
      return where([&](const Atom& a, uint32_t) { return term.has(int(a.residue)); });
    Mask wanted(atoms_.residues.size());
    for (size_t i = 0; i < wanted.size(); ++i) {
      const Residue& residue = atoms_.residues[i];
      wanted[i] =
          term.has(residue.number) || std::ranges::any_of(term.names, [&](const std::string& name) {
            return is_same(name, residue.view());
          });
    }
    return where([&](const Atom& a, uint32_t) { return wanted[a.residue]; });
  }

  const Atoms& atoms_;
  std::vector<uint32_t> residue_sizes_;
  std::vector<ResidueKind> kinds_;
};

void keep(Atoms& atoms, const Mask& kept) {
  std::vector<uint32_t> number(kept.size());
  uint32_t n = 0;
  if (atoms.marks) atoms.indices.reserve(size_t(std::ranges::count(kept, true)));
  for (uint32_t i = 0; i < kept.size(); ++i) {
    number[i] = n;
    if (!kept[i]) continue;
    atoms.atoms[n] = atoms.atoms[i];
    if (!atoms.radii.empty()) atoms.radii[n] = atoms.radii[i];
    if (!atoms.values.empty()) atoms.values[n] = atoms.values[i];
    if (atoms.marks) atoms.indices.push_back(i);
    ++n;
  }
  atoms.atoms.resize(n);
  if (!atoms.radii.empty()) atoms.radii.resize(n);
  if (!atoms.values.empty()) atoms.values.resize(n);
  const auto is_cut = [&](const auto& bond) { return !kept[bond[0]] || !kept[bond[1]]; };
  std::erase_if(atoms.bonds, is_cut);
  std::erase_if(atoms.bonds_across, [&](const BondAcross& bond) { return is_cut(bond.atoms); });
  for (auto& bond : atoms.bonds) bond = {number[bond[0]], number[bond[1]]};
  for (auto& bond : atoms.bonds_across) bond.atoms = {number[bond.atoms[0]], number[bond.atoms[1]]};
}

}  // namespace

bool has_polymer(const Atoms& atoms) {
  return std::ranges::any_of(atoms.residues, [](const Residue& residue) {
    const ResidueKind kind = residue_kind(residue.view());
    return kind == ResidueKind::protein || kind == ResidueKind::nucleic;
  });
}

std::string selection_problem(std::string_view text) {
  const auto steps = Parser(text).parse();
  return steps ? "" : fmt::format("column {}: {}", steps.error().column, steps.error().text);
}

std::expected<void, std::string> select_atoms(Atoms& atoms, const ReadOptions& options,
                                              bool fills) try {
  const bool asks = !options.only.empty() || !options.hide.empty() || !options.show.empty() ||
                    !options.color_atoms.empty();
  bool hides_solvent =
      options.hide_solvent && fills && options.only.empty() && !atoms.residues.empty();
  if (atoms.atoms.empty() || !(asks || hides_solvent)) return {};
  const Chooser chooser(atoms);
  hides_solvent = hides_solvent && has_polymer(atoms);
  const auto chosen = [&](std::string_view option, const std::string& text) {
    const auto steps = Parser(text).parse();
    if (!steps)
      throw Unfit{
          fmt::format("`{}`, column {}: {}", option, steps.error().column, steps.error().text)};
    try {
      return chooser.chosen(*steps);
    } catch (const Unfit& wrong) {
      throw Unfit{fmt::format("`{}` {}", option, wrong.text)};
    }
  };
  const size_t n = atoms.atoms.size();
  const auto mask_of = [&](std::string_view option, const std::string& text, bool usual) {
    return text.empty() ? Mask(n, usual) : chosen(option, text);
  };
  const Mask only = mask_of("only", options.only, true),
             hide = mask_of("hide", options.hide, false),
             show = mask_of("show", options.show, false),
             solvent = hides_solvent ? chosen("hide", "water, ion") : Mask(n, false);
  if (!options.hide.empty() && std::ranges::count(hide, true) == 0)
    atoms.notices.add_whole(Severity::warning, "`hide` chooses no atom");
  for (size_t c = 0; c < options.color_atoms.size(); ++c) {
    const Mask colored = chosen("color-atoms", options.color_atoms[c].atoms);
    for (size_t i = 0; i < n; ++i)
      if (colored[i]) atoms.atoms[i].own_color = uint8_t(c + 1);
  }
  Mask kept(n);
  size_t left = 0, unasked = 0;
  for (size_t i = 0; i < n; ++i) {
    kept[i] = show[i] || (only[i] && !hide[i] && !solvent[i]);
    left += kept[i];
    unasked += solvent[i] && !kept[i] && !hide[i];
  }
  Mask has_color(options.color_atoms.size() + 1);
  for (size_t i = 0; i < n; ++i)
    if (kept[i]) has_color[atoms.atoms[i].own_color] = true;
  for (size_t c = 0; c < options.color_atoms.size(); ++c)
    if (constexpr size_t kLongest = 60; !has_color[c + 1])
      atoms.notices.add(Severity::warning, "selections of `color-atoms` that colour no atom",
                        cut_text(options.color_atoms[c].atoms, kLongest));
  if (left == 0) return std::unexpected("`only` and `hide` leave no atom");
  if (unasked > 0)
    atoms.notices.add(Severity::left_out,
                      "atoms of water and ions; `show` \"water, ion\" draws them", {}, 0, unasked);
  if (options.color_by == "index" && atoms.values.empty()) {
    atoms.values.resize(n);
    std::iota(atoms.values.begin(), atoms.values.end(), 0.0F);
  }
  if (left < n) keep(atoms, kept);
  return {};
} catch (const Unfit& wrong) {
  return std::unexpected(wrong.text);
}

}  // namespace raio::core
