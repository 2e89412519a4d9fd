// Readers of files of atoms: SceneReader each.
#pragma once

#include "io/atoms/atoms.h"
#include "io/far_origin.h"
#include "io/read_scene.h"

namespace raio {

std::expected<ReadScene, Diagnostics> read_pdb(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);
/// PQR of PDB2PQR: as PDB, but blanks part the fields, and charge and radius stand behind the
/// place.
std::expected<ReadScene, Diagnostics> read_pqr(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);
std::expected<ReadScene, Diagnostics> read_mmcif(const TextBuffer& text, std::string_view file,
                                                 const ReadOptions& options);
/// XYZ and extended XYZ: of the latter the columns `pos`, `species` and `radius`, wherever they
/// are.
std::expected<ReadScene, Diagnostics> read_xyz(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);
std::expected<ReadScene, Diagnostics> read_lammps_dump(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options);
std::expected<ReadScene, Diagnostics> read_lammps_data(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options);
/// GRO of GROMACS, nanometres; elements are told from the names of atoms.
std::expected<ReadScene, Diagnostics> read_gro(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);

using Bonds = std::vector<std::array<uint32_t, 2>>;

/// Pairs of atoms no farther apart than the sum of their covalent radii and 0.45 angstroms, as most
/// programs have it, but for pairs of hydrogens, atoms of no known element, and metals with what an
/// anion holds apart from them; in order. Takes a time proportional to the number of atoms. Nothing
/// where thousands of atoms are at one place, which is no molecule.
std::optional<Bonds> find_bonds(const std::vector<Atom>& atoms);

/// Joins the alpha carbons or phosphorus atoms of neighbouring residues where these are all that a
/// file has of a chain, so that none of them has a bond. Returns how many bonds are new.
size_t add_traces(const std::vector<Atom>& atoms, Bonds& bonds);

/// The atoms as spheres and cylinders, as `options` have it, with a camera. An error says which
/// option does not fit.
std::expected<ReadScene, Diagnostics> scene_of_atoms(Atoms atoms, std::string_view file,
                                                     const ReadOptions& options);

/// A place near all atoms, if they are far from 0 and were read as they stand; else 0.
std::array<double, 3> origin_for(const std::vector<Atom>& atoms);

/// The scene of the atoms that read(origin) gives with places relative to an origin. Where they are
/// far from 0 they are read again, relative to a place near all of them.
template <class Read>
std::expected<ReadScene, Diagnostics> scene_about(const Read& read, std::string_view file,
                                                  const ReadOptions& options) {
  std::expected<Atoms, Diagnostics> atoms = read(std::array<double, 3>{});
  if (!atoms) return std::unexpected(atoms.error());
  if (const auto origin = origin_for(atoms->atoms); origin != std::array<double, 3>{}) {
    atoms->atoms = {};
    atoms = read(origin);
    if (!atoms) return std::unexpected(atoms.error());
  }
  return scene_of_atoms(*std::move(atoms), file, options);
}

}  // namespace raio
