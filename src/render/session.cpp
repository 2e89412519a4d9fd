#include "render/session.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>
#include <vector>

#include "base/executor.h"
#include "render/preview.h"
#include "scene/columns.h"

namespace raio::core {
namespace {

// Of refinement, between two pictures: a part of the time so far, since pictures change less and
// less and drawing them takes time, too.
constexpr double kLeastPassSeconds = 0.1, kMostPassSeconds = 0.5, kPassPart = 0.3;
constexpr double kPatienceSeconds = 0.06;  // without a picture; beyond that, a preview comes first
constexpr double kPreviewSeconds = 0.03;
// Scales of the sides for pictures of unknown cost. The first is cheap at any cost per pixel; the
// second is large enough to measure it.
constexpr double kMinScale = 1.0 / 32, kProbeScale = 1.0 / 8;
constexpr double kMaxPartSeconds = 0.5;  // of a sample that is shown in parts
constexpr uint32_t kMaxParts = 64;

// For timing a sample: the time allowed for drawing the previous picture; the minimum of all runs
// together; a sample of kLongSeconds needs no other run, since drawing its parts hardly slows it
// down.
constexpr double kDrawSeconds = 0.1, kTimingSeconds = 0.15, kLongSeconds = 1;

// The options that determine a pixel's cost, except the camera.
RenderOptions without_camera(RenderOptions o) {
  reset_camera(o);
  o.width = o.height = 0, o.samples = std::min(o.samples, 1);
  return o;
}

// Whether both read the same arrays. Never compares elements.
bool same_geometry(const Object& a, const Object& b) {
  if (a.origin != b.origin || a.meshes.size() != b.meshes.size() ||
      a.prototypes.size() != b.prototypes.size())
    return false;
  std::vector<const void*> arrays;
  for_each_object_column(a, [&](ColumnName, const auto& column) { arrays.push_back(&column); });
  for (const Mesh& mesh : a.meshes)
    for_each_mesh_column(mesh, [&](ColumnName, const auto& column) { arrays.push_back(&column); });
  size_t i = 0;
  bool same = true;
  const auto compare = [&]<class Column>(ColumnName, const Column& column) {
    same = same && column.shares(*static_cast<const Column*>(arrays[i++]));
  };
  for_each_object_column(b, compare);
  for (const Mesh& mesh : b.meshes) for_each_mesh_column(mesh, compare);
  return same && std::ranges::equal(a.prototypes, b.prototypes, same_geometry);
}

// Whether one scene's structure is valid for the other: both share all arrays and differ only in
// data that structures and accel/geometry.h do not read: lights, background, most of the materials.
bool bakes_alike(const Scene& a, const Scene& b, bool one_sided) {
  if (&a == &b) return true;
  // The widths of a grid's cells depend on the camera.
  if (a.camera.from != b.camera.from || a.materials.size() != b.materials.size()) return false;
  if (!same_geometry(a, b)) return false;
  // Structures depend on a few properties of materials: whether they are opaque, triangle colours,
  // and opacities.
  const bool with_colors = any_colors(a);
  for (size_t m = 0; m < a.materials.size(); ++m) {
    const Material &x = a.materials[m], &y = b.materials[m];
    if (one_sided && (x.transmission == 0) != (y.transmission == 0)) return false;
    if (with_colors && x.color != y.color) return false;
  }
  return std::ranges::equal(a.material_opacity, b.material_opacity);
}

// Whether the second request needs another structure than the first.
bool needs_another(const SessionRequest& first, const SessionRequest& second) {
  const RenderOptions &a = first.options, &b = second.options;
  return a.accel != b.accel || a.one_sided != b.one_sided || a.opacity != b.opacity ||
         !bakes_alike(*first.scene, *second.scene, true);
}

// The film's finished tiles over an enlarged preview.
Image over_preview(const Film& film, View view, const Image& preview) {
  Image image = picture_of(film, view);
  for (size_t t = 0; t < film.tiles(); ++t) {
    if (!film.samples(t).empty()) continue;
    const Tile tile = film.tile(t);
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x)
        image.at(x, y) = preview.at(int(int64_t(x) * preview.width / image.width),
                                    int(int64_t(y) * preview.height / image.height));
  }
  return image;
}

}  // namespace

Session::Session(std::function<void()> on_picture)
    : on_picture_(std::move(on_picture)), thread_([this] { run(); }) {}

Session::~Session() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    control_.stop = build_control_.stop = true;
  }
  news_.notify_all();
  thread_.join();
}

