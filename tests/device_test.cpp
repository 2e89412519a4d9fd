// The device of ANARI without its SDK: what applications create, set, commit and render, and what
// they do wrong.
#include <gtest/gtest.h>
#include <raio/raio.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <mutex>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "device/frame.h"
#include "device/objects.h"
#include "device/parameters.h"
#include "device/world.h"

namespace {

using raio::device::Array;
using raio::device::DataType;
using raio::device::Device;
using raio::device::Frame;
using raio::device::Object;
using raio::device::Severity;
using enum raio::device::DataType;

using Point = std::array<float, 3>;

// A device with the calls of an application.
struct Application {
  std::mutex mutex;  // frames report, too
  std::vector<Device::Message> messages;
  Device device{[this](const Device::Message& m) {
    const std::lock_guard lock(mutex);
    messages.push_back(m);
  }};

  Object* create(DataType type, const char* subtype = "") { return device.create(type, subtype); }
  template <class T>
  void set(const void* object, const char* name, DataType type, const T& value) {
    device.set(object, name, type, &value);
  }
  void set(const void* object, const char* name, const char* word) {
    device.set(object, name, string, word);
  }
  void set(const void* object, const char* name, const Object* value) {
    device.set(object, name, value->type, &value);
  }
  // The device's own copy.
  template <class T>
  Object* array(DataType element, const std::vector<T>& values) {
    Object* const array =
        device.create_array(array1d, nullptr, nullptr, nullptr, element, {values.size(), 1, 1});
    std::memcpy(device.map(array), values.data(), values.size() * sizeof(T));
    device.unmap(array);
    return array;
  }
  template <class T>
  void set(const void* object, const char* name, DataType element, const std::vector<T>& values) {
    Object* const a = array(element, values);
    set(object, name, a);
    device.release(a);
  }
  void commit(const void* object) { device.commit(object); }

  Object* surface(Object* geometry, Object* material) {
    commit(geometry), commit(material);
    Object* const s = create(DataType::surface);
    set(s, "geometry", geometry), set(s, "material", material);
    commit(s);
    return s;
  }
  Object* matte(Point color) {
    Object* const m = create(DataType::material, "matte");
    set(m, "color", float32_vec3, color);
    return m;
  }
  Object* spheres(const std::vector<Point>& centers, float radius) {
    Object* const g = create(DataType::geometry, "sphere");
    set(g, "vertex.position", float32_vec3, centers);
    set(g, "radius", float32, radius);
    return g;
  }
  Object* world(const std::vector<Object*>& surfaces, const std::vector<Object*>& instances = {}) {
    Object* const w = create(DataType::world);
    if (!surfaces.empty()) set(w, "surface", DataType::surface, surfaces);
    if (!instances.empty()) set(w, "instance", DataType::instance, instances);
    commit(w);
    return w;
  }
  // From (0, 0, 5) towards the origin.
  Frame* frame(Object* world, uint32_t width = 64, uint32_t height = 64) {
    Object* const c = create(DataType::camera, "perspective");
    set(c, "position", float32_vec3, Point{0, 0, 5});
    set(c, "direction", float32_vec3, Point{0, 0, -1});
    commit(c);
    Object* const r = create(DataType::renderer, "default");
    set(r, "ambientRadiance", float32, 1.0f);
    set(r, "pixelSamples", int32, 4);
    commit(r);
    auto* const f = dynamic_cast<Frame*>(create(DataType::frame));
    set(f, "world", world), set(f, "camera", c), set(f, "renderer", r);
    set(f, "size", uint32_vec2, std::array{width, height});
    for (const auto& [name, type] :
         {std::pair("channel.color", float32_vec4), std::pair("channel.depth", float32),
          std::pair("channel.primitiveId", DataType::uint32),
          std::pair("channel.objectId", DataType::uint32),
          std::pair("channel.instanceId", DataType::uint32)})
      set(f, name, data_type, int(type));
    commit(f);
    return f;
  }
  template <class T>
  std::vector<T> pixels(Frame* frame, const char* channel) {
    uint32_t width = 0, height = 0;
    DataType type = unknown;
    const void* const data = frame->map(channel, &width, &height, &type);
    std::vector<T> out(size_t(width) * height * raio::device::size_of(type) / sizeof(T));
    if (!out.empty()) std::memcpy(out.data(), data, out.size() * sizeof(T));
    return out;
  }
  std::vector<float> render(Frame* frame) {
    frame->render({});
    frame->ready(true);
    return pixels<float>(frame, "channel.color");
  }
  std::string all_messages() const {
    std::string out;
    for (const auto& m : messages) out += m.text + "\n";
    return out;
  }
};

// A film from the bottom.
std::vector<float> flipped(const std::vector<float>& rows, size_t row) {
  std::vector<float> out;
  for (size_t y = rows.size() / row; y-- > 0;)
    out.insert(out.end(), rows.begin() + ptrdiff_t(y * row),
               rows.begin() + ptrdiff_t((y + 1) * row));
  return out;
}

TEST(Device, PictureHasTheLibrarysBytes) {
  Application app;
  std::vector<Point> centers, colors;
  std::vector<float> radii;
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0, 1);
  for (int i = 0; i < 200; ++i) {
    centers.push_back({unit(random) * 4 - 2, unit(random) * 4 - 2, unit(random) * 2 - 1});
    colors.push_back({unit(random), unit(random), unit(random)});
    radii.push_back(0.1f + 0.2f * unit(random));
  }
  Object* const g = app.create(geometry, "sphere");
  app.set(g, "vertex.position", float32_vec3, centers), app.set(g, "vertex.radius", float32, radii);
  app.set(g, "vertex.color", float32_vec3, colors);
  Object* const m = app.create(material, "matte");
  app.set(m, "color", "color");
  Frame* const frame = app.frame(app.world({app.surface(g, m)}), 80, 60);
  const std::vector<float> found = app.render(frame);

