// Part files, merging, and that rendering in several steps never changes a picture.
#include "render/part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <cstring>
#include <limits>
#include <random>

#include "base/hash.h"
#include "integrate/prepared_scene.h"
#include "io/nff/nff.h"
#include "one_picture.h"
#include "render/options.h"
#include "render/render.h"
#include "sanitized.h"
#include "scenes.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using tests::if_sanitized;
using tests::random_scene;
using tests::same_bytes;

bool same_film(const Film& a, const Film& b) {
  if (a.tiles() != b.tiles()) return false;
  for (size_t t = 0; t < a.tiles(); ++t)
    if (a.copy(t) != b.copy(t)) return false;
  return true;
}

/// A scene with its structure, to render parts of.
struct Studio {
  Scene scene;
  RenderSettings options;
  std::unique_ptr<Accel> accel;

  explicit Studio(RenderOptions request, Scene of = random_scene(60, 5)) : scene(std::move(of)) {
    request.width = 100, request.height = 70;
    request.soft_shadows = true, request.dof = true;
    if (request.threads == 0) request.threads = 2;
    options = resolve_options(request, scene);
    accel = *build_accel(scene, options.accel);
  }

  void add_to(Film& film, const RenderTask& task = {}) const {
    WorkControl control;
    EXPECT_TRUE(render(scene, *accel, options, film, control, task).finished);
  }
  Part part(const RenderTask& task = {}, int tile_side = kTileSide) const {
    Part out{{settings_of(scene, options), task.shard, task.shards},
             std::make_unique<Film>(options.width, options.height, sample_bound(scene, options),
                                    tile_side)};
    add_to(*out.film, task);
    return out;
  }
};

RenderOptions jittered() {
  RenderOptions o;
  o.aa = 2, o.lens_samples = 2;
  return o;
}

RenderOptions sobol(int samples) {
  RenderOptions o;
  o.samples = samples;
  return o;
}

TEST(Hash, MatchesThePublishedOne) {
  EXPECT_EQ(hex(hash128("")), "00000000000000000000000000000000");
  // From the author's program, with seed 0.
  EXPECT_EQ(hex(hash128("hello")), "cbd8a7b341bd9b025b1e906a48ae1d19");
  EXPECT_EQ(hex(hash128("The quick brown fox jumps over the lazy dog")),
            "e34bbc7bbc071b6c7a433ca9c49a9347");
}

TEST(ContentHash, FollowsWhatThePictureDependsOn) {
  const Scene scene = random_scene(40, 1);
  const std::string hash = content_hash(scene);
  Scene same = scene;
  same.name = "other", same.requests.near_clip = 3;
  EXPECT_EQ(content_hash(same), hash);
  const auto changed = [&](auto change) {
    Scene s = scene;
    change(s);
    return content_hash(s);
  };
  std::vector<std::string> hashes = {
      hash,
      changed([](Scene& s) { s.camera.up.x += 1; }),
      changed([](Scene& s) { s.camera.lens_radius = 0.0f; }),
      changed([](Scene& s) { s.camera.focus_distance = 0.0f; }),
      changed([](Scene& s) { s.lights[1].color = Rgb(); }),
      changed([](Scene& s) { s.materials[2].ior += 1e-6f; }),
      changed([](Scene& s) { s.sphere_materials.back() ^= 1; }),
      changed([](Scene& s) { std::swap(s.triangles[0][0], s.triangles[0][1]); }),
      changed([](Scene& s) { s.polygons.pop_back(), s.polygon_materials.pop_back(); }),
      changed([](Scene& s) { s.origin.y = 1; }),
  };
  std::ranges::sort(hashes);
  EXPECT_EQ(std::ranges::adjacent_find(hashes), hashes.end());
}

