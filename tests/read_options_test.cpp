// Options of reading as texts, and as pictures keep them.
#include "render/read_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/srgb.h"
#include "data_files.h"
#include "render/provenance.h"

namespace raio::core {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

// Each field with a value other than the default. A new field of ReadOptions goes here, and gets a
// row of the table or a reason why it needs none.
ReadOptions unusual() {
  ReadOptions o = kForPictures;
  auto& [style, color_by, colormap, color_range, smooth, color_atoms, radius, assembly, frame,
         atom_style, cell, images, only, hide, show, environment, sky, environment_rotation,
         hide_solvent, instances, labels, folder, cache] = o;
  style = AtomStyle::sticks, color_by = "forces.1", colormap = "plasma";
  color_range = {0.1, -2e10}, smooth = 12.5F, radius = 0.3F, assembly = 0, frame = -3;
  atom_style = "full", cell = false, images = {2, 1, 3};
  color_atoms = {{"chain A", linear_from_srgb(0xffa500u), "orange"},
                 {"index 0-3", {0.5F, 0, 1}, "0.5,0,1"}};
  only = "not (water, ion)", hide = "hydrogen", show = "residue HEM,5-12";
  environment = "a sky.hdr", sky = {2.5F, 30, -120}, environment_rotation = -12.5F;
  // The program sets these, not the user.
  (void)hide_solvent, (void)instances, (void)labels, (void)folder, (void)cache;
  return o;
}

Metadata stored(const ReadOptions& read) {
  const auto water = parse_scene(kWater, "water.xyz", {});
  return settings_of(water->scene, resolve_options({}, water->scene), read);
}

TEST(ReadOptionsTest, TextsBringThemBack) {
  const ReadOptions all = unusual();
  ReadOptions again = kForPictures;
  for (const ReadOptionSpec& spec : read_option_table()) {
    EXPECT_THAT(spec.text(kForPictures), IsEmpty()) << spec.name;
    const std::string text = spec.text(all);
    EXPECT_NE(text, "") << spec.name;
    EXPECT_TRUE(spec.set(again, text).has_value()) << spec.name;
  }
  EXPECT_EQ(again, all);
  EXPECT_EQ(option_arguments(kForPictures), "");
  EXPECT_EQ(option_arguments({.color_by = "a b", .assembly = 2, .cell = true}),
            " --color-by 'a b' --assembly 2 --cell");
  EXPECT_THAT(option_arguments(all), HasSubstr(" --assembly none"));
  EXPECT_THAT(option_arguments(all), HasSubstr(" --no-cell"));
}

TEST(ReadOptionsTest, ColoursOfAtomsSayWhatIsWrong) {
  const ReadOptionSpec& spec = read_option_of("color-atoms");
  ReadOptions options;
  const auto error = [&](std::string_view text) {
    const auto set = spec.set(options, text);
    return set ? "" : set.error();
  };
  EXPECT_EQ(error(" chain A : red ;; index 1:#f80;"), "");
  EXPECT_EQ(spec.text(options), "chain A: red; index 1: #f80");
  EXPECT_THAT(error("chain A"), HasSubstr("a colon and a colour, as in"));
  EXPECT_THAT(error("chian A: red"), HasSubstr("'chian A', column 1: expected water"));
  EXPECT_THAT(error("chain A: redd"), HasSubstr("did you mean red?"));
  EXPECT_THAT(error("chain A: transparent"),
              HasSubstr("#rrggbb, or three numbers from 0 to 1 as in 0.1,0.2,0.4, found 'transp"));
  EXPECT_THAT(error("chain A: 255,0,0"), HasSubstr("from 0 to 1"));
  EXPECT_THAT(error(" ; "), HasSubstr("expected a selection, a colon and a colour"));
  EXPECT_LT(error("index 1 " + std::string(9000, 'x')).size(), 200u);
  std::string many;
  for (size_t i = 0; i <= kMaxAtomColors; ++i) many += "all: red;";
  EXPECT_THAT(error(many), HasSubstr("at most 255 selections"));
  EXPECT_EQ(spec.text(options), "chain A: red; index 1: #f80") << "errors change nothing";
}

TEST(ReadOptionsTest, PicturesKeepThem) {
  const Metadata settings = stored(unusual());
  EXPECT_EQ(setting(settings, "read_color_by"), "forces.1");
  const auto read = read_options_from(settings);
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(*read, unusual());
  EXPECT_TRUE(options_from(settings).has_value());
  EXPECT_EQ(*read_options_from(stored(kForPictures)), kForPictures);
}

TEST(ReadOptionsTest, SettingsNeedNotBeTrusted) {
  EXPECT_EQ(read_options_from({{"read_color", "x"}}).error().message,
            "its setting read_color: is unknown to this version");
  EXPECT_THAT(read_options_from({{"read_only", "watr"}}).error().message,
              HasSubstr("its setting read_only: column 1: expected water"));
  for (const auto& [key, text] : {std::pair("read_images", "1,1"),
                                  {"read_images", "0,1,1"},
                                  {"read_images", "1,1,1,"},
                                  {"read_color_range", "1,1"},
                                  {"read_color_range", "nan,1"},
                                  {"read_radius", "-1"},
                                  {"read_radius", "nan"},
                                  {"read_assembly", "0"},
                                  {"read_frame", "1:2"},
                                  {"read_style", "balls"},
                                  {"read_smooth", "181"}})
    EXPECT_THAT(read_options_from({{key, text}}).error().message, HasSubstr("expected")) << text;
}

}  // namespace
}  // namespace raio::core