uint64_t Session::request(SessionRequest request) {
  const std::lock_guard lock(mutex_);
  const bool goes_on = request.frame_s > 0 && frame_must_end_ && Clock::now() < *frame_must_end_;
  if (!goes_on) control_.stop = true;
  if (built_ && needs_another(*built_, request)) build_control_.stop = true;
  request_ = std::move(request);
  news_.notify_all();
  return ++requests_;
}

void Session::rest() {
  const std::lock_guard lock(mutex_);
  request_.reset();
  control_.stop = true;
  news_.notify_all();
}

void Session::pause(bool paused) {
  const std::lock_guard lock(mutex_);
  paused_ = paused;
  news_.notify_all();
}

bool Session::is_paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

bool Session::is_idle() const {
  const std::lock_guard lock(mutex_);
  return waiting_ && !request_;
}

std::optional<SessionProgress> Session::progress() const {
  const std::lock_guard lock(mutex_);
  if (!stage_) return std::nullopt;
  SessionProgress p{.stage = stage_->stage};
  p.passed_s = seconds_since(stage_->start);
  if (p.stage == SessionProgress::structure) p.share = build_control_.share();
  if (stage_->parts == 0) {
    p.left_s = std::max(0.0, stage_->expected_s - p.passed_s);
    return p;
  }
  const double of_part =
      double(control_.work_done) / double(std::max<uint64_t>(1, control_.work_total));
  p.share = std::min(1.0, (stage_->part + std::min(1.0, of_part)) / stage_->parts);
  // The initial estimate counts less and less: parts are spread over the picture, so their time
  // soon tells more.
  constexpr double kTelling = 0.02;
  const double all_s = p.share > 0 ? p.passed_s / p.share : stage_->expected_s;
  const double trust = std::min(1.0, p.share / kTelling);
  p.left_s = std::max(
      0.0, trust * all_s + (1 - trust) * std::max(stage_->expected_s, p.passed_s) - p.passed_s);
  return p;
}

void Session::begin_stage(SessionProgress::Stage stage, double expected_s) {
  const std::lock_guard lock(mutex_);
  stage_ = Stage{.stage = stage, .start = Clock::now(), .expected_s = expected_s};
}

std::shared_ptr<const SessionPicture> Session::picture() const {
  const std::lock_guard lock(mutex_);
  return picture_;
}

void Session::run() {
  SessionRequest request;  // lives as long as built_ may point to it
  while (true) {
    SessionPicture next;
    {
      std::unique_lock lock(mutex_);
      frame_must_end_.reset();
      stage_.reset();
      built_ = nullptr;
      waiting_ = true;
      news_.wait(lock, [&] { return ending_ || request_; });
      waiting_ = false;
      if (ending_) return;
      request = *std::exchange(request_, std::nullopt);
      next.request = requests_;
      control_.stop = false;
      if (request.frame_s > 0) {
        const std::chrono::duration<double> patience(3 * request.frame_s);
        frame_must_end_ = Clock::now() + std::chrono::duration_cast<Clock::duration>(patience);
      }
    }
    try {
      Executor(request.options.threads).run([&] { serve(request, next); });
    } catch (const std::bad_alloc&) {
      fail({ErrorKind::no_resource, "", "out of memory"}, next);
    }
  }
}

void Session::serve(const SessionRequest& request, SessionPicture& next) {
  const std::pair like(request.scene, without_camera(request.options));
  if (std::exchange(like_, like) != like) pixel_s_ = 0;
  next.settings = resolve_options(request.options, *request.scene);
  if (!bake(request, next)) return;
  if (request.frame_s > 0) {
    preview(request.frame_s, next);
    // Stopped for taking too long: the next one must be coarser.
    if (control_.stop) pixel_s_ *= 4;
  } else {
    refine(next);
  }
}

