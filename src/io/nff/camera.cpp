// `v`, the camera.
#include <fmt/format.h>

#include <array>
#include <cmath>

#include "base/exact_math.h"
#include "io/fit_camera.h"
#include "io/nff/geometry.h"
#include "io/nff/parser.h"
#include "io/nff/writer.h"

namespace raio::core::nff {
namespace {

/// The parameters of `v`, as written.
struct CameraText {
  Vec3d from, at, up;
  double angle = 0, hither = 0, aperture = 0, focal = 0;
  int64_t width = 0, height = 0;
  std::set<CameraWord> seen;
  CameraWord last = CameraWord::none;
  bool usual_order = true;
  bool damaged = false;  // an error hid one of its parameters

  bool has(CameraWord word) const { return seen.contains(word); }
};

bool read_piece(Parser& p, CameraWord word, CameraText& v) {
  static constexpr std::string_view kFrom[] = {"x in \"from\"", "y in \"from\"", "z in \"from\""};
  static constexpr std::string_view kAt[] = {"x in \"at\"", "y in \"at\"", "z in \"at\""};
  static constexpr std::string_view kUp[] = {"x in \"up\"", "y in \"up\"", "z in \"up\""};
  const auto vector = [&](Vec3d& out, Parser::Names names) {
    double n[3];
    if (!p.numbers(n, names)) return false;
    out = {n[0], n[1], n[2]};
    return true;
  };
  const auto number = [&](double& out, std::string_view name) {
    return p.numbers({&out, 1}, {&name, 1});
  };
  const auto check = [&](bool sound, std::string_view fault) {
    if (!sound) p.reject(std::string(fault), p.last_word());
    return true;  // read completely, valid or not
  };
  switch (word) {
    case CameraWord::from:
      return vector(v.from, kFrom);
    case CameraWord::at:
      return vector(v.at, kAt);
    case CameraWord::up:
      return vector(v.up, kUp);
    case CameraWord::angle:
      return number(v.angle, "the angle") && check(float(v.angle) > 0 && float(v.angle) < 180,
                                                   "the angle must lie between 0 and 180 degrees");
    case CameraWord::hither:
      return number(v.hither, "hither") && check(v.hither >= 0, "hither must not be negative");
    case CameraWord::resolution: {
      constexpr int64_t kMost = 65536;
      const auto width = p.whole_number("the width", 1, kMost);
      const auto height = width ? p.whole_number("the height", 1, kMost) : std::nullopt;
      if (!height) return false;
      v.width = *width, v.height = *height;
      return true;
    }
    case CameraWord::aperture:
      return number(v.aperture, "the aperture") &&
             check(v.aperture >= 0, "the aperture must not be negative");
    case CameraWord::focal:
      return number(v.focal, "the focal ratio") &&
             check(v.focal > 0, "the focal ratio must be positive");
    case CameraWord::none:
      break;
  }
  return false;
}

void choose_origin(Parser& p, const CameraText& v) {
  constexpr double kFar =
      1000;  // beyond it a float resolves no more than a few hundredths of a pixel
  const double distance = length(v.at - v.from);
  const bool first = !p.seen.object && p.scene().lights.empty();
  if (!first || !(distance > 0) || !(max_component(abs(v.at)) > kFar * distance)) return;
  // A multiple of a power of two near the distance: it has few digits, and subtracting it is exact.
  const double unit = std::ldexp(1, int(std::round(exact_log2(distance))));
  for (int a = 0; a < 3; ++a) p.scene().origin[a] = std::round(v.at[a] / unit) * unit;
}

void set_lens(Parser& p, const CameraText& v) {
  Camera& out = p.scene().camera;
  if (v.has(CameraWord::aperture)) out.lens_radius = float(v.aperture * pixel_size(out));
  if (v.has(CameraWord::focal)) out.focus_distance = float(v.focal * view_distance(out));
  if (!std::isfinite(out.lens_radius.value_or(0)))
    p.reject("the aperture gives a lens beyond the range of a float");
  if (!std::isfinite(out.focus_distance.value_or(1)) || out.focus_distance == 0.0f)
    p.reject("the focal ratio gives a distance beyond the range of a float");
}

void set_camera(Parser& p, const CameraText& v) {
  if (v.damaged) return;
  std::string missing;
  for (const auto& [word, name] : {std::pair{CameraWord::from, "from"},
                                   {CameraWord::at, "at"},
                                   {CameraWord::up, "up"},
                                   {CameraWord::angle, "angle"}})
    if (!v.has(word)) missing += fmt::format("{}\"{}\"", missing.empty() ? "" : ", ", name);
  if (!missing.empty()) return p.reject(fmt::format("v has no {}", missing));
  if (!v.usual_order)
    p.warn(
        "the parameters of v are out of order, expected from, at, up, angle, hither, resolution");
  if (p.seen.object) p.warn("v follows objects, but NFF requires it first");
  choose_origin(p, v);
  Camera& out = p.scene().camera;
  out.from = p.place(v.from);
  out.at = p.place(v.at);
  out.up = Vec3f(v.up);
  out.fov_deg = float(v.angle);
  p.scene().requests.near_clip = float(v.hither);
  out.width = int(v.width), out.height = int(v.height);
  const Vec3d view = Vec3d(out.at) - Vec3d(out.from), up(out.up);
  if (!is_finite(out.from) || !is_finite(out.at))
    p.reject("from and at are too far apart for a float");
  else if (length(view) == 0)
    p.reject("from and at are the same point");
  else if (length(up) == 0)
    p.reject("up is zero");
  else if (!(length(cross(view, up)) > 1e-6 * length(view) * length(up)))
    p.reject("up is parallel to the line of sight");
  else
    set_lens(p, v);
}

void read_camera(Parser& p) {
  if (p.seen.camera)
    p.reject(fmt::format("a second camera, the first is at line {}; a scene has one",
                         p.line_of(p.seen.camera)));
  else
    p.seen.camera = p.begin();
  CameraText v;
  for (;;) {
    const char* const here = p.next();
    if (*here == '\0') break;
    const std::string_view word = word_at(here);
    const CameraWord piece = find_camera_word(word);
    if (piece != CameraWord::none) {
      if (v.has(piece)) p.reject(fmt::format("{} is given twice", quoted(word)), here);
      p.pass(word);
      v.usual_order &= piece > v.last || piece >= CameraWord::aperture;
      v.last = piece;
      v.seen.insert(piece);
      v.damaged |= !read_piece(p, piece, v);
    } else if (const RefusedWord* refused = find_refused(word)) {
      p.refuse(*refused, true);
    } else if (const std::string_view nearest = nearest_word(word, true);
               !find_entity(word) && !nearest.empty()) {
      p.reject(fmt::format("unknown word {} in v; did you mean \"{}\"?", quoted(word), nearest),
               here);
      v.damaged = true;
      p.pass(word);
      p.skip_to_entity(true);
    } else {
      break;  // the next entity, or a word that the next entity's reader reports
    }
  }
  set_camera(p, v);
}

constexpr std::array kCameraRows = {
    Entity{.word = kCameraKeyword,
           .noun = "the camera",
           .usage = "v takes from, at, up, angle, hither and resolution",
           .read = read_camera,
           .leaves = Entity::Leaves::more},
};

}  // namespace

constinit const Family kCameras = kCameraRows;

void write_camera(Writer& w) {
  const Camera& c = w.scene().camera;
  w.text().word("v").end_line();
  w.position("from", c.from).end_line();
  w.position("at", c.at).end_line();
  w.text().word("up").vector(c.up).end_line();
  w.text().word("angle").number(fitted_fov_deg(c)).end_line();
  w.text().word("hither").number(w.scene().requests.near_clip).end_line();
  if (c.width > 0 && c.height > 0)
    w.text().word("resolution").number(c.width).number(c.height).end_line();
  // In double, so that the reader's product rounds to the same float.
  if (c.lens_radius) {
    const double measured = w.scene().dialect == Dialect::p3f ? 2 : 1;  // across, or the radius
    w.text().word("aperture").number(measured * double(*c.lens_radius) / pixel_size(c)).end_line();
  }
  if (c.focus_distance)
    w.text().word("focal").number(double(*c.focus_distance) / view_distance(c)).end_line();
}

}  // namespace raio::core::nff
