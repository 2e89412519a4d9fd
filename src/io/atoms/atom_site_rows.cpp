// Rows of _atom_site, from text or from gemmi's values.
#include <algorithm>
#include <atomic>
#include <cstring>
#include <ranges>
#include <span>

#include "base/parallel.h"
#include "io/atoms/atom_site.h"
#include "io/atoms/element_names.h"
#include "io/atoms/lines.h"
#include "io/atoms/site_values.h"

namespace raio::core {
namespace {

using cif::char_of, cif::drop_large_numbers, cif::element_of_type, cif::is_null, cif::is_whole;
using cif::number_of, cif::residue_number_of, cif::ResidueNumber, cif::text_of;

constexpr std::string_view kCategory = "_atom_site.";

bool is_blank(char c) { return c == ' ' || c == '\t'; }
bool is_printable(char c) { return c > ' ' && c < 127; }

bool is_keyword(std::string_view word) {
  const bool may_be = (word.size() > 4 && word[4] == '_') || (word.size() > 6 && word[6] == '_');
  if (!may_be) return false;
  constexpr std::string_view kKeywords[] = {"data_", "loop_", "global_", "save_", "stop_"};
  return std::ranges::any_of(kKeywords, [&](std::string_view keyword) {
    return std::ranges::equal(word.substr(0, keyword.size()), keyword,
                              [](char a, char b) { return a == b || (a | 32) == b; });
  });
}

// The end of a plain value that begins at `p` and lies on one line; null if there is none.
const char* end_of_value(const char* p, const char* end) {
  const char first = *p;
  if (first == '\'' || first == '"') {
    for (++p; (p = static_cast<const char*>(std::memchr(p, first, size_t(end - p)))); ++p) {
      if (p + 1 == end || is_blank(p[1])) return p + 1;
      if (p[1] == '#' || p[1] == '\r') return nullptr;
    }
    return nullptr;
  }
  if (first == '_' || first == '$' || first == '#') return nullptr;
  const char* const from = p;
  while (p < end && is_printable(*p)) ++p;
  if (p == from || (p < end && !is_blank(*p)) || is_keyword({from, p})) return nullptr;
  return p;
}

// Splits a line into values; false if their number is not the expected one or anything else
// follows.
bool split(std::string_view line, std::span<std::string_view> out) {
  if (line.starts_with(';')) return false;
  const char *p = line.data(), *const end = p + line.size();
  size_t count = 0;
  for (;; ++count) {
    while (p < end && is_blank(*p)) ++p;
    if (p == end) return count == out.size();
    if (count == out.size()) return false;
    const char* const from = p;
    p = end_of_value(p, end);
    if (!p) return false;
    out[count] = {from, p};
  }
}

}  // namespace

std::optional<SiteLoop> find_atom_site(std::string_view text) {
  const char *p = text.data(), *const end = p + text.size();
  bool is_in_text = false;  // inside a field between lines that begin with a semicolon
  SiteLoop loop;
  for (size_t number = 1; p < end; ++number) {
    const char* const from = p;
    const std::string_view line = take_line(p, end);
    if (line.starts_with(';')) is_in_text = !is_in_text, loop = {};
    if (is_in_text) continue;
    const std::string_view word = without_blanks(line);
    if (word == "loop_") {
      loop = {{}, number, nullptr};
    } else if (loop.line > 0 && word.starts_with(kCategory) &&
               std::ranges::all_of(word, is_printable)) {
      loop.tags.emplace_back(word);
    } else if (loop.line > 0 && !loop.tags.empty() && !word.starts_with('_')) {
      loop.rows = from;
      return loop;
    } else {
      loop = {};
    }
  }
  return std::nullopt;
}

AtomSite::AtomSite(const std::vector<std::string>& tags, const std::array<double, 3>& origin)
    : width_(tags.size()), origin_(origin) {
  struct Wanted {
    SiteColumn column;
    std::array<std::string_view, 3> tags;  // the first of these that exists
    std::string_view instead;
  };
  using enum SiteColumn;
  static constexpr Wanted kWanted[] = {
      {id, {"id"}, "1"},
      {symbol, {"type_symbol"}, "?"},
      {name, {"auth_atom_id", "label_atom_id", "type_symbol"}, "X"},
      {name_of_element, {"label_atom_id", "auth_atom_id", "type_symbol"}, "X"},
      {residue_of_element, {"label_comp_id", "auth_comp_id"}, "UNL"},
      {conformer, {"label_alt_id"}, "."},
      {residue, {"auth_comp_id", "label_comp_id"}, "UNL"},
      {chain, {"auth_asym_id", "label_asym_id"}, "A"},
      {part, {"label_asym_id", "auth_asym_id"}, "A"},
      {label_number, {"label_seq_id"}, "?"},
      {number, {"auth_seq_id", "label_seq_id"}, "1"},
      {insertion, {"pdbx_PDB_ins_code"}, "?"},
      {x, {"Cartn_x"}, ""},
      {y, {"Cartn_y"}, ""},
      {z, {"Cartn_z"}, ""},
      {occupancy, {"occupancy"}, "1"},
      {b_factor, {"B_iso_or_equiv"}, "?"},
      {charge, {"pdbx_formal_charge"}, "?"},
      {model, {"pdbx_PDB_model_num"}, "1"}};
  static_assert(std::size(kWanted) == kSiteColumns);
  const auto find = [&](std::string_view wanted) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? char(c | 32) : c; };
    const std::string full = std::string(kCategory).append(wanted);
    return size_t(std::ranges::find_if(tags,
                                       [&](const std::string& tag) {
                                         return std::ranges::equal(tag, full, {}, lower, lower);
                                       }) -
                  tags.begin());
  };
  for (const Wanted& wanted : kWanted) {
    Source& source = sources_[size_t(wanted.column)];
    source.instead = wanted.instead;
    for (const std::string_view tag : wanted.tags)
      if (source.column >= width_) source.column = find(tag);
    has_places_ &= source.column < width_ || !wanted.instead.empty();
  }
}

