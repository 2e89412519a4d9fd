#include "io/atoms/gemmi.h"

#include <gemmi/cif.hpp>
#include <gemmi/mmcif.hpp>
#include <gemmi/smcif.hpp>
#include <memory>

namespace raio::core::cif {
namespace {

Block plain(gemmi::cif::Block from) {
  Block out{from.name, {}};
  for (gemmi::cif::Item& item : from.items)
    if (item.type == gemmi::cif::ItemType::Loop)
      out.items.push_back(
          {std::move(item.loop.tags), std::move(item.loop.values), item.line_number, true});
    else if (item.type == gemmi::cif::ItemType::Pair)
      out.items.push_back({{item.pair[0]}, {item.pair[1]}, item.line_number, false});
  return out;
}

gemmi::cif::Block block_of(Block from) {
  gemmi::cif::Block out(from.name);
  for (Item& item : from.items) {
    if (!item.is_loop) {
      out.items.emplace_back(item.tags[0], item.values[0]);
      continue;
    }
    out.items.emplace_back(gemmi::cif::LoopArg{});
    out.items.back().loop.tags = std::move(item.tags);
    out.items.back().loop.values = std::move(item.values);
  }
  return out;
}

gemmi::Position position(const std::array<double, 3>& at) { return {at[0], at[1], at[2]}; }

UnitCell plain(const gemmi::UnitCell& from) {
  UnitCell out;
  for (int row = 0; row < 3; ++row) {
    for (int k = 0; k < 3; ++k) out.matrix[row][k] = from.orth.mat[row][k];
    out.shift[row] = from.orth.vec.at(row);
  }
  out.reciprocal = {from.ar, from.br, from.cr};
  out.alpha = from.alpha, out.gamma = from.gamma;
  out.is_crystal = from.is_crystal();
  out.matrix_disagrees = from.explicit_matrices;
  out.is_nearest = [cell = std::make_shared<gemmi::UnitCell>(from)](
                       const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return !cell->is_crystal() ||
           cell->find_nearest_image(position(a), position(b), gemmi::Asu::Any).same_asu();
  };
  return out;
}

static_assert(gemmi::Op::DEN == kParts);

Operation plain(const gemmi::Op& op) { return {op.rot, op.tran}; }

std::vector<Operation> plain(const gemmi::GroupOps& from) {
  std::vector<Operation> out;
  for (const gemmi::Op op : from) out.push_back(plain(op));
  return out;
}

AtomAddress plain(const gemmi::AtomAddress& from) {
  AtomAddress out{from.chain_name, from.res_id.name, from.atom_name, {}, from.altloc};
  const gemmi::SeqId& id = from.res_id.seqid;
  if (id.num.has_value()) out.number.number = id.num.value;
  out.number.insertion = id.icode;
  return out;
}

// A document that calls `look` as it grows; most of its content is values of loops.
struct Growing : gemmi::cif::Document {
  const std::function<void()>& look;
};
template <class Rule>
struct Grow : gemmi::cif::Action<Rule> {};
template <>
struct Grow<gemmi::cif::rules::loop_value> {
  template <class Input>
  static void apply(const Input& in, Growing& out) {
    out.look();
    gemmi::cif::Action<gemmi::cif::rules::loop_value>::apply(in, out);
  }
};

}  // namespace

// As the parser of gemmi does it, with our actions.
Document parse(const char* text, size_t size, const std::function<void()>& look) {
  Growing parsed{{}, look};
  tao::pegtl::parse<gemmi::cif::rules::file, Grow, gemmi::cif::Errors>(
      tao::pegtl::memory_input<>(text, size, ""), parsed);
  Document out;
  try {
    gemmi::cif::check_for_duplicates(parsed);
  } catch (const std::exception& error) {
    out.duplicates = error.what();
  }
  for (gemmi::cif::Block& block : parsed.blocks) out.blocks.push_back(plain(std::move(block)));
  return out;
}

UnitCell unit_cell(const CellRecords& records) try {
  gemmi::UnitCell cell;
  const auto& n = records.lengths_and_angles;
  cell.set(n[0], n[1], n[2], n[3], n[4], n[5]);
  if (records.scale) {
    gemmi::Transform fraction;
    for (int row = 0; row < 3; ++row) {
      for (int k = 0; k < 3; ++k) fraction.mat[row][k] = (*records.scale)[4 * row + k];
      fraction.vec.at(row) = (*records.scale)[4 * row + 3];
    }
    cell.set_matrices_from_fract(fraction);
  }
  if (cell.is_crystal())
    cell.set_cell_images_from_spacegroup(
        gemmi::find_spacegroup_by_name(records.group, cell.alpha, cell.gamma));
  return plain(cell);
} catch (const std::runtime_error&) {
  throw std::runtime_error("the angles in CRYST1 are impossible");
}

Operation parse_operation(const std::string& text) { return plain(gemmi::parse_triplet(text)); }

std::vector<Operation> operations_of_hall(const std::string& symbol) {
  return plain(gemmi::symops_from_hall(symbol.c_str()));
}

std::vector<Operation> operations_of_group(const std::string& name, const UnitCell& cell) {
  const auto* group = gemmi::find_spacegroup_by_name(name, cell.alpha, cell.gamma);
  return group ? plain(group->operations()) : std::vector<Operation>();
}

std::vector<Operation> operations_of_group(int number) {
  const auto* group = gemmi::find_spacegroup_by_number(number);
  return group ? plain(group->operations()) : std::vector<Operation>();
}

Crystal crystal_of(Block block) {
  const auto small = gemmi::make_small_structure_from_block(block_of(std::move(block)));
  Crystal out{plain(small.cell), small.spacegroup_hm, {}};
  for (const gemmi::SmallStructure::Site& site : small.sites)
    out.sites.push_back({site.label,
                         {site.fract.x, site.fract.y, site.fract.z},
                         site.occ,
                         site.u_iso * gemmi::u_to_b(),
                         site.disorder_group,
                         site.element.atomic_number()});
  return out;
}

Molecule molecule_of(Block block) {
  const auto structure = gemmi::make_structure_from_block(block_of(std::move(block)));
  Molecule out{plain(structure.cell), {}};
  for (const gemmi::Connection& link : structure.connections)
    if (link.asu != gemmi::Asu::Different && link.type != gemmi::Connection::Hydrog)
      out.links.push_back(
          {{plain(link.partner1), plain(link.partner2)}, link.asu == gemmi::Asu::Any});
  return out;
}

}  // namespace raio::core::cif
