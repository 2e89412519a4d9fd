// Reads long texts in pieces, in parallel, with the same scene and messages as in one pass. A piece
// begins with a keyword that is the first word of its line. The reader always begins an entity
// there, whatever went wrong before: no entity takes a keyword as part of itself, and none skips a
// keyword that begins a line. So pieces with nothing but objects and materials are read
// independently and joined in the order of the text. A piece with anything else or with an error is
// read again in its turn, by the reader of the whole text.
#include "base/memory.h"
#include "base/parallel.h"
#include "io/nff/parser.h"

namespace raio::core::nff {
namespace {

constexpr size_t kPieceBytes = 128 * 1024;
constexpr size_t kPiecesAtOnce = 64;  // bounds their memory in addition to the scene

/// Picks an overload by the argument's type.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};

/// Appends elements, each after `change`. `whole` is the length of the text relative to the part
/// read so far; it predicts the final size of the pool. Unused reserve costs nothing, but moving a
/// large pool does.
template <class T, class Change>
void append_changed(Array<T>& pool, Array<T>& more, double whole, Change change) {
  const size_t size = pool.size() + more.size();
  if (size > pool.capacity()) {
    pool.reserve(std::max(2 * pool.capacity(), size_t(1.1 * whole * double(size))));
    use_large_pages(pool.data() + pool.size(), (pool.capacity() - pool.size()) * sizeof(T));
  }
  for (T& item : more) change(item);
  pool.insert(pool.end(), more.begin(), more.end());
}
template <class T, class Change>
void append_changed(StridedArray<T>& pool, StridedArray<T>& more, double whole, Change change) {
  append_changed(pool.writable(), more.writable(), whole, change);
}

}  // namespace

struct Parser::Piece {
  const char *begin, *end;
  TextReport report;
  bool plain = false;       // only then the members below are set
  Scene scene = {};         // its material 0 represents the current material at the piece's start
  MaterialId material = 0;  // current at the piece's end
};

/// A parser for a piece.
Parser::Parser(const Parser& whole, const char* begin, TextReport& report)
    : text_(whole.text_), report_(report), p_(begin), begin_(begin), material_(0) {
  scene_.origin = whole.scene_.origin;
  scene_.materials.emplace_back();
}

/// The end of the piece that starts at `begin`.
const char* Parser::next_cut(const char* begin) const {
  if (size_t(text_.end() - begin) <= kPieceBytes) return text_.end();
  for (const char* p = begin + kPieceBytes;;) {
    while (*p != '\0' && !is_char(*p, kLineEnd)) ++p;
    while (is_char(*p, kBlank)) ++p;
    if (*p == '\0') return text_.end();
    if (find_entity(word_at(p))) return p;
  }
}

/// Reads from a cut to the end of the text. The next pieces are read while finished ones are
/// joined.
void Parser::read_pieces(const char* cut) {
  std::vector<Piece> pieces = some_pieces(cut), next;
  while (!pieces.empty()) {
    cut = pieces.back().end;
    const auto join = [&] {
      for (Piece& piece : pieces) {
        check_stop();
        piece.plain ? append(piece) : walk(piece.end);
      }
    };
    parallel_invoke([&] { next = some_pieces(cut); }, join);
    pieces.swap(next);
  }
}

std::vector<Parser::Piece> Parser::some_pieces(const char* cut) const {
  std::vector<Piece> pieces;
  while (cut < text_.end() && pieces.size() < kPiecesAtOnce) {
    const char* const end = next_cut(cut);
    pieces.push_back({cut, end, report_.of_part()});
    cut = end;
  }
  parallel_for(pieces.size(), [&](size_t i) { read(pieces[i]); });
  return pieces;
}

void Parser::read(Piece& piece) const {
  Parser parser(*this, piece.begin, piece.report);
  piece.plain = true;
  while (piece.plain && parser.next() < piece.end) {
    const Entity* const entity = parser.entity();
    piece.plain = entity && entity->leaves == Entity::Leaves::objects && !piece.report.failed();
  }
  piece.scene = std::move(parser.scene_);
  piece.material = *parser.material_;
}

void Parser::append(Piece& piece) {
  Scene &from = piece.scene, &to = scene_;
  p_ = piece.end;
  if (from.dialect == Dialect::p3f) to.dialect = Dialect::p3f;
  report_.append(std::move(piece.report));

  std::vector<MaterialId> ids = {*material_};
  for (MaterialId i = 1; i < from.materials.size(); ++i)
    ids.push_back(material_id({from.materials[i], from.specular_of(i), from.roughness_of(i)}));
  material_ = ids[piece.material];

  const auto first = uint32_t(to.positions.size()), first_normal = uint32_t(to.normals.size());
  if (!from.triangle_normals.empty() || !to.triangle_normals.empty()) {
    // As add_triangle() does.
    constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};
    to.triangle_normals.resize(to.triangles.size(), kFlat);
    from.triangle_normals.resize(from.triangles.size(), kFlat);
  }

  const double whole = double(text_.view().size()) / double(offset(piece.end));
  const auto join = [&](auto& pool, auto& more, auto change) {
    append_changed(pool, more, whole, change);
  };
  const auto as_it_is = [](auto&) {};
  const auto renumber = [&](MaterialId& id) { id = ids[id]; };
  const auto move_triangle = [&](TriangleIndices& t) {
    for (uint32_t& corner : t) corner += first;
  };
  const auto move_polygon = [&](Polygon& p) { p.first += first; };
  const auto moved = Overloaded{move_triangle, move_polygon, as_it_is};
  for_each_pool([&](auto pool) {
    join(to.*pool.shapes, from.*pool.shapes, moved);
    join(to.*pool.materials, from.*pool.materials, renumber);
  });
  join(to.positions, from.positions, as_it_is);
  join(to.normals, from.normals, as_it_is);
  join(to.triangle_normals, from.triangle_normals, [&](TriangleIndices& t) {
    for (uint32_t& normal : t) normal += normal == kNoNormal ? 0 : first_normal;
  });
}

}  // namespace raio::core::nff
