#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/raio/raio.h"
#include "io/scene_file.h"
#include "nff_text.h"
#include "one_picture.h"
#include "raio_mend.h"
#include "rich_scene.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using scene_file::Entry;
using scene_file::Header;
using testing::AllOf;
using testing::HasSubstr;

Scene decoded(std::string_view bytes) {
  auto scene = decode_raio_scene(bytes, nullptr);
  if (!scene) {
    ADD_FAILURE() << scene.error();
    return {};
  }
  return std::move(*scene);
}

std::string error_of(std::string_view bytes) {
  const auto scene = decode_raio_scene(bytes, nullptr);
  return scene ? "" : scene.error();
}

/// The table's entry of a column, to be changed in bytes with recomputed hashes.
std::string with_entry(std::string bytes, std::string_view name, void (*change)(Entry&)) {
  Header header;
  std::memcpy(&header, bytes.data(), sizeof header);
  for (size_t i = 0; i < header.columns; ++i) {
    Entry entry;
    char* const at = bytes.data() + sizeof header + i * sizeof entry;
    std::memcpy(&entry, at, sizeof entry);
    if (entry.name != name) continue;
    change(entry);
    std::memcpy(at, &entry, sizeof entry);
  }
  tests::mend_raio_scene(bytes.data(), bytes.size());
  return bytes;
}

TEST(RaioScene, KeepsEverything) {
  const Scene scene = tests::rich_scene();
  const std::string bytes = encode_raio_scene(scene);
  const Scene again = decoded(bytes);
  EXPECT_EQ(content_hash(again), content_hash(scene));
  EXPECT_EQ(encode_raio_scene(again), bytes);
  EXPECT_EQ(again.requests.near_clip, 1);
  EXPECT_EQ(again.object_names, scene.object_names);
  EXPECT_EQ(again.object_ranges, scene.object_ranges);
  EXPECT_EQ(again.meshes[1].uv, scene.meshes[1].uv);
  tests::expect_same(again, scene);
}

TEST(RaioScene, KeepsRandomScenes) {
  for (uint64_t seed = 0; seed < 30; ++seed) {
    Scene scene = tests::RandomScene(seed).make();
    scene.origin = {1e9, double(seed), -3};
    const Scene again = decoded(encode_raio_scene(scene));
    tests::expect_same(again, scene);
    EXPECT_EQ(content_hash(again), content_hash(scene));
  }
}

TEST(RaioScene, KeepsInstances) {
  const Scene scene = tests::nested_scene();
  ASSERT_TRUE(validate(scene).empty()) << validate(scene).front();
  const std::string bytes = encode_raio_scene(scene);
  const Scene again = decoded(bytes);
  EXPECT_EQ(content_hash(again), content_hash(scene));
  EXPECT_EQ(encode_raio_scene(again), bytes);
  EXPECT_EQ(again.instances, scene.instances);
  EXPECT_EQ(again.object_ranges, scene.object_ranges);
  ASSERT_EQ(again.prototypes.size(), 2u);
  EXPECT_EQ(again.prototypes[1].instances, scene.prototypes[1].instances);
  EXPECT_EQ(again.prototypes[1].prototypes[0].object_ranges,
            scene.prototypes[1].prototypes[0].object_ranges);
  RenderOptions options;
  options.width = 60, options.height = 40, options.aa = 2;
  const Image picture = tests::expect_one_picture(again, options);
  EXPECT_TRUE(tests::same_bytes(picture, tests::picture_of(scene, options)));
  Scene without = scene;
  without.instances = {}, without.prototypes.clear(), without.object_ranges = {};
  EXPECT_FALSE(tests::same_bytes(picture, tests::picture_of(without, options)));
}

