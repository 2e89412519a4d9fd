// Small files of atoms, points and meshes, and helpers to read them.
#pragma once

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>

#include "io/scene_file.h"

namespace raio::core {

inline std::expected<ReadScene, Diagnostics> read(std::string_view text, std::string_view name,
                                                  const ReadOptions& options = {}) {
  return parse_scene(text, name, options);
}

inline std::string error(std::string_view text, std::string_view name,
                         const ReadOptions& options = {}) {
  const auto result = read(text, name, options);
  if (result) return "no error";
  return result.error().front().text();
}

inline std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t bits = 0;
    for (size_t k = 0; k < 3; ++k)
      bits = bits << 8 | (i + k < bytes.size() ? uint8_t(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k)
      out += i + k <= bytes.size() ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

inline constexpr std::string_view kWater =
    "3\n"
    "water\n"
    "O 0 0 0\n"
    "H 0.9572 0 0\n"
    "H -0.24 0.927 0\n";

inline constexpr std::string_view kDump =
    "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n2\nITEM: BOX BOUNDS pp pp pp\n-1 1\n0 4\n0 8\n"
    "ITEM: ATOMS id type xs ys zs c_pe\n1 1 0.5 0.25 0.5 -3\n2 2 1 1 1 -2\n"
    "ITEM: TIMESTEP\n10\nITEM: NUMBER OF ATOMS\n1\n"
    "ITEM: BOX BOUNDS xy xz yz pp pp pp\n0 12 2\n0 10 0\n0 10 0\n"
    "ITEM: ATOMS id element xs ys zs diameter\n1 Fe 0.5 0.5 0.5 3\n";

inline constexpr std::string_view kSalt =
    "data_salt\n_cell_length_a 5.64\n_cell_length_b 5.64\n_cell_length_c 5.64\n"
    "_cell_angle_alpha 90\n_cell_angle_beta 90\n_cell_angle_gamma 90\n"
    "_symmetry_space_group_name_H-M 'F m -3 m'\n"
    "loop_\n_atom_site_label\n_atom_site_fract_x\n_atom_site_fract_y\n_atom_site_fract_z\n"
    "Na1 0 0 0\nCl1 0.5 0.5 0.5000(1)\n";

inline constexpr std::string_view kData =
    "LAMMPS data file\n\n3 atoms\n2 bonds\n2 atom types\n0 20 xlo xhi\n0 20 ylo yhi\n"
    "0 20 zlo zhi\n\nMasses\n\n1 15.9994 # O\n2 1.008\n\nAtoms # full\n\n"
    "7 1 1 -0.8 1 1 1 0 0 0\n9 1 2 0.4 2 1 1 0 0 0\n8 1 2 0.4 1 19 1 0 0 0\n\n"
    "Velocities\n\n7 0 0 0\n9 0 0 0\n8 0 0 0\n\nBonds\n\n1 1 7 9\n2 1 7 8\n";

inline constexpr std::string_view kGro =
    "Water and an ion t= 0.0\n    4\n"
    "    1SOL     OW    1   0.126   1.624   1.679  0.1227 -0.0580  0.0434\n"
    "    1SOL    HW1    2   0.190   1.661   1.747  0.8085  0.3191 -0.7791\n"
    "    1SOL    HW2    3   0.177   1.568   1.613-12.9045 -0.0580  0.0434\n"
    "    2CA      CA    4-999.900   1.568   1.613\n"
    "   1.86824   1.86824   1.86824\n";

inline constexpr std::string_view kPdb =
    "REMARK 350 BIOMOLECULE: 1\n"
    "REMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
    "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
    "REMARK 350   BIOMT1 1000 -1.000000  0.000000  0.000000       10.00000\n"
    "REMARK 350   BIOMT2 1000  0.000000 -1.000000  0.000000        0.00000\n"
    "REMARK 350   BIOMT3 1000  0.000000  0.000000  1.000000        5.00000\n"
    "ATOM      1  N   ALA A   1       1.000   2.000   3.000  1.00 10.00           N\n"
    "ATOM      2  CA AALA A   1       2.400   2.000   3.000  0.40 20.00           C\n"
    "ATOM      3  CA BALA A   1       2.500   2.000   3.000  0.60 20.00           C\n"
    "HETATM    4 CA    CA B   2       8.000   2.000   3.000  1.00 30.00          CA\n"
    "END\n";

inline constexpr std::string_view kMesh =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float "
    "z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0 255 255 255\n4 0 1 2 3\n";

inline constexpr std::string_view kStl =
    "solid two\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
    "   vertex 0 1 0\n  endloop\n endfacet\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 1 0 0\n"
    "VERTEX 1 1 0\nVERTEX 0 1 0\nENDLOOP\nENDFACET\nendsolid two\n";

inline constexpr std::string_view kObj =
    "# a square\nmtllib square.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\n"
    "vt 1 1\nvn 0 0 2\nusemtl red one\nf 1/1/1 2/2/1 3/3/1\nusemtl clear\nf -4/3 -2/3 -1\n"
    "l 1 2\nf 1 2 \\\n3\n";

// The same points as text and in both byte orders.
inline std::string ply(std::string_view format, int count, bool clear) {
  std::string out =
      "ply\nformat " + std::string(format) + " 1.0\ncomment made here\nelement vertex " +
      std::to_string(count) +
      "\nproperty float x\nproperty float y\nproperty double z\nproperty float radius\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property uchar alpha\nend_header\n";
  const auto add = [&](const auto& number) {
    std::array<char, sizeof number> bytes;
    std::memcpy(bytes.data(), &number, bytes.size());
    if (format == "binary_big_endian") std::ranges::reverse(bytes);
    out.append(bytes.data(), bytes.size());
  };
  for (int i = 0; i < count; ++i) {
    const float x = float(i), y = float(i % 7) * 0.5f, r = 0.25f + float(i % 3);
    const double z = 0.125 * (i % 5);
    const auto red = uint8_t(i % 256), alpha = uint8_t(clear && i % 2 ? 128 : 255);
    if (format == "ascii") {
      out += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + " " +
             std::to_string(r) + " " + std::to_string(red) + " 0 255 " + std::to_string(alpha) +
             "\n";
    } else {
      add(x), add(y), add(z), add(r), add(red), add(uint8_t(0)), add(uint8_t(255)), add(alpha);
    }
  }
  return out;
}

}  // namespace raio::core