  raio::Scene scene;
  scene.set_figure(true);
  raio::Material white;
  white.color = {1, 1, 1}, white.kd = 1;
  raio::Appearance look = scene.add_material(white);
  look.colors = {colors.data()->data(), colors.size()};
  scene.add_spheres({centers.data()->data(), centers.size()}, {radii.data(), radii.size()}, look);
  raio::Settings settings;
  settings.set("size", {80, 60})
      .set("from", {0, 0, 5})
      .set("at", {0, 0, 4})
      .set("up", {0, 1, 0})
      .set("fov", 60);
  settings.set("integrator", "ambient")
      .set("look", "matte-1")
      .set("sky-light", {1, 1, 1})
      .set("key-light", "off");
  settings.set("samples", 4).set("background", "transparent");
  std::vector<float> expected = flipped(raio::Job(scene, settings).run().rgba(), 80 * 4);
  for (size_t i = 3; i < expected.size(); i += 4) expected[i] = 1;
  EXPECT_TRUE(found == expected);
  EXPECT_EQ(app.all_messages(), "");
}

TEST(Device, DepthAndNumbersOfPixels) {
  Application app;
  Object* const a = app.surface(app.spheres({{-1, 0, 0}, {1, 0, 0}}, 0.8f), app.matte({1, 0, 0}));
  app.set(a, "id", DataType::uint32, 7u), app.commit(a);
  Frame* const frame = app.frame(app.world({a}), 65, 65);
  app.render(frame);
  const auto depth = app.pixels<float>(frame, "channel.depth");
  const auto primitives = app.pixels<uint32_t>(frame, "channel.primitiveId");
  const auto objects = app.pixels<uint32_t>(frame, "channel.objectId");
  // The column of the pixel that looks at (x, 0, 0).
  const auto pixel = [&](double x) {
    return size_t(32 * 65 + std::lround(32 + x / (2 * 5 * std::tan(std::numbers::pi / 6)) * 65));
  };
  EXPECT_EQ(primitives[pixel(-1)], 0u);
  EXPECT_EQ(primitives[pixel(1)], 1u);
  EXPECT_EQ(primitives[0], 0xffffffffu);
  EXPECT_EQ(objects[pixel(1)], 7u);
  EXPECT_TRUE(std::isinf(depth[0]));
  EXPECT_NEAR(double(depth[pixel(1)]), std::sqrt(26.0) - 0.8, 0.01);
}

TEST(Device, InstancesHaveTheirNumbersAndColours) {
  Application app;
  Object* const group = app.create(DataType::group);
  app.set(group, "surface", DataType::surface,
          std::vector{app.surface(app.spheres({{0, 0, 0}}, 0.5f), app.matte({1, 1, 1}))});
  app.commit(group);
  std::vector<Object*> instances;
  for (const float x : {-1.0f, 1.0f}) {
    Object* const i = app.create(DataType::instance, "transform");
    app.set(i, "group", group);
    app.set(i, "transform", float32_mat4,
            std::array<float, 16>{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, x, 0, 0, 1});
    app.set(i, "id", DataType::uint32, x < 0 ? 3u : 9u);
    app.commit(i);
    instances.push_back(i);
  }
  Frame* const frame = app.frame(app.world({}, instances));
  const auto color = app.render(frame);
  const auto ids = app.pixels<uint32_t>(frame, "channel.instanceId");
  const size_t row = 32 * 64;
  EXPECT_EQ(std::count(ids.begin() + row, ids.begin() + row + 64, 3u),
            std::count(ids.begin() + row, ids.begin() + row + 64, 9u));
  EXPECT_EQ(ids[row + 21], 3u);
  EXPECT_EQ(ids[row + 42], 9u);
  EXPECT_FLOAT_EQ(color[4 * (row + 21)], 1);
}

// The look's own light replaces the world's.
TEST(Device, LooksHaveTheLibrarysBytes) {
  Application app;
  Object* const l = app.create(light, "directional");
  app.commit(l);
  Object* const w = app.create(world);
  Object* const s = app.surface(app.spheres({{0, 0, 0}}, 1), app.matte({0.2f, 0.4f, 0.6f}));
  app.set(w, "surface", surface, std::vector{s}), app.set(w, "light", light, std::vector{l});
  app.commit(w);
  Frame* const frame = app.frame(w, 40, 40);
  Object* const r = app.create(renderer, "default");
  app.set(r, "look", "paper"), app.set(r, "pixelSamples", int32, 4);
  app.set(r, "background", float32_vec4, std::array<float, 4>{0, 0, 0, 0});
  app.commit(r), app.set(frame, "renderer", r), app.commit(frame);

  raio::Scene scene;
  scene.set_figure(true);
  raio::Material blue;
  blue.color = {double(0.2f), double(0.4f), double(0.6f)}, blue.kd = 1;
  const float radius = 1, center[] = {0, 0, 0};
  scene.add_spheres({center, 1}, {&radius, 1}, scene.add_material(blue));
  raio::Settings settings;
  settings.set("size", {40, 40}).set("from", {0, 0, 5}).set("at", {0, 0, 4}).set("up", {0, 1, 0});
  settings.set("fov", 60).set("samples", 4).set("background", "transparent").set("look", "paper");
  EXPECT_TRUE(app.render(frame) == flipped(raio::Job(scene, settings).run().rgba(), 40 * 4));
  EXPECT_EQ(app.all_messages(), "");
}

