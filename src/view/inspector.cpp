#include "view/inspector.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ranges>

#include "render/read_options.h"
#include "view/selection.h"
#include "view/texts.h"

namespace raio::core::view {

void Inspector::close() {
  inspection_.cancel();
  open_ = picking_ = playing_ = false;
  found_.reset();
  scene_.set({}, nullptr);
  scene_.boxes.clear(), scene_.points.clear(), scene_.objects.reset();
}

std::string Inspector::look(const ViewState& state, const Stage& stage,
                            const std::shared_ptr<const BakedScene>& baked, ImVec2 a, ImVec2 b) {
  const auto pixel = [](float part, int size) {
    return std::clamp(int(std::floor(part * float(size))), 0, size - 1);
  };
  const int width = stage.picture_width, height = stage.picture_height;
  const auto [left, right] = std::minmax({pixel(a.x, width), pixel(b.x, width)});
  const auto [top, bottom] = std::minmax({pixel(a.y, height), pixel(b.y, height)});
  ViewState shown = state;
  shown.show(View::picture);
  request_.scene = state.scene, request_.largest = largest_in(state.box);
  request_.options = shown.request(width, height);
  request_.baked = baked;
  request_.pixel = {left, top}, request_.last = {right, bottom};
  request_.sample = 0;
  eye_ = state.camera, aspect_ = stage.aspect();
  open_ = true, picking_ = playing_ = false;
  ray_ = 0, step_ = -1;
  inspection_.start(request_);
  return request_.is_region() ? fmt::format("inspects: {},{} to {},{}", left, top, right, bottom)
                              : fmt::format("inspects: {},{} sample 0", left, top);
}

void Inspector::follow(const ViewState& state) {
  if (!open_) return;
  ViewState shown = state;
  shown.show(View::picture);
  shown.camera = eye_;
  // The focus on a point depends on the interactive camera, which differs.
  if (state.focus_point && !(state.camera == eye_)) shown.options.focus = request_.options.focus;
  InspectionRequest next = request_;
  next.scene = state.scene, next.largest = largest_in(state.box);
  next.options = shown.request(request_.options.width, request_.options.height);
  if (next == request_) return;
  next.sample =
      std::min(next.sample, resolve_options(next.options, *next.scene).samples_per_pixel() - 1);
  request_ = std::move(next);
  inspection_.start(request_);
}

void Inspector::restart(int sample) {
  if (sample == request_.sample) return;
  request_.sample = sample;
  inspection_.start(request_);
}

std::optional<std::expected<std::string, Error>> Inspector::poll() {
  auto found = inspection_.poll();
  if (!found || !open_) return std::nullopt;
  if (found->error) {
    close();
    return std::unexpected(*found->error);
  }
  take(std::move(found));
  const Inspected& f = *found_;
  if (f.request.is_region())
    return fmt::format("inspected: {} rays of {} pixels", f.rays.size(), f.pixels);
  const Vec3f rgb(f.sample.rgb);
  return fmt::format("inspected: {} rays, sample {}, rgb {} {} {}", f.sample.rays.size(),
                     f.request.sample, rgb.x, rgb.y, rgb.z);
}

void Inspector::take(std::shared_ptr<const Inspected> found) {
  found_ = std::move(found), copied_ = false;
  const auto& rays = found_->sample.rays;
  children_.assign(rays.size(), {});
  for (size_t i = 1; i < rays.size(); ++i) children_[size_t(rays[i].parent)].push_back(int(i));
  // Each ray, the shadow rays of its hit, then its children with theirs.
  order_.clear();
  places_in_order_.assign(rays.size(), 0);
  std::vector<int> open;
  if (!rays.empty()) open.push_back(0);
  while (!open.empty()) {
    const int i = open.back();
    open.pop_back();
    places_in_order_[size_t(i)] = int(order_.size());
    order_.push_back(i);
    const auto& below = children_[size_t(i)];
    for (const bool shadow : {false, true})
      for (const int k : below | std::views::reverse)
        if ((rays[size_t(k)].kind == ExplainedRay::Kind::shadow) == shadow) open.push_back(k);
  }
  if (ray_ >= int(rays.size())) ray_ = 0, step_ = -1;
  steps_.clear();
  choose(ray_, step_);
}

std::vector<TraversalStep> Inspector::steps_of(int ray) const {
  const auto i = size_t(ray);
  const ExplainedRay& r = found_->sample.rays[i];
  std::vector<TraversalStep> steps;
  if (found_->logs[i])
    steps = traversal_words(r, *found_->logs[i], found_->baked->accel->geometry(),
                            found_->settings.accel.kind);
  const double end = steps.empty() ? 0 : steps.back().t;
  for (TraversalStep& s :
       shading_words(found_->sample, *found_->request.scene, found_->settings, i)) {
    s.t = std::max(s.t, end);
    steps.push_back(std::move(s));
  }
  return steps;
}

void Inspector::choose(int ray, int step) {
  if (!has_pixel()) return update_scene();
  const bool same = ray == ray_ && !steps_.empty();
  brings_ray_in_ = !same;
  ray_ = ray;
  if (!same || step < 0) steps_ = steps_of(ray);
  step_ = std::clamp(step, -1, int(steps_.size()) - 1);
  update_scene();
}

void Inspector::go(int by) {
  const int step = step_ + by, at = places_in_order_[size_t(ray_)];
  if (step >= 0 && step < int(steps_.size())) return choose(ray_, step);
  const int next = at + by;
  if (next < 0) return choose(ray_, -1);
  if (next >= int(order_.size())) {
    playing_ = false;
    return;
  }
  steps_.clear();
  choose(order_[size_t(next)], by > 0 ? 0 : 1 << 30);
}

bool Inspector::advance(double now) {
  if (!playing_ || !has_pixel() || now < next_step_at_) return false;
  // All steps that are due: fast playing exceeds the frame rate.
  for (int k = 0; k < 1000 && playing_ && next_step_at_ <= now; ++k) {
    next_step_at_ += 1 / double(speed_);
    go(1);
  }
  next_step_at_ = std::max(next_step_at_, now);
  return true;
}

std::string Inspector::walk(Walk where, double now) {
  if (!has_pixel()) return {};
  if (where != Walk::play) playing_ = false;
  switch (where) {
    case Walk::first:
      steps_.clear();
      choose(0, 0);
      break;
    case Walk::back:
      go(-1);
      break;
    case Walk::on:
      go(1);
      break;
    case Walk::last:
      steps_.clear();
      choose(order_.back(), 1 << 30);
      break;
    case Walk::play:
      playing_ = !playing_;
      next_step_at_ = now;
      // From the end, or from a whole ray: restarts.
      if (playing_ && (step_ < 0 || (ray_ == order_.back() && step_ + 1 == int(steps_.size())))) {
        steps_.clear();
        choose(0, 0);
      }
      break;
  }
  return trf("step {} of {} of ray {}", step_ + 1, steps_.size(), ray_);
}

std::string Inspector::label_of(int ray) const {
  const ExplainedRay& r = found_->sample.rays[size_t(ray)];
  const auto& log = found_->logs[size_t(ray)];
  const Geometry& geometry = found_->baked->accel->geometry();
  if (r.kind == ExplainedRay::Kind::shadow) {
    const std::string light = app::light_name(found_->sample, r);
    const TraceLog::Test* by = r.occluded ? app::stopper(log) : nullptr;
    if (by) return trf("light {} is behind {}", light, app::name_of(geometry, by->primitive));
    return r.occluded ? trf("light {} is hidden", light) : trf("light {} shines", light);
  }
  const Rgb w = r.weight;
  const std::string weight = w == Rgb(w.x) ? fmt::format("{:.3g}", w.x)
                                           : fmt::format("{:.3g} {:.3g} {:.3g}", w.x, w.y, w.z);
  const std::string hit = !r.traced       ? tr("beyond the last level")
                          : r.hit.found() ? app::name_of(geometry, r.hit.primitive)
                                          : tr("background");
  return fmt::format("{}  {}: {}, {} {}", ray, tr(name_of(kind_of(r))), hit, tr("weight"), weight);
}

Camera Inspector::side_camera() const {
  if (!has_pixel()) return found_->side_view.camera;
  return app::side_view(found_->sample, found_->settings, found_->request.pixel, aspect_).camera;
}

std::string Inspector::explanation() const {
  return has_pixel() ? app::explained_text(found_->explained()) : std::string();
}

Vec3d Inspector::place(Vec3f p) const { return found_->request.scene->origin + Vec3d(p); }

// While steps are shown: earlier rays, the current one as far as it got, and the others faintly.
std::vector<DrawnRay> Inspector::pixel_rays() const {
  std::vector<DrawnRay> drawn;
  const auto& rays = found_->sample.rays;
  const int here = places_in_order_[size_t(ray_)];
  for (size_t i = 0; i < rays.size(); ++i) {
    const ExplainedRay& r = rays[i];
    DrawnRay d{.from = Vec3d(r.ray.origin),
               .to = app::drawn_end(r, found_->logs[i], found_->side_view),
               .kind = kind_of(r)};
    d.chosen = int(i) == ray_;
    const bool later = step_ >= 0 && places_in_order_[i] > here;
    d.alpha = later ? 0.18f : 1;
    d.is_sample = d.kind == RayKind::lit;
    if (r.surface) d.label = fmt::format("{}", i);
    if (d.chosen && step_ >= 0 && step_ < int(steps_.size())) {
      DrawnRay begun = d;
      begun.label.clear(), begun.is_sample = false;
      const double t = steps_[size_t(step_)].t;
      if (std::isfinite(t)) begun.to = begun.from + Vec3d(r.ray.dir) * t;
      drawn.push_back(std::move(begun));
      d.chosen = false, d.alpha = 0.35f;
    }
    drawn.push_back(std::move(d));
  }
  return drawn;
}

void Inspector::update_scene() {
  scene_.boxes.clear(), scene_.points.clear();
  if (!found_) return;
  scene_.objects = found_->side_view;
  if (!has_pixel()) {
    std::vector<DrawnRay> drawn;
    const float alpha = std::clamp(300.0f / float(found_->rays.size() + 1), 0.12f, 0.8f);
    for (const RegionRay& r : found_->rays)
      if (filter_.passes(r))
        drawn.push_back({.from = r.from, .to = r.to, .kind = r.kind, .alpha = alpha});
    return scene_.set(std::move(drawn), found_->baked);
  }
  scene_.set(pixel_rays(), found_->baked);
  const auto& log = found_->logs[size_t(ray_)];
  if (step_ < 0 || step_ >= int(steps_.size())) return;
  const TraversalStep& now = steps_[size_t(step_)];
  int last = -1;
  for (int k = 0; k <= step_; ++k) last = std::max(last, steps_[size_t(k)].log_step);
  if (log) {
    // Earlier ones, fainter with age.
    for (int k = std::max(0, last - 40); k <= last && k < int(log->steps.size()); ++k) {
      const bool current = k == (now.log_step >= 0 ? now.log_step : last);
      const float ago = float(last - k);
      scene_.boxes.push_back(
          {log->steps[size_t(k)].box, current ? 1.0f : std::max(0.12f, 0.55f - 0.03f * ago)});
    }
  }
  const ExplainedRay& r = found_->sample.rays[size_t(ray_)];
  if (std::isfinite(now.t)) scene_.points.push_back(Vec3d(r.ray.origin) + Vec3d(r.ray.dir) * now.t);
}

void Inspector::draw_rays(const Rect& area, const Camera& camera, const Stage& stage) {
  if (!open_ || !found_) return;
  aspect_ = stage.aspect();
  scene_.draw(area, camera, stage);
  draw_ray_legend(area, has_pixel());
}

std::function<std::expected<std::string, std::string>()> Inspector::drawing(
    const std::string& suffix, const Camera& camera) const {
  return [found = found_, suffix, camera]() -> std::expected<std::string, std::string> {
    app::Explained what = found->explained();
    if (suffix == ".json") return app::explained_json(what);
    what.plot_camera = camera;
    return app::draw_explained(what, suffix == ".svg" ? PlotFormat::svg : PlotFormat::png);
  };
}

std::string Inspector::command_line(const ViewState& state) const {
  if (!has_pixel()) return {};
  const InspectionRequest& q = found_->request;
  RenderOptions o = q.options;
  o.accel.kind = found_->settings.accel.kind;
  return fmt::format("{} explain {}{} --pixel {},{} --sample {}{} --json",
                     shell_word(state.program), shell_word(state.path),
                     option_arguments(state.read_options), q.pixel[0], q.pixel[1], q.sample,
                     option_arguments(o));
}

std::string Inspector::file_name() const {
  const InspectionRequest& q = found_->request;
  return fmt::format("{}-{}-{}", q.scene->name, q.pixel[0], q.pixel[1]);
}

std::string Inspector::places() { return std::exchange(button_places_, {}); }

}  // namespace raio::core::view