TEST(Provenance, OptionsComeBack) {
  const Scene scene = random_scene(10, 2);
  RenderOptions request;
  request.width = 31, request.height = 17;
  request.accel.grid_factor = 2.25f;
  request.aa = 3, request.soft_shadows = true, request.light_size = 0.1f;
  request.dof = true, request.focus = 3.3333333f, request.depth = 7, request.one_sided = true,
  request.seed = 12;
  for (const RenderOptions& o : {request, RenderOptions(), sobol(7)}) {
    const RenderSettings resolved = resolve_options(o, scene);
    const Metadata settings = settings_of(scene, resolved);
    const auto back = options_from(settings);
    ASSERT_TRUE(back.has_value()) << back.error().text();
    EXPECT_EQ(settings_of(scene, resolve_options(*back, scene)), settings);
    EXPECT_EQ(back->aa, resolved.aa);
    EXPECT_EQ(back->focus, resolved.dof ? resolved.focus : 0);
    EXPECT_EQ(back->seed, resolved.seed);
  }
  // Defaults are stored all the same: another version's may differ.
  const Metadata plain = settings_of(scene, resolve_options({}, scene));
  for (const char* key : {"version", "scene_hash", "size", "accel", "aa", "depth", "seed"})
    EXPECT_NE(setting(plain, key), "") << key;
}

TEST(Provenance, RefusesUnknownFeatures) {
  const auto error = [](Metadata settings) {
    const auto options = options_from(settings);
    return options ? "" : options.error().text();
  };
  const Metadata sound = {{"version", "1"}, {"scene_hash", "x"}};
  const auto with = [&](std::string key, std::string text) {
    Metadata m = sound;
    m.emplace_back(std::move(key), std::move(text));
    return m;
  };
  EXPECT_EQ(error(sound), "");
  EXPECT_THAT(error({}), HasSubstr("no settings"));
  EXPECT_THAT(error({{"version", "1"}}), HasSubstr("no settings"));
  EXPECT_THAT(error(with("aa", "0")), HasSubstr("aa: expected"));
  EXPECT_THAT(error(with("frobnicate", "1")), HasSubstr("frobnicate is unknown"));
  EXPECT_THAT(error(with("threads", "1")), HasSubstr("threads is unknown"));
  EXPECT_THAT(error(with("light_size", "1")), HasSubstr("cannot be combined"));
}

TEST(Provenance, DifferencesAreNamed) {
  const Scene scene = random_scene(10, 2);
  const auto with = [&](auto change) {
    RenderOptions o;
    change(o);
    return settings_of(scene, resolve_options(o, scene));
  };
  const Metadata plain = with([](RenderOptions&) {});
  EXPECT_EQ(difference(plain, plain), "");
  const Metadata two = with([](RenderOptions& o) { o.aa = 2, o.depth = 7; });
  EXPECT_EQ(difference(plain, two), "`aa` 1, not 2; `depth` 5, not 7");
  EXPECT_EQ(difference(two, plain), "`aa` 2, not 1; `depth` 7, not 5");
  const Metadata soft = with([](RenderOptions& o) { o.soft_shadows = true; });
  EXPECT_EQ(difference(plain, soft), "without `soft-shadows`, not with it");
  EXPECT_EQ(difference(soft, plain), "`soft-shadows`, not without it");
  EXPECT_EQ(difference(plain, settings_of(random_scene(10, 3), resolve_options({}, scene))),
            "the scene differs");
}

TEST(PartFile, ComesBack) {
  for (const int samples : {1, 9}) {
    const Studio studio(sobol(samples));
    for (const RenderTask& task : {RenderTask{}, {.shard = 2, .shards = 5}}) {
      Part part = studio.part(task);
      const std::string bytes = encode_part(part.header, *part.film);
      const auto back = decode_part(bytes);
      ASSERT_TRUE(back.has_value()) << back.error().text();
      EXPECT_EQ(back->header.settings, part.header.settings);
      EXPECT_EQ(back->header.shard, task.shard);
      EXPECT_EQ(back->header.shards, task.shards);
      EXPECT_TRUE(same_film(*back->film, *part.film));
      EXPECT_TRUE(same_bytes(back->film->resolve(), part.film->resolve()));
      EXPECT_EQ(encode_part(back->header, *back->film), bytes);
    }
  }
}

