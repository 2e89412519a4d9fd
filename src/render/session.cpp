#include "render/session.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

namespace raio {
namespace {

constexpr double kPassSeconds = 0.05;      // of refinement, between two pictures
constexpr double kPatienceSeconds = 0.06;  // without a picture; then there is a preview first
constexpr double kPreviewSeconds = 0.03;
constexpr double kProbeScale = 0.125;  // of the sides: what costs so little that it may be unknown

// What the cost of a pixel depends on, but for the camera.
RenderOptions without_camera(RenderOptions o) {
  o.from = o.at = o.up = std::nullopt;
  o.fov_deg = 0, o.width = o.height = 0, o.samples = std::min(o.samples, 1);
  return o;
}

// The tiles that the film has, over an enlarged preview.
Image over_preview(const Film& film, View view, const Image& preview) {
  Image image = picture_of(film, view);
  for (size_t t = 0; t < film.tiles(); ++t) {
    if (film.samples(t) > 0) continue;
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
    control_.stop = true;
  }
  news_.notify_all();
  thread_.join();
}

uint64_t Session::request(SessionRequest request) {
  const std::lock_guard lock(mutex_);
  const bool goes_on = request.frame_s > 0 && frame_must_end_ && Clock::now() < *frame_must_end_;
  if (!goes_on) control_.stop = true;
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

std::shared_ptr<const SessionPicture> Session::picture() const {
  const std::lock_guard lock(mutex_);
  return picture_;
}

void Session::run() {
  while (true) {
    SessionRequest request;
    SessionPicture next;
    {
      std::unique_lock lock(mutex_);
      frame_must_end_.reset();
      news_.wait(lock, [&] { return ending_ || request_; });
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
      serve(request, next);
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
    // Stopped for taking too long: the next one shall be coarser.
    if (control_.stop) pixel_s_ *= 4;
  } else {
    refine(next);
  }
}

// Makes sure that there is the structure of the request.
bool Session::bake(const SessionRequest& request, SessionPicture& next) {
  const AccelOptions& o = next.settings.accel;
  if (!baked_ || baked_->scene != request.scene || baked_->options != o ||
      baked_->one_sided != next.settings.one_sided) {
    auto baked = std::make_shared<BakedScene>();
    baked->scene = request.scene, baked->options = o, baked->one_sided = next.settings.one_sided;
    const auto start = Clock::now();
    std::expected<std::unique_ptr<Accel>, Error> accel;
    on_threads(next.settings.threads,
               [&] { accel = build_accel(*request.scene, o, next.settings.one_sided); });
    if (!accel) return fail(accel.error(), next);
    baked->build_s = std::chrono::duration<double>(Clock::now() - start).count();
    baked->accel = std::move(*accel);
    baked->info = baked->accel->info();
    baked_ = std::move(baked);
  }
  next.baked = baked_;
  return !control_.stop;
}

// What a sample of the whole picture takes, as far as is known.
double Session::expected_s(const SessionPicture& next) const {
  return pixel_s_ * next.settings.width * next.settings.height;
}

// The picture with sides of `scale` of the size in full.
bool Session::render_scaled(double scale, SessionPicture& next) {
  const auto start = Clock::now();
  RenderSettings settings = next.settings;
  const auto scaled = [&](int side) { return std::max(1, int(std::lround(side * scale))); };
  settings.width = scaled(settings.width), settings.height = scaled(settings.height);
  const BakedScene& baked = *next.baked;
  const auto film = make_film(*baked.scene, settings);
  if (!film) return fail(film.error(), next);
  if (!render(*baked.scene, *baked.accel, settings, **film, control_, {.samples = 1}).finished)
    return false;
  next.image = std::make_shared<Image>(picture_of(**film, settings.view));
  next.rays = (*film)->rays();
  next.pass_s = next.render_s = std::chrono::duration<double>(Clock::now() - start).count();
  const double pixel_s = next.pass_s / (double(settings.width) * settings.height);
  // One number for all sizes: what small pictures cost more, tells against the next one's.
  pixel_s_ = pixel_s_ > 0 ? (pixel_s_ + pixel_s) / 2 : pixel_s;
  return true;
}

// The finest picture that takes `seconds`.
bool Session::preview(double seconds, SessionPicture& next) {
  if (pixel_s_ == 0 && !render_scaled(kProbeScale, next)) return false;
  const double scale = std::sqrt(std::min(1.0, seconds / expected_s(next)));
  if (!render_scaled(std::max(scale, 1.0 / 32), next)) return false;
  publish(next);
  return true;
}

void Session::refine(SessionPicture& next) {
  if (pixel_s_ == 0 && !render_scaled(kProbeScale, next)) return;
  const double expected = expected_s(next);
  if (expected > kPatienceSeconds && !preview(kPreviewSeconds, next)) return;
  const BakedScene& baked = *next.baked;
  auto film = make_film(*baked.scene, next.settings);
  if (!film) return void(fail(film.error(), next));
  next.render_s = 0;
  if (!first_sample(**film, expected, next)) return;
  const int all = next.settings.samples_per_pixel();
  for (int samples = 1;;) {
    next.samples = samples, next.finished = samples == all;
    next.pass_s = next.render_s / samples;
    next.rays = (*film)->rays();
    next.image = std::make_shared<Image>(picture_of(**film, next.settings.view));
    publish(next);
    if (next.finished || !may_go_on()) return;
    const int step = int(std::min(kPassSeconds / std::max(next.pass_s, 1e-6), double(samples)));
    samples += std::min(std::max(1, step), all - samples);
    const RenderResult done = render(*baked.scene, *baked.accel, next.settings, **film, control_,
                                     {.samples = uint32_t(samples)});
    if (!done.finished) return;
    next.render_s += done.seconds;
  }
}

// In parts, where it takes long, so that there is something to see meanwhile.
bool Session::first_sample(Film& film, double expected, SessionPicture& next) {
  const BakedScene& baked = *next.baked;
  const bool long_wait = expected > kPatienceSeconds;
  const auto shards = long_wait ? uint32_t(std::clamp(expected / kPassSeconds, 1.0, 64.0)) : 1;
  const std::shared_ptr<const Image> preview = next.image;
  for (uint32_t shard = 0; shard < shards; ++shard) {
    const RenderResult done = render(*baked.scene, *baked.accel, next.settings, film, control_,
                                     {.samples = 1, .shard = shard, .shards = shards});
    if (!done.finished) return false;
    next.render_s += done.seconds;
    if (!long_wait) continue;
    next.image = std::make_shared<Image>(over_preview(film, next.settings.view, *preview));
    publish(next);
  }
  pixel_s_ = next.render_s / (double(film.width()) * film.height());
  return true;
}

// Waits while paused.
bool Session::may_go_on() {
  std::unique_lock lock(mutex_);
  news_.wait(lock, [&] { return control_.stop || !paused_; });
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

}  // namespace raio
