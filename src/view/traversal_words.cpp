#include "view/traversal_words.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "app/test_numbers.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

using Kind = ExplainedRay::Kind;
using Variables = std::vector<std::pair<std::string, std::string>>;
constexpr char kAxes[] = "xyz";

// A variable's value; within sentences a shorter one.
std::string value_text(double x) { return fmt::format("{:.6g}", x); }
std::string brief(double x) { return fmt::format("{:.4g}", x); }

std::string cell_text(const TraceLog::Step& s) {
  return fmt::format("({}, {}, {})", s.cell[0], s.cell[1], s.cell[2]);
}

class TraversalNarrator {
 public:
  TraversalNarrator(const ExplainedRay& ray, const TraceLog& log, const Geometry& geometry,
                    AccelKind kind)
      : ray_(ray),
        log_(log),
        geometry_(geometry),
        grid_(kind == AccelKind::grid),
        nearest_(ray.ray.tmax) {}

  std::vector<TraversalStep> tell() && {
    if (!ray_.traced) {
      add(tr("The ray is beyond the last level and is not traced"));
      return std::move(out_);
    }
    begin();
    for (size_t k = 0; k < log_.steps.size(); ++k) {
      at_ = int(k);
      grid_ ? cell(k) : box(log_.steps[k]);
      tests(log_.steps[k].first_test,
            k + 1 < log_.steps.size() ? log_.steps[k + 1].first_test : log_.tests.size());
    }
    grid_ ? end_of_grid() : end();
    return std::move(out_);
  }

 private:
  bool shadow() const { return ray_.kind == Kind::shadow; }

  TraversalStep& add(std::string words, std::string formula = {}, Variables variables = {}) {
    out_.push_back({.words = std::move(words),
                    .formula = std::move(formula),
                    .variables = std::move(variables),
                    .log_step = at_,
                    .t = reached_});
    return out_.back();
  }

  // Tests outside of cells and boxes.
  void begin() {
    const size_t first = log_.steps.empty() ? log_.tests.size() : log_.steps[0].first_test;
    if (grid_ && log_.enter && log_.steps.empty())
      add(
          tr("The ray starts too far away to tell cells apart: it is tested against all "
             "primitives"));
    else if (grid_ && first > 0)
      add(
          tr("Planes and very large primitives are in no cell: every ray is tested against them "
             "first"));
    else if (!grid_ && first > 0 && !log_.steps.empty())
      add(tr("Planes have no box: every ray is tested against them first"));
    if (log_.unlisted > 0)
      add(trf("The ray is tested against all primitives in turn; it misses {}", log_.unlisted));
    tests(0, first);
  }

  std::string name_of(PrimitiveId id) const {
    return fmt::format("{} {}", tr(kPrimitiveKindNames[size_t(geometry_.kind_of(id))].data()),
                       geometry_.index_of(id));
  }

  void tests(size_t first, size_t end) {
    for (size_t i = first; i < end; ++i) test(i);
  }
  void test(size_t i) {
    const TraceLog::Test& test = log_.tests[i];
    const std::string name = name_of(test.primitive);
    if (test.repeated) {
      add(trf("{}: already tested in an earlier cell (mailbox), skipped", name)).test = int(i);
      return;
    }
    const PrimitiveKind of = geometry_.kind_of(test.primitive);
    const app::TestNumbers numbers = app::test_numbers(geometry_, test.primitive, ray_.ray);
    Variables variables{{tr("nearest t so far"), value_text(nearest_)}};
    for (const auto& [variable, value] : numbers.values)
      variables.emplace_back(variable, fmt::format("{:.6g}", fmt::join(value, " ")));
    std::string words;
    if (std::isinf(test.t))
      words = *numbers.miss ? trf("Test {}: missed, since {}", name, numbers.miss)
                            : trf("Test {}: missed, since this side is not visible", name);
    else if (!test.nearest)
      words = trf("Test {}: hit at t = {}, but not the nearest", name, brief(test.t));
    else if (shadow())
      words = trf("Test {}: hit at t = {}, before the light", name, brief(test.t));
    else
      words = trf("Test {}: hit at t = {}, the nearest so far", name, brief(test.t));
    if (of == PrimitiveKind::triangle && !std::exchange(told_of_weights_, true))
      words +=
          tr(". The edge functions U, V and W, divided by their sum, are the barycentric "
             "weights b0, b1 and b2 of the corners, those of Möller and Trumbore's test");
    if (test.nearest) nearest_ = test.t;
    add(words, numbers.formula, std::move(variables)).test = int(i);
  }

