// CIF and mmCIF, from text to scene, and helpers for all molecules.
#include <algorithm>
#include <bit>
#include <cmath>
#include <vector>

#include "io/atoms/element_names.h"
#include "io/atoms/lines.h"
#include "io/atoms/read.h"
#include "io/nff/text_cursor.h"

namespace raio::core {
namespace {

std::expected<Atoms, Diagnostics> atoms_of(std::string_view bytes, std::string_view file,
                                           const ReadOptions& options,
                                           const std::array<double, 3>& origin) {
  Atoms atoms;
  atoms.origin = origin;
  if (options.labels) atoms.marks.emplace();
  if (const auto fault = read_structure(bytes.data(), bytes.size(), options.frame, atoms)) {
    if (fault->column == 0) return failed(file, printable(fault->message), fault->line);
    const LineIndex index(bytes);
    const char* p = index.begin_of(fault->line - 1);
    const std::string_view line = take_line(p, bytes.data() + bytes.size());
    return wrong_line(file, fault->line, line,
                      {line.data() + std::min(fault->column - 1, line.size()),
                       "the syntax of CIF (" + printable(fault->message) + ")"});
  }
  if (atoms.frames == 0)
    return failed(file,
                  "no atom can be read; expected the columns Cartn_x, "
                  "Cartn_y and Cartn_z of _atom_site");
  return atoms;
}

}  // namespace

std::expected<ReadScene, Diagnostics> read_mmcif(const TextBuffer& text, std::string_view file,
                                                 const ReadOptions& options) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::string_view bytes = text.view();
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  return scene_about([&](const auto& origin) { return atoms_of(bytes, file, options, origin); },
                     file, options);
}

void note_coincident(Atoms& atoms, const std::function<std::string(uint32_t)>& name_of) {
  const auto hash_of = [](const std::array<float, 3>& p) {
    uint64_t hash = 0;
    for (const float x : p) hash = (hash ^ std::bit_cast<uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
    return size_t(hash ^ (hash >> 32));
  };
  // A hash table with linear probing: the first atom at each position, counted from 1.
  std::vector<uint32_t> slots(std::bit_ceil(2 * atoms.atoms.size() + 1));
  size_t count = 0;
  for (uint32_t i = 0; i < atoms.atoms.size(); ++i) {
    const auto& place = atoms.atoms[i].place;
    if (std::ranges::any_of(place, [](float x) { return std::isnan(x); })) continue;
    size_t slot = hash_of(place) & (slots.size() - 1);
    while (slots[slot] > 0 && atoms.atoms[slots[slot] - 1].place != place)
      slot = (slot + 1) & (slots.size() - 1);
    if (slots[slot] == 0) {
      slots[slot] = i + 1;
      continue;
    }
    const std::string name = ++count <= Notices::kNames ? name_of(i) : "";
    atoms.notices.add(Severity::warning, "atoms at the same position as another", name);
  }
}

}  // namespace raio::core
