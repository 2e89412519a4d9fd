// Checks whether a scene can be rendered. Scenes may have millions of elements, straight from a
// file, so all threads check them; only faults are formatted.

#include <algorithm>
#include <charconv>
#include <string_view>

#include "base/parallel.h"
#include "base/ray.h"
#include "scene/columns.h"

namespace raio::core {
namespace {

/// Sentences about faults, limited to a readable number.
class Problems {
 public:
  template <class... Parts>
  void check(bool sound, const Parts&... parts) {
    if (sound) return;
    if (++count_ > kMost) return;
    std::string sentence;
    (write(sentence, parts), ...);
    sentences_.push_back(std::move(sentence));
  }

  void append(Problems&& more) {
    for (std::string& sentence : more.sentences_)
      if (sentences_.size() < kMost) sentences_.push_back(std::move(sentence));
    count_ += more.count_;
  }

  std::vector<std::string> take() {
    if (count_ > kMost) sentences_.push_back(std::to_string(count_ - kMost) + " more problems");
    return std::move(sentences_);
  }

 private:
  static constexpr size_t kMost = 20;

  static void write(std::string& out, std::string_view part) { out += part; }
  static void write(std::string& out, size_t number) { out += std::to_string(number); }

  std::vector<std::string> sentences_;
  size_t count_ = 0;
};

bool at_least_zero(float x) { return std::isfinite(x) && x >= 0; }

bool is_intensity(Rgb c) { return at_least_zero(c.x) && at_least_zero(c.y) && at_least_zero(c.z); }

void check_camera(const Camera& camera, Problems& problems) {
  bool finite = is_finite(camera.from) && is_finite(camera.at) && is_finite(camera.up);
  problems.check(finite, "camera: from, at and up must be finite");
  if (const auto& m = camera.movement) {
    finite &= is_finite(m->from) && is_finite(m->at);
    check_times(m->begin, m->end,
                [&](bool holds, const char* must) { problems.check(holds, "camera: ", must); });
  }
  const std::string why = finite ? camera_problem(camera) : "";
  problems.check(why.empty(), "camera: ", why);
  problems.check(camera.fov_deg > 0 && camera.fov_deg < 180,
                 "camera: the angle must lie between 0 and 180 degrees");
  problems.check(camera.horizontal_fov_deg >= 0 && camera.horizontal_fov_deg < 180,
                 "camera: the horizontal angle must lie between 0 and 180 degrees");
  problems.check(camera.projection <= Projection::omnidirectional,
                 "camera: the projection must be perspective, orthographic or omnidirectional");
  problems.check(camera.width >= 0 && camera.height >= 0 && !camera.width == !camera.height,
                 "camera: the resolution must be two positive numbers, or two zeros for none");
  problems.check(!camera.lens_radius || at_least_zero(*camera.lens_radius),
                 "camera: the lens radius must not be negative");
  problems.check(!camera.focus_distance ||
                     (at_least_zero(*camera.focus_distance) && *camera.focus_distance > 0),
                 "camera: the focus distance must be positive");
}

void check_physical_light(const PhysicalLight& l, size_t i, Problems& problems) {
  const auto check = [&](bool sound, std::string_view expected) {
    problems.check(sound, "physical light ", i, ": ", expected);
  };
  check(l.kind <= LightKind::ring, "the kind must be 0 to 4");
  check(is_intensity(l.color), "the colour must be finite and not negative");
  check(is_finite(l.position), "the position must be finite");
  check(is_finite(l.direction) && length(l.direction) > 0,
        "the direction must be finite and not zero");
  check(l.angular_diameter >= 0 && l.angular_diameter <= 170,
        "the angular diameter must be 0 to 170 degrees");
  check(l.opening >= 0 && l.opening <= 360, "the opening must be 0 to 360 degrees");
  check(l.falloff >= 0 && l.falloff <= l.opening / 2,
        "the falloff must be 0 to half of the opening");
  check(is_finite(l.edge1) && is_finite(l.edge2) && length(cross(l.edge1, l.edge2)) > 0,
        "the edges must be finite and span an area");
  check(l.front <= 1 && l.back <= 1 && l.front + l.back > 0, "a side of the quad must emit");
  check(l.inner_radius >= 0 && std::isfinite(l.radius) &&
            (l.inner_radius < l.radius || (l.inner_radius == 0 && l.radius == 0)),
        "the inner radius must be at least 0 and below the radius, or both must be 0");
}

void check_standard_surface(const Scene& scene, size_t i, Problems& problems) {
  const StandardSurface& s = scene.standard_surfaces[i];
  const std::string fault =
      fault_of(s, s.is_standard ? scene.materials[i].ior : 1, scene.textures.size());
  problems.check(fault.empty(), "material ", i, ": ", fault);
}

void check_lights_and_materials(const Scene& scene, Problems& problems) {
  problems.check(is_intensity(scene.background),
                 "background: the colour must be finite and not negative");
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Light& light = scene.lights[i];
    problems.check(is_finite(light.position), "light ", i, ": the position must be finite");
    problems.check(!light.color || is_intensity(*light.color), "light ", i,
                   ": the colour must be finite and not negative");
    problems.check(
        !light.extent || (at_least_zero(light.extent->width) && at_least_zero(light.extent->depth)),
        "light ", i, ": the sides must be finite and not negative");
    problems.check(!light.extent || light.extent->points >= 1, "light ", i,
                   ": the number of points must be at least 1");
  }
  for (size_t i = 0; i < scene.physical_lights.size(); ++i)
    check_physical_light(scene.physical_lights[i], i, problems);
  problems.check(!scene.materials.empty(), "there is no material");
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    problems.check(is_intensity(m.color), "material ", i,
                   ": the colour must be finite and not negative");
    problems.check(at_least_zero(m.kd) && at_least_zero(m.ks) && at_least_zero(m.shine) &&
                       at_least_zero(m.transmission) && at_least_zero(m.ior),
                   "material ", i, ": Kd, Ks, Shine, T and ior must be finite and not negative");
    problems.check(!(m.transmission > 0) || m.ior > 0, "material ", i,
                   ": T is above 0, so ior must be too");
  }
  const auto parallel = [&](size_t count, std::string_view what) {
    problems.check(count == 0 || count == scene.materials.size(), "there are ",
                   scene.materials.size(), " materials but ", count, " ", what, " for them");
  };
  parallel(scene.material_specular.size(), "specular colours");
  parallel(scene.material_roughness.size(), "roughness values");
  parallel(scene.material_opacity.size(), "opacities");
  parallel(scene.material_texture.size(), "textures");
  parallel(scene.standard_surfaces.size(), "standard surfaces");
  if (scene.standard_surfaces.size() == scene.materials.size())
    for (size_t i = 0; i < scene.standard_surfaces.size(); ++i)
      check_standard_surface(scene, i, problems);
  for (size_t i = 0; i < scene.material_specular.size(); ++i)
    problems.check(is_intensity(scene.material_specular[i]), "material ", i,
                   ": the specular colour must be finite and not negative");
  for (size_t i = 0; i < scene.material_opacity.size(); ++i)
    problems.check(scene.material_opacity[i] >= 0 && scene.material_opacity[i] <= 1, "material ", i,
                   ": its opacity must lie between 0 and 1");
  for (size_t i = 0; i < scene.material_roughness.size(); ++i)
    problems.check(at_least_zero(scene.material_roughness[i]), "material ", i,
                   ": the roughness must be finite and not negative");
}

