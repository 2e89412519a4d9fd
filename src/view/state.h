// The window's state and its changes by keys and clicks: the scene, the options as set by panel and
// keys, the camera. No window and no thread.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "accel/accel.h"
#include "io/read_scene.h"
#include "render/options.h"
#include "scene/scene.h"
#include "view/keys.h"

namespace raio::core::view {

/// The samples of a picture if the options leave their number open.
inline constexpr int kRefineSamples = 1024;

/// Which boxes of the structure are drawn over the picture, and how.
struct BoxLook {
  bool shown = false;
  int level = kLeafBoxes;  // in a tree
  int fewest = 1;          // minimum number of primitives in a box
  bool by_level = false;   // else coloured by the number of primitives

  friend bool operator==(const BoxLook&, const BoxLook&) = default;
};

class ViewState {
 public:
  ViewState(std::string path, std::shared_ptr<const Scene> scene, const RenderOptions& options);

  std::string path;                         // of the scene's file
  std::string program = "raio";             // as it was started
  ReadOptions read_options = kForPictures;  // for the file
  std::shared_ptr<const Scene> scene;
  RenderOptions options;  // including those of disabled effects; without the camera
  Camera camera;
  std::optional<Vec3d> focus_point;  // stays in focus while the camera moves
  bool split = false;                // next to the picture without `split_effect`
  Command split_effect = Command::antialiasing;
  // The roughness of gloss and translucency before they were switched off, for switching them on.
  std::optional<float> waiting_gloss, waiting_translucency;
  std::optional<std::array<float, 2>> waiting_shutter;  // likewise for motion blur
  bool paused = false, panel = true;
  BoxLook boxes;
  int chosen_light = 0, chosen_material = 0;  // selected in the panel

  /// Another scene. For the same file the camera stays, unless it was the scene's and that changed.
  void open(std::string new_path, std::shared_ptr<const Scene> new_scene);

  /// The scene's camera, with all data in the picture.
  Camera own_camera() const;

  bool is_on(Command effect) const;
  /// The option of gloss or of translucency.
  std::optional<float>& roughness(Command effect) {
    return effect == Command::gloss ? options.gloss : options.translucency;
  }
  /// Switches an effect, or to the next structure. Returns the new state: "soft shadows on".
  std::string toggle(Command effect);

  /// The labels at the left and right of the split view's bar.
  std::pair<std::string, std::string> split_labels() const;
  /// Of the window.
  std::string title() const;

  void show(View view) { options.view = view; }

  /// Objects at the distance of the point looked at keep their size; the scene's own camera becomes
  /// the one that shows everything in the other projection.
  void set_projection(core::Projection projection);

  /// The equivalent options of `raio render` for this picture with this size, without those that
  /// have no effect. `samples`: per pixel, if their number is open; 0: the final number of
  /// refinement.
  RenderOptions request(int width, int height, int samples = 0) const;
  /// The same without `split_effect`, or with it if it is off.
  RenderOptions other_request(int width, int height) const;

  /// The camera for a picture of this height with its angle from edge to edge, however the options
  /// measure it.
  Camera edge_to_edge(int height) const;

  /// Whether a pixel may have any number of samples. Not with cells, which determine it.
  bool endless() const;

  /// "raio render SCENE --size ... -o OUTPUT", with the program as it was started.
  std::string command_line(int width, int height, int samples, const std::string& output) const;

  /// Focuses at `depth` along the line of sight; switches the lens on.
  void focus_at(float depth);
  /// Focuses on a point, which stays in focus when the camera moves.
  void focus_on(Vec3d point);
  /// After a camera movement: the focus follows the point, unless that is behind the camera, or
  /// another focus was set meanwhile.
  void follow_focus();
  /// Multiplies the aperture by `factor`.
  void scale_aperture(float factor);

  /// Compares everything that undo restores: not pausing or hiding.
  friend bool operator==(const ViewState& a, const ViewState& b) {
    return a.scene == b.scene && a.options == b.options && a.camera == b.camera &&
           a.split == b.split && a.split_effect == b.split_effect;
  }

 private:
  RenderSettings resolved() const;
  void switch_roughness(Command effect, bool on);
  void switch_motion(bool on);

  float followed_focus_ = 0;  // the last focus from focus_point
};

/// The hit of the ray through a position of the picture (0 to 1 from the upper left).
struct Pick {
  Hit hit;
  Vec3d point;
  double depth = 0;  // along the line of sight
  std::string what;  // "sphere 12"
};
Pick pick(const Accel& accel, const Camera& camera, double x, double y, double width_per_height);

}  // namespace raio::core::view
