// The procedural scenes against the published counts and against files from the public generators.
#include "io/generate/generate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <unordered_map>

namespace raio::core {
namespace {

Scene generated(std::string_view name, int size = 0) {
  auto scene = generate_scene(name, size);
  if (!scene) throw std::runtime_error(scene.error().text());
  return std::move(*scene);
}

struct Counts {
  size_t spheres = 0, cones = 0, triangles = 0, polygons = 0;
  friend bool operator==(const Counts&, const Counts&) = default;
  friend std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << c.spheres << " spheres " << c.cones << " cones " << c.triangles << " triangles "
               << c.polygons << " polygons";
  }
};

Counts counts(const Scene& s) {
  return {s.spheres.size(), s.cones.size(), s.triangles.size(), s.polygons.size()};
}

// ---- The contents of the files, in a form for comparison ----

/// A primitive: a letter for its kind, its material, and its numbers in the file's order.
struct Item {
  std::string kind;
  Material material;
  std::vector<float> numbers;
};

struct Listing {
  Camera camera;
  Rgb background;
  std::vector<Light> lights;
  std::vector<Item> items;
  float near_clip = 0;
};

/// Reads the subset of NFF used by the standard files: one entity per line except `p`, `pp` and
/// `v`.
class FileReader {
 public:
  explicit FileReader(const std::string& path) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) read_line(line, file);
  }
  Listing take() { return std::move(out_); }

 private:
  static std::vector<float> floats(std::istream& in, size_t n) {
    std::vector<float> v(n);
    for (float& x : v) {
      if (double d = 0; in >> d) x = float(d);
    }
    EXPECT_TRUE(in);
    return v;
  }
  static Vec3f vec(const std::vector<float>& v) { return {v.at(0), v.at(1), v.at(2)}; }

  void read_line(const std::string& text, std::istream& file) {
    std::istringstream line(text);
    std::string key;
    line >> key;
    if (key == "from") out_.camera.from = vec(floats(line, 3));
    if (key == "at") out_.camera.at = vec(floats(line, 3));
    if (key == "up") out_.camera.up = vec(floats(line, 3));
    if (key == "angle") line >> out_.camera.fov_deg;
    if (key == "hither") line >> out_.near_clip;
    if (key == "resolution") line >> out_.camera.width >> out_.camera.height;
    if (key == "b") out_.background = vec(floats(line, 3));
    if (key == "l") {
      out_.lights.push_back({vec(floats(line, 3)), {}});
      if (float r, g, b; line >> r >> g >> b) out_.lights.back().color = Rgb(r, g, b);
    }
    if (key == "f") {
      const auto v = floats(line, 8);
      material_ = {vec(v), v[3], v[4], v[5], v[6], v[7]};
    }
    if (key == "s") out_.items.push_back({key, material_, floats(line, 4)});
    if (key == "c") out_.items.push_back({key, material_, floats(line, 8)});
    if (key == "p" || key == "pp") {
      size_t n = 0;
      line >> n;
      out_.items.push_back({key, material_, floats(file, n * (key == "p" ? 3 : 6))});
    }
  }

  Listing out_;
  Material material_;
};

void append(std::vector<float>& out, Vec3f v) { out.insert(out.end(), {v.x, v.y, v.z}); }

Listing listing(const Scene& s) {
  Listing out{s.camera, s.background, s.lights, {}, s.requests.near_clip};
  for (size_t i = 0; i < s.spheres.size(); ++i) {
    Item item{"s", s.materials.at(s.sphere_materials[i]), {}};
    append(item.numbers, s.spheres[i].center);
    item.numbers.push_back(s.spheres[i].radius);
    out.items.push_back(item);
  }
  for (size_t i = 0; i < s.cones.size(); ++i) {
    Item item{"c", s.materials.at(s.cone_materials[i]), {}};
    append(item.numbers, s.cones[i].base);
    item.numbers.push_back(s.cones[i].base_radius);
    append(item.numbers, s.cones[i].apex);
    item.numbers.push_back(s.cones[i].apex_radius);
    out.items.push_back(item);
  }
  for (size_t i = 0; i < s.triangles.size(); ++i) {
    const bool smooth = !s.triangle_normals.empty();
    Item item{smooth ? "pp" : "p", s.materials.at(s.triangle_materials[i]), {}};
    for (int corner = 0; corner < 3; ++corner) {
      append(item.numbers, s.positions.at(s.triangles[i][corner]));
      if (smooth) append(item.numbers, s.normals.at(s.triangle_normals.at(i)[corner]));
    }
    out.items.push_back(item);
  }
  for (size_t i = 0; i < s.polygons.size(); ++i) {
    Item item{"p", s.materials.at(s.polygon_materials[i]), {}};
    for (uint32_t k = 0; k < s.polygons[i].count; ++k) {
      append(item.numbers, s.positions.at(s.polygons[i].first + k));
    }
    out.items.push_back(item);
  }
  return out;
}

