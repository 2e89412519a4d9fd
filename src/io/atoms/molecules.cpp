// CIF and mmCIF, from the text to the scene; and what all molecules are asked.
#include <bit>
#include <unordered_set>

#include "io/atoms/element_names.h"
#include "io/atoms/lines.h"
#include "io/atoms/read.h"
#include "io/nff/text_cursor.h"

namespace raio {
namespace {

std::expected<Atoms, Diagnostics> atoms_of(std::string_view bytes, std::string_view file, int frame,
                                           const std::array<double, 3>& origin) {
  Atoms atoms;
  atoms.origin = origin;
  if (const auto fault = read_structure(bytes.data(), bytes.size(), frame, atoms)) {
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
                  "there are no atoms that could be read; expected the columns Cartn_x, "
                  "Cartn_y and Cartn_z of _atom_site");
  note_coincident(atoms);
  return atoms;
}

}  // namespace

std::expected<ReadScene, Diagnostics> read_mmcif(const TextBuffer& text, std::string_view file,
                                                 const ReadOptions& options) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  std::string_view bytes = text.view();
  if (bytes.starts_with(kByteOrderMark)) bytes.remove_prefix(kByteOrderMark.size());
  return scene_about(
      [&](const auto& origin) { return atoms_of(bytes, file, options.frame, origin); }, file,
      options);
}

void note_coincident(Atoms& atoms) {
  struct Same {
    size_t operator()(const std::array<float, 3>& p) const {
      uint64_t hash = 0;
      for (const float x : p)
        hash = (hash ^ std::bit_cast<uint32_t>(x + 0.0f)) * 0x9e3779b97f4a7c15u;
      return hash ^ (hash >> 32);
    }
  };
  std::unordered_set<std::array<float, 3>, Same> places;
  places.reserve(atoms.atoms.size());
  size_t count = 0;
  for (const Atom& atom : atoms.atoms) count += !places.insert(atom.place).second;
  if (count > 0)
    atoms.notices.add(Severity::warning, "atoms at the very place of another", {}, 0, count);
}

}  // namespace raio
