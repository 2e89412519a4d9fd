// Readers of files of atoms; each is a SceneReader.
#pragma once

#include "io/atoms/atoms.h"
#include "io/far_origin.h"
#include "io/read_scene.h"

namespace raio::core {

std::expected<ReadScene, Diagnostics> read_pdb(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);
/// PQR of PDB2PQR: like PDB, but with fields separated by blanks, and charge and radius after the
/// position.
std::expected<ReadScene, Diagnostics> read_pqr(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);
std::expected<ReadScene, Diagnostics> read_mmcif(const TextBuffer& text, std::string_view file,
                                                 const ReadOptions& options);
/// XYZ and extended XYZ, with the columns `pos`, `species` and `radius` of the latter at any
/// position.
std::expected<ReadScene, Diagnostics> read_xyz(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);
std::expected<ReadScene, Diagnostics> read_lammps_dump(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options);
std::expected<ReadScene, Diagnostics> read_lammps_data(const TextBuffer& text,
                                                       std::string_view file,
                                                       const ReadOptions& options);
/// GRO of GROMACS, in nanometres; elements are guessed from atom names.
std::expected<ReadScene, Diagnostics> read_gro(const TextBuffer& text, std::string_view file,
                                               const ReadOptions& options);

using Bonds = std::vector<std::array<uint32_t, 2>>;

/// Pairs of atoms no farther apart than the sum of their covalent radii plus 0.45 angstroms, the
/// usual tolerance, in order. Excludes pairs of hydrogens, atoms of unknown element, and metals
/// bridged by an anion. Takes time proportional to the number of atoms. Nothing if thousands of
/// atoms are at one position, which is not a molecule.
std::optional<Bonds> find_bonds(const std::vector<Atom>& atoms);

/// Bonds the alpha carbons or phosphorus atoms of consecutive residues if a chain has no other
/// atoms, so that none of them has a bond. Returns the number of new bonds.
size_t add_traces(const std::vector<Atom>& atoms, Bonds& bonds);

/// The atoms as spheres and cylinders, in the requested style, with a camera. The error names the
/// option that does not fit.
std::expected<ReadScene, Diagnostics> scene_of_atoms(Atoms atoms, std::string_view file,
                                                     const ReadOptions& options);

/// An origin near all atoms, if they are far from 0 and were read without an origin; else 0.
std::array<double, 3> origin_for(const std::vector<Atom>& atoms);

/// The scene of the atoms that read(origin) returns, with positions relative to the origin. If they
/// are far from 0, they are read again relative to an origin near them.
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

}  // namespace raio::core