void check_textures(const Scene& scene, Problems& problems) {
  for (size_t i = 0; i < scene.material_texture.size(); ++i) {
    const uint32_t texture = scene.material_texture[i];
    problems.check(texture == kNoTexture || texture < scene.textures.size(), "material ", i,
                   ": texture ", size_t(texture), " of ", scene.textures.size());
  }
  problems.check(scene.texels.size() <= kMaxTexels, "there are ", scene.texels.size(),
                 " texels, more than ", kMaxTexels);
  for (size_t i = 0; i < scene.textures.size(); ++i) {
    const Texture& t = scene.textures[i];
    const bool has_size =
        t.width >= 1 && t.width <= kLargestTexture && t.height >= 1 && t.height <= kLargestTexture;
    problems.check(has_size, "texture ", i, ": the sides must be 1 to ", size_t(kLargestTexture));
    problems.check(!has_size || size_t(t.first) + size_t(t.width) * t.height <= scene.texels.size(),
                   "texture ", i, ": its texels must be those of the scene");
    problems.check(t.wrap_u <= TextureWrap::mirror && t.wrap_v <= TextureWrap::mirror, "texture ",
                   i, ": the wrap mode must be 0, 1 or 2");
  }
}

/// Calls check(problems, i) for 0 .. count - 1 on all threads. The sentences stay in order.
template <class F>
void check_each(size_t count, Problems& problems, const F& check) {
  constexpr size_t kChunk = 1 << 16;
  std::vector<Problems> chunks((count + kChunk - 1) / kChunk);
  const auto one = [&](size_t c) {
    const size_t end = std::min(count, (c + 1) * kChunk);
    for (size_t i = c * kChunk; i < end; ++i) check(chunks[c], i);
  };
  if (chunks.size() > 1)
    parallel_for(chunks.size(), one);
  else if (count > 0)
    one(0);
  for (Problems& chunk : chunks) problems.append(std::move(chunk));
}