  // ---- The grid.
  static int nearest_plane(const TraceLog::Step& s) {  // with the traversal's choice among ties
    const Vec3d& t = s.t_max;
    if (t.x < t.y) return t.x < t.z ? 0 : 2;
    return t.y < t.z ? 1 : 2;
  }
  Variables variables_of(const TraceLog::Step& s) const {
    Variables out;
    for (int a = 0; a < 3; ++a)
      out.emplace_back(fmt::format("tMax.{}", kAxes[a]), value_text(s.t_max[a]));
    for (int a = 0; a < 3; ++a) {
      const bool parallel = ray_.ray.dir[a] == 0;
      out.emplace_back(
          fmt::format("tDelta.{}", kAxes[a]),
          value_text(parallel ? std::numeric_limits<double>::infinity() : log_.t_delta[a]));
    }
    for (int a = 0; a < 3; ++a) {
      const float d = ray_.ray.dir[a];
      out.emplace_back(fmt::format("step.{}", kAxes[a]), d > 0 ? "+1" : d < 0 ? "-1" : "0");
    }
    return out;
  }
  void cell(size_t k) {
    const TraceLog::Step& s = log_.steps[k];
    if (k == 0) {
      reached_ = log_.enter.value_or(0);
      add(reached_ > 0
              ? trf("The ray enters the grid in cell {} at t = {}", cell_text(s), brief(reached_))
              : trf("The ray starts in cell {} of the grid", cell_text(s)),
          "tMax = (plane - O) / D\ntDelta = cell / |D|", variables_of(s));
      return;
    }
    const TraceLog::Step& before = log_.steps[k - 1];
    const int a = nearest_plane(before);
    reached_ = std::max(reached_, before.t_max[a]);
    const std::string axis(1, kAxes[a]);
    add(trf("tMax.{} is the smallest: go one cell along {}, to {} at t = {}; tMax.{} grows by "
            "tDelta.{}",
            axis, axis, cell_text(s), brief(reached_), axis, axis),
        fmt::format("{0} := {0} + step.{0}\ntMax.{0} := tMax.{0} + tDelta.{0}", axis),
        variables_of(s));
  }
  void end_of_grid() {
    if (log_.steps.empty() || (shadow() && stopper())) return end();
    const TraceLog::Step& s = log_.steps.back();
    const double leave = s.t_max[nearest_plane(s)];
    const std::string plane = brief(leave), tmax = brief(ray_.ray.tmax);
    Variables variables = variables_of(s);
    variables.insert(variables.begin(), {"t", value_text(nearest_)});
    std::string formula = "t <= min(tMax.x, tMax.y, tMax.z)", words;
    reached_ = std::max(reached_, std::min(leave, nearest_));
    if (ray_.hit.found()) {
      const std::string name = name_of(ray_.hit.primitive), t = brief(ray_.hit.t);
      if (ray_.hit.t <= leave) {
        words =
            trf("The hit of {} at t = {} lies in this cell (t <= min tMax), so the traversal ends",
                name, t);
      } else {
        words = trf("The ray leaves the grid; the nearest hit is {} at t = {}", name, t);
        formula.clear(), reached_ = std::max(reached_, nearest_);
      }
    } else if (nearest_ <= leave) {
      words = shadow()
                  ? trf("The light is in this cell, at t = {}: nothing is in front of it", tmax)
                  : trf("The ray ends in this cell, at t = {}, and hits nothing", tmax);
    } else {
      words =
          trf("tMax.{} is the smallest, and no cell is left there: the ray leaves the grid at "
              "t = {} and hits nothing",
              kAxes[nearest_plane(s)], plane);
      formula.clear();
    }
    add(words, formula, std::move(variables));
  }

