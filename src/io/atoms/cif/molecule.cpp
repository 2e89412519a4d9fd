#include <algorithm>

#include "io/atoms/cells.h"
#include "io/atoms/cif/assemblies.h"
#include "io/atoms/cif/block.h"
#include "io/atoms/cif/cif.h"

namespace raio::core::cif {
namespace {

// The rows of the block, including those removed before parsing. Takes the values of a loop.
AtomSite rows_of(Block& block, CutRows* cut, const Atoms& out) {
  Item& found = block.items[index_of(block, "_atom_site.Cartn_x")];
  Item loop;
  if (found.is_loop) {
    loop.tags = found.tags, loop.values = std::move(found.values);
  } else {
    for (const Item& pair : block.items)
      if (!pair.is_loop && has_prefix(pair, "_atom_site."))
        loop.tags.push_back(pair.tags[0]), loop.values.push_back(pair.values[0]);
  }
  AtomSite rows =
      cut && cut->line == found.line ? std::move(cut->rows) : AtomSite(loop.tags, out.origin);
  rows.add_values(std::move(loop.values));
  return rows;
}

// Everything else that gemmi reads of the block. It is slow with many atoms and residues, so it
// gets only the rows that other tables refer to.
Molecule rest_of(Block block, const AtomSite& rows) {
  // Large tables that are not used here. gemmi fails if the first of them names a residue without
  // atoms.
  std::erase_if(block.items, [](const Item& item) {
    return has_prefix(item, "_pdbx_sifts_xref_db.") || has_prefix(item, "_atom_site_anisotrop.");
  });
  const bool names_residues =
      has_tag(block, "_struct_conn.id") &&
      !Table(block, "_struct_conn.",
             {"ptnr1_auth_asym_id", "ptnr2_auth_asym_id", "ptnr1_auth_seq_id", "ptnr2_auth_seq_id"})
           .is_complete();
  Item& atoms = block.items[index_of(block, "_atom_site.Cartn_x")];
  if (atoms.is_loop) {
    atoms.tags = AtomSite::sample_tags();
    atoms.values = rows.sample(names_residues);
  }
  return molecule_of(std::move(block));
}

}  // namespace

void add_molecule(Block block, CutRows* cut, int frame, Atoms& out) {
  out.has_occupancies = has_tag(block, "_atom_site.occupancy");
  out.has_b_factors = has_tag(block, "_atom_site.B_iso_or_equiv");
  AtomSite rows = rows_of(block, cut, out);
  rows.group(out.notices);
  const Assemblies assemblies(block);
  const Molecule rest = rest_of(std::move(block), rows);
  out.frames = rows.models();
  const int64_t at = frame < 0 ? int64_t(rows.models()) + frame : frame;
  if (at < 0 || at >= int64_t(rows.models())) return;
  std::vector<AtomAddress> ends;
  for (const Link& link : rest.links) ends.insert(ends.end(), link.ends, link.ends + 2);
  std::vector<std::string> part_names;
  Names parts(part_names);
  const std::vector<uint32_t> atoms = rows.fill(size_t(at), parts, ends, out);
  if (out.marks) rows.add_marks(*out.marks);
  out.has_residues = true;
  if (rest.cell.is_crystal) out.cell = cell_of(rest.cell);
  if (rest.cell.matrix_disagrees)
    out.notices.add_whole(
        Severity::warning,
        "_atom_sites.fract_transf_matrix disagrees with _cell; the matrix is used "
        "for the cell");
  for (size_t i = 0; i < rest.links.size(); ++i) {
    const uint32_t a = atoms[2 * i], b = atoms[2 * i + 1];
    if (a == AtomSite::kNoAtom || b == AtomSite::kNoAtom || a == b) continue;
    // If the file does not say which symmetry mate is meant, the nearest one is.
    if (rest.links[i].may_be_to_mate && !rest.cell.is_nearest(rows.place_of(a), rows.place_of(b)))
      continue;
    out.bonds.push_back({std::min(a, b), std::max(a, b)});
  }
  note_coincident(out, [&](uint32_t i) { return rows.name_of(out, i); });
  out.assemblies = assemblies.take(parts);
}

}  // namespace raio::core::cif