/// Rays that hit mirror after mirror, each as bright as floats go: together they exceed a sample's
/// bound.
TEST(PartFile, OfALightAtTheEndOfFloatsComesBack) {
  for (const float light : {1e37f, 1e38f, 3e38f}) {
    Scene scene = random_scene(60, 5);
    for (Light& l : scene.lights) l.color = Rgb(light);
    for (Material& m : scene.materials) m.kd = m.ks = 1;
    const Studio studio(sobol(3), std::move(scene));
    const Part part = studio.part();
    const auto back = decode_part(encode_part(part.header, *part.film));
    ASSERT_TRUE(back.has_value()) << light << ": " << back.error().text();
    EXPECT_TRUE(same_film(*back->film, *part.film));

    Part grown = studio.part({.samples = 1});
    studio.add_to(*grown.film);
    EXPECT_TRUE(same_film(*grown.film, *part.film));
  }
}

TEST(PartFile, TilesWithoutSamplesCostFourBytes) {
  const Studio studio(jittered());
  const Part few = studio.part({.shard = 0, .shards = 1000});
  Part none{few.header, std::make_unique<Film>(100, 70, 1.0)};
  const std::string empty = encode_part(none.header, *none.film);
  Part more{few.header, std::make_unique<Film>(100, 70, 1.0, 8)};
  const size_t tiles = more.film->tiles() - none.film->tiles();
  EXPECT_EQ(encode_part(more.header, *more.film).size(), empty.size() + 4 * tiles);
}

/// With a sound check sum, whatever became of it.
std::string sealed(std::string bytes) {
  const Hash128 hash = hash128(bytes);
  for (const uint64_t half : {hash.first, hash.second})
    for (int i = 0; i < 8; ++i) bytes += char(half >> 8 * i & 255);
  return bytes;
}

TEST(PartFile, IsNotTrusted) {
  const Studio studio(sobol(2));
  const Part part = studio.part();
  const std::string bytes = encode_part(part.header, *part.film);
  const auto error = [](std::string_view b) {
    const auto decoded = decode_part(b);
    return decoded ? "" : decoded.error().text();
  };
  EXPECT_THAT(error(""), HasSubstr("not a Raio part file"));
  EXPECT_THAT(error("RAIOPART"), HasSubstr("format 0"));
  EXPECT_THAT(error(bytes + "x"), HasSubstr("checksum is wrong"));
  std::string changed = bytes;
  changed[bytes.size() / 2] ^= 1;
  EXPECT_THAT(error(changed), HasSubstr("checksum is wrong"));
  for (size_t size = 0; size < bytes.size(); size += 97)
    EXPECT_NE(error(std::string_view(bytes).substr(0, size)), "");

  // Resealed changes give only an error or a valid film.
  const std::string body = bytes.substr(0, bytes.size() - 16);
  EXPECT_EQ(error(sealed(body)), "");
  EXPECT_THAT(error(sealed(body + "x")), HasSubstr("bytes follow its last tile"));
  for (size_t size = 12; size < body.size(); size += 61)
    EXPECT_NE(error(sealed(body.substr(0, size))), "") << size;
  std::mt19937 rng(1);
  for (int i = 0; i < 3000; ++i) {
    std::string b = body;
    const size_t most = i % 2 == 0 ? 400 : b.size();
    for (size_t k = 1 + rng() % 3; k > 0; --k) b[rng() % most] = char(rng());
    if (const auto decoded = decode_part(sealed(b))) decoded->film->resolve();
  }
}

