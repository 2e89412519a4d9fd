// The public interface's films: parts of pictures in memory and files, merged and continued; and
// scenes as bytes, and settings from values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <raio/raio.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "temporary_folder.h"

namespace {

using testing::AllOf;
using testing::HasSubstr;
using Floats = std::vector<float>;

class LibraryParts : public raio::core::TemporaryFolder {
 protected:
  std::string path(std::string_view name) const { return file(name).string(); }
  // The bytes of the picture, with settings.
  std::string picture(const raio::Film& film) const {
    film.write(path("picture.exr"));
    return get(path("picture.exr"));
  }
};

raio::Scene scene() {
  raio::Scene made;
  made.set_background({0.1, 0.2, 0.4});
  made.set_camera({{0, -9, 4}, {0, 0, 0}, {0, 0, 1}, 40});
  made.add_light({5, -8, 10});
  const uint32_t shiny = made.add_material({{0.9, 0.5, 0.25}, 0.6, 0.3, 30, 0, 1});
  std::mt19937 random(4);
  std::uniform_real_distribution<float> at(-3, 3), radius(0.1f, 0.6f);
  Floats centers, radii;
  for (int i = 0; i < 30; ++i) {
    centers.insert(centers.end(), {at(random), at(random), at(random)});
    radii.push_back(radius(random));
  }
  made.add_spheres({centers.data(), 30}, {radii.data(), 30}, shiny);
  return made;
}

raio::Settings twelve() {
  return raio::Settings()
      .set("size", {100, 70})
      .set("threads", 2)
      .set("samples", 12)
      .set("soft-shadows")
      .set("channels", "alpha,depth,normal,variance,samples");
}

raio::Film rendered(const raio::Settings& settings) { return raio::Job(scene(), settings).run(); }

// The message of the error that `f` throws; it must be one of bad input.
template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const raio::Error& error) {
    EXPECT_EQ(error.kind(), raio::ErrorKind::bad_input);
    return error.what();
  }
  return "nothing was refused";
}

TEST_F(LibraryParts, OfRandomSpansMergeToTheWholePicture) {
  const raio::Film whole = rendered(twelve());
  const std::string expected = picture(whole);
  EXPECT_TRUE(whole.complete());
  EXPECT_EQ(whole.samples(), (std::array<uint32_t, 2>{12, 12}));
  std::mt19937 random(5);
  for (int round = 0; round < 12; ++round) {
    // Every shard has its own spans.
    const uint32_t shards = 1 + uint32_t(random() % 3);
    std::vector<raio::Film> parts;
    for (uint32_t shard = 1; shard <= shards; ++shard) {
      for (uint32_t first = 0, end = 0; first < 12; first = end) {
        end = std::min<uint32_t>(12, first + 1 + uint32_t(random() % 6));
        raio::Settings settings = twelve();
        if (shards > 1) settings.set("shard", std::to_string(shard) + "/" + std::to_string(shards));
        settings.set("sample-range", std::to_string(first) + ":" + std::to_string(end));
        raio::Film part = rendered(settings);
        EXPECT_EQ(part.samples(), (std::array<uint32_t, 2>{end - first, end - first}));
        EXPECT_EQ(part.settings().get("shard"), settings.get("shard"));
        EXPECT_EQ(part.settings().get("sample-range"), settings.get("sample-range"));
        EXPECT_EQ(part.complete(), shards == 1 && first == 0 && end == 12);
        // Some come from elsewhere.
        if (random() % 2 == 0) part = raio::Film::from_bytes(part.to_bytes());
        parts.push_back(std::move(part));
      }
    }
    std::shuffle(parts.begin(), parts.end(), random);
    const raio::Film merged = raio::Film::merge(parts);
    EXPECT_TRUE(merged.complete()) << merged.missing();
    EXPECT_TRUE(merged.to_bytes() == whole.to_bytes()) << round;
    ASSERT_TRUE(picture(merged) == expected) << round;
    if (parts.size() == 1) continue;
    parts.pop_back();
    const raio::Film most = raio::Film::merge(parts);
    EXPECT_FALSE(most.complete());
    EXPECT_THAT(refusal([&] { most.write(path("x.png")); }),
                AllOf(HasSubstr("missing"), HasSubstr(most.missing()), HasSubstr("(.raio)")));
    // A job can render the missing samples instead.
    EXPECT_TRUE(raio::Job(scene(), twelve(), most).run().to_bytes() == whole.to_bytes()) << round;
  }
  EXPECT_FALSE(std::filesystem::exists(path("x.png")));
}

