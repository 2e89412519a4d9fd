// What rays do that make a pixel, or a region of pixels, worked out in the background. No window in
// it: the inspector (view/inspector.h) says what to look into and shows what is found.
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

namespace raio::view {

/// A region has no more pixels, evenly chosen, and no more rays.
inline constexpr int kMaxRegionPixels = 4096;
inline constexpr size_t kMaxRegionRays = 20000;

enum class RayKind : uint8_t { eye, reflected, refracted, lit, stopped };
inline constexpr int kRayKinds = 5;
RayKind kind_of(const ExplainedRay& ray);

struct RegionRay {
  RayKind kind = RayKind::eye;
  int level = 1;
  Vec3d from, to;
  std::optional<PrimitiveKind> hit{};  // of a stopped ray, the nearest primitive in its way
  MaterialId material = 0;             // of that
};

/// Which rays are shown.
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
  RenderOptions options;                    // as `raio render` has them, with a size and the camera
  std::shared_ptr<const BakedScene> baked;  // used if it fits; may be null
  std::array<int, 2> pixel{0, 0};           // column, row
  std::array<int, 2> last{0, 0};            // of a region, whose first is `pixel`
  int sample = 0;

  bool is_region() const { return last != pixel; }
  friend bool operator==(const InspectionRequest& a, const InspectionRequest& b) {
    return a.scene == b.scene && a.options == b.options && a.pixel == b.pixel && a.last == b.last &&
           a.sample == b.sample;
  }
};

/// What was found. Immutable.
struct Inspected {
  InspectionRequest request;
  RenderSettings settings;
  std::shared_ptr<const BakedScene> baked;
  app::SideView side_view;
  std::optional<Error> error;
  // Of one pixel:
  Explanation sample;
  std::vector<std::optional<TraceLog>> logs;
  // Of a region:
  std::vector<RegionRay> rays;
  size_t pixels = 0;  // that were looked into

  /// As `raio explain` takes it.
  app::Explained explained() const {
    return {*request.scene, *baked->accel, settings, request.pixel, request.sample, sample, logs};
  }
};

/// All of it at once; stops early, without meaning, when `stop` is set.
std::shared_ptr<const Inspected> inspect(const InspectionRequest& request,
                                         const std::atomic<bool>& stop);

/// Works on the newest request.
class Inspection {
 public:
  /// `on_news` is called from another thread when something was found.
  explicit Inspection(std::function<void()> on_news) : on_news_(std::move(on_news)) {}
  ~Inspection();
  Inspection(const Inspection&) = delete;
  Inspection& operator=(const Inspection&) = delete;

  void start(InspectionRequest request);
  /// Gives up; does not wait.
  void cancel();
  bool busy() const { return working_.valid() || next_; }
  /// What was found, once; null where there is nothing new.
  std::shared_ptr<const Inspected> poll();

 private:
  void begin();

  std::function<void()> on_news_;
  std::atomic<bool> stop_ = false;
  std::optional<InspectionRequest> next_;
  std::shared_ptr<const BakedScene> baked_;  // of the last, for the next
  std::future<std::shared_ptr<const Inspected>> working_;
};

}  // namespace raio::view