// A ball of each, by the renderer `path`, has the bytes of the library's material.
TEST(Device, PathsShowPhysicalMaterials) {
  using Set = std::vector<std::pair<const char*, float>>;
  using M = raio::StandardMaterial;
  const auto compare = [](const Set& numbers, const Set& colors, M expected) {
    Application app;
    Object* const m = app.create(material, "physicallyBased");
    for (const auto& [name, x] : numbers) app.set(m, name, float32, x);
    for (const auto& [name, x] : colors) app.set(m, name, float32_vec3, Point{x, 0.5f, x});
    Frame* const frame =
        app.frame(app.world({app.surface(app.spheres({{0, 0, 0}}, 1), m)}), 40, 40);
    Object* const r = app.create(renderer, "path");
    app.set(r, "pixelSamples", int32, 4);
    app.set(r, "background", float32_vec4, std::array<float, 4>{0, 0, 0, 0});
    app.commit(r), app.set(frame, "renderer", r), app.commit(frame);

    raio::Scene scene;
    scene.set_figure(true);
    expected.alpha_mode = raio::AlphaMode::opaque;
    const float radius = 1, center[] = {0, 0, 0};
    scene.add_spheres({center, 1}, {&radius, 1}, scene.add_material(expected));
    raio::Settings settings;
    settings.set("size", {40, 40}).set("from", {0, 0, 5}).set("at", {0, 0, 4}).set("up", {0, 1, 0});
    settings.set("fov", 60).set("samples", 4).set("background", "transparent");
    settings.set("integrator", "path").set("look", "matte-1").set("sky-light", {1, 1, 1});
    settings.set("key-light", "off");
    EXPECT_TRUE(app.render(frame) == flipped(raio::Job(scene, settings).run().rgba(), 40 * 4))
        << (numbers.empty() ? "" : numbers[0].first);
    EXPECT_EQ(app.all_messages(), "");
  };
  compare({}, {}, {.color = {1, 1, 1}, .metallic = 1, .roughness = 1, .specular = 0, .thin = true});
  compare({{"metallic", 0}, {"roughness", 0.25f}, {"specular", 1}, {"ior", 1.75f}},
          {{"baseColor", 0.25f}, {"specularColor", 0.75f}, {"emissive", 0.125f}},
          {.color = {0.25, 0.5, 0.25},
           .roughness = 0.25,
           .ior = 1.75,
           .specular_color = {0.75, 0.5, 0.75},
           .thin = true,
           .emission = {0.125, 0.5, 0.125}});
  compare({{"transmission", 0.75f},
           {"metallic", 0},
           {"roughness", 0},
           {"specular", 1},
           {"thickness", 1},
           {"attenuationDistance", 2}},
          {{"attenuationColor", 0.25f}},
          {.color = {1, 1, 1},
           .roughness = 0,
           .transmission = 0.75,
           .attenuation_color = {0.25, 0.5, 0.25},
           .attenuation_distance = 2});
  compare({{"clearcoat", 0.5f}, {"clearcoatRoughness", 0.25f}, {"sheenRoughness", 0.5f}},
          {{"sheenColor", 0.25f}},
          {.color = {1, 1, 1},
           .metallic = 1,
           .roughness = 1,
           .specular = 0,
           .thin = true,
           .clearcoat = 0.5,
           .clearcoat_roughness = 0.25,
           .sheen_color = {0.25, 0.5, 0.25},
           .sheen_roughness = 0.5});
}