TEST_F(LibraryParts, AreAddedOneByOne) {
  const raio::Film whole = rendered(twelve());
  const auto part = [](const char* shard, const char* samples) {
    return rendered(twelve().set("shard", shard).set("sample-range", samples));
  };
  using Spans = std::vector<std::array<uint32_t, 2>>;
  raio::Film film = raio::Job(scene(), twelve()).film();  // not yet begun
  EXPECT_EQ(film.tiles(), 12U);
  EXPECT_EQ(film.missing(0, 1), Spans({{0, 12}}));
  EXPECT_EQ(film.missing(11, 16), Spans({{0, 12}}));
  EXPECT_EQ(film.missing(12, 16), Spans());  // has no tile
  film.add(part("2/4", "3:7")).add(part("2/4", "9:12"));
  EXPECT_EQ(film.missing(1, 4), Spans({{0, 3}, {7, 9}}));
  EXPECT_EQ(film.missing(5, 8), Spans({{0, 3}, {7, 9}}));
  EXPECT_EQ(film.missing(0, 2), Spans({{0, 12}}));
  EXPECT_EQ(film.missing(1, 2), std::nullopt);
  EXPECT_EQ(refusal([&] { static_cast<void>(film.missing(2, 2)); }), "shard 2 of 2 does not exist");

  // A part that does not fit leaves the film unchanged.
  const std::string before = film.to_bytes();
  EXPECT_EQ(refusal([&] { film.add(part("1/1", "0:4")); }),
            "the other film: it and this film both have samples 3:4 in 3 of the 12 tiles; leave "
            "one of them out, or render parts of one division (shard)");
  EXPECT_THAT(refusal([&] { film.add(rendered(twelve().set("seed", 3))); }),
              HasSubstr("the other film: it does not match this film: seed 3, not 0"));
  EXPECT_TRUE(film.to_bytes() == before);

  for (const auto& [shard, samples] :
       {std::pair("2/4", "0:3"), {"2/4", "7:9"}, {"4/4", "0:12"}, {"1/2", "0:12"}})
    film.add(part(shard, samples));
  EXPECT_TRUE(film.to_bytes() == whole.to_bytes());
  EXPECT_EQ(film.missing(0, 1), Spans());
}

TEST_F(LibraryParts, ThatDoNotFitAreRefusedByName) {
  const auto range = [](const char* samples) {
    return rendered(twelve().set("sample-range", samples));
  };
  EXPECT_EQ(refusal([&] { raio::Film::merge({range("0:4"), range("6:10"), range("7:8")}); }),
            "film 3: it and film 2 both have samples 7:8 in 12 of the 12 tiles; leave one of them "
            "out, or render parts of one division (shard)");
  range("0:4").write(path("a.raio"));
  rendered(twelve().set("seed", 3)).write(path("b.raio"));
  EXPECT_EQ(
      refusal([&] {
        raio::Film::merge({raio::Film::read(path("a.raio")), raio::Film::read(path("b.raio"))});
      }),
      path("b.raio") + ": it does not match " + path("a.raio") + ": seed 3, not 0");
  EXPECT_EQ(refusal([] { raio::Film::merge({}); }), "there are no films to merge");
  const raio::Film first = rendered(twelve().set("shard", "1/3"));
  EXPECT_THAT(first.missing(), HasSubstr("tiles are missing: shard 2/3, shard 3/3"));
}