/// Whether `x` is the number that a file gives as `printed`. Half a unit of its sixth digit is at
/// most 5e-6 of it; the rest is the float's rounding, and cancellation to zero.
bool same_to_six_digits(float x, float printed) {
  return std::abs(x - printed) <= 5.1e-6f * std::abs(printed) + 2e-7f;
}

bool close(const std::vector<float>& a, const std::vector<float>& b) {
  return std::ranges::equal(a, b, same_to_six_digits);
}

bool close(const Material& a, const Material& b) {
  return close({a.color.x, a.color.y, a.color.z}, {b.color.x, b.color.y, b.color.z}) &&
         a.kd == b.kd && a.ks == b.ks && a.shine == b.shine && a.transmission == b.transmission &&
         a.ior == b.ior;
}

using Cell = std::array<int64_t, 3>;
struct CellHash {
  size_t operator()(const Cell& c) const {
    return size_t(c[0] * 73856093 ^ c[1] * 19349663 ^ c[2] * 83492791);
  }
};

/// The number of items of `ours` without a partner in `theirs`: the same kind and material, and the
/// same numbers, with vertices in the same order. Finds partners by the first vertex.
size_t unmatched(const std::vector<Item>& ours, const std::vector<Item>& theirs) {
  constexpr double kCell = 1e-3;  // more than the sixth digit of any coordinate
  const auto cell_of = [&](const Item& item, int offset = 13) {
    Cell cell;  // offset: one of the 27 neighbours
    for (int axis = 0, rest = offset; axis < 3; ++axis, rest /= 3) {
      cell[axis] = int64_t(std::floor(item.numbers[axis] / kCell)) + rest % 3 - 1;
    }
    return cell;
  };
  std::unordered_multimap<Cell, const Item*, CellHash> free;
  for (const Item& item : theirs) free.emplace(cell_of(item), &item);
  const auto take_partner = [&](const Item& item) {
    for (int offset = 0; offset < 27; ++offset) {
      const auto [begin, end] = free.equal_range(cell_of(item, offset));
      for (auto it = begin; it != end; ++it) {
        const Item& other = *it->second;
        if (item.kind == other.kind && close(item.material, other.material) &&
            close(item.numbers, other.numbers)) {
          free.erase(it);
          return true;
        }
      }
    }
    return false;
  };
  size_t lonely = 0;
  for (const Item& item : ours) lonely += !take_partner(item);
  return lonely;
}

std::string vec_text(Vec3f v) {
  std::ostringstream out;
  out.precision(6);
  out << v.x << ' ' << v.y << ' ' << v.z;
  return out.str();
}

void expect_same(const Listing& ours, const Listing& theirs) {
  EXPECT_EQ(vec_text(ours.camera.from), vec_text(theirs.camera.from));
  EXPECT_EQ(vec_text(ours.camera.at), vec_text(theirs.camera.at));
  EXPECT_EQ(vec_text(ours.camera.up), vec_text(theirs.camera.up));
  EXPECT_EQ(ours.camera.fov_deg, theirs.camera.fov_deg);
  EXPECT_EQ(ours.near_clip, theirs.near_clip);
  EXPECT_EQ(ours.camera.width, theirs.camera.width);
  EXPECT_EQ(ours.camera.height, theirs.camera.height);
  EXPECT_EQ(ours.background, theirs.background);
  ASSERT_EQ(ours.lights.size(), theirs.lights.size());
  for (size_t i = 0; i < ours.lights.size(); ++i) {
    EXPECT_EQ(vec_text(ours.lights[i].position), vec_text(theirs.lights[i].position));
    EXPECT_EQ(ours.lights[i].color, theirs.lights[i].color);
  }
  EXPECT_EQ(ours.items.size(), theirs.items.size());
  EXPECT_EQ(unmatched(ours.items, theirs.items), 0u);
}

