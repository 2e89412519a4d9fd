// What the window shows, and what keys and clicks make of it: the scene, the options as the panel
// and the keys set them, the camera. No window and no thread in it.
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

namespace raio::view {

/// A picture that may have any number of samples gets so many, unless the options say how many.
inline constexpr int kRefineSamples = 1024;

/// Which boxes of the structure are drawn over the picture, and how.
struct BoxLook {
  bool shown = false;
  int level = kLeafBoxes;  // of a tree
  int fewest = 1;          // primitives that a box holds
  bool by_level = false;   // coloured by level, else by the number of primitives

  friend bool operator==(const BoxLook&, const BoxLook&) = default;
};

class ViewState {
 public:
  ViewState(std::string path, std::shared_ptr<const Scene> scene, const RenderOptions& options);

  std::string path;                         // of the scene's file
  std::string program = "raio";             // as it was started
  ReadOptions read_options = kForPictures;  // of the file
  std::shared_ptr<const Scene> scene;
  RenderOptions options;  // also those that wait for an effect to be switched on; not the camera
  Camera camera;
  std::optional<Vec3d> focus_point;  // what is to stay in focus while the camera moves
  bool split = false;                // the picture beside that without `split_effect`
  Command split_effect = Command::antialiasing;
  // What gloss and translucency had when they were switched off, for when they are switched on.
  std::optional<float> waiting_gloss, waiting_translucency;
  std::optional<std::array<float, 2>> waiting_shutter;  // the same of motion
  bool paused = false, panel = true;
  BoxLook boxes;
  int chosen_light = 0, chosen_material = 0;  // those that the panel shows

  /// Another scene. Of the same file the camera stays, unless it was the scene's and that changed.
  void open(std::string new_path, std::shared_ptr<const Scene> new_scene);

  /// The scene's camera, with all data in the picture.
  Camera own_camera() const;

  bool is_on(Command effect) const;
  /// The option of gloss or of translucency.
  std::optional<float>& roughness(Command effect) {
    return effect == Command::gloss ? options.gloss : options.translucency;
  }
  /// Switches an effect, or takes the next structure. Returns what is so now: "soft shadows on".
  std::string toggle(Command effect);

  /// What stands beside the bar of the split view, at its left and at its right.
  std::pair<std::string, std::string> split_labels() const;
  /// Of the window.
  std::string title() const;

  void show(View view) { options.view = view; }

  /// What is as far away as the point looked at stays as large as it is; the scene's own camera
  /// becomes that which shows all of it in the other projection.
  void set_projection(raio::Projection projection);

  /// What `raio render` would be told for this picture of so many pixels: what has an effect, no
  /// more. `samples`: of a pixel, where their number is open; 0: those that refining ends with.
  RenderOptions request(int width, int height, int samples = 0) const;
  /// The same without `split_effect`, or with it where it is off.
  RenderOptions other_request(int width, int height) const;

  /// The camera of a picture of so many rows with its angle from edge to edge, wherever the options
  /// have it measured.
  Camera edge_to_edge(int height) const;

  /// May a pixel have any number of samples? Not with cells, whose number says it.
  bool endless() const;

  /// "raio render SCENE --size ... -o OUTPUT", with the program as it was started.
  std::string command_line(int width, int height, int samples, const std::string& output) const;

  /// Puts in focus what is at `depth`, along the line of sight; switches the lens on.
  void focus_at(float depth);
  /// The same of a point, which stays in focus when the camera moves.
  void focus_on(Vec3d point);
  /// After the camera has moved: the focus follows the point, unless that is behind the camera, or
  /// someone has set another focus meanwhile.
  void follow_focus();
  /// The aperture times `factor`.
  void scale_aperture(float factor);

  /// Equal in all that undo brings back: not in what is paused or hidden.
  friend bool operator==(const ViewState& a, const ViewState& b) {
    return a.scene == b.scene && a.options == b.options && a.camera == b.camera &&
           a.split == b.split && a.split_effect == b.split_effect;
  }

 private:
  RenderSettings resolved() const;
  void switch_roughness(Command effect, bool on);
  void switch_motion(bool on);

  float followed_focus_ = 0;  // that of focus_point
};

/// What the ray through a place of the picture (0 to 1 from the upper left) hits.
struct Pick {
  Hit hit;
  Vec3d point;
  double depth = 0;  // along the line of sight
  std::string what;  // "sphere 12"
};
Pick pick(const Accel& accel, const Camera& camera, double x, double y, double width_per_height);

}  // namespace raio::view