void check_environment(const Scene& scene, Problems& problems) {
  problems.check(scene.environment.size() <= 1, "there is more than one environment");
  size_t texels = 0;
  for (const Environment& e : scene.environment) {
    texels = size_t(e.width) * e.height;
    problems.check(texels > 0, "environment: the picture must have a size");
    problems.check(is_finite(e.up) && is_finite(e.direction) &&
                       length(cross(Vec3d(e.up), Vec3d(e.direction))) >
                           1e-7 * length(Vec3d(e.up)) * length(Vec3d(e.direction)),
                   "environment: up and direction must be finite and not parallel");
    problems.check(e.visible <= 1, "environment: visible must be 0 or 1");
  }
  problems.check(scene.environment_texels.size() == texels && texels <= kMaxTexels,
                 "environment: there are ", scene.environment_texels.size(), " texels, expected ",
                 texels, ", at most ", kMaxTexels);
  check_each(scene.environment_texels.size(), problems, [&](Problems& p, size_t i) {
    p.check(is_intensity(scene.environment_texels[i]), "environment: texel ", i,
            " must be finite and not negative");
  });
}

/// Triangles and polygons are indices, checked by check_triangles() and check_polygons().
template <class Check>
void check_shape(const TriangleIndices&, const Check&) {}
template <class Check>
void check_shape(const Polygon&, const Check&) {}

/// Checks a kind's pool with its materials, colours and opacities.
void check_pools(const Object& object, size_t materials, Problems& problems) {
  for_each_pool(object, [&](PoolKind pool, const auto& shapes, const auto& ids, const auto& colors,
                            const auto& opacity) {
    const std::string_view kind = kPoolNames[size_t(pool)];
    const size_t count = shapes.size();
    problems.check(ids.size() == count, "there are ", count, " ", kind, "s but ", ids.size(),
                   " materials for them");
    problems.check(colors.empty() || colors.size() == count, "there are ", count, " ", kind,
                   "s but ", colors.size(), " colours for them");
    problems.check(opacity.empty() || opacity.size() == count, "there are ", count, " ", kind,
                   "s but ", opacity.size(), " opacities for them");
    check_each(count, problems, [&](Problems& p, size_t i) {
      check_shape(shapes[i], [&](bool sound, std::string_view expected) {
        p.check(sound, kind, " ", i, ": ", expected);
      });
    });
    check_each(ids.size(), problems, [&](Problems& p, size_t i) {
      p.check(ids[i] < materials, kind, " ", i, ": material ", size_t(ids[i]), " of ", materials);
    });
    check_each(colors.size(), problems, [&](Problems& p, size_t i) {
      p.check(is_intensity(colors[i]), kind, " ", i,
              ": the colour must be finite and not negative");
    });
    check_each(opacity.size(), problems, [&](Problems& p, size_t i) {
      p.check(opacity[i] >= 0 && opacity[i] <= 1, kind, " ", i,
              ": the opacity must lie between 0 and 1");
    });
  });
}

/// Triangles with their vertices: of the scene, or of the mesh named by `whose`.
struct Triangles {
  std::string whose;
  const Array<Vec3f>&positions, &normals;
  const Array<TriangleIndices>&triangles, &normal_indices;
};

