// The tables of options: every entry by its own fields, and what follows from them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <ranges>

#include "program.h"
#include "render/job_options.h"
#include "render/provenance.h"
#include "render/read_options.h"
#include "scenes.h"

namespace raio::core {
namespace {

using testing::Contains;
using testing::HasSubstr;

// A value of the entry's own form, other than the default.
template <class Options>
std::string other_value(const OptionEntry<Options>& spec) {
  switch (spec.type()) {
    case OptionType::toggle:
      return "true";
    case OptionType::integer:
      return spec.least == spec.most ? "7" : fmt::format("{}", int64_t(spec.most));
    case OptionType::number:
      return fmt::format("{}", float(spec.most));
    case OptionType::words: {
      const auto other = std::ranges::find_if(spec.words, [&](std::string_view word) {
        return word != default_value(spec) && word != spec.text(Options());
      });
      return std::string(*other);
    }
    case OptionType::vector:
      return "1,2.5,-3";
    case OptionType::color:
      return "#102030";
    case OptionType::size:
      return spec.name == "width" ? "88mm" : "640x480";
    case OptionType::list:
      return spec.name == "channels"          ? "depth,normal"
             : spec.name == "crop"            ? "1,2,3,4"
             : spec.name == "grid-resolution" ? "4x5x6"
             : spec.name == "images"          ? "2,1,1"
             : spec.name == "sky"             ? "3,45,120"
                                              : "0.25,0.5";
    case OptionType::text:
      return spec.name == "assembly"      ? "2"
             : spec.name == "color-atoms" ? "chain A: navy; index 0-3: 0.5,0,1"
                                          : "element";
  }
  return {};
}

template <class Options>
void expect_sound_entries(std::span<const OptionEntry<Options>> table) {
  for (const OptionEntry<Options>& spec : table) {
    SCOPED_TRACE(spec.name);
    EXPECT_FALSE(spec.is_given(Options()));
    Options options;
    const bool selects = spec.name == "only" || spec.name == "hide" || spec.name == "show";
    const std::string value = selects ? "water" : other_value(spec);
    const auto set = spec.set(options, value);
    ASSERT_TRUE(set) << set.error();
    EXPECT_TRUE(spec.is_given(options));
    // The text brings the value back.
    Options again;
    ASSERT_TRUE(spec.set(again, spec.text(options)));
    EXPECT_EQ(again, options);
    if (spec.value.reset) {
      spec.value.reset(options);
      EXPECT_EQ(options, Options());
    }
    // Values of another form say which is expected.
    if (spec.type() != OptionType::toggle && spec.type() != OptionType::text) {
      const auto wrong = spec.set(options, "no value");
      if (spec.name != "colormap") {  // checked by the reader
        ASSERT_FALSE(wrong);
        EXPECT_THAT(wrong.error(), HasSubstr("expected "));
      }
    }
    if (spec.type() == OptionType::integer || spec.type() == OptionType::number) {
      EXPECT_FALSE(spec.set(options, "nan"));
      if (spec.least < spec.most) {
        const double below = spec.least > 0 ? spec.least / 2 : spec.least - 1;
        EXPECT_FALSE(spec.set(options, fmt::format("{}", below)));
        EXPECT_FALSE(spec.set(options, fmt::format("{}", spec.most * 2)));
        EXPECT_TRUE(spec.set(options, fmt::format("{}", float(spec.least))));
      }
    }
    // A default that the member has by itself is the one that the help states.
    if (!spec.value.is_optional && !spec.usual.empty() && !default_value(spec).empty()) {
      Options usual;
      ASSERT_TRUE(spec.set(usual, default_value(spec)));
      EXPECT_TRUE(usual == Options() || spec.text(Options()).empty());
    }
    EXPECT_FALSE(spec.help.contains("(default")) << "it has a field of its own";
  }
}

TEST(OptionTable, EntriesFollowTheirFields) {
  expect_sound_entries(render_option_table());
  expect_sound_entries(read_option_table());
}

TEST(OptionTable, HelpIsComposed) {
  EXPECT_EQ(option_help(option_of("fov")),
            "Vertical field of view, in degrees (default: the scene's)");
  EXPECT_EQ(option_help(option_of("depth")),
            "Maximum ray depth; the eye ray is level 1 (default: 5; 16 for paths)");
  EXPECT_EQ(option_help(option_of("occlusion-distance")),
            "Surfaces farther away than D scene units hide no sky, with `integrator` ambient "
            "(default: any distance)");
  EXPECT_EQ(option_help(option_of("no-reflection")),
            "Trace no reflected rays, with `integrator` classic; highlights of the lights stay");
}

TEST(OptionTable, ConstantDefaultsAreValues) {
  const auto value = [](std::string_view name) { return default_value(option_of(name)); };
  EXPECT_EQ(value("depth"), "");
  EXPECT_EQ(value("exposure"), "0");
  EXPECT_EQ(value("accel"), "auto");
  EXPECT_EQ(value("one-sided"), "false");
  for (const char* open : {"dof", "aa", "gloss", "background", "tone", "from", "size", "key-light"})
    EXPECT_EQ(value(open), "") << open;
}

TEST(OptionTable, ErrorsNameRangeAndUnit) {
  RenderOptions o;
  EXPECT_EQ(set_option(o, option_of("fov"), "200").error().text("--"),
            "--fov: expected a number from 0.001 to 179 degrees, found '200'");
  EXPECT_EQ(set_option(o, option_of("seed"), "-1").error().text(),
            "seed: expected a whole number from 0 to 4294967295, found '-1'");
  EXPECT_EQ(set_option(o, option_of("at"), "1,2").error().text(),
            "at: expected 3 numbers as X,Y,Z, each from -1e+30 to 1e+30, found '1,2'");
  EXPECT_EQ(set_option(o, option_of("grid-resolution"), "4x0x4").error().text(),
            "grid-resolution: expected 3 whole numbers as XxYxZ, each from 1 to 1048576, found "
            "'4x0x4'");
  EXPECT_EQ(set_option(o, option_of("key-light"), "yes").error().text(),
            "key-light: expected off, on or scene, found 'yes'");
}

// With each integrator, the options that it ignores are refused, and all others pass.
TEST(OptionTable, IgnoredOptionsAreRefused) {
  Scene scene = tests::random_scene(5, 1);
  for (const auto kind : {IntegratorKind::classic, IntegratorKind::views, IntegratorKind::ambient,
                          IntegratorKind::path}) {
    size_t refused = 0;
    for (const OptionSpec& spec : render_option_table()) {
      if (spec.name == "view" || spec.name == "integrator") continue;
      SCOPED_TRACE(spec.name);
      RenderOptions o;
      o.integrator = kind;
      ASSERT_TRUE(spec.set(o, other_value(spec)));
      const auto why = ignored_option(o, nullptr);
      EXPECT_EQ(why.has_value(), !spec.applies_to(kind));
      if (!why) continue;
      ++refused;
      EXPECT_EQ(why->text("--"), fmt::format("--{}: has no effect with --integrator {}; leave one "
                                             "of them out",
                                             spec.name, integrator_name(kind)));
      EXPECT_EQ(option_conflict(o)->message, why->message);
      drop_ignored_options(o, scene);
      EXPECT_FALSE(ignored_option(o, &scene));
      EXPECT_FALSE(spec.is_given(o));
    }
    EXPECT_GT(refused, 5u);
  }
  // By the scene's default, or by the view.
  RenderOptions o;
  o.key_light = KeyLight::off;
  EXPECT_FALSE(option_conflict(o));
  EXPECT_EQ(option_conflict(o, &scene)->text("--"),
            "--key-light: has no effect with --integrator classic, the default for this scene; "
            "leave it out, or add --integrator ambient or path");
  o = {}, o.view = View::normals, o.soft_shadows = true;
  EXPECT_EQ(option_conflict(o)->text("--"),
            "--soft-shadows: has no effect with --view normals; leave one of them out");
}

TEST(OptionTable, PairsAreRefusedInAnyOrder) {
  for (const OptionSpec& spec : render_option_table()) {
    if (spec.excludes.empty()) continue;
    const OptionSpec& other = option_of(spec.excludes);
    EXPECT_THAT(excluded_by(spec), Contains(other.name));
    EXPECT_THAT(excluded_by(other), Contains(spec.name));
    for (const auto& [first, second] : {std::pair(&spec, &other), {&other, &spec}}) {
      RenderOptions o;
      ASSERT_TRUE(first->set(o, other_value(*first)));
      EXPECT_FALSE(option_conflict(o)) << first->name;
      ASSERT_TRUE(second->set(o, other_value(*second)));
      ASSERT_TRUE(option_conflict(o)) << spec.name;
      EXPECT_EQ(option_conflict(o)->text(),
                fmt::format("{}: cannot be combined with {}; leave one of them out", spec.name,
                            spec.excludes));
    }
  }
}

// Older pictures store options that their integrator ignored: they can be repeated.
TEST(OptionTable, StoredOptionsMayBeIgnored) {
  const Metadata settings = {
      {"version", "1"}, {"scene_hash", "x"}, {"view", "normals"}, {"soft_shadows", "true"}};
  const auto options = options_from(settings);
  ASSERT_TRUE(options) << options.error().text();
  const Scene scene = tests::random_scene(5, 1);
  EXPECT_TRUE(option_conflict(*options, &scene));
  EXPECT_FALSE(option_conflict(*options, &scene, true));
}

using OptionsCommand = CommandLine;

TEST_F(OptionsCommand, PrintsTheTables) {
  const auto o = raio({"options"});
  EXPECT_EQ(o.status, 0);
  const auto json = nlohmann::json::parse(o.out);
  EXPECT_THAT(json["version"].get<std::string>(),
              testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+"));
  std::map<std::string, nlohmann::json> by_name;
  for (const auto& option : json["options"]) by_name[option["name"]] = option;
  EXPECT_EQ(by_name.size(),
            render_option_table().size() + read_option_table().size() + job_option_table().size());

  const auto& fov = by_name["fov"];
  EXPECT_EQ(fov["of"], "rendering");
  EXPECT_EQ(fov["group"], "Camera");
  EXPECT_EQ(fov["type"], "number");
  EXPECT_EQ(fov["value_name"], "DEG");
  EXPECT_EQ(fov["unit"], "degrees");
  EXPECT_EQ(fov["default"], "the scene's");
  EXPECT_TRUE(fov["default_value"].is_null());
  EXPECT_EQ(fov["minimum"], 0.001);
  EXPECT_EQ(fov["maximum"], 179);
  EXPECT_EQ(fov["integrators"], nlohmann::json({"classic", "views", "ambient", "path"}));
  EXPECT_EQ(fov["help"], "Vertical field of view, in degrees (default: the scene's)");
  EXPECT_EQ(by_name["depth"]["default_value"], nullptr);
  EXPECT_EQ(by_name["depth"]["integrators"], nlohmann::json({"classic", "path"}));
  EXPECT_EQ(by_name["one-sided"]["default_value"], false);
  EXPECT_EQ(by_name["one-sided"]["type"], "switch");
  EXPECT_EQ(by_name["key-light"]["words"], nlohmann::json({"off", "on", "scene"}));
  EXPECT_EQ(by_name["samples"]["excludes"], nlohmann::json::array({"lens-samples", "noise"}));
  EXPECT_EQ(by_name["threads"]["affects_picture"], false);
  EXPECT_EQ(by_name["frame"]["of"], "reading");
  EXPECT_EQ(by_name["images"]["default_value"], "1,1,1");
  EXPECT_THAT(o.out, testing::Not(HasSubstr("`")));
}

TEST_F(OptionsCommand, RefusesIgnoredOptionsAtOnce) {
  expect_refusal({"render", "ok.nff", "--view", "normals", "--gloss", "0.1"}, 2,
                 "--gloss: has no effect with --view normals; leave one of them out");
  expect_refusal({"render", "ok.nff", "--look", "dark"}, 2,
                 "--look: has no effect with --integrator classic, the default for this scene; "
                 "leave it out, or add --integrator ambient or path");
  expect_refusal({"render", "ok.nff", "--width", "88mm", "--size", "640x480"}, 2,
                 "--width: cannot be combined with --size; leave one of them out");
}

}  // namespace
}  // namespace raio::core