// Samplers of other parameters become textures of the material, too.
TEST(Device, PathsShowImagesOfMaterials) {
  Application app;
  Object* const g = app.create(geometry, "quad");
  const std::vector<Point> corners = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  const std::vector<std::array<float, 2>> places = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  app.set(g, "vertex.position", float32_vec3, corners);
  app.set(g, "vertex.attribute0", float32_vec2, places);
  const auto picture = [&](std::array<float, 2> left_right, float metal) {
    Object* const m = app.create(material, "physicallyBased");
    const auto image = [&](const char* name, std::array<Point, 2> texels) {
      Object* const a =
          app.device.create_array(array2d, nullptr, nullptr, nullptr, float32_vec3, {2, 1, 1});
      std::memcpy(app.device.map(a), texels.data(), sizeof texels);
      app.device.unmap(a);
      Object* const s = app.create(sampler, "image2D");
      app.set(s, "image", a), app.set(s, "filter", "nearest"), app.commit(s), app.set(m, name, s);
    };
    const auto both = [&](float x) { return Point{x, x, x}; };
    image("baseColor", {both(0.5f), both(0.5f)});
    image("metallic", {both(0), both(metal)});
    image("roughness", {both(0.3f), both(1)});
    image("emissive", {both(left_right[0]), both(left_right[1])});
    Frame* const frame = app.frame(app.world({app.surface(g, m)}), 40, 40);
    Object* const r = app.create(renderer, "path");
    app.set(r, "pixelSamples", int32, 64), app.set(r, "ambientRadiance", float32, 1e-3f);
    app.commit(r), app.set(frame, "renderer", r), app.commit(frame);
    return app.render(frame);
  };
  const std::vector<float> pixels = picture({0.5f, 3}, 1);
  EXPECT_NEAR(pixels[4 * (20 * 40 + 16)], 0.5f, 0.02f);
  EXPECT_NEAR(pixels[4 * (20 * 40 + 23)], 3, 0.1f);
  EXPECT_NE(picture({0.5f, 3}, 0), pixels);
  EXPECT_NE(app.all_messages().find("'metallic' is taken from the first primitive, except by"),
            std::string::npos);
}

TEST(Device, MaterialsSayWhatPathsDoNotShow) {
  Application app;
  Object* const m = app.create(material, "physicallyBased");
  Object* const g = app.spheres({{0, 0, 0}, {1, 0, 0}}, 0.5f);
  app.set(g, "primitive.attribute0", float32, std::vector<float>{0.25f, 0.75f});
  app.set(m, "roughness", "attribute0");
  app.set(m, "clearcoat", float32, 2.0f);
  app.set(m, "iridescence", float32, 1.0f);
  app.render(app.frame(app.world({app.surface(g, m)})));
  const std::string messages = app.all_messages();
  for (const char* expected :
       {"'iridescence' is not supported", "'roughness' is taken from the first",
        "'clearcoat' is cut to 0 to 1"})
    EXPECT_NE(messages.find(expected), std::string::npos) << messages;
}

TEST(Device, ViewsShowNormals) {
  Application app;
  Frame* const frame = app.frame(
      app.world({app.surface(app.spheres({{0, 0, 0}}, 1), app.matte({1, 0, 0}))}), 33, 33);
  Object* const r = app.create(renderer, "views");
  app.set(r, "view", "normals");
  app.commit(r), app.set(frame, "renderer", r), app.commit(frame);
  const std::vector<float> pixels = app.render(frame);
  const float* const middle = &pixels[4 * (16 * 33 + 16)];  // its normal is +z
  EXPECT_NEAR(middle[0], 0.5f, 0.03f);
  EXPECT_NEAR(middle[1], 0.5f, 0.03f);
  EXPECT_GT(middle[2], 0.9f);
  EXPECT_EQ(app.all_messages(), "");
}

TEST(Device, OptionsOfTheEnvironmentAreChecked) {
  Application app;
  Frame* const frame = app.frame(
      app.world({app.surface(app.spheres({{0, 0, 0}}, 1), app.matte({1, 1, 1}))}), 20, 20);
  ASSERT_EQ(setenv("RAIO_OPTIONS", "size=4x4 samples=many outline=2 nothing=1", 1), 0);
  const std::vector<float> outlined = app.render(frame);
  unsetenv("RAIO_OPTIONS");
  EXPECT_EQ(outlined.size(), 4u * 20 * 20);
  EXPECT_FALSE(outlined == app.render(frame));
  for (const char* name : {"size cannot be set here", "samples", "nothing"})
    EXPECT_NE(app.all_messages().find(name), std::string::npos) << app.all_messages();
}

// Of the same points: indices, soups and other types of the same numbers.
TEST(Device, EqualGeometriesHaveEqualPictures) {
  const std::vector<Point> corners = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0.5f}};
  const auto picture = [&](auto fill, const char* subtype = "triangle") {
    Application app;
    Object* const g = app.create(geometry, subtype);
    fill(app, g);
    const auto out =
        app.render(app.frame(app.world({app.surface(g, app.matte({0.5f, 0.7f, 0.9f}))}), 32, 32));
    EXPECT_EQ(app.all_messages(), "");
    return out;
  };
  const auto indexed = picture([&](Application& app, Object* g) {
    app.set(g, "vertex.position", float32_vec3, corners);
    app.set(g, "primitive.index", uint32_vec3,
            std::vector<std::array<uint32_t, 3>>{{0, 1, 3}, {1, 2, 3}});
  });
  EXPECT_TRUE(indexed == picture([&](Application& app, Object* g) {
                app.set(g, "vertex.position", float32_vec3,
                        std::vector{corners[0], corners[1], corners[3], corners[1], corners[2],
                                    corners[3]});
              }));
  EXPECT_TRUE(indexed == picture([&](Application& app, Object* g) {
                app.set(g, "vertex.position", float32_vec3, corners);
                app.set(g, "primitive.index", uint64_vec3,
                        std::vector<std::array<uint64_t, 3>>{{0, 1, 3}, {1, 2, 3}});
              }));
  EXPECT_TRUE(indexed ==
              picture([&](Application& app,
                          Object* g) { app.set(g, "vertex.position", float32_vec3, corners); },
                      "quad"));
  EXPECT_GT(std::ranges::count_if(indexed, [](float x) { return x > 0.4f && x < 0.8f; }), 100);
}

