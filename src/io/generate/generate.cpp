#include "io/generate/generate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "base/exact_math.h"
#include "io/generate/parts.h"

namespace raio::core {
namespace {

constexpr std::array kRecipes = {
    SceneRecipe{"balls", 4, 7,
                "Sphereflake, mirrors on a square: 1 + 9 + ... + 9^N spheres, 1 polygon",
                make_balls},
    SceneRecipe{"gears", 4, 32,
                "A cube of meshing gears, some of glass: N^3 gears of 146 polygons, 1 polygon",
                make_gears},
    SceneRecipe{"lattice", 12, 128,
                "Mirror balls joined by rods: (N+1)^3 spheres, 3N(N+1)^2 cylinders", make_lattice},
    SceneRecipe{"mount", 6, 11,
                "Glass balls in front of a fractal mountain: 2*4^N triangles, 4 spheres",
                make_mount},
    SceneRecipe{
        "rings", 7, 80,
        "A pyramid of linked pentagons: 5N(N+1)(2N+1) cylinders and as many spheres, 1 polygon",
        make_rings},
    SceneRecipe{"teapot", 12, 256,
                "The Utah teapot on a chessboard: 64N^2-8N smooth triangles, N^2 polygons",
                make_teapot},
    SceneRecipe{"tetra", 6, 11, "Sierpinski's tetrahedron: 4^N triangles", make_tetra},
    SceneRecipe{"tree", 11, 21,
                "A bare tree in a field: 2^(N+1)-1 cones and as many spheres, 1 polygon",
                make_tree},
    SceneRecipe{"sphereflake", 4, 7,
                "balls with white lights and a floor of 2 triangles: 1 + 9 + ... + 9^N spheres",
                make_sphereflake},
    SceneRecipe{"balls_low", 0, 0,
                "sphereflake of size 1, sharper highlights: 10 spheres, 2 triangles",
                make_balls_low},
    SceneRecipe{"balls_medium", 0, 0,
                "sphereflake of size 2, more mirror, tiny highlights: 91 spheres, 2 triangles",
                make_balls_medium},
    SceneRecipe{"balls_high", 0, 0, "sphereflake of size 4: 7381 spheres, 2 triangles",
                make_balls_high},
    SceneRecipe{"mount_low", 0, 0,
                "mount of size 1, a white light, thinner glass: 8 triangles, 4 spheres",
                make_mount_low},
    SceneRecipe{"mount_high", 0, 0, "mount_low of size 5: 2048 triangles, 4 spheres",
                make_mount_high},
    SceneRecipe{"mount_very_high", 0, 0, "mount_low of size 7: 32768 triangles, 4 spheres",
                make_mount_very_high},
};

std::string unknown_name(std::string_view name) {
  std::string names;
  for (const SceneRecipe& recipe : kRecipes) {
    if (!names.empty()) names += ", ";
    names += recipe.name;
  }
  return fmt::format("unknown scene '{}'; expected {}", name, names);
}

}  // namespace

std::span<const SceneRecipe> scene_recipes() { return kRecipes; }

std::expected<Scene, Error> generate_scene(std::string_view name, int size) {
  const auto refused = [](std::string why) {
    return std::unexpected(bad_option("", std::move(why)));
  };
  const auto recipe = std::ranges::find(kRecipes, name, &SceneRecipe::name);
  if (recipe == kRecipes.end()) return refused(unknown_name(name));
  if (size < 0 || size > recipe->max_size) {
    if (recipe->max_size == 0) {
      return refused(fmt::format("'{}' has only one size, found {}", name, size));
    }
    return refused(fmt::format("the size of '{}' must be from 1 to {}, found {}", name,
                               recipe->max_size, size));
  }
  Scene scene = recipe->make(size == 0 ? recipe->default_size : size);
  scene.name = name;
  return scene;
}

LinearMap rotation(Vec3d axis, double angle) {
  return rotation(axis, exact_cos(angle), exact_sin(angle));
}

LinearMap rotation(Vec3d axis, double cosine, double sine) {
  const auto turned = [&](Vec3d v) {
    return v * cosine + cross(axis, v) * sine + axis * (dot(axis, v) * (1 - cosine));
  };
  return {turned(kAxisX), turned(kAxisY), turned(kAxisZ)};
}

SceneMaker::SceneMaker(Vec3d from, Vec3d at, Vec3d up, float fov_deg, float hither) {
  scene_.camera = {.from = Vec3f(from),
                   .at = Vec3f(at),
                   .up = Vec3f(up),
                   .fov_deg = fov_deg,
                   .horizontal_fov_deg = 0,
                   .width = 512,
                   .height = 512,
                   .lens_radius = {},
                   .focus_distance = {},
                   .movement = {}};
  scene_.requests.near_clip = hither;
  scene_.background = {0.078f, 0.361f, 0.753f};
}

void SceneMaker::light(Vec3d position) { scene_.lights.push_back({Vec3f(position), {}}); }

void SceneMaker::white_light(Vec3d position) { scene_.lights.push_back({Vec3f(position), Rgb(1)}); }

void SceneMaker::use(const Material& material) {
  const auto known = std::ranges::find(scene_.materials, material);
  material_ = MaterialId(known - scene_.materials.begin());
  if (known == scene_.materials.end()) scene_.materials.push_back(material);
}

void SceneMaker::sphere(Vec3d center, double radius) {
  scene_.spheres.push_back({Vec3f(center), float(radius)});
  scene_.sphere_materials.push_back(material_);
}

void SceneMaker::cone(Vec3d base, double base_radius, Vec3d apex, double apex_radius) {
  scene_.cones.push_back({Vec3f(base), float(base_radius), Vec3f(apex), float(apex_radius)});
  scene_.cone_materials.push_back(material_);
}

void SceneMaker::face(std::span<const Vec3d> corners) {
  const auto first = uint32_t(scene_.positions.size());
  for (const Vec3d corner : corners) position(corner);
  if (corners.size() == 3) {
    triangle({first, first + 1, first + 2});
  } else {
    scene_.polygons.push_back({first, uint32_t(corners.size())});
    scene_.polygon_materials.push_back(material_);
  }
}

uint32_t SceneMaker::position(Vec3d p) {
  scene_.positions.push_back(Vec3f(p));
  return uint32_t(scene_.positions.size() - 1);
}

uint32_t SceneMaker::normal(Vec3d n) {
  scene_.normals.push_back(Vec3f(n));
  return uint32_t(scene_.normals.size() - 1);
}

void SceneMaker::triangle(TriangleIndices positions) {
  scene_.triangles.push_back(positions);
  scene_.triangle_materials.push_back(material_);
}

void SceneMaker::smooth_triangle(TriangleIndices positions, TriangleIndices normals) {
  triangle(positions);
  scene_.triangle_normals.push_back(normals);
}

}  // namespace raio::core