TEST(PartFile, NumbersOfChannelsAreNotTrusted) {
  RenderOptions request = sobol(3);
  for (const ChannelSpec& spec : kChannels) request.channels.add(spec.channel);
  const Studio studio(request);
  auto made = make_film(studio.scene, studio.options);
  ASSERT_TRUE(made);
  Film& film = **made;
  studio.add_to(film);
  const PartHeader header{settings_of(studio.scene, studio.options), 0, 1};
  const auto back = decode_part(encode_part(header, film));
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_TRUE(same_film(*back->film, film));

  const TileSamples good = film.copy(0);
  const size_t pixels = good.sums.size() / 4;
  EXPECT_TRUE(film.can_hold(good));
  EXPECT_GT(good.means.size(), 7 * pixels);
  EXPECT_EQ(good.squares.size(), 3 * pixels);
  const auto holds = [&](auto change) {
    TileSamples bad = good;
    change(bad);
    return film.can_hold(bad);
  };
  for (const int64_t number :
       {int64_t(1) << 62, -(int64_t(1) << 62), std::numeric_limits<int64_t>::min()}) {
    for (size_t i = 7; i < good.means.size(); i += pixels)
      EXPECT_FALSE(holds([&](TileSamples& t) { t.means[i] = number; })) << i;
    for (size_t c = 0; c < 4; ++c)
      EXPECT_FALSE(holds([&](TileSamples& t) { t.sums[4 * 7 + c] = number; })) << c;
  }
  for (size_t c = 0; c < 3; ++c) {
    const size_t i = c * pixels + 7;
    EXPECT_FALSE(holds([&](TileSamples& t) { t.squares[i] = ~Uint128(0); }));
    EXPECT_FALSE(holds([&](TileSamples& t) { t.squares[i] = Uint128(1) << 110; }));
    EXPECT_FALSE(holds([&](TileSamples& t) { t.sums[4 * 7 + c] = 1000, t.squares[i] = 1; }));
  }

  const auto error = [&](auto change) {
    TileSamples bad = good;
    change(bad);
    film.replace(0, bad);
    const auto refused = decode_part(encode_part(header, film));
    return refused ? "" : refused.error().text();
  };
  EXPECT_EQ(error([](TileSamples&) {}), "");
  EXPECT_THAT(error([](TileSamples& t) { t.means[0] = std::numeric_limits<int64_t>::max(); }),
              HasSubstr("a sum exceeds the bound of its samples"));
  for (const auto& [count, x, y] : {std::tuple(1u << 30, 0u, 0u), {1u, 99u, 0u}, {1u, 0u, 99u}})
    for (auto faults : {&SampleFaults::nans, &SampleFaults::clamped})
      EXPECT_THAT(error([&](TileSamples& t) { t.faults.*faults = {count, x, y}; }),
                  HasSubstr("NaN"));
  EXPECT_EQ(error([](TileSamples& t) { t.faults = {{1, 3, 2}, {2, 3, 2}}; }), "");
  EXPECT_THAT(error([](TileSamples& t) { ++t.rays.eye; }), HasSubstr("counts of rays"));
  EXPECT_THAT(error([](TileSamples& t) { t.rays.eye_hits = t.rays.eye + 1; }),
              HasSubstr("counts of rays"));
  EXPECT_THAT(error([](TileSamples& t) { t.rays.shadow = ~uint64_t(0); }),
              HasSubstr("counts of rays"));
  EXPECT_THAT(error([](TileSamples& t) { t.samples = SampleSpan{0, 4}; }),
              HasSubstr("samples 0:4, after 0 and of 0:3"));
}

