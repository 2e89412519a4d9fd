// PDB and mmCIF, from the text to the scene.
#include "io/atoms/lines.h"
#include "io/atoms/read.h"
#include "io/nff/text_cursor.h"

namespace raio {
namespace {

std::expected<ReadScene, Diagnostics> read_by_gemmi(const TextBuffer& text, std::string_view file,
                                                    bool cif, const ReadOptions& options) {
  Atoms atoms;
  const std::string_view bytes = text.view();
  if (std::string wrong = read_structure(bytes.data(), bytes.size(), cif, options.frame, atoms);
      !wrong.empty()) {
    // Of several lines the first says what it is; the name of the file is ours to say.
    wrong = wrong.substr(0, wrong.find('\n'));
    while (wrong.starts_with(':')) wrong.erase(0, 1);
    return failed(file, printable(wrong));
  }
  if (atoms.frames == 0)
    return failed(file, cif ? "there are no atoms that could be read; expected the columns id, "
                              "type_symbol, Cartn_x, Cartn_y and Cartn_z of _atom_site"
                            : "there are no atoms in this PDB file");
  return scene_of_atoms(atoms, file, options);
}

}  // namespace

std::expected<ReadScene, Diagnostics> read_pdb(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options) {
  return read_by_gemmi(text, file, false, options);
}

std::expected<ReadScene, Diagnostics> read_mmcif(const TextBuffer& text, std::string_view file,
                                                 const ReadOptions& options) {
  return read_by_gemmi(text, file, true, options);
}

}  // namespace raio