// ---- The public files ----

struct PublicFile {
  const char* path;  // under the folder of shared scenes
  const char* name;
};

void PrintTo(const PublicFile& file, std::ostream* out) { *out << file.name; }

class GeneratedScene : public testing::TestWithParam<PublicFile> {};

TEST_P(GeneratedScene, IsThePublicFile) {
  const PublicFile& file = GetParam();
  const std::string path = std::string(RAIO_SOURCE_DIR "/../shared/scenes/") + file.path;
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
  expect_same(listing(generated(file.name)), FileReader(path).take());
}

INSTANTIATE_TEST_SUITE_P(
    All, GeneratedScene,
    testing::Values(PublicFile{"spd/balls.nff", "balls"}, PublicFile{"spd/gears.nff", "gears"},
                    PublicFile{"spd/lattice.nff", "lattice"}, PublicFile{"spd/mount.nff", "mount"},
                    PublicFile{"spd/rings.nff", "rings"}, PublicFile{"spd/teapot.nff", "teapot"},
                    PublicFile{"spd/tetra.nff", "tetra"}, PublicFile{"spd/tree.nff", "tree"},
                    PublicFile{"p3d/balls_low.nff", "balls_low"},
                    PublicFile{"p3d/balls_medium.nff", "balls_medium"},
                    PublicFile{"p3d/balls_high.nff", "balls_high"},
                    PublicFile{"p3d/balls_high.nff", "sphereflake"},
                    PublicFile{"p3d/mount_low.nff", "mount_low"},
                    PublicFile{"p3d/mount_high.nff", "mount_high"},
                    PublicFile{"p3d/mount_very_high.nff", "mount_very_high"}),
    [](const auto& file) { return std::string(file.param.name); });

TEST(GenerateComparison, DetectsAMovedVertexAMaterialAndAMissingPrimitive) {
  const std::vector<Item> items = listing(generated("balls", 2)).items;
  EXPECT_EQ(unmatched(items, items), 0u);
  auto moved = items;
  moved[40].numbers[1] += 1e-5f;
  EXPECT_EQ(unmatched(moved, items), 1u);
  auto painted = items;
  painted[40].material.ks = 0.4f;
  EXPECT_EQ(unmatched(painted, items), 1u);
  auto doubled = items;
  doubled[40] = doubled[41];
  EXPECT_EQ(unmatched(doubled, items), 1u);
}

// ---- Counts by size, from the published tables ----

TEST(GenerateCounts, Balls) {
  EXPECT_EQ(counts(generated("balls", 1)), (Counts{.spheres = 10, .polygons = 1}));
  EXPECT_EQ(counts(generated("balls", 2)), (Counts{.spheres = 91, .polygons = 1}));
  EXPECT_EQ(counts(generated("balls", 3)), (Counts{.spheres = 820, .polygons = 1}));
  EXPECT_EQ(counts(generated("balls")), (Counts{.spheres = 7381, .polygons = 1}));
  EXPECT_EQ(counts(generated("sphereflake", 3)), (Counts{.spheres = 820, .triangles = 2}));
}

TEST(GenerateCounts, Gears) {
  EXPECT_EQ(counts(generated("gears", 1)), (Counts{.polygons = 147}));
  EXPECT_EQ(counts(generated("gears", 2)), (Counts{.polygons = 8 * 146 + 1}));
  EXPECT_EQ(counts(generated("gears", 3)), (Counts{.polygons = 54 + 3888 + 1}));
  const Scene scene = generated("gears");
  EXPECT_EQ(counts(scene), (Counts{.polygons = 9345}));
  EXPECT_EQ(std::ranges::count(scene.polygons, 144u, &Polygon::count), 128);
  EXPECT_EQ(std::ranges::count(scene.polygons, 4u, &Polygon::count), 9217);
}