TEST(PartFile, SpansAreNotTrusted) {
  const Studio studio(sobol(9));
  const auto error = [&](std::vector<uint32_t> spans, SampleSpan of = {}) {
    Part part = studio.part({.samples = 1});
    part.header.samples = of;
    std::string bytes = encode_part(part.header, *part.film);
    bytes.resize(bytes.size() - 16);
    // The first tile's samples: one, from 0 up to 1.
    const std::string one("\1\0\0\0\0\0\0\0\1\0\0\0", 12);
    const size_t at = bytes.find(one + std::string("\0\4\0\0", 4));
    EXPECT_NE(at, std::string::npos);
    std::string changed;
    spans.insert(spans.begin(), uint32_t(spans.size() / 2));
    for (const uint32_t n : spans)
      for (int i = 0; i < 4; ++i) changed += char(n >> 8 * i & 255);
    bytes.replace(at, one.size(), changed);
    const auto decoded = decode_part(sealed(bytes));
    return decoded ? "" : decoded.error().text();
  };
  EXPECT_EQ(error({0, 1}), "");
  EXPECT_EQ(error({8, 9}), "");
  EXPECT_THAT(error({9, 10}), HasSubstr("samples 9:10"));
  EXPECT_THAT(error({1, 1}), HasSubstr("samples 1:1"));
  EXPECT_THAT(error({2, 1}), HasSubstr("samples 2:1"));
  EXPECT_THAT(error({0, 2, 1, 3}), HasSubstr("samples 1:3, after 2"));
  EXPECT_THAT(error({0, 2, 2, 3}), HasSubstr("samples 2:3, after 2"));
  EXPECT_THAT(error({4, 5, 0, 1}), HasSubstr("samples 0:1, after 5"));
  EXPECT_THAT(error({0, 1}, {2, 5}), HasSubstr("of 2:5"));
  EXPECT_THAT(error({0, 1}, {2, 10}), HasSubstr("samples 2:10 of 9"));
  EXPECT_THAT(error({0, 1}, {3, 2}), HasSubstr("samples 3:2 of 9"));
  EXPECT_THAT(error({0, 1, 0xffffffff, 0}), HasSubstr("samples 4294967295:0"));
}

TEST(PartFile, OfAnOlderFormatIsRefusedWithAdvice) {
  const auto decoded = decode_part(std::string("RAIOPART\2\0\0\0", 12));
  ASSERT_FALSE(decoded);
  EXPECT_THAT(decoded.error().text(),
              HasSubstr("format 2, which this version cannot read (it reads 4); finish it with"));
}

TEST(PartFile, HugeSizesInSmallFilesAreRefused) {
  const Scene scene = random_scene(10, 1);
  RenderSettings o = resolve_options({}, scene);
  const Film film(o.width, o.height, 1.0);
  Metadata settings = settings_of(scene, o);
  const std::string bytes = encode_part({settings, 0, 1}, film);
  ASSERT_TRUE(decode_part(bytes).has_value());
  for (auto& [key, text] : settings)
    if (key == "size") text = "1048576x1048576";
  std::string huge = encode_part({settings, 0, 1}, film);
  huge.resize(huge.size() - 16);
  for (const size_t at : {12u, 16u}) huge.replace(at, 4, std::string("\0\0\x10\0", 4));
  const auto decoded = decode_part(sealed(huge));
  ASSERT_FALSE(decoded.has_value());
  EXPECT_THAT(decoded.error().text(), HasSubstr("truncated"));
}

TEST(Merge, ShardsMakeTheWholePicture) {
  for (const RenderOptions& request : {jittered(), sobol(5)}) {
    const Studio studio(request);
    const Part whole = studio.part();
    for (const uint32_t shards : {1u, 2u, 3u, 12u, 20u}) {
      std::vector<NamedPart> parts;
      for (uint32_t i = shards; i-- > 0;)
        parts.push_back({std::to_string(i), studio.part({.shard = i, .shards = shards})});
      const auto merged = merge_parts(parts);
      ASSERT_TRUE(merged.has_value()) << merged.error().text();
      EXPECT_EQ(missing_samples(*merged, shards), "");
      EXPECT_EQ(encode_part(merged->header, *merged->film), encode_part(whole.header, *whole.film));
    }
  }
}

