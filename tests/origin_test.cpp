// Data far from 0: all its digits, whatever the format, and where the file has it in all that Raio
// writes.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <set>

#include "data_files.h"
#include "io/image/image.h"
#include "program.h"
#include "render/job.h"

namespace raio::core {
namespace {

// Part of a map in UTM, in metres: positions 0.1 apart, as in files.
constexpr Vec3d kMapCorner(500000, 5400000, 300);
constexpr int kMapSide = 20;

std::vector<Vec3d> map_places(Vec3d corner = kMapCorner) {
  std::vector<Vec3d> out;
  for (int j = 0; j < kMapSide; ++j)
    for (int i = 0; i < kMapSide; ++i)
      out.push_back(corner + Vec3d(0.1 * i, 0.1 * j, 0.01 * (i % 7)));
  return out;
}

// Each position in a format with its three numbers.
std::string map_rows(std::string_view format, Vec3d unit = Vec3d(1)) {
  std::string out;
  int number = 0;
  for (const Vec3d& p : map_places()) {
    const double x = p.x / unit.x, y = p.y / unit.y, z = p.z / unit.z;
    out += fmt::format(fmt::runtime(format), ++number, x, y, z);
  }
  return out;
}

std::string number_bytes(double x, bool as_float) {
  const auto narrow = float(x);
  std::string out(as_float ? sizeof narrow : sizeof x, '\0');
  std::memcpy(out.data(), as_float ? static_cast<const void*>(&narrow) : &x, out.size());
  return out;
}

std::string map_ply(std::string_view type) {
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty {} x\nproperty {} y\n"
      "property {} z\nend_header\n",
      map_places().size(), type, type, type);
  for (const Vec3d& p : map_places())
    for (int a = 0; a < 3; ++a) out += number_bytes(p[a], type == "float");
  return out;
}

std::string map_faces(std::string_view format, int first) {
  std::string out;
  for (int j = 0; j + 1 < kMapSide; ++j)
    for (int i = 0; i + 1 < kMapSide; ++i) {
      const int at = j * kMapSide + i + first;
      out += fmt::format(fmt::runtime(format), at, at + 1, at + kMapSide + 1);
    }
  return out;
}

std::string map_stl() {
  std::string out = "solid map\n";
  for (const Vec3d& p : map_places())
    out += fmt::format(
        "facet normal 0 0 1\nouter loop\nvertex {:.2f} {:.2f} {:.2f}\nvertex {:.2f} {:.2f} {:.2f}\n"
        "vertex {:.2f} {:.2f} {:.2f}\nendloop\nendfacet\n",
        p.x, p.y, p.z, p.x + 0.1, p.y, p.z, p.x, p.y + 0.1, p.z);
  return out + "endsolid\n";
}

// Places near 0 that `nodes` move, as triangles or, in mode 0, points; all hang on the first joint.
std::string map_gltf(std::string_view nodes, int mode, std::string_view attributes = "",
                     std::string_view skins = "") {
  const size_t count = map_places().size(), used = mode == 0 ? count : count / 3 * 3;
  std::string bytes;
  for (const Vec3d& p : map_places({}))
    for (int a = 0; a < 3; ++a) bytes += number_bytes(p[a], true);
  const size_t joints = bytes.size(), weights = joints + 4 * count;
  bytes.resize(weights);
  for (size_t i = 0; i < count; ++i)
    for (const double x : {1, 0, 0, 0}) bytes += number_bytes(x, true);
  return fmt::format(
      R"({{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{}],
      "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0{}}},"mode":{}}}]}}],{}
      "accessors":[{{"bufferView":0,"componentType":5126,"count":{},"type":"VEC3"}},
        {{"bufferView":0,"byteOffset":{},"componentType":5121,"count":{},"type":"VEC4"}},
        {{"bufferView":0,"byteOffset":{},"componentType":5126,"count":{},"type":"VEC4"}}],
      "bufferViews":[{{"buffer":0,"byteLength":{}}}],
      "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{}"}}]}})",
      nodes, attributes, mode, skins, used, joints, used, weights, used, bytes.size(), bytes.size(),
      base64(bytes));
}