template <class Words>
SiteValues AtomSite::select(const Words& words) const {
  SiteValues out;
  for (size_t i = 0; i < kSiteColumns; ++i)
    out[i] = sources_[i].column < width_ ? std::string_view(words[sources_[i].column])
                                         : sources_[i].instead;
  return out;
}

SiteValues AtomSite::values_of(const SiteRow& row) const {
  if (row.values) return select(row.values);
  std::vector<std::string_view> words(width_);
  const char* p = row.line;
  split(take_line(p, text_end_), words);
  return select(words);
}

// Reads rows in sequence.
class AtomSite::Reader {
 public:
  Reader(const AtomSite& site, Part& out) : site_(site), out_(out) {}

  void add(SiteValues values, SiteRow row) {
    using enum SiteColumn;
    drop_large_numbers(values, [&](SiteColumn column, std::string_view value) {
      out_.too_large.emplace_back(column, value);
    });
    row.place = local({number_of(values[x]), number_of(values[y]), number_of(values[z])});
    row.occupancy = float(number_of(values[occupancy], 1));
    row.b_factor = float(number_of(values[b_factor], 50));
    row.element = element_of(values);
    const auto conformer_read = char_of(values[conformer], 0);
    row.conformer = conformer_read.value_or(0);
    row.is_readable = conformer_read && (is_null(values[charge]) || is_whole(values[charge]));
    if (!begins_run(values)) {
      row.is_readable &= has_number_;
    } else {
      SiteRun run;
      run.first = out_.rows.size();
      run.model = text_of(values[model]), run.chain = text_of(values[chain]);
      run.residue = text_of(values[residue]), run.part = text_of(values[part]);
      const auto number_read = residue_number_of(values[number], values[insertion]);
      has_number_ = number_read.has_value();
      row.is_readable &= has_number_;
      run.number = number_read.value_or(ResidueNumber());
      run.has_label_number = is_null(values[label_number]) || is_whole(values[label_number]);
      out_.runs.push_back(run);
    }
    out_.rows.push_back(row);
  }

 private:
  // Whether the values differ in what identifies a residue.
  bool begins_run(const SiteValues& values) {
    using enum SiteColumn;
    bool is_same = !out_.runs.empty();
    for (const SiteColumn column : {number, residue, chain, insertion, model})
      is_same &= values[column] == before_[column];
    if (!is_same) before_ = values;
    return !is_same;
  }

  std::array<float, 3> local(const std::array<double, 3>& place) const {
    std::array<float, 3> out;
    for (size_t k = 0; k < 3; ++k) out[k] = float(place[k] - site_.origin_[k]);
    return out;
  }

  uint8_t element_of(const SiteValues& values) {
    using enum SiteColumn;
    if (!is_null(values[symbol]) && text_of(values[symbol]) != "X")
      return element_of_type(text_of(values[symbol]));
    const std::string_view atom = text_of(values[name_of_element]);
    const uint8_t element = element_of_names(text_of(values[residue_of_element]), atom);
    out_.guesses.emplace_back(element, atom);
    return element;
  }

  const AtomSite& site_;
  Part& out_;
  SiteValues before_;
  bool has_number_ = true;
};

const char* AtomSite::add_lines(std::string_view text) {
  if (!has_places_) return text.data();
  constexpr size_t kChunk = 1 << 18;
  const size_t chunks = (text.size() + kChunk - 1) / kChunk;
  const char* const end = text_end_ = text.data() + text.size();
  parts_.resize(chunks);
  std::atomic<size_t> last = chunks;  // the chunk in which the rows end
  const auto begin_of = [&](size_t chunk) {
    if (chunk == 0) return text.data();
    const char* p = text.data() + std::min(chunk * kChunk, text.size()) - 1;
    take_line(p, end);
    return p;
  };
  parallel_for(chunks, [&](size_t chunk) {
    std::vector<std::string_view> words(width_);
    Reader reader(*this, parts_[chunk]);
    const char* const chunk_end = begin_of(chunk + 1);
    for (const char* p = begin_of(chunk); p < chunk_end && chunk <= last;) {
      const char* const from = p;
      if (split(take_line(p, end), words)) {
        reader.add(select(words), {.line = from});
        continue;
      }
      for (size_t known = last; chunk < known && !last.compare_exchange_weak(known, chunk);) {
      }
      return;
    }
  });
  if (last < chunks) parts_.resize(last + 1);
  for (const Part& part : parts_ | std::views::reverse)
    if (!part.rows.empty()) return part.rows.back().line;
  return text.data();
}

void AtomSite::add_values(std::vector<std::string> values) {
  if (!has_places_) return;
  values_ = std::move(values);
  const bool follows_lines =
      std::ranges::any_of(parts_, [](const Part& p) { return !p.rows.empty(); });
  const size_t first = follows_lines, count = values_.size() / width_ - first;
  const size_t before = parts_.size();
  parts_.resize(before + chunks_of(count));
  for_chunks(count, [&](size_t chunk, size_t from, size_t to) {
    Reader reader(*this, parts_[before + chunk]);
    for (size_t i = from; i < to; ++i) {
      const std::string* const row = &values_[(first + i) * width_];
      reader.add(select(row), {.values = row});
    }
  });
}

}  // namespace raio::core
