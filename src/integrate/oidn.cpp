#include "integrate/oidn.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <exception>

#include "base/executor.h"
#include "base/lazy_library.h"
#include "base/parallel.h"

// The binary interface of the functions in use; no header is needed to build.
extern "C" {
using OidnDevice = struct OidnDeviceOfLibrary*;
using OidnFilter = struct OidnFilterOfLibrary*;
OidnDevice oidnNewDevice(int type);
void oidnSetDeviceBool(OidnDevice device, const char* name, bool value);
void oidnSetDeviceInt(OidnDevice device, const char* name, int value);
int oidnGetDeviceInt(OidnDevice device, const char* name);
void oidnCommitDevice(OidnDevice device);
int oidnGetDeviceError(OidnDevice device, const char** message);
void oidnReleaseDevice(OidnDevice device);
OidnFilter oidnNewFilter(OidnDevice device, const char* type);
void oidnSetSharedFilterImage(OidnFilter filter, const char* name, void* memory, int format,
                              size_t width, size_t height, size_t offset, size_t pixel_stride,
                              size_t row_stride);
void oidnSetFilterBool(OidnFilter filter, const char* name, bool value);
void oidnCommitFilter(OidnFilter filter);
void oidnExecuteFilter(OidnFilter filter);
void oidnReleaseFilter(OidnFilter filter);
}

namespace raio::core {
namespace {

constexpr char kOidn[] = "libOpenImageDenoise.so.2";

class OidnOnProcessor {
 public:
  OidnOnProcessor() : device_(call<kOidn, oidnNewDevice>(1)) {
    call<kOidn, oidnSetDeviceInt>(device_, "numThreads", max_concurrency());
    call<kOidn, oidnSetDeviceBool>(device_, "setAffinity", false);
    call<kOidn, oidnCommitDevice>(device_);
  }
  ~OidnOnProcessor() {
    if (filter_) call<kOidn, oidnReleaseFilter>(filter_);
    call<kOidn, oidnReleaseDevice>(device_);
  }
  OidnOnProcessor(const OidnOnProcessor&) = delete;
  OidnOnProcessor& operator=(const OidnOnProcessor&) = delete;

  std::expected<void, std::string> check() const {
    const char* message = nullptr;
    if (call<kOidn, oidnGetDeviceError>(device_, &message) == 0) return {};
    return std::unexpected(
        fmt::format("Open Image Denoise fails: {}", message ? message : "for an unknown reason"));
  }

  std::string version() const {
    const auto part = [&](const char* name) {
      return call<kOidn, oidnGetDeviceInt>(device_, name);
    };
    return fmt::format("{}.{}.{}", part("versionMajor"), part("versionMinor"),
                       part("versionPatch"));
  }

  // Images of three floats per pixel.
  void run(const std::array<Image*, 4>& images) {
    filter_ = call<kOidn, oidnNewFilter>(device_, "RT");
    constexpr const char* kNames[] = {"color", "albedo", "normal", "output"};
    constexpr int kFloat3 = 3;
    constexpr size_t kNone = 0;  // pixels and rows without gaps
    for (size_t i = 0; i < images.size(); ++i)
      call<kOidn, oidnSetSharedFilterImage>(
          filter_, kNames[i], static_cast<void*>(images[i]->pixels.data()), kFloat3,
          size_t(images[i]->width), size_t(images[i]->height), kNone, kNone, kNone);
    call<kOidn, oidnSetFilterBool>(filter_, "hdr", true);
    call<kOidn, oidnCommitFilter>(filter_);
    call<kOidn, oidnExecuteFilter>(filter_);
  }

 private:
  OidnDevice device_;
  OidnFilter filter_ = nullptr;
};

std::expected<std::string, std::string> load_oidn() try {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): nothing sets it meanwhile
  const char* const named = std::getenv("RAIO_OIDN");
  const char* const file = named && *named ? named : kOidn;
  if (!load_library(file) && (file == named || !load_library("libOpenImageDenoise.so")))
    return std::unexpected(fmt::format("{} cannot be loaded", file));
  const OidnOnProcessor device;
  if (auto sound = device.check(); !sound) return std::unexpected(std::move(sound.error()));
  return device.version();
} catch (const std::exception& error) {  // a function is missing
  return std::unexpected(fmt::format("this Open Image Denoise is not version 2: {}", error.what()));
}

}  // namespace

std::expected<std::string, std::string> oidn_version() {
  static const std::expected<std::string, std::string> kVersion = load_oidn();
  return kVersion;
}

std::expected<void, std::string> denoise_by_oidn(Image& color, const PixelGuides& guides) {
  Image input(color.width, color.height), albedo = input, normal = input, output = input;
  for_each_index(color.pixels.size(), [&](size_t i) {
    if (!can_denoise(color.pixels[i], guides, i)) return;
    const float scale = 1 / guides.alpha_of(i);
    input.pixels[i] = color.pixels[i] * scale;
    for (int c = 0; c < 3; ++c) {
      const size_t at = 3 * i + size_t(c);
      albedo.pixels[i][c] = std::clamp(guides.albedo[at] * scale, 0.0f, 1.0f);
      normal.pixels[i][c] = std::clamp(guides.normal[at] * scale, -1.0f, 1.0f);
    }
  });
  OidnOnProcessor device;
  device.run({&input, &albedo, &normal, &output});
  if (auto sound = device.check(); !sound) return sound;
  for_each_index(color.pixels.size(), [&](size_t i) {
    if (can_denoise(color.pixels[i], guides, i))
      color.pixels[i] = output.pixels[i] * guides.alpha_of(i);
  });
  return {};
}

}  // namespace raio::core
