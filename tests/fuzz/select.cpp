// Selections of atoms, in a small file with most of what they can select.
#include "io/atoms/select.h"

#include <string>
#include <string_view>

#include "io/scene_file.h"
#include "require.h"

namespace {

constexpr std::string_view kFile =
    "ATOM      1  CA  ALA A   1       0.000   0.000   0.000  1.00  0.00           C\n"
    "ATOM      2  HA  ALA A   1       1.000   0.000   0.000  1.00  0.00           H\n"
    "ATOM      3  P    DA B   1       9.000   0.000   0.000  1.00  0.00           P\n"
    "HETATM    4 FE   HEM B   5       5.000   5.000   0.000  1.00  0.00          FE\n"
    "HETATM    5 NA    NA A   7       0.000   5.000   0.000  1.00  0.00          NA\n"
    "HETATM    6  O   HOH A 101       0.000   5.000   5.000  1.00  0.00           O\n";

size_t atoms(const raio::core::ReadOptions& options) {
  const auto read = raio::core::parse_scene(kFile, "a.pdb", options);
  return read ? read->scene.spheres.size() : 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const bool is_sound = raio::core::selection_problem(text).empty();
  const size_t kept = atoms({.style = raio::core::AtomStyle::space_filling, .only = text});
  raio::core::fuzz::require(is_sound || kept == 0 || text.empty(),
                            "what is no selection chooses nothing");
  const size_t rest = atoms({.style = raio::core::AtomStyle::space_filling, .hide = text});
  // Either leaves no atom, or the selected property is missing in the file.
  raio::core::fuzz::require(!is_sound || kept == 0 || rest == 0 || kept + rest == 6,
                            "what is chosen and what is hidden are all atoms");
  return 0;
}
