#include <algorithm>
#include <gemmi/mmcif.hpp>

#include "io/atoms/cif/assemblies.h"
#include "io/atoms/cif/cif.h"

namespace raio::core {
namespace {

// The rows of the block, including those removed before parsing.
AtomSite rows_of(gemmi::cif::Block& block, CutRows* cut, const Atoms& out) {
  gemmi::cif::Item* const item = block.find_values("_atom_site.Cartn_x").item();
  std::vector<std::string> tags, values;
  if (item->type == gemmi::cif::ItemType::Loop) {
    tags = item->loop.tags, values = std::move(item->loop.values);
  } else {
    for (const gemmi::cif::Item& pair : block.items)
      if (pair.type == gemmi::cif::ItemType::Pair && pair.has_prefix("_atom_site."))
        tags.push_back(pair.pair[0]), values.push_back(pair.pair[1]);
  }
  AtomSite rows =
      cut && cut->line == item->line_number ? std::move(cut->rows) : AtomSite(tags, out.origin);
  rows.add_values(std::move(values));
  return rows;
}

// Everything else that gemmi reads of the block. It is slow with many atoms and residues, so it
// gets only those that other tables refer to.
gemmi::Structure structure_of(gemmi::cif::Block& block, const AtomSite& rows) {
  // Large tables that are not used here. gemmi fails if the first of them names a residue without
  // atoms.
  for (gemmi::cif::Item& item : block.items)
    if (item.has_prefix("_pdbx_sifts_xref_db.") || item.has_prefix("_atom_site_anisotrop."))
      item.erase();
  const bool names_residues =
      block.has_tag("_struct_conn.id") &&
      !block
           .find("_struct_conn.", {"ptnr1_auth_asym_id", "ptnr2_auth_asym_id", "ptnr1_auth_seq_id",
                                   "ptnr2_auth_seq_id"})
           .ok();
  if (gemmi::cif::Loop* const loop = block.find_loop("_atom_site.Cartn_x").get_loop()) {
    loop->tags = AtomSite::sample_tags();
    loop->values = rows.sample(names_residues);
  }
  return gemmi::make_structure_from_block(block);
}

// Connections of struct_conn between and within molecules, without hydrogen bonds and bonds to
// symmetry mates.
std::vector<gemmi::Connection> links_of(const gemmi::Structure& s) {
  std::vector<gemmi::Connection> out;
  for (const gemmi::Connection& link : s.connections)
    if (link.asu != gemmi::Asu::Different && link.type != gemmi::Connection::Hydrog)
      out.push_back(link);
  return out;
}

}  // namespace

void add_molecule(gemmi::cif::Block& block, CutRows* cut, int frame, Atoms& out) {
  out.has_occupancies = block.has_tag("_atom_site.occupancy");
  out.has_b_factors = block.has_tag("_atom_site.B_iso_or_equiv");
  AtomSite rows = rows_of(block, cut, out);
  rows.group(out.notices);
  const Assemblies assemblies(block);
  const gemmi::Structure s = structure_of(block, rows);
  out.frames = rows.models();
  const int64_t at = frame < 0 ? int64_t(rows.models()) + frame : frame;
  if (at < 0 || at >= int64_t(rows.models())) return;
  const std::vector<gemmi::Connection> links = links_of(s);
  std::vector<gemmi::AtomAddress> ends;
  for (const gemmi::Connection& link : links)
    ends.push_back(link.partner1), ends.push_back(link.partner2);
  std::vector<std::string> part_names;
  Names parts(part_names);
  const std::vector<uint32_t> atoms = rows.fill(size_t(at), parts, ends, out);
  out.has_residues = true;
  if (s.cell.is_crystal()) out.cell = cell_of(s.cell);
  if (s.cell.explicit_matrices)
    out.notices.add_whole(
        Severity::warning,
        "_atom_sites.fract_transf_matrix disagrees with _cell; the matrix is used "
        "for the cell");
  const auto position = [&](uint32_t atom) {
    const auto [x, y, z] = rows.place_of(atom);
    return gemmi::Position(x, y, z);
  };
  for (size_t i = 0; i < links.size(); ++i) {
    const uint32_t a = atoms[2 * i], b = atoms[2 * i + 1];
    if (a == AtomSite::kNoAtom || b == AtomSite::kNoAtom || a == b) continue;
    // If the file does not say which symmetry mate is meant, the nearest one is.
    if (links[i].asu == gemmi::Asu::Any && s.cell.is_crystal() &&
        !s.cell.find_nearest_image(position(a), position(b), gemmi::Asu::Any).same_asu())
      continue;
    out.bonds.push_back({std::min(a, b), std::max(a, b)});
  }
  note_coincident(out, [&](uint32_t i) { return rows.name_of(out, i); });
  out.assemblies = assemblies.take(parts);
}

}  // namespace raio::core