TEST_F(LibraryParts, AreNotTrusted) {
  const std::string bytes =
      rendered(twelve().set("size", {40, 30}).set("sample-range", "2:3")).to_bytes();
  EXPECT_TRUE(raio::Film::from_bytes(bytes).to_bytes() == bytes);
  for (size_t size = 0; size < bytes.size(); size += 97)
    EXPECT_NE(refusal([&] { raio::Film::from_bytes(std::string_view(bytes).substr(0, size)); }),
              "nothing was refused")
        << size;
  for (size_t i = 0; i < bytes.size(); i += 61) {
    std::string changed = bytes;
    changed[i] = char(changed[i] ^ 4);
    EXPECT_NE(refusal([&] { raio::Film::from_bytes(changed); }), "nothing was refused") << i;
  }
  put(file("a.raio"), bytes.substr(0, 100));
  EXPECT_THAT(refusal([&] { raio::Film::read(path("a.raio")); }),
              AllOf(HasSubstr("a.raio"), HasSubstr("checksum")));
  EXPECT_THAT(refusal([&] { raio::Film::read(path("no.raio")); }), HasSubstr("no.raio"));
}

TEST_F(LibraryParts, AreContinued) {
  const raio::Film whole = rendered(twelve()), few = rendered(twelve().set("samples", 5));
  const std::string before = few.to_bytes();
  EXPECT_TRUE(raio::Job(scene(), twelve(), few).run().to_bytes() == whole.to_bytes());
  EXPECT_TRUE(raio::Job(raio::Accel(scene()), twelve(), few).run().to_bytes() == whole.to_bytes());
  EXPECT_TRUE(few.to_bytes() == before) << "the job has a copy";
  // By its own settings.
  raio::Settings own = few.settings();
  EXPECT_EQ(own.get("size"), "100x70");
  EXPECT_EQ(own.get("samples"), "5");
  EXPECT_TRUE(raio::Job(scene(), own.set("samples", 12), few).run().to_bytes() == whole.to_bytes());
  const raio::Film part = rendered(twelve().set("shard", "2/3").set("sample-range", "3:7"));
  EXPECT_TRUE(raio::Job(scene(), part.settings(), part).run().to_bytes() == part.to_bytes());

  const auto error = [&](const raio::Settings& settings, const raio::Film& film) {
    return refusal([&] { raio::Job(scene(), settings, film); });
  };
  EXPECT_EQ(error(twelve().set("samples", 3), few),
            "the film: it already has 5 samples per pixel; request at least as many");
  EXPECT_EQ(error(twelve().set("seed", 1), few), "the film: seed 0, not 1");
  EXPECT_THAT(error(twelve(), part), HasSubstr("it is shard 2/3 of a picture; add shard 2/3"));
  EXPECT_THAT(error(twelve().set("resume"), few), HasSubstr("has no effect without checkpoint"));
  few.write(path("few.raio"));
  EXPECT_THAT(error(twelve().set("depth", 2), raio::Film::read(path("few.raio"))),
              HasSubstr("few.raio: depth 5, not 2"));
  EXPECT_THAT(refusal([&] { raio::Job(raio::Scene(), twelve(), few); }),
              HasSubstr("the scene differs"));
}

TEST_F(LibraryParts, OfCancelledJobsAreContinued) {
  const raio::Film whole = rendered(twelve()), few = rendered(twelve().set("samples", 5));
  raio::Job job(scene(), twelve(), few);
  job.cancel();
  try {
    job.run();
    FAIL() << "it ran to its end";
  } catch (const raio::Error& error) {
    EXPECT_EQ(error.kind(), raio::ErrorKind::cancelled);
  }
  const raio::Film left = job.film();
  EXPECT_EQ(left.samples(), few.samples());
  EXPECT_FALSE(left.complete());
  EXPECT_TRUE(raio::Job(scene(), twelve(), left).run().to_bytes() == whole.to_bytes());

  raio::Job again(scene(), twelve());
  EXPECT_EQ(again.film().samples(), (std::array<uint32_t, 2>{0, 0}));
  EXPECT_TRUE(again.run().to_bytes() == whole.to_bytes());
  EXPECT_THAT(refusal([&] { again.run(); }), HasSubstr("has run"));
  EXPECT_THAT(refusal([&] { again.film(); }), HasSubstr("returned the film"));
}