std::string map_dump(std::string_view columns, std::string_view format, Vec3d unit = Vec3d(1)) {
  return fmt::format(
             "ITEM: TIMESTEP\n0\nITEM: NUMBER OF ATOMS\n{}\nITEM: BOX BOUNDS pp pp pp\n0 1000000\n"
             "0 10000000\n0 10000\nITEM: ATOMS id {}\n",
             map_places().size(), columns) +
         map_rows(format, unit);
}

std::string map_cif() {
  std::string out = "data_map\nloop_\n";
  for (const char* tag : {"group_PDB", "id", "type_symbol", "label_atom_id", "label_comp_id",
                          "label_asym_id", "label_seq_id", "Cartn_x", "Cartn_y", "Cartn_z"})
    out += fmt::format("_atom_site.{}\n", tag);
  return out + map_rows("ATOM {0} C C{0} ALA A {0} {1:.3f} {2:.3f} {3:.3f}\n");
}

// Positions of the scene's vertices and centres in the file.
std::vector<Vec3d> places_in_file(const Scene& scene) {
  std::vector<Vec3d> out;
  const auto add = [&](const Object& s, const Placement& place) {
    for (const Mesh& mesh : s.meshes)
      for (const Vec3f& p : mesh.positions) out.push_back(scene.origin + place.point(Vec3d(p)));
    for (const Sphere& s1 : s.spheres) out.push_back(scene.origin + place.point(Vec3d(s1.center)));
  };
  add(scene, Placement({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}));
  for (const Instance& copy : scene.instances)
    add(scene.prototypes[copy.prototype], Placement(copy.matrix));
  return out;
}

// The largest distance of a position from the nearest one in the file.
double largest_error(const std::vector<Vec3d>& found, const std::vector<Vec3d>& wanted) {
  double largest = 0;
  for (const Vec3d& p : found) {
    double nearest = 1e30;
    for (const Vec3d& w : wanted) nearest = std::min(nearest, max_component(abs(p - w)));
    largest = std::max(largest, nearest);
  }
  return largest;
}

size_t distinct(const std::vector<Vec3d>& places) {
  std::set<std::array<long, 3>> out;
  for (const Vec3d& p : places)
    out.insert({std::lround((p.x - kMapCorner.x) * 1000), std::lround((p.y - kMapCorner.y) * 1000),
                std::lround((p.z - kMapCorner.z) * 1000)});
  return out.size();
}

