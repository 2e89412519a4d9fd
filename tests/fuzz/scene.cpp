// Scene files: any bytes give errors with a location, or a valid scene that reads back the same
// when written, and every structure gives the same picture.
#include <cstring>

#include "io/nff/nff.h"
#include "render/options.h"
#include "render/render.h"
#include "require.h"

namespace raio::core::fuzz {
namespace {

constexpr size_t kMaxPrimitives = 100, kMaxLights = 10;

Image picture(const Scene& scene, AccelKind kind) {
  RenderOptions options;
  options.accel.kind = kind;
  options.width = options.height = 8;
  options.aa = options.threads = 1;
  options.depth = 4;
  options.soft_shadows = scene.lights.size() % 2 == 0;
  const RenderSettings settings = resolve_options(options, scene);
  const auto accel = build_accel(scene, settings.accel);
  require(accel.has_value(), "a few primitives can be built");
  WorkControl control;
  const auto film = make_film(scene, settings);
  require(film.has_value(), "there is memory for a small picture");
  require(render(scene, **accel, settings, **film, control).finished, "a picture is finished");
  return (*film)->resolve();
}

void check_errors(const Diagnostics& errors) {
  require(!errors.empty() && errors.size() <= kMaxDiagnostics + 1, "the number of errors");
  for (const Diagnostic& d : errors) {
    require(!d.message.empty() && (d.line > 0) == (d.column > 0), "an error has a place");
    for (const char c : d.text()) require(c >= 32 && c < 127, "an error is one line of ASCII");
  }
}

void check_pictures(const Scene& scene) {
  const Image none = picture(scene, AccelKind::none);
  for (const Rgb& pixel : none.pixels) require(is_finite(pixel), "a pixel is finite");
  for (const AccelKind kind : {AccelKind::grid, AccelKind::bvh}) {
    const Image other = picture(scene, kind);
    require(
        std::memcmp(none.pixels.data(), other.pixels.data(), 64 * sizeof(Rgb)) == 0,
        kind == AccelKind::grid ? "the grid sees what there is" : "the tree sees what there is");
  }
}

}  // namespace
}  // namespace raio::core::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace raio::core;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const auto read = parse_nff(text, "fuzz.nff");
  if (!read) return fuzz::check_errors(read.error()), 0;
  const Scene& scene = read->scene;
  fuzz::require(validate(scene).empty(), "what is read is sound");
  const std::string written = write_nff(scene);
  const auto again = parse_nff(written, "fuzz.nff");
  fuzz::require(again.has_value(), "what is written can be read");
  fuzz::require(write_nff(again->scene) == written, "what is read back is the same");
  if (scene.primitive_count() <= fuzz::kMaxPrimitives && scene.lights.size() <= fuzz::kMaxLights)
    fuzz::check_pictures(scene);
  return 0;
}