// Its own camera or materials.
TEST(RaioScene, PrototypesWithMoreThanGeometryAreRefused) {
  const Scene scene = tests::nested_scene();
  const std::string whole = encode_raio_scene(scene);
  const std::string inner = encode_raio_scene(standalone(scene, scene.prototypes[0]));
  const size_t at = whole.find(inner);
  ASSERT_NE(at, std::string::npos);
  for (const std::string_view column : {"camera", "materials"}) {
    std::string changed = whole;
    char* const prototype = changed.data() + at;
    Header header;
    std::memcpy(&header, prototype, sizeof header);
    for (size_t i = 0; i < header.columns; ++i) {
      Entry entry;
      std::memcpy(&entry, prototype + sizeof header + i * sizeof entry, sizeof entry);
      if (entry.name == column) prototype[entry.offset] ^= 1;
    }
    tests::mend_raio_scene(changed.data(), changed.size());
    EXPECT_THAT(error_of(changed), HasSubstr("prototype 0: it has more than an object's geometry"));
  }
}

TEST(RaioScene, NestingOfPrototypesIsLimited) {
  Scene inner;
  inner.materials.emplace_back();
  inner.spheres = {{{0, 0, 0}, 1}}, inner.sphere_materials = {0};
  for (int depth = 1; depth <= kMaxNested + 1; ++depth) {
    Scene outer;
    outer.materials = inner.materials;
    outer.prototypes = {inner};
    outer.instances = {{0, kIdentity}};
    inner = outer;
    const std::string error = error_of(encode_raio_scene(inner));
    if (depth <= kMaxNested)
      EXPECT_EQ(error, "") << depth;
    else
      EXPECT_THAT(error, HasSubstr("prototypes are nested more than 16 deep"));
  }
}

TEST(RaioScene, TooManyInstancesAreRefused) {
  Scene inner;
  inner.materials.emplace_back();
  inner.spheres = {{{0, 0, 0}, 1}}, inner.sphere_materials = {0};
  for (int depth = 0; depth < 10; ++depth) {  // 10^10 instances
    Scene outer;
    outer.materials = inner.materials;
    outer.prototypes = {inner};
    outer.instances.assign(10, {0, kIdentity});
    inner = outer;
  }
  EXPECT_THAT(error_of(encode_raio_scene(inner)),
              HasSubstr("there are more than 4294967294 instances in total"));
}

TEST(RaioScene, AnEmptySceneIsAFile) {
  Scene scene;
  scene.materials.emplace_back();
  EXPECT_EQ(content_hash(decoded(encode_raio_scene(scene))), content_hash(scene));
}

using RaioSceneFile = TemporaryFolder;

TEST_F(RaioSceneFile, ColumnsAreReadInPlace) {
  const auto path = file("rich.raio");
  const Scene scene = tests::rich_scene();
  ASSERT_TRUE(write_raio_scene(scene, path));
  auto again = read_raio_scene(path);
  ASSERT_TRUE(again) << tests::texts(again.error());
  EXPECT_EQ(again->name, "rich");
  for_each_column(*again, [](ColumnName column, const auto& array) {
    EXPECT_TRUE(array.is_borrowed() || array.empty()) << column.name;
    EXPECT_EQ(reinterpret_cast<uintptr_t>(array.address(0)) % 64, 0u) << column.name;
  });
  std::filesystem::remove(path);
  const Scene copy = *again;
  *again = Scene();  // drops the last reference except the copy
  EXPECT_EQ(content_hash(copy), content_hash(scene));
}

TEST_F(RaioSceneFile, TruncatedFilesLeaveTheSceneAlone) {
  const auto path = file("truncated.raio");
  const Scene scene = tests::rich_scene();
  ASSERT_TRUE(write_raio_scene(scene, path));
  const auto again = read_raio_scene(path);
  ASSERT_TRUE(again);
  std::filesystem::resize_file(path, 0);
  EXPECT_EQ(content_hash(*again), content_hash(scene));
}

