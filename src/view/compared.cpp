#include "view/compared.h"

#include "render/picture.h"
#include "render/provenance.h"

namespace raio::core::view {
void ComparedFile::open(std::string path) {
  watch_.emplace(std::move(path));
  is_new_ = true;
}

std::optional<ComparedFile::Read> ComparedFile::poll() {
  if (is_ready(reading_)) {
    Read read = reading_.get();
    // Another file may have been opened meanwhile, or none is wanted any more.
    if (watch_ && watch_->path() == read.path && !is_new_) return read;
  }
  if (!watch_ || reading_.valid()) return std::nullopt;
  // A picture that vanishes is about to be written again.
  if (!std::exchange(is_new_, false) && watch_->look() != FileWatch::Seen::changed)
    return std::nullopt;
  reading_ = std::async(std::launch::async, [path = watch_->path()]() -> Read {
    auto image = read_displayed(path);
    if (!image) return {path, std::unexpected(std::move(image.error()))};
    return {path, std::make_shared<const ComparedPicture>(path, *std::move(image))};
  });
  return std::nullopt;
}

void Comparer::start(std::shared_ptr<const SessionPicture> a,
                     std::shared_ptr<const ComparedPicture> b) {
  const bool is_whole = a && a->image && a->samples > 0 && a->baked && b &&
                        a->image->width == b->image.width && a->image->height == b->image.height;
  if (!is_whole || running_.valid() || (a == a_ && b == b_)) return;
  a_ = a, b_ = b;
  if (std::exchange(request_, a->request) != a->request) regions_ = nullptr;
  running_ = std::async(std::launch::async,
                        [this, a = std::move(a), b = std::move(b), regions = regions_]() mutable {
                          Difference found{a, {}, {}, {}};
                          Executor(a->settings.threads, &control_).run([&] {
                            Image shown = *a->image;
                            tone_map(shown, {}, a->settings.tone, a->settings.exposure);
                            found.whole = compare(shown, b->image);
                            found.image = difference_image(shown, b->image);
                            const BakedScene& baked = *a->baked;
                            if (!regions)
                              regions = std::make_shared<const std::vector<Region>>(
                                  regions_of(*baked.scene, *baked.accel, a->settings, control_));
                            check_stop();
                            found.regions = differences(shown, b->image, *regions);
                          });
                          on_end_();
                          return std::pair(std::move(found), std::move(regions));
                        });
}

std::optional<Difference> Comparer::poll() {
  if (!is_ready(running_)) return std::nullopt;
  auto [found, regions] = running_.get();
  if (found.of->request == request_) regions_ = std::move(regions);
  return std::move(found);
}

}  // namespace raio::core::view