void check_triangles(const Triangles& t, Problems& problems) {
  const std::string_view whose = t.whose;
  check_each(t.positions.size(), problems, [&](Problems& p, size_t i) {
    p.check(is_finite(t.positions[i]), whose, "position ", i, ": must be finite");
  });
  check_each(t.normals.size(), problems, [&](Problems& p, size_t i) {
    p.check(is_finite(t.normals[i]) && is_unit(t.normals[i]), whose, "normal ", i,
            ": must have length 1");
  });
  check_each(t.triangles.size(), problems, [&](Problems& p, size_t i) {
    for (const uint32_t corner : t.triangles[i])
      p.check(corner < t.positions.size(), whose, "triangle ", i, ": vertex ", size_t(corner),
              " of ", t.positions.size(), " positions");
  });
  problems.check(t.normal_indices.empty() || t.normal_indices.size() == t.triangles.size(), whose,
                 "there are ", t.triangles.size(), " triangles but ", t.normal_indices.size(),
                 " triples of normals");
  check_each(t.normal_indices.size(), problems, [&](Problems& p, size_t i) {
    constexpr TriangleIndices kFlat = {kNoNormal, kNoNormal, kNoNormal};
    if (t.normal_indices[i] == kFlat) return;
    for (const uint32_t normal : t.normal_indices[i])
      p.check(normal < t.normals.size(), whose, "triangle ", i, ": normal ", size_t(normal), " of ",
              t.normals.size());
  });
}

void check_polygons(const Object& scene, Problems& problems) {
  check_each(scene.polygons.size(), problems, [&](Problems& p, size_t i) {
    const Polygon& polygon = scene.polygons[i];
    p.check(polygon.count >= 4, "polygon ", i, ": ", size_t(polygon.count),
            " vertices, fewer than 4");
    p.check(size_t(polygon.first) + polygon.count <= scene.positions.size(), "polygon ", i,
            ": vertices up to ", size_t(polygon.first) + polygon.count, " of ",
            scene.positions.size(), " positions");
  });
}

void check_mesh(const Mesh& mesh, size_t number, size_t materials, Problems& problems) {
  const std::string whose = "mesh " + std::to_string(number) + ": ";
  check_triangles({whose, mesh.positions, mesh.normals, mesh.triangles, mesh.normal_indices},
                  problems);
  const auto of_vertices = [&](std::string_view what, size_t count) {
    problems.check(count == 0 || count == mesh.positions.size(), whose, "there are ",
                   mesh.positions.size(), " positions but ", count, " ", what);
  };
  if (mesh.normal_indices.empty()) of_vertices("normals", mesh.normals.size());
  of_vertices("texture coordinates", mesh.uv.size());
  of_vertices("colours", mesh.colors.size());
  check_each(mesh.uv.size(), problems, [&](Problems& p, size_t i) {
    p.check(std::isfinite(mesh.uv[i][0]) && std::isfinite(mesh.uv[i][1]), whose,
            "texture coordinates ", i, ": must be finite");
  });
  check_each(mesh.colors.size(), problems, [&](Problems& p, size_t i) {
    p.check(is_intensity(mesh.colors[i]), whose, "colour ", i, ": must be finite and not negative");
  });
  problems.check(mesh.materials.size() == 1 || mesh.materials.size() == mesh.triangles.size(),
                 whose, "there are ", mesh.triangles.size(), " triangles but ",
                 mesh.materials.size(), " materials, expected 1 or one per triangle");
  check_each(mesh.materials.size(), problems, [&](Problems& p, size_t i) {
    p.check(mesh.materials[i] < materials, whose, "material ", size_t(mesh.materials[i]), " of ",
            materials);
  });
}

void check_meshes(const Object& scene, size_t materials, Problems& problems) {
  size_t triangles = scene.triangles.size(), positions = scene.positions.size(),
         normals = scene.normals.size();
  for (size_t i = 0; i < scene.meshes.size(); ++i) {
    const Mesh& mesh = scene.meshes[i];
    check_mesh(mesh, i, materials, problems);
    triangles += mesh.triangles.size(), positions += mesh.positions.size();
    normals += mesh.normals.size();
  }
  for (const Polygon& polygon : scene.polygons) triangles += polygon.count;
  // Geometry numbers all primitives in one list.
  size_t primitives = triangles;
  for_each_kind([&]<PrimitiveKind kind> {
    if constexpr (kind != PrimitiveKind::triangle)
      primitives += (scene.*kPoolOf<PrimitiveType<kind>>.shapes).size();
  });
  problems.check(primitives <= kMaxPrimitives && positions < kNoNormal && normals < kNoNormal,
                 "there are ", primitives, " primitives, ", triangles, " of them triangles of ",
                 positions, " positions and ", normals,
                 " normals with those of meshes and polygons, more than can be rendered");
}

