// Recognizes files that are neither NFF nor .raio.
#include <algorithm>
#include <array>

#include "base/spelling.h"
#include "io/atoms/pdb_atoms.h"
#include "io/atoms/read.h"
#include "io/mesh/read.h"
#include "io/mesh/smooth.h"
#include "io/nff/text_cursor.h"
#include "io/scene_file.h"

namespace raio::core {
namespace {

using Takes = FileKind::Takes;
constexpr FileKind kPdb{"a PDB file of a molecule", read_pdb, Takes::all};
constexpr FileKind kPqr{"a PQR file of a molecule", read_pqr, Takes::all};
constexpr FileKind kCif{"a CIF file of a molecule or crystal", read_mmcif, Takes::all};
constexpr FileKind kXyz{"an XYZ file of a molecule", read_xyz, Takes::all};
constexpr FileKind kGro{"a GRO file of a molecule", read_gro, Takes::all};
constexpr FileKind kDump{"a LAMMPS dump", read_lammps_dump, Takes::all};
constexpr FileKind kData{"a LAMMPS data file", read_lammps_data, Takes::all};
constexpr FileKind kPly{"a PLY file of points or a mesh", read_ply, Takes::points, true,
                        kSmoothDegrees};
constexpr FileKind kStl{"an STL mesh", read_stl, Takes::nothing, true, kSmoothDegrees};
constexpr FileKind kOff{"an OFF mesh", read_off, Takes::nothing, true, kSmoothDegrees};
constexpr FileKind kObj{"a Wavefront OBJ mesh", read_obj, Takes::nothing, true, kSmoothDegrees};
constexpr FileKind kGltf{"a glTF scene", read_gltf, Takes::nothing, true};
constexpr FileKind kSense8{"a scene of Sense8 WorldToolKit, another format that ends with .nff"};

struct Sign {
  std::string_view start;
  FileKind kind;
};

constexpr Sign kStarts[] = {
    {"RAIOPART", {"a part file of a render, which raio merge turns into a picture"}},
    {"\x89PNG", {"a PNG picture"}},
    {"\xff\xd8\xff", {"a JPEG picture"}},
    {"GIF8", {"a GIF picture"}},
    {"\x76\x2f\x31\x01", {"an OpenEXR picture"}},
    {"#?RADIANCE", {"a Radiance picture"}},
    {"#?RGBE", {"a Radiance picture"}},
    {{"II*\0", 4}, {"a TIFF picture"}},
    {{"MM\0*", 4}, {"a TIFF picture"}},
    {"%PDF", {"a PDF document"}},
    {"PK\3\4", {"a ZIP archive"}},
    {"glTF", kGltf},
    {"ply\n", kPly},
    {"ply\r", kPly},
    {"solid ", kStl},
    {"solid\t", kStl},
    {"solid\n", kStl},
    {"solid\r", kStl},
    {"OFF\n", kOff},
    {"OFF\r", kOff},
    {"OFF ", kOff},
    {"CNOFF", kOff},
    {"STOFF", kOff},
    {"STCOFF", kOff},
    {"STNOFF", kOff},
    {"STCNOFF", kOff},
    {"COFF", kOff},
    {"NOFF", kOff},
    {"nff\n", kSense8},
    {"nff\r", kSense8},
    {"nff ", kSense8},
    {"Kaydara FBX", {"an FBX scene"}},
    {"BLENDER", {"a Blender file"}},
    {"ITEM: ", kDump},
    {"LAMMPS", kData},
    {"data_", kCif},
    {"HEADER ", kPdb},
    {"ATOM  ", kPdb},
    {"HETATM", kPdb},
    {"CRYST1", kPdb},
    {"REMARK ", kPdb},
    {"MODEL  ", kPdb},
    {"COMPND ", kPdb},
    {"TITLE  ", kPdb},
    {"<?xml", {"an XML file"}},
    {"<!", {"an XML file"}},
};

constexpr Sign kSuffixes[] = {
    {".obj", kObj},    {".mtl", {"a Wavefront MTL file of materials"}},
    {".stl", kStl},    {".ply", kPly},
    {".off", kOff},    {".3ds", {"a 3DS scene"}},
    {".gltf", kGltf},  {".pov", {"a POV-Ray scene"}},
    {".ent", kPdb},    {".mmcif", kCif},
    {".pdb", kPdb},    {".cif", kCif},
    {".gro", kGro},    {".xyz", kXyz},
    {".extxyz", kXyz}, {".data", kData},
    {".dump", kDump},  {".lammpstrj", kDump},
    {".lmp", kData},   {".pqr", kPqr},
};

/// The blank-separated words of a line, at most five.
size_t first_words(std::string_view line, std::array<std::string_view, 5>& words) {
  size_t count = 0;
  for (line = trimmed(line); !line.empty() && count < words.size(); line = trimmed(line)) {
    const size_t end = std::min(line.find_first_of(" \t"), line.size());
    words[count++] = line.substr(0, end);
    line.remove_prefix(end);
  }
  return count;
}

bool all_digits(std::string_view word) {
  return !word.empty() && std::ranges::all_of(word, [](char c) { return c >= '0' && c <= '9'; });
}

/// NFF also has `v`, but without a number on its line, and an `f` with eight numbers.
bool is_obj_line(std::string_view line) {
  std::array<std::string_view, 5> words;
  const size_t count = first_words(line, words);
  if (count < 2) return false;
  const std::string_view word = words[0];
  if (word == "mtllib" || word == "usemtl") return true;
  if (word == "v" || word == "vn" || word == "vt") return looks_like_number(words[1]);
  return word == "f" && all_digits(words[1].substr(0, words[1].find('/'))) &&
         words[1].find('/') != std::string_view::npos;
}

/// "12", a line of anything, "C 0 0 0"; or a line that describes the columns.
bool is_xyz(std::string_view first, std::string_view second, std::string_view third) {
  std::array<std::string_view, 5> words;
  if (first_words(first, words) != 1 || !all_digits(words[0])) return false;
  if (second.find("Properties=") != std::string_view::npos ||
      second.find("Lattice=") != std::string_view::npos)
    return true;
  const size_t count = first_words(third, words);
  return count >= 4 && !looks_like_number(words[0]) &&
         std::all_of(&words[1], &words[4], looks_like_number);
}

FileKind kind_of_text(std::string_view text, std::string_view suffix, bool has_title) {
  constexpr std::string_view kUtf8 = "\xef\xbb\xbf";
  if (trimmed(text.starts_with(kUtf8) ? text.substr(kUtf8.size()) : text).starts_with('{')) {
    // Top-level keys of glTF, in any order; "asset" may come last.
    constexpr std::string_view kTop[] = {"\"asset\"", "\"accessors\"", "\"bufferViews\""};
    const bool is_gltf = suffix == ".gltf" || std::ranges::any_of(kTop, [&](auto word) {
                           return text.find(word) != std::string_view::npos;
                         });
    return is_gltf ? kGltf : FileKind{"a JSON file"};
  }
  const auto next_line = [&text] {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    return line;
  };
  const std::string_view all = text, first = next_line(), second = next_line();
  if (is_xyz(first, second, next_line())) return kXyz;
  text = all;
  if (has_title) (void)next_line();
  while (!text.empty()) {
    const std::string_view line = next_line();
    if (line.starts_with("data_")) return kCif;
    std::array<std::string_view, 5> words;
    if (first_words(line, words) == 2 && words[1] == "atoms" && all_digits(words[0])) return kData;
    if (is_obj_line(line)) return kObj;
  }
  return {};
}

/// "BM", the size, four zero bytes.
bool is_bmp(std::string_view start) {
  return start.starts_with("BM") && start.size() > 10 &&
         start.substr(6, 4) == std::string_view("\0\0\0\0", 4);
}

/// Whether the start could be a title, which may be any text.
bool may_be_title(const FileKind& kind) {
  return kind.read == read_stl || kind.read == read_off || kind.read == read_pdb ||
         kind.read == read_mmcif || kind.read == read_lammps_data;
}

/// "P6", a blank.
bool is_netpbm(std::string_view start) {
  return start.size() > 2 && start[0] == 'P' &&
         std::string_view("123456fF").find(start[1]) != std::string_view::npos &&
         is_char(start[2], kBlank);
}

/// PDB or PQR, with the same records: PQR by its suffix or by its first atom.
FileKind pdb_or_pqr(std::string_view start, std::string_view suffix) {
  if (suffix == ".pqr") return kPqr;
  while (!start.empty()) {
    const size_t end = std::min(start.find('\n'), start.size());
    const std::string_view line = start.substr(0, end);
    if (line.starts_with("ATOM") || line.starts_with("HETATM"))
      return end < start.size() && is_pqr_line(line) ? kPqr : kPdb;
    start.remove_prefix(std::min(end + 1, start.size()));
  }
  return kPdb;
}

}  // namespace

FileKind file_kind(std::string_view start, std::string_view suffix, size_t size) {
  start = start.substr(0, 4096);
  if (start.starts_with("RAIOSCEN")) return {};
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (start.starts_with(kByteOrderMark)) start.remove_prefix(kByteOrderMark.size());
  const bool has_title = suffix == ".gro" || suffix == ".data" || suffix == ".lmp";
  for (const Sign& sign : kStarts)
    if (start.starts_with(sign.start) && !(has_title && may_be_title(sign.kind)))
      return sign.kind.read == read_pdb ? pdb_or_pqr(start, suffix) : sign.kind;
  if (!has_title && is_bmp(start)) return {"a BMP picture"};
  if (!has_title && is_netpbm(start)) return {"a picture (PPM, PGM, PBM or PFM)"};
  if (const FileKind kind = kind_of_text(start, suffix, has_title); !kind.name.empty()) return kind;
  if (is_binary_stl(start, size)) return kStl;
  for (const Sign& sign : kSuffixes)
    if (suffix == sign.start)
      return sign.kind.read == read_pdb ? pdb_or_pqr(start, suffix) : sign.kind;
  return {};
}

std::vector<std::string_view> scene_suffixes() {
  std::vector<std::string_view> suffixes = {"nff", "p3f", "raio", "glb", "gz"};
  for (const Sign& sign : kSuffixes)
    if (sign.kind.read) suffixes.push_back(sign.start.substr(1));
  return suffixes;
}

bool has_scene_suffix(const std::filesystem::path& path) {
  constexpr std::string_view kCompressed = ".gz";
  std::string suffix = lower_suffix(path);
  if (suffix == kCompressed) suffix = lower_suffix(path.stem());
  if (suffix.empty() || suffix == kCompressed) return false;
  return std::ranges::count(scene_suffixes(), std::string_view(suffix).substr(1)) > 0;
}

}  // namespace raio::core