// Ensures that the request's structure exists.
bool Session::bake(const SessionRequest& request, SessionPicture& next) {
  const AccelOptions& o = next.settings.accel;
  const bool keeps_structure = baked_ && baked_->options == o &&
                               baked_->one_sided == next.settings.one_sided &&
                               bakes_alike(*baked_->scene, *request.scene, baked_->one_sided);
  if (keeps_structure && baked_->scene != request.scene) {
    auto baked = std::make_shared<BakedScene>(*baked_);
    baked->scene = request.scene;
    baked_ = std::move(baked);
  } else if (!keeps_structure) {
    begin_stage(SessionProgress::structure, 0);
    {
      const std::lock_guard lock(mutex_);
      // A newer request may need another structure, or the session may end.
      build_control_.stop = ending_ || (request_ && needs_another(request, *request_));
      built_ = &request;
    }
    auto baked = std::make_shared<BakedScene>();
    baked->scene = request.scene, baked->options = o, baked->one_sided = next.settings.one_sided;
    const auto start = Clock::now();
    const bool same_options =
        baked_ && baked_->options == o && baked_->one_sided == baked->one_sided;
    const Accel* const like = same_options ? baked_->accel.get() : nullptr;
    auto accel = Executor(next.settings.threads, &build_control_).run([&] {
      return build_accel(*request.scene, o, baked->one_sided, false, like);
    });
    if (!accel) return accel.error().kind != ErrorKind::stopped && fail(accel.error(), next);
    const bool is_shared = like && (*accel)->structure() == like->structure();
    baked->build_s = is_shared ? baked_->build_s : seconds_since(start);
    baked->accel = {accel->release(),
                    [scene = request.scene](const Accel* built) { delete built; }};
    baked->info = baked->accel->info();
    baked_ = std::move(baked);
  }
  next.baked = baked_;
  const std::lock_guard lock(mutex_);
  stage_.reset();
  return !control_.stop;
}

// The expected time of a sample of the whole picture.
double Session::expected_s(const SessionPicture& next) const {
  return pixel_s_ * next.settings.width * next.settings.height;
}

// Renders the picture with sides scaled by `scale`.
bool Session::render_scaled(double scale, SessionPicture& next) {
  const auto start = Clock::now();
  RenderSettings settings = next.settings;
  const auto scaled = [&](int side) { return std::max(1, int(std::lround(side * scale))); };
  settings.width = scaled(settings.width), settings.height = scaled(settings.height);
  settings.preview_scale = float(settings.width) / float(next.settings.width);
  const bool is_noisy = lights_from_all_sides(settings.integrator);
  if (is_noisy)
    for (const Channel c : {Channel::depth, Channel::id}) settings.channels.add(c);
  const BakedScene& baked = *next.baked;
  const auto film = make_film(*baked.scene, settings);
  if (!film) return fail(film.error(), next);
  if (!render(*baked.scene, *baked.accel, settings, **film, control_, {.samples = 1}).finished)
    return false;
  Image image = picture_of(**film, settings.view);
  if (is_noisy)
    image = without_noise(image, std::get<Column<float>>((*film)->resolve(Channel::depth)),
                          std::get<Column<uint32_t>>((*film)->resolve(Channel::id)));
  next.image = std::make_shared<Image>(std::move(image));
  const double seconds = seconds_since(start);
  const double pixel_s = seconds / (double(settings.width) * settings.height);
  // One number for all sizes: the overhead of small pictures makes the next ones more cautious.
  pixel_s_ = pixel_s_ > 0 ? (pixel_s_ + pixel_s) / 2 : pixel_s;
  return true;
}

// Measures the cost of a pixel with the smallest picture, and with a larger one if that is fast.
bool Session::probe(SessionPicture& next) {
  if (pixel_s_ > 0) return true;
  if (!render_scaled(kMinScale, next)) return false;
  if (expected_s(next) * kProbeScale * kProbeScale > kPreviewSeconds) return true;
  pixel_s_ = 0;
  return render_scaled(kProbeScale, next);
}

// The finest picture that takes `seconds`.
bool Session::preview(double seconds, SessionPicture& next) {
  if (!probe(next)) return false;
  const double scale = std::max(std::sqrt(std::min(1.0, seconds / expected_s(next))), kMinScale);
  // The probe's smaller picture may be there already.
  const double least_width = 1.5 * kMinScale * next.settings.width;
  const bool is_there =
      next.image && scale <= 1.5 * kMinScale && next.image->width <= std::max(1.0, least_width);
  if (!is_there && !render_scaled(scale, next)) return false;
  publish(next);
  return true;
}

void Session::refine(SessionPicture& next) {
  begin_stage(SessionProgress::sample, expected_s(next));
  if (!probe(next)) return;
  const double expected = expected_s(next);
  if (expected > kPatienceSeconds && !preview(kPreviewSeconds, next)) return;
  const BakedScene& baked = *next.baked;
  auto film = make_film(*baked.scene, next.settings);
  if (!film) return void(fail(film.error(), next));
  if (!first_sample(**film, expected, next)) return;
  show(**film, next);
  if (!time_sample(**film, next)) return;
  const int all = next.settings.samples_per_pixel();
  while (true) {
    show(**film, next);
    if (next.finished || !may_go_on()) return;
    const double pass_s =
        std::clamp(kPassPart * next.render_s, kLeastPassSeconds, kMostPassSeconds);
    const double sample_s = std::max(next.render_s / next.samples, 1e-6);
    const int step = int(std::min(pass_s / sample_s, double(next.samples)));
    if (!add_samples(**film, std::min(std::max(1, step), all - next.samples), next)) return;
  }
}