TEST_F(RaioSceneFile, PrototypesAreReadInPlace) {
  const auto path = file("copies.raio");
  const Scene scene = tests::nested_scene();
  ASSERT_TRUE(write_raio_scene(scene, path));
  const auto again = read_scene(path, {.instances = true});
  ASSERT_TRUE(again) << tests::texts(again.error());
  EXPECT_TRUE(again->scene.instances.is_borrowed());
  const Object& object = again->scene.prototypes[1].prototypes[0];
  EXPECT_TRUE(object.spheres.is_borrowed());
  EXPECT_EQ(reinterpret_cast<uintptr_t>(object.spheres.address(0)) % 64, 0u);
  EXPECT_EQ(content_hash(again->scene), content_hash(scene));
  // Readers without instances get primitives; these have a non-uniform scale.
  const auto flat = read_scene(path);
  ASSERT_FALSE(flat);
  EXPECT_THAT(tests::texts(flat.error()), HasSubstr("spheres have a non-uniform scale"));
}

TEST_F(RaioSceneFile, OpeningErrorsAreReported) {
  const auto text = [&](const std::filesystem::path& path) {
    const auto scene = read_raio_scene(path);
    return scene ? "" : tests::texts(scene.error());
  };
  EXPECT_THAT(text(file("none.raio")), HasSubstr("No such file"));
  EXPECT_THAT(text(folder()), HasSubstr("found a folder, expected a file"));
  ASSERT_TRUE(write_file(file("empty.raio"), ""));
  EXPECT_THAT(text(file("empty.raio")), HasSubstr("not a .raio scene"));
}

class RaioSceneDamage : public testing::TestWithParam<bool> {
 protected:
  const std::string sound =
      encode_raio_scene(GetParam() ? tests::nested_scene() : tests::rich_scene());
};
INSTANTIATE_TEST_SUITE_P(Scenes, RaioSceneDamage, testing::Bool(),
                         [](const auto& at) { return at.param ? "Nested" : "Rich"; });

TEST_P(RaioSceneDamage, EveryByteMatters) {
  for (size_t at = 0; at < sound.size(); ++at) {
    std::string bytes = sound;
    bytes[at] = char(bytes[at] ^ 1 << at % 8);
    const std::string error = error_of(bytes);
    ASSERT_FALSE(error.empty()) << at;
    ASSERT_EQ(error.find('\n'), std::string::npos);
  }
}

TEST_P(RaioSceneDamage, CutAndLengthenedFilesAreRefused) {
  for (size_t size = 0; size < sound.size(); ++size)
    ASSERT_FALSE(error_of(std::string_view(sound).substr(0, size)).empty()) << size;
  EXPECT_THAT(error_of(sound + '\0'), testing::ContainsRegex("it has [0-9]+ bytes, expected"));
}

/// A change with recomputed hashes: refused, or a valid scene with its only possible file.
TEST_P(RaioSceneDamage, DamageWithValidHashes) {
  size_t refused = 0, taken = 0;
  for (size_t at = 0; at < sound.size(); ++at)
    for (const int bit : {0, 5, 7}) {
      std::string bytes = sound;
      bytes[at] = char(bytes[at] ^ 1 << bit);
      tests::mend_raio_scene(bytes.data(), bytes.size());
      const auto scene = decode_raio_scene(bytes, nullptr);
      if (!scene) {
        ++refused;
        ASSERT_FALSE(scene.error().empty());
        continue;
      }
      ++taken;
      ASSERT_TRUE(validate(*scene).empty()) << at;
      // Of the file or of a prototype, each of which starts at a multiple.
      const size_t begin = sound.rfind(scene_file::kMagic, at), in = at - begin;
      const bool is_minor = in >= offsetof(Header, minor) && in < offsetof(Header, columns);
      ASSERT_TRUE(is_minor || encode_raio_scene(*scene) == bytes) << at;
    }
  EXPECT_GT(refused, 5000u);
  EXPECT_GT(taken, 1000u);
}

