#include "io/scene_file.h"

#include <zlib.h>

#include "program.h"
// Behind it, since they have a namespace core::tests.
#include "data_files.h"
#include "io/plain_scene.h"
#include "io/raio/raio.h"
#include "nff_text.h"
#include "rich_scene.h"

namespace raio::core {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string packed(std::string_view bytes) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(deflateBound(&stream, bytes.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  stream.avail_in = uInt(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = uInt(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

std::string errors(const std::expected<ReadScene, Diagnostics>& read) {
  return read ? "" : tests::texts(read.error());
}

class SceneFiles : public TemporaryFolder {
 protected:
  /// The messages for reading the bytes from a file of this name.
  std::string errors_of(std::string_view name, std::string_view bytes) {
    put(file(name), bytes);
    return errors(read_scene(file(name)));
  }
};

TEST_F(SceneFiles, AreDetectedByContent) {
  const Scene scene = tests::random_scene(20, 1);
  const std::string hash = content_hash(scene);
  const std::string nff = write_nff(scene), raio = encode_raio_scene(scene);
  const std::string nff_hash = content_hash(parse_nff(nff, "a.nff")->scene);
  for (const char* name : {"a.nff", "a.raio", "a", "a.txt"})
    for (const bool binary : {false, true})
      for (const bool gzip : {false, true}) {
        const std::string& bytes = binary ? raio : nff;
        put(file(name), gzip ? packed(bytes) : bytes);
        const auto read = read_scene(file(name));
        ASSERT_TRUE(read) << name << errors(read);
        EXPECT_EQ(content_hash(read->scene), binary ? hash : nff_hash) << name;
        EXPECT_EQ(read->scene.name, "a");
      }
}

TEST_F(SceneFiles, AreListedBySuffix) {
  for (const char* name : {"a.nff", "A.PDB", "a.cif.gz", "b/a.obj", "a.xyz", "a.ply", "a.glb"})
    EXPECT_TRUE(has_scene_suffix(name)) << name;
  for (const char* name : {"CMakeLists.txt", "packages.txt", "a.tar.gz", "a.gz", "a", "nff", ".nff",
                           "a.png", "a.mtl", ""})
    EXPECT_FALSE(has_scene_suffix(name)) << name;
  // All that can be read are listed.
  for (const auto& entry :
       std::filesystem::directory_iterator(std::string(RAIO_SOURCE_DIR) + "/scenes"))
    EXPECT_TRUE(entry.is_directory() || has_scene_suffix(entry.path())) << entry.path();
}

TEST_F(SceneFiles, OfOtherFormatsAreIdentified) {
  struct Other {
    std::string_view name, bytes, kind;
  };
  const Other others[] = {
      {"a.json", "{\"rays\": 5}", "a JSON file"},
      {"a.pov", "// a scene\ncamera { }\n", "a POV-Ray scene"},
      {"a.nff", "\x89PNG\r\n\x1a\n", "a PNG picture"},
      {"a.ppm", "P6\n1 1\n255\nabc", "a picture (PPM, PGM, PBM or PFM)"},
      {"a.exr", "\x76\x2f\x31\x01", "an OpenEXR picture"},
      {"a.raio", "RAIOPART\1\0\0\0",
       "a part file of a render, which raio merge turns into a picture"},
      {"a.html", "<!DOCTYPE html>", "an XML file"},
  };
  for (const Other& other : others)
    EXPECT_THAT(errors_of(other.name, other.bytes),
                AllOf(HasSubstr("error: this looks like " + std::string(other.kind) + ";"),
                      HasSubstr("Raio reads NFF, P3F, .raio, PDB, CIF, GRO, XYZ, LAMMPS, PLY, STL, "
                                "OBJ, OFF and glTF")))
        << other.name;
}

TEST_F(SceneFiles, DataIsDetectedByContentThenBySuffix) {
  struct Data {
    std::string_view name, bytes, kind;
  };
  const std::string stl = std::string(80, 'x') + std::string("\1\0\0\0", 4) + std::string(50, '\0');
  const Data all[] = {
      {"a.obj", "# Blender\nmtllib a.mtl\no Cube\nv 1 1 -1\nf 1/1/1 2/2/1 3/3/1\n",
       "a Wavefront OBJ mesh"},
      {"a", "v 1 1 -1\nv 0 0 1\nv 1 0 0\nf 1 2 3\n", "a Wavefront OBJ mesh"},
      {"a.nff", "\n  v  1 1 -1\n", "a Wavefront OBJ mesh"},
      {"a.stl", "solid cube\nfacet normal 0 0 1\n", "an STL mesh"},
      {"a", stl, "an STL mesh"},
      {"a.off", "OFF\n8 6 0\n", "an OFF mesh"},
      {"a", "glTF\2\0\0\0", "a glTF scene"},
      {"a", "\xef\xbb\xbf {\n \"asset\": {\"version\": \"2.0\"}}", "a glTF scene"},
      {"a.gltf", "{\"meshes\": []}", "a glTF scene"},
      {"a.gro", "water\n 3\n", "a GRO file of a molecule"},
      {"a.dump", "ITEM: TIMESTEP\n0\n", "a LAMMPS dump"},
      {"a", "a title\n\n 12 atoms\n", "a LAMMPS data file"},
      {"a.data", "a title\n", "a LAMMPS data file"},
      {"a", "12\n\nC 0 0 0\n", "an XYZ file of a molecule"},
      {"a.xyz", "ply\nformat ascii 1.0\n", "a PLY file of points or a mesh"},
  };
  for (const auto& [name, bytes, kind] : all) {
    const FileKind found =
        file_kind(bytes, std::filesystem::path(name).extension().string(), bytes.size());
    EXPECT_EQ(found.name, kind) << name;
    EXPECT_NE(found.read, nullptr) << name;
  }
  // Under a second suffix, and packed.
  EXPECT_THAT(errors_of("b.gz", packed("OFF\nx 6 0\n")), HasSubstr("the number of vertices"));
  EXPECT_THAT(errors_of("water.gro.gz", packed("water\n 3\n")), HasSubstr("expected 3 atoms"));
}

/// All messages about NFF texts come from the NFF reader. The first or second line of some files
/// may be anything.
TEST_F(SceneFiles, TitlesDoNotDetermineTheFormat) {
  const auto atoms = [](std::string_view text, std::string_view name) {
    const auto got = parse_scene(text, name, {.style = AtomStyle::space_filling});
    return got ? std::to_string(got->scene.spheres.size()) : got.error().front().text();
  };
  for (const char* title : {"2 atoms", "data_1", "v 1 2 3"})
    EXPECT_EQ(atoms("2\n" + std::string(title) + "\nC 0 0 0\nC 2 0 0\n", "a.xyz"), "2") << title;
  for (const char* title : {"solid argon", "BMIM BF4 box", "II*", "TITLE  x", "LAMMPS", "OFF on",
                            "P1 quartz", "216 atoms", "data_run1"}) {
    std::string gro(kGro);
    gro.replace(0, gro.find('\n'), title);
    EXPECT_EQ(atoms(gro, "a.gro"), "4") << title;
    std::string data(kData);
    data.replace(0, data.find('\n'), title);
    EXPECT_EQ(atoms(data, "a.data"), "3") << title;
  }
  const std::string columns = "1\nProperties=pos:R:3:species:S:1\n0 0 0 C\n";
  for (const char* name : {"a.extxyz", "a.xyz", "a"}) EXPECT_EQ(atoms(columns, name), "1");
  EXPECT_EQ(atoms("1\nnothing\nC 0 0 0\n", "a.extxyz"), "1");
  // No more columns than words, however many are announced.
  std::string many = "1\nProperties=pos:R:3:";
  for (int i = 0; i < 9999; ++i) many += "a:R:9999:";
  EXPECT_THAT(atoms(many + "\n0 0 0 C\n", "a.xyz"), HasSubstr("as many columns as the rows have"));
}

TEST_F(SceneFiles, SceneTextsAreNotMistaken) {
  for (const char* folder : {"scenes", "tests/broken"})
    for (const auto& entry :
         std::filesystem::directory_iterator(std::filesystem::path(RAIO_SOURCE_DIR) / folder)) {
      if (entry.path().extension() != ".nff") continue;
      const std::string text = get(entry.path());
      EXPECT_EQ(file_kind(text, ".nff", text.size()).name, "") << entry.path();
      EXPECT_EQ(errors(read_scene(entry.path())), errors(read_nff(entry.path())));
    }
}

TEST_F(SceneFiles, ErrorsHaveLocations) {
  EXPECT_THAT(errors_of("bad.nff", "v\nfrom 1 2 x\n"), HasSubstr("bad.nff:2:10: error:"));
  EXPECT_THAT(errors_of("bad.nff.gz", packed("v\nfrom 1 2 x\n")),
              HasSubstr("bad.nff.gz:2:10: error:"));
  EXPECT_EQ(errors(parse_scene("v\nfrom 1 2 x\n", "memory")),
            tests::texts(parse_nff("v\nfrom 1 2 x\n", "memory").error()));
  EXPECT_THAT(errors(read_scene(file("none.nff"))), HasSubstr("cannot open the file"));
  EXPECT_THAT(errors(read_scene(folder())), HasSubstr("folder"));
}

TEST_F(SceneFiles, BrokenGzipIsRefused) {
  const std::string whole = packed(write_nff(tests::random_scene(200, 1)));
  EXPECT_THAT(errors_of("a.gz", whole.substr(0, whole.size() / 2)),
              HasSubstr("broken gzip file: it ends early"));
  EXPECT_THAT(errors_of("a.gz", "\x1f\x8b"), HasSubstr("broken gzip file"));
  std::string damaged = whole;
  damaged[whole.size() - 6] ^= 1;
  EXPECT_THAT(errors_of("a.gz", damaged), HasSubstr("broken gzip file"));
  EXPECT_THAT(errors_of("a.gz", whole + "x"), HasSubstr("broken gzip file"));
}

TEST_F(SceneFiles, GzipOfManyMembersIsOneText) {
  const std::string text = tests::kCamera + tests::kMaterial + "s 0 0 0 1\n";
  put(file("a.nff.gz"), packed(text.substr(0, 20)) + packed(text.substr(20)));
  const auto read = read_scene(file("a.nff.gz"));
  ASSERT_TRUE(read) << errors(read);
  EXPECT_EQ(read->scene.spheres.size(), 1u);
}

TEST_F(SceneFiles, AreWrittenBySuffix) {
  const Scene scene = tests::rich_scene();
  ASSERT_TRUE(write_scene(scene, file("a.raio")));
  EXPECT_EQ(content_hash(read_scene(file("a.raio"))->scene), content_hash(scene));
  ASSERT_TRUE(write_scene(scene, file("a.nff"), "rich"));
  EXPECT_EQ(get(file("a.nff")), write_nff(scene, "rich"));
  ASSERT_TRUE(write_scene(scene, file("a.POV")));
  EXPECT_THAT(get(file("a.POV")), HasSubstr("#version 3.7;"));
  const auto other = write_scene(scene, file("a.obj"));
  ASSERT_FALSE(other);
  EXPECT_EQ(other.error().kind, ErrorKind::bad_input);
  EXPECT_THAT(other.error().message,
              HasSubstr("ends with .nff, .p3f, .raio, .pov, .ply, .glb or .gltf"));
  EXPECT_FALSE(std::filesystem::exists(file("a.obj")));
}

/// Colours become materials, meshes triangles: the form in which NFF stores them.
TEST_F(SceneFiles, NffHasColorsAndMeshes) {
  const Scene scene = tests::rich_scene();
  const auto read = parse_nff(write_nff(scene), "t.nff");
  ASSERT_TRUE(read) << errors(read);
  const Scene& again = read->scene;
  EXPECT_EQ(again.triangles.size(), scene.primitive_count() - scene.planes.size() -
                                        scene.spheres.size() - scene.cones.size() -
                                        scene.polygons.size() - scene.ellipsoids.size() -
                                        scene.discs.size() - 1);  // one has no area
  for (size_t i = 0; i < scene.spheres.size(); ++i) {
    const Material& before = scene.materials[scene.sphere_materials[i]];
    const Material& after = again.materials[again.sphere_materials[i]];
    EXPECT_EQ(after.color, scene.sphere_colors[i]);
    EXPECT_EQ(after.ks, before.ks);
  }
  EXPECT_EQ(lost_features(scene, SceneFormat::raio), "");
  EXPECT_THAT(
      lost_features(scene, SceneFormat::nff),
      AllOf(HasSubstr("opacity of 10 spheres"), HasSubstr("colours of the vertices of 1 mesh"),
            HasSubstr("texture coordinates of 1 mesh"), HasSubstr("names of 3 objects"),
            HasSubstr("specular colours of "), HasSubstr("roughness of ")));
}

using ConvertCommandLine = CommandLine;

TEST_F(ConvertCommandLine, ThereAndBack) {
  Outcome done = raio({"convert", "ok.nff", "ok.raio"});
  EXPECT_EQ(done.status, 0) << done.err;
  EXPECT_EQ(done.err, "");
  done = raio({"convert", "ok.raio", "back.nff"});
  EXPECT_EQ(done.status, 0) << done.err;
  const auto scene = parse_nff(kScene, "ok.nff");
  EXPECT_EQ(content_hash(read_nff(file("back.nff"))->scene), content_hash(scene->scene));
  EXPECT_THAT(get(file("back.nff")), StartsWith("# ok, written by raio "));
  EXPECT_EQ(raio({"render", "ok.nff", "-o", "a.pfm"}).status, 0);
  EXPECT_EQ(raio({"render", "ok.raio", "-o", "b.pfm"}).status, 0);
  EXPECT_EQ(get(file("a.pfm")), get(file("b.pfm")));
}

TEST_F(ConvertCommandLine, ReportsLostFeatures) {
  ASSERT_TRUE(write_scene(tests::rich_scene(), file("rich.raio")));
  const Outcome done = raio({"convert", "rich.raio", "rich.nff"});
  EXPECT_EQ(done.status, 0);
  EXPECT_THAT(done.err, AllOf(StartsWith("rich.nff: warning: lost in this format: opacity of "),
                              HasSubstr("names of 3 objects")));
  put(file("two.xyz"), "2\n\nC 0 0 0\nC 9 0 0\n");
  EXPECT_THAT(raio({"convert", "two.xyz", "two.nff"}).err, HasSubstr("the light of figures"));
  // The angle of the picture's width.
  EXPECT_GT(read_nff(file("two.nff"))->scene.camera.fov_deg,
            read_scene(file("two.xyz"))->scene.camera.fov_deg);
  const Outcome rendered = raio({"render", "rich.raio", "--size", "8x8", "-o", "a.png"});
  EXPECT_EQ(rendered.status, 0);
}

TEST_F(ConvertCommandLine, OtherFramesAreReported) {
  put(file("two.xyz"), "1\n\nC 0 0 0\n1\n\nC 9 0 0\n");
  const auto said = [&](const std::string& frame) {
    return raio({"render", "two.xyz", "--frame", frame, "--size", "8x8", "-o", "a.png"}).err;
  };
  const auto others = HasSubstr("left out: frames or models after the first (1); --frame selects");
  EXPECT_THAT(said("0"), others);
  EXPECT_THAT(said("1"), testing::Not(others));
  EXPECT_THAT(said("0:2"), testing::Not(others));
  EXPECT_THAT(raio({"info", "two.xyz"}).err, HasSubstr("frames or models after the first"));
}

TEST_F(ConvertCommandLine, RefusesUnknownFormats) {
  const Outcome done = raio({"convert", "ok.nff", "ok.obj"});
  EXPECT_EQ(done.status, 2);
  EXPECT_THAT(
      done.err,
      HasSubstr("expected a file that ends with .nff, .p3f, .raio, .pov, .ply, .glb or .gltf"));
  EXPECT_EQ(raio({"convert", "none.nff", "ok.raio"}).status, 2);
  put(file("discs.nff"),
      "v\nfrom 0 0 5\nat 0 0 0\nup 0 1 0\nangle 40\nhither 0\nresolution 8 8\n"
      "f 1 1 1 1 0 1 0 1\npl 0 0 0 1 0 0 0 1 0\n");
  const Outcome neither = raio({"convert", "discs.nff", "a.ply"});
  EXPECT_EQ(neither.status, 2);
  EXPECT_THAT(neither.err, HasSubstr("PLY stores faces or spheres"));
}

TEST_F(ConvertCommandLine, StandardInputIsAScene) {
  ASSERT_TRUE(write_scene(parse_nff(kScene, "t.nff")->scene, file("t.raio")));
  put(file("t.nff.gz"), packed(kScene));
  const std::string expected = [&] {
    EXPECT_EQ(raio({"render", "ok.nff", "-o", "ok.pfm"}).status, 0);
    return get(file("ok.pfm"));
  }();
  for (const char* name : {"ok.nff", "t.raio", "t.nff.gz"}) {
    Redirections from;
    from.input = file(name).string();
    const Outcome done = raio({"render", "-", "-o", "in.pfm"}, from);
    EXPECT_EQ(done.status, 0) << done.err;
    EXPECT_EQ(get(file("in.pfm")), expected) << name;
  }
  Redirections from;
  from.input = file("ok.nff").string();
  EXPECT_EQ(raio({"render", "-"}, from).status, 0);
  EXPECT_TRUE(std::filesystem::exists(file("stdin.png")));
}

}  // namespace
}  // namespace raio::core