// Renders until each pixel has `samples` samples. Returns the time in seconds; nothing if stopped.
std::optional<double> Session::render_to(Film& film, int samples, const SessionPicture& next) {
  const BakedScene& baked = *next.baked;
  const RenderResult done = render(*baked.scene, *baked.accel, next.settings, film, control_,
                                   {.samples = uint32_t(samples)});
  return done.finished ? std::optional(done.seconds) : std::nullopt;
}

std::optional<double> Session::add_samples(Film& film, int count, SessionPicture& next) {
  const auto seconds = render_to(film, next.samples + count, next);
  if (seconds) next.samples += count, next.render_s += *seconds;
  return seconds;
}

// Publishes whole samples.
void Session::show(const Film& film, SessionPicture& next) {
  next.finished = next.samples == next.settings.samples_per_pixel();
  next.rays = film.rays();
  next.image = std::make_shared<Image>(picture_of(film, next.settings.view));
  publish(next);
}

// A slow sample is rendered and shown in parts.
bool Session::first_sample(Film& film, double expected, SessionPicture& next) {
  const BakedScene& baked = *next.baked;
  const bool long_wait = expected > kPatienceSeconds;
  const double part_s = std::clamp(expected / 8, kLeastPassSeconds, kMaxPartSeconds);
  const auto parts =
      long_wait ? uint32_t(std::clamp(expected / part_s, 1.0, double(kMaxParts))) : 1;
  begin_stage(SessionProgress::sample, expected);
  const std::shared_ptr<const Image> preview = next.image;
  double seconds = 0;
  for (uint32_t part = 0; part < parts; ++part) {
    {
      const std::lock_guard lock(mutex_);
      control_.work_done = 0;
      stage_->part = part, stage_->parts = parts;
    }
    const RenderResult done = render(*baked.scene, *baked.accel, next.settings, film, control_,
                                     {.samples = 1, .shard = part, .shards = parts});
    if (!done.finished) return false;
    seconds += done.seconds;
    if (!long_wait) continue;
    next.image = std::make_shared<Image>(over_preview(film, next.settings.view, *preview));
    publish(next);
  }
  next.samples = 1, next.render_s = seconds;
  pixel_s_ = seconds / (double(film.width()) * film.height());
  const std::lock_guard lock(mutex_);
  stage_.reset();
  return true;
}

// Times a sample while nothing is drawn: the next ones, or, if there are none, the first again.
bool Session::time_sample(Film& film, SessionPicture& next) {
  std::vector<double> runs_s;
  if (next.render_s >= kLongSeconds) {
    runs_s.push_back(next.render_s);
  } else {
    {
      std::unique_lock lock(mutex_);
      news_.wait_for(lock, std::chrono::duration<double>(kDrawSeconds),
                     [&] { return control_.stop.load(); });
    }
    constexpr size_t kMinRuns = 3;  // fewer would not show their spread
    for (double all = 0; runs_s.size() < kMinRuns || all < kTimingSeconds; all += runs_s.back()) {
      std::optional<double> run_s;
      if (next.samples < next.settings.samples_per_pixel() && !is_paused()) {
        run_s = add_samples(film, 1, next);
      } else {
        const auto again = make_film(*next.baked->scene, next.settings);
        if (!again) return fail(again.error(), next);
        run_s = render_to(**again, 1, next);
      }
      if (!run_s) return false;
      runs_s.push_back(std::max(*run_s, 1e-9));
    }
  }
  next.sample_s = median_interval(std::move(runs_s));
  return true;
}

// Waits while paused.
bool Session::may_go_on() {
  std::unique_lock lock(mutex_);
  waiting_ = paused_;
  news_.wait(lock, [&] { return control_.stop || !paused_; });
  waiting_ = false;
  return !control_.stop;
}

bool Session::fail(Error why, SessionPicture& next) {
  next.error = std::move(why);
  next.samples = 0;
  if (const auto before = picture()) next.image = before->image, next.baked = before->baked;
  publish(next);
  return false;
}

void Session::publish(const SessionPicture& next) {
  auto picture = std::make_shared<SessionPicture>(next);
  {
    const std::lock_guard lock(mutex_);
    picture_ = std::move(picture);
  }
  on_picture_();
}

}  // namespace raio::core