TEST(FarFromZero, EveryFormatKeepsItsDigits) {
  const size_t count = map_places().size();
  const std::string text_ply = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\n"
      "property float z\nend_header\n",
      count);
  const std::string lammps = fmt::format(
      "map\n\n{} atoms\n1 atom types\n0 1000000 xlo xhi\n0 10000000 ylo yhi\n0 10000 zlo zhi\n\n"
      "Atoms # atomic\n\n",
      count);
  const std::string here = R"("translation":[500000,5400000,300])";
  const std::pair<const char*, std::string> files[] = {
      {"text.ply", text_ply + map_rows("{1:.2f} {2:.2f} {3:.2f}\n")},
      {"double.ply", map_ply("double")},
      {"points.obj", map_rows("v {1:.2f} {2:.2f} {3:.2f}\n")},
      {"mesh.obj", map_rows("v {1:.2f} {2:.2f} {3:.2f}\n") + map_faces("f {} {} {}\n", 1)},
      {"mesh.off", fmt::format("OFF\n{} {} 0\n", count, (kMapSide - 1) * (kMapSide - 1)) +
                       map_rows("{1:.2f} {2:.2f} {3:.2f}\n") + map_faces("3 {} {} {}\n", 0)},
      {"a.xyz", fmt::format("{}\nmap\n", count) + map_rows("Ar {1:.2f} {2:.2f} {3:.2f}\n")},
      {"e.xyz", fmt::format("{}\nProperties=pos:R:3:species:S:1\n", count) +
                    map_rows("{1:.2f} {2:.2f} {3:.2f} Ar\n")},
      {"a.dump", map_dump("type x y z", "{0} 1 {1:.2f} {2:.2f} {3:.2f}\n")},
      {"s.dump", map_dump("type xs ys zs", "{0} 1 {1:.12f} {2:.12f} {3:.12f}\n", {1e6, 1e7, 1e4})},
      {"a.lmp", lammps + map_rows("{0} 1 {1:.2f} {2:.2f} {3:.2f}\n")},
      {"a.gro", fmt::format("map\n{}\n", count) +
                    map_rows("    1SOL     OW{0:5}{1:14.4f}{2:14.4f}{3:14.4f}\n", Vec3d(10)) +
                    "1 1 1\n"},
      {"a.pqr", map_rows("ATOM {0} C ALA {0} {1:.3f} {2:.3f} {3:.3f} 0.1 0.5\n")},
      {"a.cif", map_cif()},
      {"points.gltf", map_gltf(R"({"mesh":0,)" + here + "}", 0)},
      {"mesh.gltf", map_gltf(R"({"mesh":0,)" + here + "}", 4)},
      {"twice.gltf",
       map_gltf(R"({"children":[1,2],)" + here + R"(},{"mesh":0},{"mesh":0,"translation":[0,0,0]})",
                4)},
      {"skin.gltf", map_gltf(R"({"children":[1,2]},{"mesh":0,"skin":0},{)" + here + "}", 4,
                             R"(,"JOINTS_0":1,"WEIGHTS_0":2)", R"("skins":[{"joints":[2]}],)")},
  };
  for (const auto& [name, text] : files) {
    ReadOptions options;
    options.instances = true;
    const auto found = parse_scene(text, name, options);
    ASSERT_TRUE(found) << name << ": " << found.error().front().text();
    EXPECT_NE(found->scene.origin, Vec3d()) << name;
    const auto places = places_in_file(found->scene);
    EXPECT_LT(largest_error(places, map_places()), 5e-5) << name;
    EXPECT_GE(distinct(places), count / 3 * 3) << name;
  }
  const auto triangles = parse_scene(map_stl(), "text.stl");
  ASSERT_TRUE(triangles);
  EXPECT_LT(largest_error(places_in_file(triangles->scene), map_places()), 0.1 + 5e-5);
  EXPECT_GE(distinct(places_in_file(triangles->scene)), count);
}

// Coordinates that floats can represent are kept, and rendered near the origin.
TEST(FarFromZero, FloatsAreExact) {
  const auto found = parse_scene(map_ply("float"), "float.ply");
  ASSERT_TRUE(found);
  EXPECT_NE(found->scene.origin, Vec3d());
  std::vector<Vec3d> floats;
  for (const Vec3d& p : map_places()) floats.emplace_back(Vec3f(p));
  const auto places = places_in_file(found->scene);
  ASSERT_EQ(places.size(), floats.size());
  for (size_t i = 0; i < places.size(); ++i) EXPECT_EQ(places[i], floats[i]);
  ASSERT_EQ(found->notices.size(), 1u);
  EXPECT_THAT(found->notices[0].message, HasSubstr("floats are multiples of 0.5;"));
  EXPECT_TRUE(parse_scene(map_ply("double"), "double.ply")->notices.empty());
}

TEST(FarFromZero, RoundedDistantAtomsAreReported) {
  const auto told = [](std::string_view x) {
    const auto found = parse_scene(fmt::format("2\nwide\nAr 0 0 0\nAr {} 0 0\n", x), "a.xyz");
    return found->notices.empty() ? std::string() : found->notices[0].message;
  };
  EXPECT_EQ(told("100000"), "");
  EXPECT_THAT(told("1000000.3"), HasSubstr("rounded to multiples of 0.0625"));
}