std::string merge_error(std::vector<NamedPart> parts) {
  const auto merged = merge_parts(parts);
  return merged ? "" : merged.error().text();
}

TEST(Merge, NamesMismatches) {
  const Studio studio(sobol(5)), longer(sobol(6)), jitter(jittered());
  const auto shard = [](const Studio& s, uint32_t i, uint32_t n) {
    return NamedPart{"s" + std::to_string(i), s.part({.shard = i, .shards = n})};
  };
  const auto two = [](NamedPart a, NamedPart b) {
    std::vector<NamedPart> parts;
    parts.push_back(std::move(a)), parts.push_back(std::move(b));
    return merge_error(std::move(parts));
  };
  EXPECT_THAT(two(shard(studio, 0, 3), shard(longer, 1, 3)),
              HasSubstr("s1: it does not match s0: samples 6, not 5; add-samples"));
  EXPECT_THAT(two(shard(studio, 0, 3), shard(jitter, 1, 3)), HasSubstr("without samples, not 5"));
  EXPECT_THAT(two(shard(studio, 0, 3), shard(studio, 0, 3)),
              HasSubstr("s0 both have samples 0:5 in 4 of the 12 tiles"));
  EXPECT_THAT(two(shard(studio, 0, 3), shard(studio, 1, 2)), HasSubstr("in 2 of the 12"));
  NamedPart sides{"side", studio.part({}, 16)};
  EXPECT_THAT(two(shard(studio, 0, 3), std::move(sides)), HasSubstr("tile size or bound differs"));

  std::vector<NamedPart> some;
  some.push_back(shard(studio, 0, 3)), some.push_back(shard(studio, 2, 3));
  const auto merged = merge_parts(some);
  ASSERT_TRUE(merged.has_value()) << merged.error().text();
  EXPECT_EQ(missing_samples(*merged, 3), "4 of 12 tiles are missing: shard 2/3");
}

TEST(Merge, NamesMissingSamples) {
  const Studio studio(sobol(9));
  const auto merged = [&](std::initializer_list<RenderTask> tasks) {
    std::vector<NamedPart> parts;
    for (const RenderTask& task : tasks) parts.push_back({"p", studio.part(task)});
    const auto all = merge_parts(parts);
    EXPECT_TRUE(all);
    return missing_samples(*all, 3);
  };
  EXPECT_EQ(merged({{.samples = 9, .first_sample = 7}, {.samples = 5, .first_sample = 2}}),
            "samples 0:2,5:7 are missing in 12 of 12 tiles");
  EXPECT_EQ(merged({{.samples = 9, .shard = 0, .shards = 6}}),
            "10 of 12 tiles are missing: a part of shard 1/3, shard 2/3, shard 3/3");
  EXPECT_EQ(
      merged({{.samples = 4, .shard = 1, .shards = 3}, {.samples = 3, .shard = 2, .shards = 3}}),
      "4 of 12 tiles are missing: shard 1/3; samples 4:9 are missing in 1 of 12 tiles, "
      "others in 7");
}