TEST(Device, CapsCloseCylinders) {
  for (const bool closed : {false, true}) {
    Application app;
    Object* const g = app.create(geometry, "cylinder");
    app.set(g, "vertex.position", float32_vec3, std::vector<Point>{{0, 0, 0}, {0, 0, 1}});
    app.set(g, "radius", float32, 0.5f);
    app.set(g, "caps", closed ? "second" : "first");
    Frame* const frame = app.frame(app.world({app.surface(g, app.matte({1, 1, 1}))}), 33, 33);
    app.render(frame);
    EXPECT_NEAR(app.pixels<float>(frame, "channel.depth")[16 * 33 + 16], closed ? 4 : 5, 1e-5);
    EXPECT_EQ(app.pixels<uint32_t>(frame, "channel.primitiveId")[16 * 33 + 16], 0u);
  }
}

TEST(Device, OpacityOfTheThreeModes) {
  // One sphere in front of a white background, with an alpha of 0.4.
  for (const auto& [mode, alpha, expected] :
       {std::tuple("opaque", 0.4f, 0.0f), std::tuple("blend", 0.4f, 0.6f),
        std::tuple("mask", 0.4f, 1.0f), std::tuple("mask", 0.6f, 0.0f)}) {
    Application app;
    Object* const m = app.matte({0, 0, 0});
    app.set(m, "opacity", float32, alpha), app.set(m, "alphaMode", mode);
    Object* const world = app.world({app.surface(app.spheres({{0, 0, 0}}, 1), m)});
    Frame* const frame = app.frame(world, 33, 33);
    Object* const r = app.create(renderer, "default");
    app.set(r, "background", float32_vec4, std::array<float, 4>{1, 1, 1, 1});
    app.commit(r), app.set(frame, "renderer", r), app.commit(frame);
    EXPECT_NEAR(app.render(frame)[4 * (16 * 33 + 16)], expected, 1e-5) << mode << alpha;
  }
}

