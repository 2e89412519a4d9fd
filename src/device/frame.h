// A frame: renders a world by another thread, and converts its channels.
#pragma once

#include <raio/raio.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "device/objects.h"
#include "device/world.h"

namespace raio::device {

class Frame final : public Object {
 public:
  explicit Frame(Device& owner) : Object(owner, DataType::frame, "") {}
  ~Frame() override;

  /// Begins to render what is committed now. `completed` is called by the rendering thread when
  /// the frame is done.
  void render(std::function<void()> completed);
  /// Whether the frame is done; waits for it if asked to.
  bool ready(bool wait);
  /// Stops rendering soon.
  void discard();
  /// The pixels of a channel from the lower left, which stay valid until they are unmapped or the
  /// next frame; null if the frame has no such channel.
  const void* map(std::string_view channel, uint32_t* width, uint32_t* height, DataType* type);
  /// Of the last frame, seconds; and of the current one, 0 to 1.
  float duration() const { return duration_; }
  float progress() const { return progress_; }

  void forget() override;

 private:
  struct Eye {
    core::Vec3d from, forward, up;
    double fov_deg = 0, distance = 1;  // at which the picture spans this angle
    std::string projection;            // the camera's subtype
  };
  // The inputs of a frame, copied when it begins.
  struct Task {
    std::shared_ptr<ShownWorld> world;
    Settings settings;
    Eye eye;
    std::array<uint32_t, 2> size{};
    std::array<uint32_t, 2> shift{}, whole{};  // of the image region, pixels
    uint32_t samples = 0;
    uint64_t stamp = 0;  // of all that the film depends on
    std::array<float, 4> background{};
    std::shared_ptr<const Array> background_image;
    bool by_rays = false;  // whether depth or numbers are asked for
    bool open = true;      // whether the background is added to the film
    std::map<std::string, DataType, std::less<>> channels;
    std::optional<Film> begun;
  };
  // The channels of a frame.
  struct Picture {
    std::array<uint32_t, 2> size{};
    std::vector<float> color, albedo, normal, depth;
    std::vector<uint32_t> primitive_id, object_id, instance_id;
  };

  std::optional<Task> begin();
  void work(Task task);
  static void cast_rays(const Task& task, const Accel& accel, Picture& picture);
  void wait_rendered();

  std::mutex mutex_;
  std::condition_variable changed_;
  bool rendered_ = true, done_ = true;  // after the callback
  std::shared_ptr<Job> job_;            // of the current frame
  bool discarded_ = false;
  std::thread thread_;
  std::atomic<float> duration_ = 0, progress_ = 0;

  std::shared_ptr<ShownWorld> world_;  // of the film
  std::optional<Film> film_;
  uint64_t film_stamp_ = 0;
  uint32_t film_samples_ = 0;
  Picture picture_;
  std::map<std::string, DataType, std::less<>> channels_;
  std::map<std::string, std::vector<std::byte>, std::less<>> mapped_;
};

}  // namespace raio::device