TEST(RaioScene, InvalidTablesAreRefused) {
  const std::string sound = encode_raio_scene(tests::rich_scene());
  struct Lie {
    std::string_view column;
    void (*tell)(Entry&);
    std::string_view answer;
  };
  const Lie lies[] = {
      {"spheres", [](Entry& e) { e.offset -= 64; },
       "which overlaps the previous column or exceeds the file"},
      {"spheres", [](Entry& e) { e.offset += 64; },
       "which overlaps the previous column or exceeds the file"},
      {"spheres", [](Entry& e) { e.offset = ~uint64_t(63); },
       "which overlaps the previous column or exceeds the file"},
      {"spheres", [](Entry& e) { e.count = ~uint64_t(0) / 16 + 2; },
       "which overlaps the previous column"},
      {"spheres", [](Entry& e) { e.count = 0; }, "column \"spheres\" has 0 elements"},
      {"spheres", [](Entry& e) { e.number = scene_file::Number::u32; },
       "column \"spheres\" has elements of 4 numbers of type 2, expected 4 of type 3"},
      {"spheres", [](Entry& e) { e.numbers = 0; }, "has elements of 0 numbers"},
      {"spheres", [](Entry& e) { std::strcpy(e.name, "planes"); },
       "column \"planes\" is out of order"},
      {"spheres", [](Entry& e) { std::memset(e.name, 'x', sizeof e.name); }, "has no name"},
      {"mesh_uv", [](Entry& e) { e.mesh = 0x7fffffff; }, "mesh 2147483647 of"},
      {"mesh_uv", [](Entry& e) { e.mesh = 0; }, "column \"mesh_uv\" of mesh 0 is out of order"},
      {"camera", [](Entry& e) { e.count = 10; }, "column"},
  };
  for (const Lie& lie : lies)
    EXPECT_THAT(error_of(with_entry(sound, lie.column, lie.tell)), HasSubstr(lie.answer))
        << lie.column;
}

TEST(RaioScene, FilesOfANewerRaioComeWithAdvice) {
  std::string bytes = encode_raio_scene(tests::rich_scene());
  const auto unknown = with_entry(bytes, "cone_opacity", [](Entry& e) {
    e = {.number = e.number, .numbers = e.numbers, .count = e.count, .offset = e.offset};
    std::strcpy(e.name, "fur");
  });
  EXPECT_THAT(error_of(unknown), AllOf(HasSubstr("column \"fur\", which is unknown to this Raio"),
                                       HasSubstr("a newer Raio can read it")));
  bytes[offsetof(Header, minor)] = 9;
  tests::mend_raio_scene(bytes.data(), bytes.size());
  EXPECT_EQ(error_of(bytes), "") << "what it has is known";
  bytes[offsetof(Header, major)] = 2;
  tests::mend_raio_scene(bytes.data(), bytes.size());
  EXPECT_THAT(error_of(bytes),
              AllOf(HasSubstr("format 2, expected format 1"), HasSubstr("a newer Raio")));
}

TEST(RaioScene, AnInvalidSceneIsRefused) {
  Scene scene = tests::rich_scene();
  scene.spheres[3].radius = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(error_of(encode_raio_scene(scene)),
            "broken .raio scene: sphere 3: the radius must be finite and not zero");
  scene = tests::rich_scene();
  scene.lights[0].position.x = std::numeric_limits<float>::infinity();
  EXPECT_THAT(error_of(encode_raio_scene(scene)), HasSubstr("light 0"));
}

/// More than a mebibyte, split by hashing and validation.
TEST(RaioScene, LongColumns) {
  Scene scene = tests::rich_scene();
  scene.sphere_colors.clear(), scene.sphere_opacity.clear();
  scene.object_ranges.clear();
  scene.spheres.assign(300'000, {{1, 2, 3}, 1});
  scene.sphere_materials.assign(300'000, 1);
  for (size_t i = 0; i < scene.spheres.size(); ++i) scene.spheres[i].center.x = float(i);
  std::string bytes = encode_raio_scene(scene);
  EXPECT_EQ(content_hash(decoded(bytes)), content_hash(scene));
  const size_t spheres =
      bytes.find(std::string(4, '\0') + std::string("\0\0\0\x40\0\0\x40\x40", 8));
  ASSERT_NE(spheres, std::string::npos);
  bytes[spheres + size_t(16) * 200'000 + 1] ^= 1;
  EXPECT_EQ(error_of(bytes), "broken .raio scene: the checksum of column \"spheres\" is wrong");
}

}  // namespace
}  // namespace raio::core
