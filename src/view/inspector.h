// The ray inspector: shows the rays of a pixel, in the panel's place and over the picture, step by
// step. It receives clicks and changes; the viewer acts on its results.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view/inspection.h"
#include "view/inspector_scene.h"
#include "view/state.h"
#include "view/traversal_words.h"

namespace raio::core::view {

/// User input in the panel.
struct InspectorResult {
  bool closed = false, copied = false;
  bool copied_text = false;
  std::optional<Camera> camera;  // viewpoint to go to
  std::string save;              // a suffix: ".svg"
};

class Inspector {
 public:
  /// `on_news` is called from another thread.
  explicit Inspector(std::function<void()> on_news) : inspection_(std::move(on_news)) {}

  bool is_open() const { return open_; }
  /// Whether the next click selects a pixel.
  bool is_picking() const { return picking_; }
  void pick(bool on) { picking_ = on; }
  void close();

  /// Inspects the pixels between two positions of the picture (0 to 1 from the upper left), with
  /// the current state. Returns a line for the log.
  std::string look(const ViewState& state, const Stage& stage,
                   const std::shared_ptr<const BakedScene>& baked, ImVec2 a, ImVec2 b);
  /// After possible changes of the state's options: inspects the same pixel again, with the same
  /// camera.
  void follow(const ViewState& state);

  /// The result, once, as a line of the log; or its error.
  std::optional<std::expected<std::string, Error>> poll();

  /// Whether playing advanced to another step.
  bool advance(double now);
  enum class Walk { first, back, play, on, last };
  /// Returns the new position: "step 3 of 20 of ray 1".
  std::string walk(Walk where, double now);

  void draw_rays(const Rect& area, const Camera& camera, const Stage& stage);
  InspectorResult draw_panel(const Rect& where, double now);
  bool is_playing() const { return playing_; }

  /// The bytes of a drawing, seen from `camera`; may be called in another thread.
  std::function<std::expected<std::string, std::string>()> drawing(const std::string& suffix,
                                                                   const Camera& camera) const;
  /// For the displayed pixel; empty for a region.
  std::string command_line(const ViewState& state) const;
  /// What `raio explain` prints for it; empty for a region.
  std::string explanation() const;
  /// Whether a pixel is shown, which can be saved.
  bool has_pixel() const { return found_ && !found_->request.is_region(); }
  std::string file_name() const;
  /// The positions of the save buttons in the window, for tests; once.
  std::string places();

 private:
  void take(std::shared_ptr<const Inspected> found);
  void choose(int ray, int step);
  std::vector<TraversalStep> steps_of(int ray) const;
  void go(int by);
  void update_scene();
  std::vector<DrawnRay> pixel_rays() const;
  void restart(int sample);
  std::string label_of(int ray) const;
  Vec3d place(Vec3f p) const;
  Camera side_camera() const;

  void draw_head(InspectorResult& result);
  void draw_sections(double now);
  void draw_region();
  void draw_tree(int ray);
  void draw_walk(double now);
  void draw_ray() const;
  void draw_surface(const ExplainedRay& ray) const;
  void draw_sampled_light(int shadow, const ExplainedRay::Bounce& bounce) const;
  void draw_terms(const ExplainedRay& light) const;
  void draw_sum() const;

  Inspection inspection_;
  bool open_ = false, picking_ = false;
  InspectionRequest request_;
  Camera eye_;         // for the inspected pixel
  double aspect_ = 1;  // of the window's picture
  std::shared_ptr<const Inspected> found_;
  std::vector<std::vector<int>> children_;
  std::vector<int> order_;  // order of playing
  std::vector<int> places_in_order_;
  int ray_ = 0, step_ = -1;     // -1: the whole ray
  bool brings_ray_in_ = false;  // scrolls the tree of rays to it
  std::vector<TraversalStep> steps_;
  bool playing_ = false;
  double next_step_at_ = 0;
  float speed_ = 3;  // steps per second
  RayFilter filter_;
  RayScene scene_;
  bool copied_ = false;  // the displayed pixel, as text
  std::string button_places_;
};

}  // namespace raio::core::view
