// The window's state and its changes by keys and clicks: the scene, the options as set by panel and
// keys, the camera. No window and no thread.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "accel/accel.h"
#include "app/overlay.h"
#include "io/image/image.h"
#include "io/read_scene.h"
#include "measure/effect_costs.h"
#include "render/options.h"
#include "scene/scene.h"
#include "view/keys.h"

namespace raio::core::view {

/// The samples of a picture if the options leave their number open.
inline constexpr int kRefineSamples = 1024;

/// How the window reads files.
inline const ReadOptions kForWindow{
    .cell = std::nullopt, .hide_solvent = true, .instances = true, .labels = true};

/// Which boxes of the structure are drawn over the picture, and how.
struct BoxLook {
  bool shown = false;
  int level = kLeafBoxes;  // in a tree
  int fewest = 1;          // minimum number of primitives in a box
  bool by_level = false;   // else coloured by the number of primitives

  friend bool operator==(const BoxLook&, const BoxLook&) = default;
};

/// A picture of another program, as displayed.
struct ComparedPicture {
  std::string path;
  Image image;
};

/// What the panel of figures remembers, besides what undo restores.
struct FigureForm {
  bool plays = false;  // the frames of a trajectory
  int frames_per_s = 10;
  // Of the picture to be saved for print.
  float width_mm = 88;
  int dpi = int(kPrintDpi), samples = 256;
  bool transparent = false;
  Rgb own_color = {1, 0.5f, 0};  // for selected atoms; display values
  // The text typed last into the field of a reader's option, until the file was read with it, and
  // why it was not.
  std::string option, typed, problem;
};

class ViewState {
 public:
  ViewState(std::string path, std::shared_ptr<const Scene> scene, const RenderOptions& options);

  std::string path;                       // of the scene's file
  std::string program = "raio";           // as it was started
  ReadOptions read_options = kForWindow;  // for the file
  std::shared_ptr<const Scene> scene;
  Box3f box;  // of its primitives, which edits in the window leave as they are
  std::shared_ptr<const ReadScene> file;  // as read with `read_options`; null if written here
  uint32_t file_version = 0;              // of the file on the disk, counted by AppState
  app::Annotations annotations;           // those that do not fit are not drawn
  RenderOptions options;                  // including those of disabled effects; without the camera
  Camera camera;
  std::optional<Vec3d> focus_point;  // stays in focus while the camera moves
  bool split = false;                // next to the picture without `split_effect`
  Command split_effect = Command::antialiasing;
  // The roughness of gloss and translucency before they were switched off, for switching them on.
  std::optional<float> waiting_gloss, waiting_translucency;
  std::optional<std::array<float, 2>> waiting_shutter;  // likewise for motion blur
  bool paused = false, panel = true;
  bool grows = false;  // a picture of fixed size, its pixels squares of the screen
  std::shared_ptr<const ComparedPicture> compared;  // beside this one; null: none
  bool shows_difference = false;                    // of the two, instead of both
  BoxLook boxes;
  CostOf costs_of = CostOf::sample;
  std::optional<Vec3d> pivot;  // chosen for turning; nothing: turning_point() decides
  int chosen_light = 0, chosen_material = 0;  // selected in the panel
  FigureForm form;

  /// Another scene. For the same file the camera stays, unless it was the scene's and that changed;
  /// it is the same for all frames.
  void open(std::string new_path, std::shared_ptr<const Scene> new_scene,
            const ReadOptions& options_read = kForWindow,
            std::shared_ptr<const ReadScene> new_file = nullptr);

  /// Takes over from another state what neither undo nor another scene changes.
  void keep_habits(const ViewState& other);

  /// Whether the picture, also behind a view, is lit by a sky, without the scene's lights, mirrors
  /// and glass.
  bool is_figure() const;

  /// The scene's camera, with all data in the picture.
  Camera own_camera() const;