TEST(FarFromZero, WideAndNearDataStaysAsItIs) {
  EXPECT_EQ(parse_scene("2\nwide\nAr 500000 0 0\nAr 0 0 0\n", "a.xyz")->scene.origin, Vec3d());
  EXPECT_EQ(parse_scene("2\nnear\nAr 4000 0 0\nAr 4001 0 0\n", "a.xyz")->scene.origin, Vec3d());
  const auto far = parse_scene("2\nfar\nAr 5000.25 0 0\nAr 5001 0 0\n", "a.xyz");
  EXPECT_EQ(far->scene.origin, Vec3d(5000, 0, 0));
  EXPECT_EQ(far->scene.spheres[0].center, Vec3f(0.25f, 0, 0));
}

TEST(FarFromZero, CellsBondsAndImagesFollow) {
  const std::string text =
      "2\nLattice=\"4 0 0 0 4 0 0 0 4\" Origin=\"500000 5400000 300\"\n"
      "C 500001.05 5400001 301\nC 500002.25 5400001 301\n";
  ReadOptions options;
  options.cell = true, options.images = {2, 1, 1}, options.style = AtomStyle::ball_and_stick;
  const auto found = parse_scene(text, "a.xyz", options);
  ASSERT_TRUE(found);
  const Scene& scene = found->scene;
  const auto wanted = [&](double x, double y, double z) {
    return Vec3f(Vec3d(x, y, z) - scene.origin);
  };
  ASSERT_GE(scene.spheres.size(), 4u);
  EXPECT_EQ(scene.spheres[0].center, wanted(500001.05, 5400001, 301));
  EXPECT_LT(length(scene.spheres[2].center - wanted(500005.05, 5400001, 301)), 1e-4f);
  // Two bonds, each of one colour, before the edges.
  EXPECT_LT(length(scene.cones[0].base - wanted(500001.05, 5400001, 301)), 1e-4f);
  EXPECT_LT(length(scene.cones[0].apex - wanted(500002.25, 5400001, 301)), 1e-4f);
  const Box3f box = bounds(scene);
  constexpr double kEdge = 0.02;  // the radius of edges
  EXPECT_LT(length(box.lo - wanted(500000 - kEdge, 5400000 - kEdge, 300 - kEdge)), 1e-4f);
  EXPECT_LT(length(box.hi - wanted(500008 + kEdge, 5400004 + kEdge, 304 + kEdge)), 1e-4f);
}

// The second instance is rotated by half a turn about the file's z axis, and translated back.
TEST(FarFromZero, AssembliesTurnAboutTheOriginOfTheFile) {
  const std::string text =
      "REMARK 350 BIOMOLECULE: 1\nREMARK 350 APPLY THE FOLLOWING TO CHAINS: A\n"
      "REMARK 350   BIOMT1   1  1.000000  0.000000  0.000000        0.00000\n"
      "REMARK 350   BIOMT2   1  0.000000  1.000000  0.000000        0.00000\n"
      "REMARK 350   BIOMT3   1  0.000000  0.000000  1.000000        0.00000\n"
      "REMARK 350   BIOMT1   2 -1.000000  0.000000  0.000000    16400.00000\n"
      "REMARK 350   BIOMT2   2  0.000000 -1.000000  0.000000        0.00000\n"
      "REMARK 350   BIOMT3   2  0.000000  0.000000  1.000000        0.00000\n"
      "ATOM      1  CA  ALA A   1    8192.125   1.000   2.000  1.00  0.00           C\n";
  ReadOptions options;
  options.assembly = 1;
  const auto found = parse_scene(text, "a.pdb", options);
  ASSERT_TRUE(found);
  EXPECT_NE(found->scene.origin, Vec3d());
  const Box3f box = bounds(found->scene);
  const double radius = 1.7;
  EXPECT_NEAR(found->scene.origin.x + double(box.lo.x), 8192.125 - radius, 1e-3);
  EXPECT_NEAR(found->scene.origin.x + double(box.hi.x), 16400 - 8192.125 + radius, 1e-3);
  EXPECT_NEAR(found->scene.origin.y + double(box.lo.y), -1 - radius, 1e-3);
}