// `names`: the number of objects.
void check_objects(const Object& scene, size_t names, Problems& problems) {
  std::array<size_t, kPoolNames.size()> counts{};
  for_each_pool(scene, [&](PoolKind pool, const auto& shapes, auto&...) {
    counts[size_t(pool)] = shapes.size();
  });
  counts[size_t(PoolKind::mesh)] = scene.meshes.size();
  counts[size_t(PoolKind::instance)] = scene.instances.size();
  const auto& ranges = scene.object_ranges;
  check_each(ranges.size(), problems, [&](Problems& p, size_t i) {
    const ObjectRange& r = ranges[i];
    const bool known = size_t(r.pool) < counts.size();
    p.check(known, "object range ", i, ": pool ", size_t(r.pool), " of ", counts.size());
    p.check(r.object >= 1 && r.object <= names, "object range ", i, ": object ", size_t(r.object),
            " of ", names);
    const size_t end = size_t(r.first) + r.count;
    p.check(!known || end <= counts[size_t(r.pool)], "object range ", i, ": elements up to ", end,
            " of ", known ? counts[size_t(r.pool)] : 0);
    p.check(r.count > 0, "object range ", i, ": it is empty");
    if (i == 0) return;
    const ObjectRange& before = ranges[i - 1];
    p.check(before.pool < r.pool ||
                (before.pool == r.pool && size_t(before.first) + before.count <= size_t(r.first)),
            "object range ", i, ": it must follow the range before without overlap");
  });
}

void check_all_pools(const Object& scene, size_t materials, Problems& problems) {
  check_pools(scene, materials, problems);
  check_triangles({"", scene.positions, scene.normals, scene.triangles, scene.triangle_normals},
                  problems);
  check_polygons(scene, problems);
  check_meshes(scene, materials, problems);
}

/// Checks instances and their prototypes. `names`: the number of object names; `depth`: the number
/// of enclosing prototypes.
void check_instances(const Object& scene, size_t materials, size_t names, int depth,
                     Problems& problems) {
  if (depth == kMaxNested && !scene.prototypes.empty())
    return problems.check(false, "prototypes are nested more than ", size_t(kMaxNested), " deep");
  for (size_t i = 0; i < scene.prototypes.size(); ++i) {
    const Object& object = scene.prototypes[i];
    Problems own;
    check_all_pools(object, materials, own);
    check_instances(object, materials, names, depth + 1, own);
    check_objects(object, names, own);
    own.check(object.planes.empty(), "an infinite plane cannot be instanced");
    own.check(!object.has_moving(), "moving primitives cannot be instanced");
    for (const std::string& sentence : own.take())
      problems.check(false, "prototype ", i, ": ", sentence);
  }
  check_each(scene.instances.size(), problems, [&](Problems& p, size_t i) {
    const Instance& copy = scene.instances[i];
    p.check(copy.prototype < scene.prototypes.size(), "instance ", i, ": prototype ",
            size_t(copy.prototype), " of ", scene.prototypes.size());
    p.check(Placement(copy.matrix).is_sound(), "instance ", i,
            ": the matrix must be finite and have an inverse");
  });
}

// The total number with the contents of instances, saturated just above the limits.
struct Expanded {
  uint64_t instances = 0, primitives = 0;
};
constexpr uint64_t kMaxShown = uint64_t(1) << 62;

Expanded expanded(const Object& scene) {
  std::vector<Expanded> of_one;
  of_one.reserve(scene.prototypes.size());
  for (const Object& object : scene.prototypes) of_one.push_back(expanded(object));
  Expanded sum;
  for_each_pool(scene,
                [&](PoolKind, const auto& shapes, auto&...) { sum.primitives += shapes.size(); });
  for (const Mesh& mesh : scene.meshes) sum.primitives += mesh.triangles.size();
  for (const Instance& copy : scene.instances) {
    sum.instances =
        std::min(sum.instances + 1 + of_one[copy.prototype].instances, uint64_t(kMaxInstances) + 1);
    sum.primitives = std::min(sum.primitives + of_one[copy.prototype].primitives, kMaxShown + 1);
  }
  return sum;
}

}  // namespace