// A sampler's values on triangles are those of the image.
TEST(Device, TexturesShowTheirTexels) {
  for (const char* filter : {"nearest", "linear"}) {
    Application app;
    Object* const image =
        app.device.create_array(array2d, nullptr, nullptr, nullptr, float32_vec3, {2, 2, 1});
    const std::vector<Point> texels = {
        {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};  // from the lower left
    std::memcpy(app.device.map(image), texels.data(), 48);
    app.device.unmap(image);
    Object* const s = app.create(sampler, "image2D");
    app.set(s, "image", image), app.set(s, "filter", filter), app.commit(s);
    Object* const g = app.create(geometry, "quad");
    app.set(g, "vertex.position", float32_vec3,
            std::vector<Point>{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}});
    app.set(g, "vertex.attribute0", float32_vec2,
            std::vector<std::array<float, 2>>{{0, 0}, {1, 0}, {1, 1}, {0, 1}});
    Object* const m = app.create(material, "matte");
    app.set(m, "color", s);
    const auto pixels = app.render(app.frame(app.world({app.surface(g, m)}), 65, 65));
    // The quad's corners are at 1 / (5 tan 30) of the picture's half.
    const auto at = [&](double x, double y) {
      const auto place = [](double c) {
        return size_t(std::lround(32 + c * 32.5 / (5 * std::tan(std::numbers::pi / 6))));
      };
      const float* const p = &pixels[4 * (place(y) * 65 + place(x))];
      return Point{p[0], p[1], p[2]};
    };
    for (const auto& [x, y, k] : {std::tuple(-0.8, -0.8, 0), std::tuple(0.8, -0.8, 1),
                                  std::tuple(-0.8, 0.8, 2), std::tuple(0.8, 0.8, 3)})
      for (size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(at(x, y)[c], texels[size_t(k)][c], 0.02) << filter << x << y;
    if (filter == std::string("linear")) {
      EXPECT_NEAR(at(0, -0.8)[0], 0.5, 0.1);
    }
  }
}

// A white quadrilateral, far larger than the picture.
TEST(Device, LightsLightInTheirUnits) {
  const auto lit = [](auto fill, const char* subtype) {
    Application app;
    Object* const g = app.create(geometry, "quad");
    app.set(g, "vertex.position", float32_vec3,
            std::vector<Point>{{-99, -99, 0}, {99, -99, 0}, {99, 99, 0}, {-99, 99, 0}});
    Object* const s = app.surface(g, app.matte({1, 1, 1}));
    Object* const l = app.create(light, subtype);
    fill(app, l);
    app.commit(l);
    Object* const w = app.create(world);
    app.set(w, "surface", surface, std::vector{s}), app.set(w, "light", light, std::vector{l});
    app.commit(w);
    Frame* const frame = app.frame(w, 33, 33);
    Object* const r = app.create(renderer, "default");
    app.set(r, "ambientRadiance", float32, 0.0f);
    app.set(r, "ambientColor", float32_vec3, Point{0, 0, 0});
    app.commit(r), app.set(frame, "renderer", r), app.commit(frame);
    const float out = app.render(frame)[4 * (16 * 33 + 16)];
    EXPECT_EQ(app.all_messages(), "");
    return double(out);
  };
  const double pi = std::numbers::pi;
  EXPECT_NEAR(lit([](Application& app, Object* l) { app.set(l, "irradiance", float32, 2.0f); },
                  "directional"),
              2 / pi, 1e-4);
  const auto above = [](Application& app, Object* l) {
    app.set(l, "position", float32_vec3, Point{0, 0, 2});
    app.set(l, "intensity", float32, 3.0f);
  };
  EXPECT_NEAR(lit(above, "point"), 3 / (4 * pi), 1e-3);
  // A cone narrower than its border: a spot whose light falls off from its middle.
  const double spot = lit(
      [&](Application& app, Object* l) {
        above(app, l);
        app.set(l, "openingAngle", float32, 0.1f);
      },
      "spot");
  EXPECT_GT(spot, 0.05);
  EXPECT_LT(spot, 3 / (4 * pi));
  EXPECT_NEAR(lit(
                  [](Application& app, Object* l) {
                    Object* const image = app.device.create_array(array2d, nullptr, nullptr,
                                                                  nullptr, float32_vec3, {2, 1, 1});
                    const std::array<float, 6> half = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
                    std::memcpy(app.device.map(image), half.data(), sizeof half);
                    app.device.unmap(image);
                    app.set(l, "radiance", image);
                  },
                  "hdri"),
              0.5, 1e-3);
}

TEST(Device, AccumulationEqualsOneLongFrame) {
  Application app;
  Object* const world =
      app.world({app.surface(app.spheres({{-1, 0, 0}, {1, 0, 0}}, 0.9f), app.matte({1, 1, 1}))});
  Frame* const frame = app.frame(world, 40, 40);
  app.set(frame, "accumulation", boolean, true), app.commit(frame);
  for (int k = 0; k < 3; ++k) app.render(frame);
  const auto found = app.render(frame);
  Frame* const once = app.frame(world, 40, 40);
  Object* const r = app.create(renderer, "default");
  app.set(r, "ambientRadiance", float32, 1.0f), app.set(r, "pixelSamples", int32, 16),
      app.commit(r);
  app.set(once, "renderer", r), app.commit(once);
  EXPECT_TRUE(found == app.render(once));
}

TEST(Device, SharedMemoryIsReadInPlaceAndGivenBack) {
  static int given_back;
  given_back = 0;
  std::vector<Point> centers = {{0, 0, 0}, {1, 0, 0}};
  {
    Application app;
    Object* const a = app.device.create_array(array1d, centers.data(),
                                              [](const void*, const void*) { ++given_back; },
                                              nullptr, float32_vec3, {2, 1, 1});
    Object* const g = app.create(geometry, "sphere");
    app.set(g, "vertex.position", a);
    app.device.release(a);
    Object* const world = app.world({app.surface(g, app.matte({1, 1, 1}))});
    Frame* const frame = app.frame(world);
    const auto before = app.render(frame);
    EXPECT_EQ(given_back, 0);
    // Another array replaces it.
    app.set(g, "vertex.position", float32_vec3, std::vector<Point>{{0, 0, 0}});
    app.commit(g);
    EXPECT_FALSE(before == app.render(frame));
    app.render(frame);
  }
  EXPECT_EQ(given_back, 1);
}

TEST(Device, MemoryWithoutDeleterIsCopiedAtTheRelease) {
  Application app;
  auto centers =
      std::make_unique<std::array<Point, 2>>(std::array<Point, 2>{{{-1, 0, 0}, {1, 0, 0}}});
  Object* const a =
      app.device.create_array(array1d, centers.get(), nullptr, nullptr, float32_vec3, {2, 1, 1});
  Object* const g = app.create(geometry, "sphere");
  app.set(g, "vertex.position", a);
  Frame* const frame = app.frame(app.world({app.surface(g, app.matte({1, 1, 1}))}));
  const auto before = app.render(frame);
  app.device.release(a);
  std::memset(centers->data(), 0, sizeof *centers);
  centers = nullptr;
  EXPECT_TRUE(before == app.render(frame));
}

TEST(Device, MappedMemoryChangesTheNextFrame) {
  Application app;
  Object* const a = app.array(float32_vec3, std::vector<Point>{{-1, 0, 0}, {1, 0, 0}});
  Object* const g = app.create(geometry, "sphere");
  app.set(g, "vertex.position", a);
  app.set(g, "radius", float32, 0.3f);
  Frame* const frame = app.frame(app.world({app.surface(g, app.matte({1, 1, 1}))}), 33, 33);
  app.render(frame);
  EXPECT_EQ(app.pixels<uint32_t>(frame, "channel.primitiveId")[16 * 33 + 16], 0xffffffffu);
  static_cast<Point*>(app.device.map(a))[1] = {0, 0, 0};
  app.device.unmap(a);
  app.render(frame);
  EXPECT_EQ(app.pixels<uint32_t>(frame, "channel.primitiveId")[16 * 33 + 16], 1u);
}

TEST(Device, CallbackAndDiscard) {
  Application app;
  Frame* const frame = app.frame(
      app.world({app.surface(app.spheres({{0, 0, 0}}, 1), app.matte({1, 1, 1}))}), 400, 400);
  std::atomic<int> calls = 0;
  frame->render([&] { ++calls; });
  frame->ready(true);
  EXPECT_EQ(calls, 1);
  Object* const r = app.create(renderer, "default");
  app.set(r, "pixelSamples", int32, 65536), app.commit(r);
  app.set(frame, "renderer", r), app.commit(frame);
  frame->render([&] { ++calls; });
  EXPECT_FALSE(frame->ready(false));
  frame->discard();
  EXPECT_TRUE(frame->ready(true));
  EXPECT_EQ(calls, 2);
  // A release stops a frame, too.
  frame->render({});
  app.device.release(frame);
}

TEST(Device, ErrorsNameWhatWasFoundAndExpected) {
  Application app;
  const auto last = [&] { return app.messages.empty() ? "" : app.messages.back().text; };
  Object* const g = app.create(geometry, "sphere");
  app.set(g, "vertex.position", float32, 1.0f);
  EXPECT_EQ(last(), "sphere: 'vertex.position' has type FLOAT32, expected ARRAY1D");
  app.set(g, "vertex.position", app.array(float32_vec2, std::vector<float>{1, 2}));
  EXPECT_EQ(last(),
            "sphere: 'vertex.position' has elements of type FLOAT32_VEC2, expected FLOAT32_VEC3");
  app.set(g, "glow", float32, 1.0f);
  EXPECT_EQ(last(), "sphere: 'glow' is not supported and ignored");
  const size_t before = app.messages.size();
  app.set(g, "glow", float32, 1.0f);
  EXPECT_EQ(app.messages.size(), before);  // once
  Object* const m = app.create(material, "matte");
  app.set(m, "alphaMode", "glass");
  EXPECT_EQ(last(), "matte: 'alphaMode' is 'glass', expected opaque, blend, mask");
  EXPECT_EQ(
      app.device.create_array(array1d, nullptr, nullptr, nullptr, float32, {~uint64_t(0), 1, 1}),
      nullptr);
  EXPECT_TRUE(last().find("cannot exist") != std::string::npos) << last();
  app.device.release(g);
  app.set(g, "radius", float32, 1.0f);
  EXPECT_TRUE(last().find("released") != std::string::npos) << last();
  auto* const frame = dynamic_cast<Frame*>(app.create(DataType::frame));
  frame->render({});
  EXPECT_EQ(last(), "FRAME: has no 'world'; nothing is rendered");
  app.create(geometry, "isosurface");
  EXPECT_EQ(last(), "GEOMETRY 'isosurface' is not supported and left out");
}

TEST(Device, IndicesBeyondTheVerticesAreErrors) {
  Application app;
  Object* const g = app.create(geometry, "triangle");
  app.set(g, "vertex.position", float32_vec3,
          std::vector<Point>{{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
  app.set(g, "primitive.index", uint32_vec3, std::vector<std::array<uint32_t, 3>>{{0, 1, 3}});
  app.render(app.frame(app.world({app.surface(g, app.matte({1, 1, 1}))})));
  EXPECT_EQ(app.all_messages(), "triangle: primitive 0 refers to vertex 3 of 3\n");
}

TEST(Device, TypesHaveTheirSizesAndNumbers) {
  EXPECT_EQ(raio::device::size_of(float32_mat4), 64u);
  EXPECT_EQ(raio::device::size_of(ufixed8_rgba_srgb), 4u);
  EXPECT_EQ(raio::device::size_of(DataType(12345)), 0u);
  EXPECT_EQ(raio::device::name_of(DataType(1047)), "UFIXED16_VEC4");
  const std::array<uint8_t, 4> rgba = {255, 188, 0, 128};
  const auto* const bytes = reinterpret_cast<const std::byte*>(rgba.data());
  EXPECT_NEAR(raio::device::number_at(bytes, *raio::device::layout_of(ufixed8_rgba_srgb), 1), 0.503,
              0.001);
  EXPECT_NEAR(raio::device::number_at(bytes, *raio::device::layout_of(ufixed8_rgba_srgb), 3),
              128 / 255.0, 1e-9);
  const uint16_t half = 0x3e00;  // 1.5
  EXPECT_EQ(raio::device::number_at(reinterpret_cast<const std::byte*>(&half),
                                    *raio::device::layout_of(DataType(1064)), 0),
            1.5);
  for (int byte = 0; byte < 256; ++byte) {
    const auto b = uint8_t(byte);
    EXPECT_EQ(raio::device::display_byte(raio::device::number_at(
                  reinterpret_cast<const std::byte*>(&b), {raio::device::Scalar::srgb8, 1}, 0)),
              b);
  }
}

// Random calls with right and wrong handles, names, types and sizes.
TEST(Device, MisuseIsReportedAndHarmless) {
  std::atomic<int> frames = 0;  // outlives those of the device
  Application app;
  std::mt19937 random(7);
  const auto pick = [&](const auto& from) { return from[random() % std::size(from)]; };
  static constexpr DataType kTypes[] = {camera, frame,    geometry,     group,   instance,
                                        light,  material, renderer,     surface, sampler,
                                        volume, world,    spatial_field};
  static constexpr const char* kSubtypes[] = {
      "",          "sphere",    "cylinder",        "cone",         "curve",   "triangle",
      "quad",      "matte",     "physicallyBased", "image1D",      "image2D", "image3D",
      "primitive", "transform", "directional",     "point",        "spot",    "quad",
      "ring",      "hdri",      "perspective",     "orthographic", "default", "views",
      "nothing"};
  static constexpr DataType kValues[] = {
      float32,        float32_vec2, float32_vec3, float32_vec4, DataType::uint32,
      uint32_vec2,    uint32_vec3,  uint64_vec3,  float32_mat4, boolean,
      int32,          data_type,    float32_box2, ufixed8_vec4, DataType::uint8,
      uint64_region1, DataType(77), void_pointer};
  std::vector<const void*> handles = {nullptr, &app};
  std::vector<std::string> names = {"nothing"};
  for (const DataType type : kTypes)
    for (const char* subtype : kSubtypes)
      if (const auto* const info = raio::device::object_info(type, subtype))
        for (const auto& p : info->parameters)
          if (p.name != "frameCompletionCallback") names.push_back(p.name);
  std::array<float, 16> numbers;
  const char* const calls = std::getenv("RAIO_CALLS");
  for (int i = 0, n = calls ? std::atoi(calls) : 20000; i < n; ++i) {
    const void* const handle = pick(handles);
    const std::string name = pick(names);
    try {
      switch (random() % 12) {
        case 0:
          handles.push_back(app.create(pick(kTypes), pick(kSubtypes)));
          break;
        case 1: {
          const uint64_t sizes[] = {0, 1, 2, 3, 8, uint64_t(1) << 40, ~uint64_t(0)};
          const DataType type = pick(std::array{array1d, array2d, array3d});
          const DataType element = random() % 3 ? pick(kValues) : pick(kTypes);
          if (const Object* const a =
                  app.device.create_array(type, nullptr, nullptr, nullptr, element,
                                          {pick(sizes), type == array1d ? 1 : random() % 4, 1}))
            handles.push_back(a);
          break;
        }
        case 2:
          app.device.release(handle);
          break;
        case 3:
          if (random() % 8 == 0) app.device.retain(handle);
          break;
        case 4:
        case 5: {
          for (float& x : numbers)
            x = random() % 20 == 0   ? NAN
                : random() % 20 == 0 ? INFINITY
                                     : float(int(random() % 9) - 2);
          app.device.set(handle, name, pick(kValues), random() % 30 ? numbers.data() : nullptr);
          break;
        }
        case 6:
        case 7: {
          const void* const value = pick(handles);
          app.device.set(handle, name, random() % 2 ? object : pick(kTypes), &value);
          break;
        }
        case 8:
          app.device.set(handle, name, string, pick(kSubtypes));
          break;
        case 9:
          app.device.commit(handle);
          break;
        case 10: {
          void* const memory = app.device.map(handle);
          const auto array = memory ? app.device.find<Array>(handle, "an array") : nullptr;
          if (array && array->bytes() < 4096)
            for (uint64_t k = 0; k + 8 <= array->bytes(); k += 8) {
              const void* const value = pick(handles);
              if (is_object(array->element))
                std::memcpy(static_cast<std::byte*>(memory) + k, &value, 8);
              else
                for (int half = 0; half < 2; ++half) {
                  const float x = float(random() % 5);
                  std::memcpy(static_cast<std::byte*>(memory) + k + 4 * half, &x, 4);
                }
            }
          if (random() % 4) app.device.unmap(handle);
          break;
        }
        case 11:
          if (random() % 10) {
            app.device.unset(handle, name);
            break;
          }
          if (const auto frame =
                  std::dynamic_pointer_cast<Frame>(app.device.find(handle, "a frame"))) {
            // A whole frame, whatever was set before.
            if (random() % 2) {
              const std::array<uint32_t, 2> size = {16, 16};
              app.device.set(frame.get(), "size", uint32_vec2, &size);
              Object* const c = app.create(camera, "perspective");
              Object* const r = app.create(renderer, "default");
              Object* const w = app.create(world);
              for (const auto& [members_of, type] :
                   {std::pair("surface", surface), std::pair("instance", instance),
                    std::pair("light", light)}) {
                std::vector<const void*> members(8);
                for (const void*& member : members) member = pick(handles);
                app.set(w, members_of, type, members);
              }
              app.commit(w), app.set(frame.get(), "world", w), app.device.release(w);
              app.set(c, "position", float32_vec3, Point{0, 0, 9});
              app.commit(c), app.commit(r);
              app.set(frame.get(), "camera", c), app.set(frame.get(), "renderer", r);
              app.device.release(c), app.device.release(r);
              app.commit(frame.get());
            }
            const auto size = frame->get("size", std::array<uint32_t, 2>{0, 0});
            if (uint64_t(size[0]) * size[1] > 10000) break;
            frame->render([&] { ++frames; });
            if (random() % 3 == 0) frame->discard();
            if (random() % 3) frame->ready(true);
          }
      }
    } catch (const std::bad_alloc&) {  // the layer above reports it
    }
  }
  EXPECT_GT(frames, 0);
  EXPECT_FALSE(app.messages.empty());
  // The device still works.
  Frame* const frame =
      app.frame(app.world({app.surface(app.spheres({{0, 0, 0}}, 1), app.matte({1, 1, 1}))}));
  EXPECT_GT(app.render(frame)[4 * (32 * 64 + 32)], 0.9f);
}

}  // namespace