  /// What the camera turns about, if not about the point under the cursor: the chosen pivot, or the
  /// middle of data.
  std::optional<Vec3d> turning_point() const;

  /// Whether it changes pictures of this scene. Those of light and surfaces do not exist in
  /// figures.
  bool has(Command effect) const;
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

  /// The frame in use, from 0, and their number, at least 1.
  int frame() const;
  int frames() const { return file ? std::max(1, int(file->frames)) : 1; }

  /// The annotations that fit a picture with these options: those that `raio render` accepts.
  app::Annotations annotations_of(const RenderOptions& picture) const;

  /// Draws them on a picture with these settings; empty if there are none.
  Overlay overlay(const RenderSettings& picture) const;

  /// The options of a picture for print: as wide as the form says, with the shape of these pixels.
  RenderOptions print_request(int width, int height) const;

  /// The equivalent options of `raio render` for this picture with this size, without those that
  /// have no effect. `samples`: per pixel, if their number is open; 0: the final number of
  /// refinement.
  RenderOptions request(int width, int height, int samples = 0) const;
  /// The same without `split_effect`, or with it if it is off.
  RenderOptions other_request(int width, int height) const;

  /// The camera for a picture of this size. A narrow one has a wider angle: it shows the sides of
  /// the scene's frame, too.
  Camera shown_camera(int width, int height) const;
  /// The same with its angle from edge to edge, however the options measure it.
  Camera edge_to_edge(int width, int height) const;
  /// The size that the options ask for; 0: that of the window.
  std::array<int, 2> wanted_size() const;
  /// The same; that of the picture compared with, if there is one.
  std::array<int, 2> picture_size() const;
  /// Whether a bar divides the picture.
  bool has_bar() const { return compared ? !shows_difference : split; }

  /// Whether a pixel may have any number of samples. Not with cells, which determine it.
  bool endless() const;

  /// "raio render SCENE --size ... -o OUTPUT", with the program as it was started.
  std::string command_line(int width, int height, int samples, const std::string& output) const {
    return command_line(request(width, height, samples), output);
  }
  /// The same for the result of request() or print_request().
  std::string command_line(const RenderOptions& picture, const std::string& output) const;

  /// Focuses at `depth` along the line of sight; switches the lens on.
  void focus_at(float depth);
  /// Focuses on a point, which stays in focus when the camera moves.
  void focus_on(Vec3d point);
  /// After a camera movement: the focus follows the point, unless that is behind the camera, or
  /// another focus was set meanwhile.
  void follow_focus();
  /// Multiplies the aperture by `factor`.
  void scale_aperture(float factor);

  /// Compares everything that undo restores: not pausing or hiding, nor the pivot.
  friend bool operator==(const ViewState& a, const ViewState& b) {
    return a.scene == b.scene && a.read_options == b.read_options && a.options == b.options &&
           a.annotations == b.annotations && a.camera == b.camera && a.split == b.split &&
           a.split_effect == b.split_effect;
  }

 private:
  RenderSettings resolved() const;
  void switch_roughness(Command effect, bool on);
  void switch_motion(bool on);

  float followed_focus_ = 0;  // the last focus from focus_point
  double frame_aspect_ = 1;   // of what must be visible in any window
};

/// The hit of the ray through a position of the picture (0 to 1 from the upper left).
struct Pick {
  Hit hit;
  Vec3d point;
  double depth = 0;              // along the line of sight
  Vec3d place;                   // of a sphere its centre, else the point
  std::string what;              // "sphere 12"
  std::string object;            // its name, or what is known of the atom; empty: nothing
  std::optional<uint32_t> atom;  // of the file's AtomLabels
  std::string in_file;           // the atom's number and index
  MaterialId material = 0;
};
/// `file`: of the scene, with names of atoms; may be null.
Pick pick(const Accel& accel, const Camera& camera, double x, double y, double width_per_height,
          const ReadScene* file = nullptr);

}  // namespace raio::core::view