TEST(GenerateCounts, Lattice) {
  EXPECT_EQ(counts(generated("lattice", 1)), (Counts{.spheres = 8, .cones = 12}));
  EXPECT_EQ(counts(generated("lattice", 2)), (Counts{.spheres = 27, .cones = 54}));
  EXPECT_EQ(counts(generated("lattice", 3)), (Counts{.spheres = 64, .cones = 144}));
  EXPECT_EQ(counts(generated("lattice", 5)), (Counts{.spheres = 216, .cones = 540}));
  EXPECT_EQ(counts(generated("lattice")), (Counts{.spheres = 2197, .cones = 6084}));
}

TEST(GenerateCounts, Mount) {
  for (int size = 1; size <= 9; ++size) {
    EXPECT_EQ(counts(generated("mount", size)),
              (Counts{.spheres = 4, .triangles = size_t(2) << (2 * size)}));
  }
  EXPECT_EQ(counts(generated("mount")), (Counts{.spheres = 4, .triangles = 8192}));
}

TEST(GenerateCounts, Rings) {
  EXPECT_EQ(counts(generated("rings", 1)), (Counts{.spheres = 30, .cones = 30, .polygons = 1}));
  EXPECT_EQ(counts(generated("rings", 2)), (Counts{.spheres = 150, .cones = 150, .polygons = 1}));
  EXPECT_EQ(counts(generated("rings", 3)), (Counts{.spheres = 420, .cones = 420, .polygons = 1}));
  EXPECT_EQ(counts(generated("rings")), (Counts{.spheres = 4200, .cones = 4200, .polygons = 1}));
}

TEST(GenerateCounts, Teapot) {
  for (size_t n : {1, 2, 3, 7, 12, 30}) {
    EXPECT_EQ(counts(generated("teapot", int(n))),
              (Counts{.triangles = 64 * n * n - 8 * n, .polygons = n * n}));
  }
  EXPECT_EQ(counts(generated("teapot")), (Counts{.triangles = 9120, .polygons = 144}));
}

TEST(GenerateCounts, Tetra) {
  for (int size = 1; size <= 8; ++size) {
    EXPECT_EQ(counts(generated("tetra", size)), (Counts{.triangles = size_t(1) << (2 * size)}));
  }
  EXPECT_EQ(counts(generated("tetra")), (Counts{.triangles = 4096}));
}

TEST(GenerateCounts, Tree) {
  EXPECT_EQ(counts(generated("tree", 1)), (Counts{.spheres = 3, .cones = 3, .polygons = 1}));
  EXPECT_EQ(counts(generated("tree", 2)), (Counts{.spheres = 7, .cones = 7, .polygons = 1}));
  EXPECT_EQ(counts(generated("tree")), (Counts{.spheres = 4095, .cones = 4095, .polygons = 1}));
}

// ---- Geometry that the public files do not reach ----

TEST(GenerateGeometry, MountsOfAllSizesAreOneMountain) {
  const Scene coarse = generated("mount", 7), fine = generated("mount", 9);
  for (size_t y = 0; y <= 128; ++y) {
    for (size_t x = 0; x <= 128; ++x) {
      EXPECT_EQ(coarse.positions[y * 129 + x], fine.positions[y * 4 * 513 + x * 4]);
    }
  }
}

TEST(GenerateGeometry, TeapotNormalsLeaveTheBody) {
  const Scene scene = generated("teapot", 9);
  size_t outward = 0;
  for (size_t i = 0; i < scene.triangles.size(); ++i) {
    const auto& t = scene.triangles[i];
    const Vec3f a = scene.positions[t[0]], b = scene.positions[t[1]], c = scene.positions[t[2]];
    const Vec3f face = cross(b - a, c - a);
    for (uint32_t n : scene.triangle_normals[i]) outward += dot(face, scene.normals[n]) > 0;
  }
  // The two sides of a face agree except for a few slivers around spout and handle.
  EXPECT_GT(double(outward), 0.99 * 3 * double(scene.triangles.size()));
}