// All channels, each by its own rule.
TEST(Merge, MergesSpansInAnyOrder) {
  RenderOptions request = sobol(12);
  for (const ChannelSpec& spec : kChannels) request.channels.add(spec.channel);
  const Studio studio(request);
  const auto make = [&](const RenderTask& task) {
    Part part{{settings_of(studio.scene, studio.options), task.shard, task.shards},
              *make_film(studio.scene, studio.options)};
    studio.add_to(*part.film, task);
    return part;
  };
  const Part whole = make({});
  const std::string bytes = encode_part(whole.header, *whole.film);
  const size_t tiles = whole.film->tiles();
  // Each sample separately, to combine into any span.
  std::vector<std::vector<TileSamples>> samples(12);
  for (uint32_t k = 0; k < 12; ++k) {
    const Part one = make({.samples = k + 1, .first_sample = k});
    for (size_t t = 0; t < tiles; ++t) samples[k].push_back(one.film->copy(t));
  }
  std::mt19937 rng(7);
  for (int round = 0; round < if_sanitized(30, 300); ++round) {
    // Random spans of random tiles in up to five parts.
    const size_t count = 1 + rng() % 5;
    std::vector<NamedPart> parts;
    for (size_t i = 0; i < count; ++i)
      parts.push_back(
          {std::to_string(i), {whole.header, *make_film(studio.scene, studio.options)}});
    for (size_t t = 0; t < tiles; ++t) {
      std::vector<std::pair<size_t, uint32_t>> order;  // part, sample
      for (uint32_t k = 0; k < 12;)
        for (uint32_t i = uint32_t(rng() % count), end = k + 1 + uint32_t(rng() % 6);
             k < std::min(end, 12u); ++k)
          order.emplace_back(i, k);
      std::ranges::shuffle(order, rng);
      for (const auto& [i, k] : order) parts[i].part.film->add(t, samples[k][t]);
    }
    std::ranges::shuffle(parts, rng);
    const auto merged = merge_parts(parts);
    ASSERT_TRUE(merged) << merged.error().text();
    ASSERT_TRUE(missing_samples(*merged, 1).empty());
    ASSERT_TRUE(same_film(*merged->film, *whole.film)) << round;
    if (round % 100 == 0) {
      ASSERT_TRUE(encode_part(merged->header, *merged->film) == bytes) << round;
    }
  }
  // Rendered in several steps, out of order.
  Part goes = make({.samples = 9, .first_sample = 5});
  studio.add_to(*goes.film, {.samples = 4, .first_sample = 2, .shard = 1, .shards = 2});
  auto back = decode_part(encode_part(goes.header, *goes.film));
  ASSERT_TRUE(back) << back.error().text();
  EXPECT_TRUE(same_film(*back->film, *goes.film));
  studio.add_to(*back->film);
  EXPECT_TRUE(encode_part(back->header, *back->film) == bytes);
}

TEST(SampleSet, IsASetOfNumbers) {
  std::mt19937 rng(3);
  for (int round = 0; round < 2000; ++round) {
    std::vector<bool> has(20);
    SampleSet set;
    for (int i = 0; i < 6; ++i) {
      const uint32_t first = uint32_t(rng() % 20), end = first + uint32_t(rng() % (21 - first));
      const SampleSet missing = set.missing({first, end});
      set.add(missing);
      std::fill(has.begin() + first, has.begin() + std::max(first, end), true);
    }
    const uint32_t first = uint32_t(rng() % 20), end = first + uint32_t(rng() % (21 - first));
    uint32_t count = 0, gaps = 0;
    for (uint32_t k = 0; k < 20; ++k) {
      const bool is_there = set.count({k, k + 1}) == 1;
      EXPECT_EQ(is_there, has[k]);
      EXPECT_EQ(!set.overlap(SampleSpan{k, k + 1}).empty(), has[k]);
      if (k >= first && k < end) count += has[k], gaps += !has[k];
    }
    EXPECT_EQ(set.count({first, end}), count);
    EXPECT_EQ(set.missing({first, end}).count(), gaps);
    for (size_t i = 1; i < set.spans().size(); ++i)
      EXPECT_LT(set.spans()[i - 1].end, set.spans()[i].first);
  }
  EXPECT_EQ(SampleSet().end(), 0u);
  EXPECT_EQ(text_of(SampleSet({2, 5})), "2:5");
}