// While it works, its film can be looked at and stored.
TEST_F(LibraryParts, OfAJobAtWorkAreSound) {
  raio::Settings endless;
  endless.set("size", {300, 200}).set("samples", 1 << 20).set("threads", 2);
  raio::Job job(scene(), endless);
  std::atomic<bool> seen = false;
  std::thread watcher([&] {
    const auto patience = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!seen && std::chrono::steady_clock::now() < patience) {
      const raio::Film film = job.film();
      seen = film.samples()[1] > 0;
      if (!seen) continue;
      const raio::Film back = raio::Film::from_bytes(film.to_bytes());
      EXPECT_EQ(back.rgba(), film.rgba());
      EXPECT_FALSE(film.complete());
    }
    job.cancel();
  });
  EXPECT_THROW(job.run(), raio::Error);
  watcher.join();
  EXPECT_TRUE(seen);
  EXPECT_GT(job.film().samples()[1], 0u);
}

// The limit is long enough for a sample of each pixel, even on a busy machine.
raio::Film rendered_in_time(raio::Settings settings) {
  for (double seconds = 0.3;; seconds *= 2) try {
      return rendered(settings.set("time-limit", seconds));
    } catch (const raio::Error& error) {
      if (error.kind() != raio::ErrorKind::no_resource || seconds > 30) throw;
    }
}

TEST_F(LibraryParts, EndedByATimeLimitSayTheirSamples) {
  const raio::Film film = rendered_in_time(twelve().set("samples", 1 << 20));
  EXPECT_TRUE(film.complete()) << film.missing();
  EXPECT_GT(film.samples()[0], 0u);
  EXPECT_LT(film.samples()[1], 1u << 20);
  EXPECT_EQ(film.settings().get("samples"), std::to_string(film.samples()[0]));
  EXPECT_TRUE(picture(rendered(film.settings())) == picture(film));

  // Cells of pixels have no first ones: the picture says how many it has.
  const raio::Film cells = rendered_in_time(raio::Settings().set("size", {40, 30}).set("aa", 200));
  EXPECT_FALSE(cells.complete());
  EXPECT_NO_THROW((void)picture(cells));

  raio::Job late(scene(), raio::Settings().set("size", {2000, 1500}).set("time-limit", 0.001));
  try {
    late.run();
    FAIL() << "it had enough time";
  } catch (const raio::Error& error) {
    EXPECT_EQ(error.kind(), raio::ErrorKind::no_resource);
  }
  EXPECT_EQ(late.film().samples()[0], 0u);
}

TEST_F(LibraryParts, AreCheckpointsToo) {
  const raio::Settings settings = twelve().set("checkpoint", path("c.raio"));
  const raio::Film film = rendered(settings);
  EXPECT_TRUE(raio::Film::read(path("c.raio")).to_bytes() == film.to_bytes());
  EXPECT_THAT(refusal([&] { rendered(settings); }), HasSubstr("add resume to continue it"));
  const raio::Settings again = raio::Settings(settings).set("resume");
  EXPECT_TRUE(rendered(again).to_bytes() == film.to_bytes());
  EXPECT_THAT(refusal([&] { raio::Job(scene(), again, film); }),
              HasSubstr("there is a film to continue"));
}

TEST_F(LibraryParts, AreAnnotatedAsPictures) {
  raio::Film film = raio::Job(scene(), twelve()).run();
  const auto plain = film.display();
  const auto light = film.rgba();
  // Of 70 pixels, at the distance of the point looked at.
  EXPECT_NEAR(film.pixels_per_unit(), 35 / (std::sqrt(97) * 0.36397), 1e-3);
  raio::Annotations wanted;
  wanted.color_bar = raio::ColorScale{"speed", 0, 2, raio::colormap("plasma")};
  wanted.scale_bar = {film.pixels_per_unit(), "nm"};
  if (const std::string why = raio::drawing_problem(); !why.empty()) {
    EXPECT_THROW(film.annotate(wanted), raio::Error);
    GTEST_SKIP() << why;
  }
  film.annotate(wanted);
  const auto drawn = film.display();
  EXPECT_NE(drawn, plain);
  EXPECT_EQ(film.rgba(), light);
  EXPECT_EQ(raio::Film(film).display(), drawn);
  raio::Film read = raio::Film::from_bytes(film.to_bytes());
  EXPECT_EQ(read.display(), plain);
  EXPECT_THAT(refusal([&] { read.annotate({.scale_bar = {{read.pixels_per_unit(), "nm"}}}); }),
              HasSubstr("size of a scene unit in it is unknown"));
  EXPECT_EQ(read.annotate(wanted).display(), drawn);
  EXPECT_THAT(refusal([&] { film.annotate({.legend = {{"one", {1, 0, 0}}}}); }),
              HasSubstr("100x70 pixels has no room for a legend"));
  wanted.color_bar->colors.pop_back();
  EXPECT_THAT(refusal([&] { film.annotate(wanted); }), HasSubstr("found 767 numbers"));
  EXPECT_EQ(film.display(), drawn);
}