  // ---- The tree.
  void box(const TraceLog::Step& s) {
    if (!s.leaf && s.depth == 0) {
      add(
          trf("The traversal starts at the root of the tree, node {}, and tests the boxes of its "
              "children",
              s.node));
      return;
    }
    double near = 0, far = ray_.ray.tmax;
    Variables slabs;
    for (int a = 0; a < 3; ++a) {
      const double o = ray_.ray.origin[a], d = ray_.ray.dir[a];
      if (d == 0) continue;  // parallel to the slab and within it, else the ray would miss the box
      const double t1 = (double(s.box.lo[a]) - o) / d, t2 = (double(s.box.hi[a]) - o) / d;
      near = std::max(near, std::min(t1, t2)), far = std::min(far, std::max(t1, t2));
      slabs.emplace_back(fmt::format("t1.{}", kAxes[a]), value_text(t1));
      slabs.emplace_back(fmt::format("t2.{}", kAxes[a]), value_text(t2));
    }
    far = std::max(near, far);  // boxes are hit up to a few roundings
    reached_ = near;
    slabs.insert(slabs.begin(), {{"near", value_text(near)}, {"far", value_text(far)}});
    add(near > nearest_ && (s.leaf || !goes_deeper()) ? words_behind(s, near)
        : s.leaf
            ? trf("Level {}: the ray hits the box of leaf {} between t = {} and t = {}: {}",
                  s.depth, s.node, brief(near), brief(far), count_of_tests())
            : trf("Level {}: the ray hits the box of node {} between t = {} and t = {}: enter it",
                  s.depth, s.node, brief(near), brief(far)),
        "t1 = (lo - O) / D, t2 = (hi - O) / D\nnear = max(0, min(t1, t2) of x, y, z)\n"
        "far = min(tmax, max(t1, t2) of x, y, z)\nnear <= far",
        std::move(slabs));
  }
  // The root's children were pushed before there was a hit.
  std::string words_behind(const TraceLog::Step& s, double near) const {
    const std::string from = brief(near);
    if (s.leaf)
      return trf(
          "Level {}: the box of leaf {} begins at t = {}, behind the hit, but was already on the "
          "stack: {}",
          s.depth, s.node, from, count_of_tests());
    return trf(
        "Level {}: the box of node {} begins at t = {}, behind the hit, but was already on the "
        "stack: none of its children is hit",
        s.depth, s.node, from);
  }
  bool goes_deeper() const {
    const size_t next = size_t(at_) + 1;
    return next < log_.steps.size() && log_.steps[next].depth > log_.steps[next - 1].depth;
  }
  std::string count_of_tests() const {
    const size_t next = size_t(at_) + 1;
    const size_t end = next < log_.steps.size() ? log_.steps[next].first_test : log_.tests.size();
    return number_of(end - log_.steps[size_t(at_)].first_test, "primitive", "primitives");
  }

  // ---- The end of a traversal, unless it went through the last cell.
  const TraceLog::Test* stopper() const {
    const auto found = std::ranges::find_if(log_.tests, &TraceLog::Test::nearest);
    return found == log_.tests.end() ? nullptr : &*found;
  }
  void end() {
    const TraceLog::Test* const by = stopper();
    if (by) reached_ = std::max(reached_, double(shadow() ? by->t : ray_.hit.t));
    if (shadow() && by)
      add(trf("Any hit ends the traversal of a shadow ray: {} is in front of the light",
              name_of(by->primitive)),
          "0 < t < tMax", {{"t", value_text(by->t)}, {"tMax", value_text(ray_.ray.tmax)}});
    else if (shadow())
      add(tr("Nothing is left to test: nothing is in front of the light"));
    else if (!by)
      add(tr("Nothing is left to test: the ray hits nothing"));
    else
      add(trf("Nothing left to test can be nearer: the hit is {} at t = {}",
              name_of(ray_.hit.primitive), brief(ray_.hit.t)),
          "", {{"t", value_text(ray_.hit.t)}});
  }

  const ExplainedRay& ray_;
  const TraceLog& log_;
  const Geometry& geometry_;
  bool grid_;
  double nearest_, reached_ = 0;
  int at_ = -1;                   // the step of the log
  bool told_of_weights_ = false;  // once for a ray
  std::vector<TraversalStep> out_;
};

}  // namespace

std::vector<TraversalStep> traversal_words(const ExplainedRay& ray, const TraceLog& log,
                                           const Geometry& geometry, AccelKind kind) {
  return TraversalNarrator(ray, log, geometry, kind).tell();
}

}  // namespace raio::core::view