TEST(SameBytes, AnyThreadsTilesShardsAndPasses) {
  for (const RenderOptions& request : {jittered(), sobol(5)}) {
    const Image picture = Studio(request).part().film->resolve();
    for (const int threads : {1, 2, 3, 7, 16}) {
      RenderOptions o = request;
      o.threads = threads;
      const Studio studio(o);
      for (const int side : {8, 16, 32, 64}) {
        const Part part = studio.part({.samples = 2, .shard = 1, .shards = 3}, side);
        // Stored and read back, resumed, with and without a time limit.
        const auto back = decode_part(encode_part(part.header, *part.film));
        ASSERT_TRUE(back.has_value());
        studio.add_to(*back->film, {.samples = 3, .shard = 0, .shards = 2});
        studio.add_to(*back->film, {.seconds = 1000});
        EXPECT_TRUE(same_bytes(picture, back->film->resolve())) << threads << " " << side;
      }
    }
  }
}

// A change of the computation changes these numbers; compilers, optimization levels and instruction
// sets must not.
TEST(SameBytes, FromAllBuilds) {
  const auto file = read_nff(RAIO_SOURCE_DIR "/scenes/shapes.nff");
  ASSERT_TRUE(file.has_value());
  EXPECT_EQ(content_hash(file->scene), "7d190ddae635c66dfc3813176e6fac8d");
  for (const auto& [request, hash] : {std::pair(jittered(), "19766c0c5bde4a2bafd54054cf6cafc2"),
                                      std::pair(sobol(5), "06ff4212f63931b4b3b0d928e4304b24")}) {
    const Image picture = Studio(request, file->scene).part().film->resolve();
    const auto* bytes = reinterpret_cast<const char*>(picture.pixels.data());
    EXPECT_EQ(hex(hash128({bytes, picture.pixels.size() * sizeof(Rgb)})), hash);
  }
}

// For this machine, whatever the cells of pixels, lens and lights.
TEST(SameBytes, FromAllInstructionSets) {
  for (const auto& [aa, lens_samples] : {std::pair(3, 1), {1, 7}, {2, 3}}) {
    RenderOptions request;
    request.aa = aa, request.lens_samples = lens_samples;
    const Studio studio(request);
    const Image picture = studio.part().film->resolve();
    for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      EXPECT_TRUE(same_bytes(picture, studio.part().film->resolve()))
          << hwy::TargetName(target) << ", " << aa << " x " << aa << " x " << lens_samples;
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

TEST(TimeLimit, LeavesWholePasses) {
  const Studio studio(sobol(kMaxSamples));
  for (const double seconds : {1e-9, 0.02, 0.2}) {
    Part part{{settings_of(studio.scene, studio.options), 0, 1},
              std::move(*make_film(studio.scene, studio.options))};
    WorkControl control;
    const auto done = render(studio.scene, *studio.accel, studio.options, *part.film, control,
                             {.seconds = seconds});
    EXPECT_FALSE(done.finished);
    const SampleCounts samples = samples_of(part);
    if (seconds < 1e-3) {
      EXPECT_EQ(samples.most, 0u);
      continue;
    }
    if (samples.fewest == 0) continue;  // a machine too busy for one
    EXPECT_EQ(samples.fewest, samples.most);
    const Studio fewer(sobol(int(samples.fewest)));
    EXPECT_TRUE(same_film(*part.film, *fewer.part().film));
  }
}

class PartOnDisk : public TemporaryFolder {};

TEST_F(PartOnDisk, IsWrittenWholeOrNotAtAll) {
  const Studio studio(sobol(2));
  const Part part = studio.part();
  ASSERT_TRUE(write_part(file("a.raio"), part.header, *part.film).has_value());
  const auto back = read_part(file("a.raio"));
  ASSERT_TRUE(back.has_value());
  EXPECT_TRUE(same_film(*back->film, *part.film));
  EXPECT_FALSE(write_part(file("no/a.raio"), part.header, *part.film).has_value());
  EXPECT_EQ(read_part(file("missing.raio")).error().kind, ErrorKind::cannot_read);
  put(file("b.raio"), "RAIOPART nonsense");
  EXPECT_THAT(read_part(file("b.raio")).error().text(), HasSubstr("b.raio"));
  EXPECT_EQ(entries(), 2);
}

}  // namespace
}  // namespace raio::core