TEST_F(LibraryParts, AreDisplayedWithAnotherExposure) {
  const auto display = [&](const raio::Film& film) {
    film.write(path("a.png"));
    return get(path("a.png"));
  };
  raio::Settings settings = raio::Settings().set("size", {40, 30}).set("samples", 4);
  const raio::Film plain = rendered(settings);
  raio::Film bright = plain;
  bright.set("exposure", 1.5);
  EXPECT_EQ(bright.rgba(), plain.rgba());
  EXPECT_EQ(bright.settings().get("exposure"), "1.5");
  EXPECT_TRUE(display(bright) != display(plain));
  EXPECT_TRUE(display(bright) == display(rendered(settings.set("exposure", 1.5))));
  EXPECT_TRUE(display(bright.set("exposure", 0)) == display(plain));
  bright.set("exposure", 1.5).set("tone", "agx");
  EXPECT_TRUE(display(bright) == display(rendered(settings.set("tone", "agx"))));
  EXPECT_THAT(refusal([&] { bright.set("depth", 2); }), HasSubstr("cannot change depth, only"));
  EXPECT_THAT(refusal([&] { bright.set("tone", "loud"); }), HasSubstr("expected none, srgb"));
  raio::Film normals = rendered(raio::Settings().set("size", {40, 30}).set("view", "normals"));
  EXPECT_THAT(refusal([&] { normals.set("exposure", 1); }), HasSubstr("has no effect with view"));
}

// With instances, a mesh and colours.
raio::Scene rich_scene(const std::shared_ptr<const void>& keep) {
  static const Floats kCenters = {0, 0, 0, 1, 0, 0.5f}, kRadii = {0.5f, 0.25f};
  static const Floats kColors = {1, 0, 0, 0, 1, 0.5f};
  static const Floats kMatrices = {1, 0,  0, -2, 0, 1, 0, 0, 0, 0, 1, 0,
                                   0, -1, 0, 2,  1, 0, 0, 0, 0, 0, 1, 0};
  static const Floats kCorners = {-1, -1, -0.4f, 1, -1, -0.4f, 0, 1, -0.4f};
  static const uint32_t kTriangle[] = {0, 1, 2};
  raio::Scene object, made = scene();
  raio::Appearance look;
  look.colors = {kColors.data(), 2, 12, keep};
  object.add_spheres({kCenters.data(), 2, 12, keep}, {kRadii.data(), 2, 4, keep}, look);
  object.add_triangles({kCorners.data(), 3, 12, keep}, {kTriangle, 1, 12, keep});
  made.add_instances(made.add_prototype(object), {kMatrices.data(), 2, 48, keep}, "pair");
  made.add_triangles({kCorners.data(), 3, 12, keep}, {kTriangle, 1, 12, keep});
  return made;
}

TEST(LibrarySceneBytes, ComeBack) {
  const raio::Settings settings =
      raio::Settings().set("size", {48, 36}).set("channels", "object,id,depth");
  const auto keep = std::make_shared<int>();
  for (const bool borrowed : {false, true}) {
    const raio::Scene made = rich_scene(borrowed ? keep : nullptr);
    EXPECT_EQ(keep.use_count() > 1, borrowed);
    const std::string bytes = made.to_bytes();
    const auto kept = std::make_shared<const std::string>(bytes);
    const raio::Scene in_place = raio::Scene::from_bytes(*kept, kept);
    EXPECT_GT(kept.use_count(), 2);
    std::string passing = bytes;
    const raio::Scene copied = raio::Scene::from_bytes(passing);
    passing.assign(passing.size(), '\xff');
    const std::string film = raio::Job(made, settings).run().to_bytes();
    for (const raio::Scene* back : {&in_place, &copied}) {
      EXPECT_EQ(back->primitive_count(), made.primitive_count());
      EXPECT_EQ(back->bounds(), made.bounds());
      EXPECT_TRUE(back->to_bytes() == bytes);
      EXPECT_TRUE(raio::Job(*back, settings).run().to_bytes() == film);
    }
  }
}