class FarFiles : public CommandLine {
 protected:
  // Seen from above, so no pixel shows more than one sphere.
  FarFiles() {
    put(file("map.ply"),
        "ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double y\n"
        "property double z\nend_header\n" +
            map_rows("{1:.2f} {2:.2f} {3:.2f}\n"));
  }
};

// The mean over a pixel's spheres is none of them, so all are within a radius of one.
TEST_F(FarFiles, PositionsAreThoseOfTheFile) {
  JobRequest request;
  request.scene = file("map.ply");
  request.output = file("map.exr");
  request.options.width = 96, request.options.height = 72;
  request.options.channels.add(Channel::position);
  request.options.channels.add(Channel::depth);
  RenderJob job(request);
  ASSERT_TRUE(job.prepare());
  ASSERT_TRUE(job.run());
  ASSERT_TRUE(job.write());
  const auto picture = read_picture(request.output);
  ASSERT_TRUE(picture);
  const auto layer = [&](std::string_view name) {
    const auto at = std::ranges::find(picture->layers, name, &Layer::name);
    return at == picture->layers.end() ? Column<float>() : std::get<Column<float>>(at->values);
  };
  const auto high = layer("position"), low = layer("position_low"), depth = layer("depth");
  ASSERT_EQ(high.size(), 3u * 96 * 72);
  ASSERT_EQ(low.size(), high.size());
  const Scene& scene = job.scene();
  const double radius = double(scene.spheres[0].radius);
  std::set<size_t> seen;
  double off = 0;  // from the surface of the nearest sphere
  for (size_t i = 0; i < depth.size(); ++i) {
    if (!std::isfinite(depth[i])) continue;
    Vec3d place;
    for (size_t a = 0; a < 3; ++a) place[int(a)] = double(high[3 * i + a]) + double(low[3 * i + a]);
    double nearest = 1e30;
    size_t which = 0;
    const auto all = map_places();
    for (size_t k = 0; k < all.size(); ++k)
      if (const double d = std::abs(length(place - all[k]) - radius); d < nearest)
        nearest = d, which = k;
    off = std::max(off, nearest);
    seen.insert(which);
  }
  EXPECT_GT(seen.size(), 390u);
  EXPECT_LT(off, 1e-3);

  // NumPy's arrays have the sums.
  ASSERT_TRUE(write_image(*picture, file("map.npz")));
  const std::string bytes = get(file("map.npz"));
  EXPECT_THAT(bytes, HasSubstr("position.npy"));
  EXPECT_THAT(bytes, testing::Not(HasSubstr("position_low")));
}

TEST_F(FarFiles, ScenesNearZeroHaveNoRest) {
  put(file("near.ply"),
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float "
      "y\nproperty float z\nend_header\n1 2 3\n");
  for (const auto& [name, has_rest] : {std::pair("near.ply", false), std::pair("map.ply", true)}) {
    const auto scene = read_scene(file(name));
    RenderOptions options;
    options.channels.add(Channel::position);
    const RenderSettings settings = resolve_options(options, scene->scene);
    EXPECT_EQ(settings.channels.has(Channel::position_low), has_rest) << name;
    EXPECT_FALSE(resolve_options({}, scene->scene).channels.has(Channel::position_low));
  }
}

TEST_F(FarFiles, InfoRoundsPositionsToTheSceneSize) {
  const Outcome text = raio({"info", file("map.ply").string()});
  // Radii are half of the mean spacing.
  EXPECT_THAT(text.out, testing::ContainsRegex("bounds +499999\\.9[0-9]+ 5399999\\.9[0-9]+"));
  EXPECT_THAT(text.out, testing::ContainsRegex("to  500001\\.9[0-9]+ 5400001\\.9[0-9]+"));
}

