#include <fmt/format.h>

#include <cmath>

#include "io/nff/geometry.h"
#include "io/nff/parser.h"

namespace raio::nff {

/// What `v` says, as written.
struct Parser::CameraText {
  Vec3d from, at, up;
  double angle = 0, hither = 0, aperture = 0, focal = 0;
  long width = 0, height = 0;
  std::set<CameraWord> seen;
  CameraWord last = CameraWord::none;
  bool usual_order = true;
  bool damaged = false;  // a piece was lost to an error

  bool has(CameraWord word) const { return seen.contains(word); }
};

void Parser::camera() {
  if (camera_begin_)
    reject(fmt::format("a second camera, the first is at line {}; a scene has one",
                       report_.line_of(offset(camera_begin_))));
  else
    camera_begin_ = begin_;
  CameraText v;
  for (;;) {
    p_ = skip_blanks(p_);
    if (*p_ == '\0') break;
    const std::string_view word = word_at(p_);
    const CameraWord piece = find_camera_word(word);
    if (piece != CameraWord::none) {
      if (v.has(piece)) report_.error(offset(p_), fmt::format("{} is given twice", quoted(word)));
      p_ += word.size();
      v.usual_order &= piece > v.last || piece >= CameraWord::aperture;
      v.last = piece;
      v.seen.insert(piece);
      v.damaged |= !camera_piece(piece, v);
    } else if (const RefusedWord* refused = find_refused(word)) {
      refuse(*refused, true);
    } else if (const std::string_view nearest = nearest_word(word, true);
               find_keyword(word) == Keyword::none && !nearest.empty()) {
      report_.error(offset(p_), fmt::format("unknown word {} in v; did you mean \"{}\"?",
                                            quoted(word), nearest));
      v.damaged = true;
      p_ += word.size();
      skip_to_entity(true);
    } else {
      break;  // the next entity, or something that the next entity's reader will name
    }
  }
  camera_done(v);
}

bool Parser::camera_piece(CameraWord word, CameraText& v) {
  static constexpr std::string_view kFrom[] = {"x of from", "y of from", "z of from"};
  static constexpr std::string_view kAt[] = {"x of at", "y of at", "z of at"};
  static constexpr std::string_view kUp[] = {"x of up", "y of up", "z of up"};
  const auto vector = [&](Vec3d& out, Names names) {
    double n[3];
    if (!numbers(n, names)) return false;
    out = {n[0], n[1], n[2]};
    return true;
  };
  const auto number = [&](double& out, std::string_view name) {
    return numbers({&out, 1}, {&name, 1});
  };
  const auto check = [&](bool sound, std::string_view fault) {
    if (!sound) report_.error(offset(last_word()), std::string(fault));
    return true;  // read in full, sound or not
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
      constexpr long kMost = 65536;
      const auto width = whole_number("the width", 1, kMost);
      const auto height = width ? whole_number("the height", 1, kMost) : std::nullopt;
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

void Parser::camera_done(CameraText& v) {
  if (v.damaged) return;
  std::string missing;
  for (const auto& [word, name] : {std::pair{CameraWord::from, "from"},
                                   {CameraWord::at, "at"},
                                   {CameraWord::up, "up"},
                                   {CameraWord::angle, "angle"}})
    if (!v.has(word)) missing += fmt::format("{}\"{}\"", missing.empty() ? "" : ", ", name);
  if (!missing.empty()) return reject(fmt::format("v lacks {}", missing));
  if (!v.usual_order)
    warn("the pieces of v are not in the usual order: from, at, up, angle, hither, resolution");
  if (object_seen_) warn("v after objects; NFF wants it first");
  choose_origin(v);
  Camera& out = scene_.camera;
  out.from = place(v.from);
  out.at = place(v.at);
  out.up = Vec3f(v.up);
  out.fov_deg = float(v.angle);
  out.hither = float(v.hither);
  out.width = int(v.width), out.height = int(v.height);
  const Vec3d view = Vec3d(out.at) - Vec3d(out.from), up(out.up);
  if (!is_finite(out.from) || !is_finite(out.at))
    reject("from and at are too far apart for a float");
  else if (length(view) == 0)
    reject("from and at are the same point");
  else if (length(up) == 0)
    reject("up is zero");
  else if (!(length(cross(view, up)) > 1e-6 * length(view) * length(up)))
    reject("up is parallel to the line of sight");
  else
    camera_lens(v, out);
}

void Parser::camera_lens(const CameraText& v, Camera& out) {
  if (v.has(CameraWord::aperture)) out.lens_radius = float(v.aperture * pixel_size(out));
  if (v.has(CameraWord::focal)) out.focus_distance = float(v.focal * view_distance(out));
  if (!std::isfinite(out.lens_radius.value_or(0)))
    reject("the aperture gives a lens beyond the range of a float");
  if (!std::isfinite(out.focus_distance.value_or(1)) || out.focus_distance == 0.0f)
    reject("the focal ratio gives a distance beyond the range of a float");
}

void Parser::choose_origin(const CameraText& v) {
  constexpr double kFar = 1000;  // here a float still resolves a few hundredths of a pixel
  const double distance = length(v.at - v.from);
  const bool first = !object_seen_ && scene_.lights.empty();
  if (!first || !(distance > 0) || !(max_component(abs(v.at)) > kFar * distance)) return;
  // A multiple of a power of two near the distance: few digits, and no rounding in differences.
  const double unit = std::exp2(std::round(std::log2(distance)));
  for (int a = 0; a < 3; ++a) scene_.origin[a] = std::round(v.at[a] / unit) * unit;
}

}  // namespace raio::nff
