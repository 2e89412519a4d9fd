#include <algorithm>
#include <cstdlib>
#include <exception>
#include <stdexcept>

#include "base/executor.h"
#include "io/atoms/cif/block.h"
#include "io/atoms/cif/cif.h"
#include "io/atoms/element_names.h"

namespace raio::core {
namespace {

// Converts gemmi's message, which begins with a location, or with the name of the file, which is
// empty.
CifFault fault_of(std::string message) {
  CifFault out;
  message = message.substr(0, message.find('\n'));
  const auto number = [&](size_t& to) {
    const size_t from = message.find_first_not_of(':');
    const size_t end = std::min(message.find_first_not_of("0123456789", from), message.size());
    if (from == std::string::npos || end == from) return;
    to = size_t(std::atoll(message.c_str() + from));
    message.erase(0, end);
  };
  number(out.line);
  if (out.line > 0) number(out.column);
  message.erase(0, std::min(message.find_first_not_of(": "), message.size()));
  out.message = message;
  return out;
}

cif::Document parse(const char* text, size_t size) {
  return cif::parse(text, size, [look = StopCheck()]() mutable { look(); });
}

// Parses tolerantly where a strict reader would stop, with a notice.
cif::Document document_of(const char* text, size_t size, Notices& notices) {
  const auto is_plain = [](char c) { return static_cast<unsigned char>(c) < 128; };
  cif::Document out;
  try {
    out = parse(text, size);
  } catch (const std::runtime_error&) {
    if (std::all_of(text, text + size, is_plain)) throw;
    std::string plain(text, size);
    std::replace_if(plain.begin(), plain.end(), [&](char c) { return !is_plain(c); }, '?');
    out = parse(plain.data(), size);
    const size_t first = size_t(std::find_if_not(text, text + size, is_plain) - text);
    notices.add(Severity::warning, "unquoted non-ASCII letters, which CIF does not allow", {},
                1 + size_t(std::count(text, text + first, '\n')),
                size_t(std::count_if(text, text + size, [](char c) {
                  return (static_cast<unsigned char>(c) & 0xc0) == 0xc0;
                })));
  }
  if (!out.duplicates.empty()) {
    const CifFault fault = fault_of(out.duplicates);
    const std::string tag = "duplicate tag ";
    const size_t at = fault.message.find(tag);
    notices.add(Severity::warning, "duplicate tags or block names; the first one is used",
                at == std::string::npos ? "" : fault.message.substr(at + tag.size()), fault.line);
  }
  return out;
}

// A document, and the rows that were removed from it.
struct Parsed {
  cif::Document document;
  std::optional<cif::CutRows> cut;
};

// gemmi takes many times as long for a row as reading lines in parallel. Nothing if there are
// notices, since removed lines change the line numbers.
std::optional<Parsed> parse_without_rows(std::string_view text, const Atoms& out) try {
  const auto loop = find_atom_site(text);
  if (!loop) return std::nullopt;
  cif::CutRows cut{int(loop->line), AtomSite(loop->tags, out.origin)};
  const size_t first = size_t(loop->rows - text.data());
  const size_t last = size_t(cut.rows.add_lines(text.substr(first)) - text.data());
  if (last == first) return std::nullopt;
  const std::string rest = std::string(text.substr(0, first)).append(text.substr(last));
  Parsed parsed{parse(rest.data(), rest.size()), std::move(cut)};
  if (!parsed.document.duplicates.empty()) return std::nullopt;
  return parsed;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception&) {
  return std::nullopt;
}

// The kind of atoms in a block.
enum class Holds { nothing, crystal, molecule, component };

Holds holds(const cif::Block& block) {
  if (has_tag(block, "_atom_site_fract_x")) return Holds::crystal;
  if (has_tag(block, "_atom_site.Cartn_x")) return Holds::molecule;
  for (const char* x : {"pdbx_model_Cartn_x_ideal", "model_Cartn_x", "x"})
    if (has_tag(block, std::string("_chem_comp_atom.") + x)) return Holds::component;
  return Holds::nothing;
}

}  // namespace

std::optional<CifFault> read_structure(const char* text, size_t size, int frame, Atoms& out,
                                       bool cuts_rows) try {
  std::optional<Parsed> parsed;
  if (cuts_rows) parsed = parse_without_rows({text, size}, out);
  if (!parsed) parsed = Parsed{document_of(text, size, out.notices), std::nullopt};
  cif::Block* chosen = nullptr;
  Cases others;
  bool has_reflections = false;
  for (cif::Block& block : parsed->document.blocks) {
    has_reflections |= std::ranges::any_of(block.items, [](const cif::Item& item) {
      return has_prefix(item, "_refln.") || has_prefix(item, "_refln_");
    });
    if (holds(block) == Holds::nothing) continue;
    if (chosen)
      others.add(block.name);
    else
      chosen = &block;
  }
  if (!chosen && has_reflections)
    return CifFault{
        "this CIF file has reflections but no atoms; read the coordinate file of the structure"};
  if (!chosen)
    return CifFault{
        "this CIF file has no atoms; expected coordinates: _atom_site.Cartn_x, "
        "_atom_site_fract_x or _chem_comp_atom.model_Cartn_x"};
  others.tell(out.notices, Severity::left_out, "further blocks with atoms");
  const bool is_only_frame = frame == 0 || frame == -1;
  switch (holds(*chosen)) {
    case Holds::molecule:
      add_molecule(std::move(*chosen), parsed->cut ? &*parsed->cut : nullptr, frame, out);
      break;
    case Holds::crystal:
      if (is_only_frame) add_crystal(std::move(*chosen), out);
      break;
    default:
      if (is_only_frame) add_component(*chosen, out);
  }
  return std::nullopt;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  return fault_of(error.what());
}

}  // namespace raio::core