TEST(LibrarySceneBytes, AreNotTrusted) {
  const std::string bytes = rich_scene(nullptr).to_bytes();
  for (size_t size = 0; size < bytes.size(); size += 13)
    EXPECT_NE(refusal([&] { raio::Scene::from_bytes(std::string_view(bytes).substr(0, size)); }),
              "nothing was refused")
        << size;
  for (size_t i = 0; i < bytes.size(); ++i) {
    std::string changed = bytes;
    changed[i] = char(changed[i] ^ 1);
    EXPECT_NE(refusal([&] { raio::Scene::from_bytes(changed); }), "nothing was refused") << i;
  }
  EXPECT_EQ(refusal([] { raio::Scene::from_bytes("v\nfrom 0 0 0\n"); }), "not a .raio scene");
  raio::Scene dark = scene();
  dark.add_material({{-1, 0, 0}, 0.6, 0.3, 30, 0, 1});
  EXPECT_NE(refusal([&] { (void)dark.to_bytes(); }), "nothing was refused");
}

TEST(LibrarySettings, TakeValuesAsTheirText) {
  raio::Settings values, texts;
  const int width = 640, height = 480;
  values.set("size", {width, height}).set("aa", 4).set("dof", false).set("soft-shadows", true);
  values.set("light-size", 0.1f).set("shutter", {0, 0.5}).set("crop", {0, 5, 64, 48});
  values.set("from", {0.1, -9, 4}).set("at", raio::Triple{1, 2.5, -1e-7}).set("seed", 4294967295u);
  values.set("grid-resolution", {8, 9, 10}).set("time-limit", 2.5).set("tone", "agx");
  values.set("threads", size_t(3));
  for (const auto& [name, text] : {std::pair("size", "640x480"),
                                   {"aa", "4"},
                                   {"dof", "false"},
                                   {"soft-shadows", "true"},
                                   {"light-size", "0.1"},
                                   {"shutter", "0,0.5"},
                                   {"crop", "0,5,64,48"},
                                   {"from", "0.1,-9,4"},
                                   {"at", "1,2.5,-1e-7"},
                                   {"seed", "4294967295"},
                                   {"grid-resolution", "8x9x10"},
                                   {"time-limit", "2.5"},
                                   {"tone", "agx"},
                                   {"threads", "3"}})
    texts.set(name, text);
  for (const auto& option : raio::Settings::options())
    EXPECT_EQ(values.get(option.name), texts.get(option.name)) << option.name;
  EXPECT_EQ(values.get("size"), "640x480");
  EXPECT_EQ(values.get("from"), "0.1,-9,4");
  EXPECT_EQ(values.get("shutter"), "0,0.5");
  EXPECT_EQ(values.get("dof"), "false");
  EXPECT_EQ(values.get("time-limit"), "2.5");
  // The text is refused.
  EXPECT_THAT(refusal([&] { values.set("aa", 2.5); }), HasSubstr("found '2.5'"));
  EXPECT_THAT(refusal([&] { values.set("aa", true); }), HasSubstr("found 'true'"));
  EXPECT_THAT(refusal([&] { values.set("dof", 1); }), HasSubstr("true or false, found '1'"));
  EXPECT_THAT(refusal([&] { values.set("size", {640, 480, 3}); }), HasSubstr("'640x480x3'"));
  EXPECT_THAT(refusal([&] { values.set("shard", "5/4"); }),
              HasSubstr("shard: expected a part and the number of parts"));
  EXPECT_THAT(refusal([&] { values.set("time-limit", -1); }), HasSubstr("time-limit: expected"));
  EXPECT_THAT(refusal([&] { values.set("sample-range", "4:4"); }), HasSubstr("as in 0:64"));
  EXPECT_THAT(refusal([&] { values.set("shards", 4); }), HasSubstr("unknown setting 'shards'"));
}

}  // namespace