/// Finite numbers, indices and materials in range, sensible sizes: what a renderer takes for
/// granted.
void expect_sound(const Scene& s) {
  const auto materials_fit = [&](const StridedArray<MaterialId>& ids, size_t n) {
    return ids.size() == n &&
           std::ranges::all_of(ids, [&](MaterialId id) { return id < s.materials.size(); });
  };
  EXPECT_TRUE(materials_fit(s.sphere_materials, s.spheres.size()));
  EXPECT_TRUE(materials_fit(s.cone_materials, s.cones.size()));
  EXPECT_TRUE(materials_fit(s.triangle_materials, s.triangles.size()));
  EXPECT_TRUE(materials_fit(s.polygon_materials, s.polygons.size()));
  EXPECT_TRUE(std::ranges::all_of(
      s.spheres, [](const Sphere& x) { return is_finite(x.center) && x.radius > 0; }));
  EXPECT_TRUE(std::ranges::all_of(s.cones, [](const Cone& c) {
    return is_finite(c.base) && is_finite(c.apex) && c.apex_radius > 0 &&
           c.base_radius >= c.apex_radius && length(c.apex - c.base) > 0;
  }));
  EXPECT_TRUE(std::ranges::all_of(s.positions, is_finite<float>));
  EXPECT_TRUE(
      std::ranges::all_of(s.normals, [](Vec3f n) { return std::abs(length(n) - 1) < 1e-6; }));
  const auto below = [](size_t n) { return [n](uint32_t i) { return i < n; }; };
  EXPECT_TRUE(std::ranges::all_of(s.triangles, [&](const TriangleIndices& t) {
    return std::ranges::all_of(t, below(s.positions.size()));
  }));
  EXPECT_TRUE(std::ranges::all_of(s.triangle_normals, [&](const TriangleIndices& t) {
    return std::ranges::all_of(t, below(s.normals.size()));
  }));
  EXPECT_TRUE(s.triangle_normals.empty() || s.triangle_normals.size() == s.triangles.size());
  EXPECT_TRUE(std::ranges::all_of(s.polygons, [&](const Polygon& p) {
    return p.count >= 4 && size_t(p.first) + p.count <= s.positions.size();
  }));
  EXPECT_TRUE(std::ranges::all_of(s.materials, [](const Material& m) {
    const bool color =
        std::min({m.color.x, m.color.y, m.color.z}) >= 0 && max_component(m.color) <= 1;
    const auto part = [](float x) { return x >= 0 && x <= 1; };
    return color && part(m.kd) && part(m.ks) && part(m.transmission) && m.shine > 0 &&
           (m.transmission == 0 || m.ior >= 1);
  }));
  EXPECT_FALSE(s.lights.empty());
  EXPECT_EQ(s.camera.width, 512);
}

TEST(GenerateScene, EverySceneIsSound) {
  for (const SceneRecipe& recipe : scene_recipes()) {
    // The default, and sizes up to a tenth of a million primitives.
    for (int size = 0; size <= recipe.max_size; ++size) {
      SCOPED_TRACE(std::string(recipe.name) + " " + std::to_string(size));
      const Scene scene = generated(recipe.name, size);
      expect_sound(scene);
      EXPECT_EQ(scene.name, recipe.name);
      if (size > 0 && scene.primitive_count() > 100'000) break;
    }
  }
}

TEST(GenerateScene, RecipesAreFitForAList) {
  for (const SceneRecipe& recipe : scene_recipes()) {
    SCOPED_TRACE(recipe.name);
    EXPECT_LE(recipe.default_size, recipe.max_size);
    EXPECT_EQ(recipe.default_size == 0, recipe.max_size == 0);
    EXPECT_FALSE(recipe.summary.empty());
    EXPECT_THAT(std::string(recipe.summary), testing::Not(testing::HasSubstr("\n")));
  }
}

TEST(GenerateScene, ListsTheScenesForAnUnknownName) {
  const auto scene = generate_scene("bolas");
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().text(), testing::HasSubstr("'bolas'"));
  for (const SceneRecipe& recipe : scene_recipes()) {
    EXPECT_THAT(scene.error().text(), testing::HasSubstr(std::string(recipe.name)));
  }
}

TEST(GenerateScene, StatesTheRangeForABadSize) {
  EXPECT_EQ(generate_scene("balls", 8).error().message,
            "the size of 'balls' must be from 1 to 7, found 8");
  EXPECT_EQ(generate_scene("balls", -1).error().message,
            "the size of 'balls' must be from 1 to 7, found -1");
  EXPECT_EQ(generate_scene("mount_low", 2).error().message,
            "'mount_low' has only one size, found 2");
}

}  // namespace
}  // namespace raio::core