// NOLINTNEXTLINE(readability-function-size): one parameter after another
std::string fault_of(const StandardSurface& s, float ior, size_t textures) {
  std::string fault;
  const auto text = [](float x) {
    std::array<char, 32> digits;
    return std::string(digits.data(),
                       std::to_chars(digits.data(), digits.data() + digits.size(), x).ptr);
  };
  const auto check = [&](bool sound, std::string_view name, const std::string& found,
                         std::string_view expected) {
    if (!sound && fault.empty())
      fault = std::string(name) + " is " + found + ", expected " + std::string(expected);
  };
  const auto part = [&](std::string_view name, float x) {
    check(x >= 0 && x <= 1, name, text(x), "0 to 1");
  };
  const auto triple = [&](Rgb c) {
    return "(" + text(c.x) + ", " + text(c.y) + ", " + text(c.z) + ")";
  };
  const auto intensity = [&](std::string_view name, Rgb c) {
    check(is_intensity(c), name, triple(c), "numbers that are finite and not negative");
  };
  const auto color = [&](std::string_view name, Rgb c) {
    check(is_intensity(c) && max_component(c) <= 1, name, triple(c), "0 to 1");
  };
  const auto texture = [&](std::string_view name, uint32_t number) {
    check(number == kNoTexture || number < textures, name, std::to_string(number),
          "a number below " + std::to_string(textures));
  };
  if (s.is_standard > 1 || s.is_thin > 1 || s.is_two_sided > 1 || s.is_unlit > 1)
    return "a switch must be 0 or 1";
  part("metallic", s.metallic), part("roughness", s.roughness);
  check(std::isfinite(ior) && ior > 0, "ior", text(ior), "a number above 0");
  part("specular", s.specular), intensity("specular_color", s.specular_color);
  part("transmission", s.transmission), color("attenuation_color", s.attenuation_color);
  check(at_least_zero(s.attenuation_distance), "attenuation_distance", text(s.attenuation_distance),
        "a number that is finite and not negative");
  intensity("emission", s.emission);
  part("clearcoat", s.coat), part("clearcoat_roughness", s.coat_roughness);
  color("sheen_color", s.sheen_color), part("sheen_roughness", s.sheen_roughness);
  check(s.alpha_mode <= AlphaMode::blend, "alpha_mode", std::to_string(uint32_t(s.alpha_mode)),
        "0 to 2");
  check(at_least_zero(s.alpha_cutoff), "alpha_cutoff", text(s.alpha_cutoff),
        "a number that is finite and not negative");
  check(std::isfinite(s.normal_scale), "normal_scale", text(s.normal_scale), "a finite number");
  texture("metallic_roughness_texture", s.metallic_roughness_texture);
  texture("normal_texture", s.normal_texture), texture("emission_texture", s.emission_texture);
  texture("transmission_texture", s.transmission_texture);
  return fault;
}

std::vector<std::string> validate(const Scene& scene) {
  Problems problems;
  problems.check(is_finite(scene.origin), "the origin must be finite");
  problems.check(std::isfinite(scene.requests.near_clip), "camera: hither must be finite");
  problems.check(scene.requests.samples_per_pixel >= 0,
                 "the samples per pixel must not be negative");
  problems.check(
      std::ranges::none_of(scene.requests.sky_folder, [](char c) { return uint8_t(c) < 32; }),
      "the folder of the sky must be one line");
  check_camera(scene.camera, problems);
  check_lights_and_materials(scene, problems);
  check_textures(scene, problems);
  check_environment(scene, problems);
  check_all_pools(scene, scene.materials.size(), problems);
  check_instances(scene, scene.materials.size(), scene.object_names.size(), 0, problems);
  check_objects(scene, scene.object_names.size(), problems);
  if (const auto sound = problems.take(); !sound.empty()) return sound;
  // Counted last, since invalid prototype indices have no size.
  const Expanded all = expanded(scene);
  problems.check(all.instances <= kMaxInstances && all.primitives <= kMaxShown,
                 "there are more than ",
                 size_t(all.instances > kMaxInstances ? uint64_t(kMaxInstances) : kMaxShown),
                 all.instances > kMaxInstances ? " instances" : " primitives",
                 " in total, more than can be rendered");
  return problems.take();
}

}  // namespace raio::core
