// Explains the rays of a pixel, or a region of pixels, in the background. No window: the inspector
// (view/inspector.h) makes requests and shows the results.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/explain.h"
#include "render/session.h"

namespace raio::core::view {

/// The maximum number of a region's pixels, evenly chosen, and of its rays.
inline constexpr int kMaxRegionPixels = 4096;
inline constexpr size_t kMaxRegionRays = 20000;

enum class RayKind : uint8_t { eye, reflected, refracted, lit, stopped };
inline constexpr int kRayKinds = 5;
RayKind kind_of(const ExplainedRay& ray);

struct RegionRay {
  RayKind kind = RayKind::eye;
  int level = 1;
  Vec3d from, to;
  std::optional<PrimitiveKind> hit{};  // for a stopped ray, the nearest primitive in its way
  MaterialId material = 0;             // of that primitive
};

/// Selects the rays to show.
struct RayFilter {
  enum class Hits { anything, nothing, kind, material };
  std::array<bool, kRayKinds> kinds{true, true, true, true, true};
  int level = 0;  // 0: all
  Hits hits = Hits::anything;
  int number = 0;  // of the kind of primitive, or of the material

  bool passes(const RegionRay& ray) const;
};

struct InspectionRequest {
  std::shared_ptr<const Scene> scene;
  RenderOptions options;                    // as for `raio render`, with a size and the camera
  std::shared_ptr<const BakedScene> baked;  // used if it fits; may be null
  double largest = 0;                       // coordinate of the scene's primitives
  std::array<int, 2> pixel{0, 0};           // column, row
  std::array<int, 2> last{0, 0};            // of a region that starts at `pixel`
  int sample = 0;

  bool is_region() const { return last != pixel; }
  friend bool operator==(const InspectionRequest& a, const InspectionRequest& b) {
    return a.scene == b.scene && a.options == b.options && a.pixel == b.pixel && a.last == b.last &&
           a.sample == b.sample;
  }
};

/// The result. Immutable.
struct Inspected {
  InspectionRequest request;
  RenderSettings settings;
  std::shared_ptr<const BakedScene> baked;
  app::SideView side_view;
  std::optional<Error> error;
  // For one pixel:
  Explanation sample;
  std::vector<std::optional<TraceLog>> logs;
  // For a region:
  std::vector<RegionRay> rays;
  size_t pixels = 0;  // that were inspected

  /// In the form of `raio explain`.
  app::Explained explained() const {
    return {*request.scene, *baked->accel, settings, request.pixel, request.sample, sample, logs};
  }
};

/// Computes everything; if `stop` is set, returns early with an invalid result.
std::shared_ptr<const Inspected> inspect(const InspectionRequest& request,
                                         const std::atomic<bool>& stop);

/// Works on the newest request.
class Inspection {
 public:
  /// `on_news` is called from another thread for each result.
  explicit Inspection(std::function<void()> on_news) : on_news_(std::move(on_news)) {}
  ~Inspection();
  Inspection(const Inspection&) = delete;
  Inspection& operator=(const Inspection&) = delete;

  void start(InspectionRequest request);
  /// Cancels; does not wait.
  void cancel();
  bool busy() const { return working_.valid() || next_; }
  /// The result, once; null if there is nothing new.
  std::shared_ptr<const Inspected> poll();

 private:
  void begin();
  // Replaces a scene with instances by one with primitives; returns the error. By the worker.
  std::string flatten(InspectionRequest& request);

  std::function<void()> on_news_;
  std::atomic<bool> stop_ = false;
  std::optional<InspectionRequest> next_;
  std::shared_ptr<const BakedScene> baked_;     // of the last request, for the next
  std::shared_ptr<const Scene> copied_, flat_;  // the worker's: the last one with instances, flat
  std::future<std::shared_ptr<const Inspected>> working_;
};

}  // namespace raio::core::view
