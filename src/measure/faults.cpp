#include "measure/faults.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/exact_math.h"
#include "base/srgb.h"
#include "integrate/classic.h"
#include "integrate/lights.h"

namespace raio::core {
namespace {

// Finished pictures.

template <class Place>
Image rearranged(const Image& image, const Place& place) {
  return picked(image, image.width, image.height, place);
}

Image upside_down(const Image& image) {
  return rearranged(image, [&](int x, int y) { return std::pair(x, image.height - 1 - y); });
}
Image mirrored(const Image& image) {
  return rearranged(image, [&](int x, int y) { return std::pair(image.width - 1 - x, y); });
}
Image turned(const Image& image) { return mirrored(upside_down(image)); }
Image transposed(const Image& image) {
  return rearranged(image, [](int x, int y) { return std::pair(y, x); });
}

// Applies `curve` to each displayed value.
template <class Curve>
Image through(Image image, const Curve& curve) {
  for (Rgb& pixel : image.pixels)
    for (int c = 0; c < 3; ++c) pixel[c] = curve(pixel[c] > 0 ? pixel[c] : 0);
  return image;
}

Image red_for_blue(const Image& image) {
  Image out = image;
  for (Rgb& pixel : out.pixels) std::swap(pixel.x, pixel.z);
  return out;
}
Image encoded_srgb(const Image& image) { return through(image, srgb_from_linear); }
Image decoded_srgb(const Image& image) {
  return through(image, [](float x) { return linear_from_srgb(x); });
}
Image encoded_power(const Image& image) {
  return through(image, [](float x) { return float(exact_pow(double(x), 1 / 2.2)); });
}
Image decoded_power(const Image& image) {
  return through(image, [](float x) { return float(exact_pow(double(x), 2.2)); });
}
Image wrapped(const Image& image) {
  return through(image, [](float x) {
    const double level = std::min(double(x) * 255 + 0.5, 1e15);
    return float(int64_t(level) % 256) / 255;
  });
}

template <Image (*transform)(const Image&)>
bool transform_with(Imitation& what) {
  what.transforms.push_back(transform);
  return true;
}

bool transpose(Imitation& what) {
  return what.settings.width == what.settings.height && transform_with<transposed>(what);
}

// Light.

template <ShadowRays shadows>
bool cast(Imitation& what) {
  // Shadows of transparent primitives are not rays.
  if (what.scene.lights.empty() || any_transparent(what.scene)) return false;
  if (what.shadows != ShadowRays::right) return false;
  what.shadows = shadows;
  return true;
}

// Whether `change` changed any material.
template <class Change>
bool change_materials(Imitation& what, const Change& change) {
  const Array<Material> before = what.scene.materials;
  for (Material& m : what.scene.materials) change(m);
  return what.scene.materials != before;
}

bool without_ambient(Imitation& what) {
  if (ambient_factor(what.scene, what.settings) == 0) return false;
  const Rgb intensity = uncolored_intensity(what.scene);
  for (Light& light : what.scene.lights) light.color = intensity;  // as in the text of NFF
  return !what.scene.lights.empty();
}

bool without_highlight(Imitation& what) {
  constexpr float kSharp = 1e9f;
  return change_materials(what, [](Material& m) {
    if (m.ks > 0) m.shine = kSharp;
  });
}

bool without_diffuse(Imitation& what) {
  return change_materials(what, [](Material& m) { m.kd = 0; });
}

bool divided_by_pi(Imitation& what) {
  return change_materials(what, [](Material& m) { m.kd /= std::numbers::pi_v<float>; });
}

bool has_shared_light(const Imitation& what) {
  return what.light_scale == 1 && what.scene.lights.size() > 1 &&
         std::ranges::none_of(what.scene.lights,
                              [](const Light& l) { return l.color.has_value(); });
}
bool full_intensity(Imitation& what) {
  if (!has_shared_light(what)) return false;
  what.light_scale = std::sqrt(float(what.scene.lights.size()));
  return true;
}
bool divided_intensity(Imitation& what) {
  if (!has_shared_light(what)) return false;
  what.light_scale = 1 / std::sqrt(float(what.scene.lights.size()));
  return true;
}

template <int power>
bool fall_off(Imitation& what) {
  if (what.falloff != 0 || what.scene.lights.empty()) return false;
  what.falloff = power;
  return true;
}

// Keeps one light, with its intensity among all.
bool only_light(Imitation& what, size_t index) {
  if (what.scene.lights.size() < 2) return false;
  const bool shared = has_shared_light(what);
  if (shared) divided_intensity(what);
  const Rgb usual = uncolored_intensity(what.scene);
  Light light = what.scene.lights[index];
  if (!shared) light.color = light.color.value_or(usual);
  what.scene.lights = {light};
  return true;
}
bool first_light(Imitation& what) { return only_light(what, 0); }
bool last_light(Imitation& what) { return only_light(what, what.scene.lights.size() - 1); }

// Mirrors and glass.

template <bool PlainOptions::* off>
bool switch_off(Imitation& what, bool has_effect) {
  if (what.settings.*off || !has_effect) return false;
  what.settings.*off = true;
  return true;
}

bool has_glass(const Imitation& what) {
  return std::ranges::any_of(what.scene.materials,
                             [](const Material& m) { return m.transmission > 0; });
}
bool has_rays(const Imitation& what) {
  return has_glass(what) ||
         std::ranges::any_of(what.scene.materials, [](const Material& m) { return m.ks > 0; });
}
bool without_reflection(Imitation& what) {
  return switch_off<&PlainOptions::no_reflection>(what, has_rays(what));
}
bool without_refraction(Imitation& what) {
  return switch_off<&PlainOptions::no_refraction>(what, has_glass(what));
}

template <int by>
bool change_depth(Imitation& what) {
  const int depth = what.settings.depth + by;
  if (depth < 1 || depth > kMaxDepth || !has_rays(what)) return false;
  what.settings.depth = depth;
  return true;
}

bool eye_rays_only(Imitation& what) {
  if (what.settings.depth == 1 || !has_rays(what)) return false;
  what.settings.depth = 1;
  return true;
}

bool inverse_index(Imitation& what) {
  return change_materials(what, [](Material& m) {
    if (m.transmission > 0) m.ior = 1 / m.ior;
  });
}
bool without_index(Imitation& what) {
  return change_materials(what, [](Material& m) { m.ior = 1; });
}

bool black_rays(Imitation& what) {
  if (what.settings.sky || what.settings.background == Rgb() || !has_rays(what)) return false;
  what.black_rays = true;
  return true;
}

bool without_background(Imitation& what) {
  if (!what.settings.sky && what.settings.background == Rgb()) return false;
  what.settings.background = Rgb(), what.settings.sky.reset();
  return true;
}

// The camera.

template <int dx, int dy>
bool look_through(Imitation& what) {
  if (what.settings.camera.is_omnidirectional() || what.within_pixel != std::array{1, 1})
    return false;
  what.within_pixel = {dx, dy};
  return true;
}

bool angle_to_centers(Imitation& what) {
  if (what.settings.camera.is_omnidirectional()) return false;
  what.settings.angle_to_centers = !what.settings.angle_to_centers;
  return true;
}

// Sets half the picture's height at distance 1, if that is possible.
bool set_half_height(Imitation& what, double half) {
  if (what.settings.camera.is_omnidirectional() || !(half > 0) || !(half < 100)) return false;
  what.settings.camera.fov_deg = float(exact_atan(half) * 360 / std::numbers::pi);
  return true;
}
double half_angle(const Imitation& what) {
  return double(what.settings.camera.fov_deg) * std::numbers::pi / 360;
}
bool whole_angle(Imitation& what) { return set_half_height(what, exact_tan(2 * half_angle(what))); }
bool quarter_angle(Imitation& what) {
  return set_half_height(what, exact_tan(half_angle(what) / 2));
}
bool angle_across(Imitation& what) {
  const auto& s = what.settings;
  return s.width != s.height &&
         set_half_height(what, exact_tan(half_angle(what)) * s.height / s.width);
}
bool ignore_shape(Imitation& what) {
  if (what.ignores_shape || what.settings.width == what.settings.height ||
      what.settings.camera.is_omnidirectional() || what.within_pixel != std::array{1, 1})
    return false;
  return what.ignores_shape = true;
}

template <int axis>
bool fixed_up(Imitation& what) {
  Vec3f up;
  up[axis] = 1;
  Camera& camera = what.settings.camera;
  if (camera.up == up) return false;
  camera.up = up;
  return camera_problem(camera).empty();
}

// Shapes and materials.

bool flat_normals(Imitation& what) {
  bool any = !what.scene.triangle_normals.empty();
  what.scene.triangle_normals.clear();
  for (Mesh& mesh : what.scene.meshes) {
    any |= !mesh.normals.empty();
    mesh.normals.clear(), mesh.normal_indices.clear();
  }
  return any;
}

template <class Shape>
bool without_shapes(Imitation& what) {
  constexpr auto& pool = kPoolOf<Shape>;
  Scene& scene = what.scene;
  if ((scene.*pool.shapes).empty()) return false;
  (scene.*pool.shapes).clear(), (scene.*pool.materials).clear();
  (scene.*pool.colors).clear(), (scene.*pool.opacity).clear();
  if constexpr (std::is_same_v<Shape, TriangleIndices>) scene.triangle_normals.clear();
  scene.object_ranges.clear();
  return true;
}

bool first_material(Imitation& what) {
  const Material first = what.scene.materials.front();
  return change_materials(what, [&](Material& m) { m = first; });
}
bool last_material(Imitation& what) {
  const Material last = what.scene.materials.back();
  return change_materials(what, [&](Material& m) { m = last; });
}

// As with normals that are not divided by the radius, as far as diffuse light goes.
bool long_normals(Imitation& what) {
  Scene& scene = what.scene;
  if (scene.spheres.empty() || !scene.material_specular.empty() ||
      !scene.material_roughness.empty() || !scene.material_opacity.empty() ||
      !scene.material_texture.empty())
    return false;
  bool any = false;
  for (size_t i = 0; i < scene.spheres.size(); ++i) {
    const float radius = scene.spheres[i].radius;
    Material material = scene.materials[std::as_const(scene).sphere_materials[i]];
    if (radius == 1 || material.kd == 0) continue;
    material.kd *= radius;
    scene.sphere_materials[i] = scene.add_material(material);
    any = true;
  }
  return any;
}

constexpr KnownFault kFaults[] = {
    {"upside-down", "the picture upside down",
     "The first row of the file is the uppermost one, where y is largest.", true,
     transform_with<upside_down>},
    {"mirrored", "left and right exchanged", "The camera's right is view x up, not up x view.",
     true, transform_with<mirrored>},
    {"turned", "the picture turned by 180 degrees",
     "Rows go from top to bottom, and the camera's right is view x up.", true,
     transform_with<turned>},
    {"transposed", "rows and columns exchanged",
     "The file has one row after another, so the loop over rows is the outer one.", true,
     transpose},
    {"red-blue", "red and blue exchanged", "PNG and PPM have red, green and blue in this order.",
     true, transform_with<red_for_blue>},
    {"gamma", "the sRGB curve applied",
     "Raio writes the values of this scene as they are, without a curve; leave it out.", true,
     transform_with<encoded_srgb>},
    {"gamma-2.2", "a gamma of 2.2 applied",
     "Raio writes the values of this scene as they are, without a curve; leave it out.", true,
     transform_with<encoded_power>},
    {"inverse-gamma", "the sRGB curve inverted",
     "The values are those of the display; do not convert them.", true,
     transform_with<decoded_srgb>},
    {"inverse-gamma-2.2", "a gamma of 2.2 inverted",
     "The values are those of the display; do not convert them.", true,
     transform_with<decoded_power>},
    {"overflow", "values above 1 that wrap around",
     "Clamp each colour to 1 before it becomes a byte.", true, transform_with<wrapped>},

    {"no-shadows", "no shadows",
     "A light adds nothing where an object stands between it and the point.", false,
     cast<ShadowRays::none>},
    {"beyond-light", "shadows of objects beyond the light",
     "An object hides a light only if it is nearer than the light.", false,
     cast<ShadowRays::beyond>},
    {"no-light", "no light from the lights",
     "Each light adds to the colour if N.L is positive and its shadow ray hits nothing; a shadow "
     "ray that hits its own surface must not count.",
     false, cast<ShadowRays::always>},
    {"acne", "shadow rays that hit their own surface in some pixels",
     "Start rays a little off the surface, on the side they go to.", false,
     cast<ShadowRays::speckled>},
    {"no-ambient", "no ambient light",
     "The colour of a material is multiplied by the ambient factor, 0.1, and added once per hit.",
     false, without_ambient},
    {"no-diffuse", "no diffuse light", "Each light adds Kd times the colour times N.L.", false,
     without_diffuse},
    {"no-highlight", "no highlights", "Each light adds Ks times max(0, R.V) to the power Shine.",
     false, without_highlight},
    {"diffuse-by-pi", "diffuse light divided by pi",
     "NFF's lights have no unit: leave out the division.", false, divided_by_pi},
    {"full-intensity", "intensity 1 for each light",
     "The intensity of each of n lights without a colour is 1 / sqrt(n).", false, full_intensity},
    {"divided-intensity", "intensity 1 / n for each light",
     "The intensity of each of n lights without a colour is 1 / sqrt(n), not 1 / n.", false,
     divided_intensity},
    {"first-light", "the first light only", "Sum over all lights; the loop may end too early.",
     false, first_light},
    {"last-light", "the last light only",
     "Sum over all lights; each may replace what those before it added.", false, last_light},
    {"falloff-2", "lights that decrease with the square of the distance",
     "NFF's lights do not decrease with the distance.", false, fall_off<2>},
    {"falloff-1", "lights that decrease with the distance",
     "NFF's lights do not decrease with the distance.", false, fall_off<1>},

    {"no-reflection", "no mirrored rays",
     "Where Ks is above 0, trace a mirrored ray and add Ks "
     "times its colour.",
     false, without_reflection},
    {"no-refraction", "no refracted rays",
     "Where T is above 0, trace a refracted ray and add T times its colour.", false,
     without_refraction},
    {"inverse-index", "the index of refraction upside down",
     "The ratio is the index on the ray's side, divided by that behind the surface: 1 / ior when "
     "the ray enters.",
     false, inverse_index},
    {"no-index", "rays that go straight through glass",
     "Bend refracted rays by Snell's law, with the index of the material.", false, without_index},
    {"depth-less", "one level of rays less",
     "The eye ray has level 1, and the last level is "
     "traced, too.",
     false, change_depth<-1>},
    {"depth-more", "one level of rays more",
     "The eye ray has level 1, not 0; compare the last level with <=.", false, change_depth<1>},
    {"depth-2-less", "two levels of rays less", "Compare the maximum depth with Raio's `depth`.",
     false, change_depth<-2>},
    {"depth-1", "a depth of 1",
     "Mirrored and refracted rays have a level of their own; they get the background only beyond "
     "the last level.",
     false, eye_rays_only},
    {"no-background", "a black background", "Rays that hit nothing get the background, `b`.", false,
     without_background},
    {"black-rays", "black for mirrored and refracted rays that hit nothing",
     "They get the background, like eye rays.", false, black_rays},

    {"corner-upper-left", "eye rays through the upper left corner of each pixel",
     "The middle of pixel (x, y) is at (x + 0.5, y + 0.5).", false, look_through<0, 0>},
    {"corner-lower-left", "eye rays through the lower left corner of each pixel",
     "The middle of pixel (x, y) is at (x + 0.5, y + 0.5).", false, look_through<0, 2>},
    {"corner-upper-right", "eye rays through the upper right corner of each pixel",
     "The middle of pixel (x, y) is at (x + 0.5, y + 0.5).", false, look_through<2, 0>},
    {"corner-lower-right", "eye rays through the lower right corner of each pixel",
     "The middle of pixel (x, y) is at (x + 0.5, y + 0.5).", false, look_through<2, 2>},
    {"angle-to-centers", "the angle from the middle of the first row to that of the last",
     "The angle is that between the picture's edges: divide by the number of rows, not by one "
     "less.",
     false, angle_to_centers},
    {"whole-angle", "the tangent of the whole angle",
     "Half of the picture's height at distance 1 is the tangent of half the angle.", false,
     whole_angle},
    {"quarter-angle", "a field of view half as wide",
     "Half of the picture's height at distance 1 is the tangent of half the angle; divide it by 2 "
     "once.",
     false, quarter_angle},
    {"angle-across", "the angle from left to right",
     "The angle is vertical, from the bottom of the picture to its top.", false, angle_across},
    {"no-aspect", "the same angle from left to right as from bottom to top",
     "Pixels are square: the picture is wider than high by width / height.", false, ignore_shape},
    {"up-y", "y as the camera's up direction", "The up direction is that of the file, `up`.", false,
     fixed_up<1>},
    {"up-z", "z as the camera's up direction", "The up direction is that of the file, `up`.", false,
     fixed_up<2>},

    {"flat-normals", "flat triangles",
     "The normal of a smooth triangle (`pp`) is mixed from those of its corners.", false,
     flat_normals},
    {"long-normals", "normals of spheres that are not of length 1",
     "Divide the vector from the centre to the point by the radius.", false, long_normals},
    {"no-spheres", "no spheres", "Is `s` read, and the nearer of the two hits in front taken?",
     false, without_shapes<Sphere>},
    {"no-triangles", "no triangles", "Are `p 3` and `pp 3` read, and the hit test right?", false,
     without_shapes<TriangleIndices>},
    {"no-polygons", "no polygons of four or more corners",
     "Is `p` read with any number of corners?", false, without_shapes<Polygon>},
    {"no-cones", "no cones and cylinders", "Is `c` read?", false, without_shapes<Cone>},
    {"first-material", "the first material everywhere",
     "Each object has the material of the last `f` before it.", false, first_material},
    {"last-material", "the last material everywhere",
     "Each object has the material of the last `f` before it; copy it, rather than point to one "
     "that changes.",
     false, last_material},
};

struct Trial {
  const KnownFault* fault;
  Imitation imitation;
  double rmse;
};

}  // namespace

std::span<const KnownFault> known_faults() { return kFaults; }

std::vector<Cause> causes_of_difference(const Imitation& right, const Image& reference,
                                        const Image& picture, bool only_of_file) {
  std::vector<Cause> causes;
  Imitation current = right;
  Image image = reference;
  double rmse = compare(image, picture).rmse;
  while (causes.size() < kMaxCauses && rmse > 0) {
    std::optional<Trial> best;
    std::vector<std::pair<const KnownFault*, double>> tried;
    for (const KnownFault& fault : kFaults) {
      if (only_of_file && !fault.of_file) continue;
      Trial trial{&fault, current, 0};
      if (!fault.add(trial.imitation)) continue;
      const auto made = fault.of_file ? trial.imitation.transforms.back()(image)
                                      : imitate(trial.imitation, picture);
      if (!made) continue;
      trial.rmse = compare(*made, picture).rmse;
      tried.emplace_back(&fault, trial.rmse);
      if (!best || trial.rmse < best->rmse) best = std::move(trial);
    }
    if (!best) break;
    Cause cause{.fault = best->fault, .rmse_before = rmse, .rmse = best->rmse, .equals = {}};
    if (cause.share() < kLeastShare) break;
    // The bytes of equal faults may differ by roundings.
    constexpr double kEqual = 1.1, kRoundings = 0.1;
    for (const auto& [fault, left] : tried)
      if (fault != cause.fault && left <= kEqual * cause.rmse + kRoundings)
        cause.equals.push_back(fault);
    causes.push_back(std::move(cause));
    current = std::move(best->imitation);
    auto next = only_of_file ? current.transforms.back()(image) : imitate(current, picture);
    if (!next) break;
    image = std::move(*next), rmse = causes.back().rmse;
    constexpr double kNoise = 1;
    if (rmse <= kNoise) break;
  }
  return causes;
}

}  // namespace raio::core