TEST_F(FarFiles, WrittenFilesHaveTheCoordinatesOfTheFile) {
  for (const char* name : {"a.ply", "a.nff", "a.raio"}) {
    ASSERT_EQ(raio({"convert", file("map.ply").string(), file(name).string()}).status, 0) << name;
    const auto again = read_scene(file(name));
    ASSERT_TRUE(again) << name;
    const auto places = places_in_file(again->scene);
    ASSERT_EQ(places.size(), 400u) << name;
    const auto all = map_places();
    for (size_t i = 0; i < places.size(); ++i)
      ASSERT_LT(length(places[i] - all[i]), 5e-5) << name << ' ' << i;
  }
  // POV-Ray bounds objects by floats.
  const Outcome done = raio({"convert", file("map.ply").string(), file("a.pov").string()});
  ASSERT_EQ(done.status, 0);
  const Vec3d origin = read_scene(file("map.ply"))->scene.origin;
  EXPECT_THAT(done.err,
              HasSubstr(fmt::format("relative to {} {} {}", origin.x, origin.y, origin.z)));
  EXPECT_THAT(get(file("a.pov")), HasSubstr(fmt::format("#declare Origin = <{}, {}, {}>;", origin.x,
                                                        origin.y, origin.z)));
}

// Frames with distant first atoms have different origins, and the same picture.
TEST_F(FarFiles, FramesAreSeenByTheSameCamera) {
  const std::string a = "Ar 500400 5400000 300\n", b = "Ar 500604 5400100 300\n";
  put(file("two.xyz"), "2\none\n" + a + b + "2\ntwo\n" + b + a);
  ReadOptions second;
  second.frame = 1;
  ASSERT_NE(read_scene(file("two.xyz"))->scene.origin,
            read_scene(file("two.xyz"), second)->scene.origin);
  const Outcome done = raio({"render", file("two.xyz").string(), "--frame", "0:2", "--size",
                             "60x40", "--radius", "20", "-o", file("f.png").string()});
  ASSERT_EQ(done.status, 0) << done.err;
  const auto one = read_image(file("f-0001.png")), two = read_image(file("f-0002.png"));
  ASSERT_TRUE(one && two) << done.err;
  EXPECT_GT(compare(*one, *two).psnr_db, 50);
}

TEST_F(FarFiles, CoincidentAtomsAreNamed) {
  put(file("same.pdb"),
      "ATOM      1  CA  ALA A   1       1.000   1.000   2.000  1.00  0.00           C\n"
      "ATOM      2  CB  ALA A   1       1.000   1.000   2.000  1.00  0.00           C\n"
      "ATOM      3  OG  SER B   7       1.000   1.000   2.000  1.00  0.00           O\n");
  EXPECT_THAT(raio({"info", file("same.pdb").string()}).err,
              HasSubstr("atoms at the same position as another (2: CB ALA A1, OG SER B7)"));
}

// A file that requests brute force, with this many spheres.
std::string brute_force(int spheres) {
  std::string out =
      "accel 0\nb 1 1 1\nv\nfrom 0 -9 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\n"
      "resolution 16 16\nl 3 -4 5\nf 1 0 0 0.8 0.2 10 0 1\n";
  for (int i = 0; i < spheres; ++i) out += fmt::format("s {} 0 {} 0.01\n", i % 100, i / 100);
  return out;
}

TEST_F(FarFiles, BruteForceOfManyPrimitivesIsReported) {
  put(file("few.p3f"), brute_force(10000)), put(file("many.p3f"), brute_force(10001));
  EXPECT_EQ(raio({"render", file("few.p3f").string(), "-o", file("a.png").string()})
                .err.find("brute force"),
            std::string::npos);
  const std::string said =
      raio({"render", file("many.p3f").string(), "-o", file("a.png").string()}).err;
  EXPECT_THAT(said, testing::ContainsRegex("requests brute force, so each ray is tested with "
                                           "all of 10001 primitives; try --accel bvh, "
                                           "which takes about [0-9.e-]+ s for this picture"));
  EXPECT_EQ(
      raio({"render", file("many.p3f").string(), "--accel", "bvh", "-o", file("a.png").string()})
          .err.find("brute force"),
      std::string::npos);
}

}  // namespace
}  // namespace raio::core
