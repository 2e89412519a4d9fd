#include "view/files.h"

#include <fmt/format.h>

#include <system_error>

#include "app/warnings.h"
#include "base/executor.h"
#include "io/file.h"
#include "io/scene_file.h"
#include "render/picture.h"
#include "render/render.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr std::chrono::milliseconds kLook(150);

template <class T>
bool is_ready(const std::future<T>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

}  // namespace

SceneFile::SceneFile(std::string path, ReadOptions options)
    : path_(std::move(path)),
      options_(std::move(options)),
      read_(stamp(path_)),
      seen_(read_),
      next_look_(Clock::now() + kLook) {}

SceneFile::Stamp SceneFile::stamp(const std::string& path) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  if (error) return {};
  const auto size = std::filesystem::file_size(path, error);
  return {time, error ? 0 : size};
}

void SceneFile::open(std::string path) { waiting_ = std::move(path); }

void SceneFile::follow(std::string path) {
  path_ = std::move(path), options_ = {};
  read_ = seen_ = stamp(path_);
}

void SceneFile::start(std::string path, int threads) {
  const ReadOptions options = path == path_ ? options_ : kForPictures;
  reading_ = std::async(std::launch::async, [this, path = std::move(path), options, threads] {
    auto read = Executor(threads, &control_).run([&] { return read_scene(path, options); });
    if (!read) return Read{path, std::unexpected(std::move(read.error())), {}};
    std::vector<std::string> warnings;
    for (const Diagnostic& d : read->notices) warnings.push_back(d.text());
    return Read{path, std::make_shared<const Scene>(std::move(read->scene)), warnings};
  });
}

std::optional<SceneFile::Read> SceneFile::poll(int threads) {
  if (is_ready(reading_)) {
    Read read = reading_.get();
    if (read.scene && read.path != path_) follow(read.path);
    return read;
  }
  if (reading_.valid()) return std::nullopt;
  if (waiting_) {
    start(*std::exchange(waiting_, std::nullopt), threads);
    return std::nullopt;
  }
  const auto now = Clock::now();
  if (now < next_look_) return std::nullopt;
  next_look_ = now + kLook;
  // A file that still changes, or is missing for a moment, is being written.
  const Stamp before = std::exchange(seen_, stamp(path_));
  if (seen_ != before || seen_ == read_) return std::nullopt;
  read_ = seen_;
  if (seen_ == Stamp()) {
    Diagnostic gone;
    gone.file = path_, gone.message = tr("the file is gone; the picture shows its last version");
    return Read{path_, std::unexpected(Diagnostics{gone}), {}};
  }
  start(path_, threads);
  return std::nullopt;
}

PictureWriter::~PictureWriter() {
  for (auto& one : writing_) one.wait();
}

void PictureWriter::write(std::shared_ptr<const Image> image, std::string path, Metadata metadata,
                          std::string command) {
  writing_.push_back(
      std::async(std::launch::async,
                 [image = std::move(image), path = std::move(path), metadata = std::move(metadata),
                  command = std::move(command), executor = Executor(max_concurrency())] {
                   return Written{path, command, executor.run([&] {
                                    return write_picture({*image, {}, {}}, path, metadata);
                                  })};
                 }));
}

void PictureWriter::write(std::function<std::expected<std::string, std::string>()> make,
                          std::string path, std::string command) {
  writing_.push_back(std::async(std::launch::async, [make = std::move(make), path = std::move(path),
                                                     command = std::move(command)] {
    const auto bytes = make();
    if (!bytes)
      return Written{path, command,
                     std::unexpected(Error{ErrorKind::no_resource, "", bytes.error()})};
    return Written{path, command, write_file(path, *bytes)};
  }));
}

std::optional<PictureWriter::Written> PictureWriter::poll() {
  for (auto one = writing_.begin(); one != writing_.end(); ++one) {
    if (!is_ready(*one)) continue;
    Written written = one->get();
    writing_.erase(one);
    return written;
  }
  return std::nullopt;
}

bool Warnings::find(const Scene& scene, const SessionPicture& picture) {
  if (!picture.baked || request_ == picture.request) return false;
  request_ = picture.request;
  lines_ = of_file_;
  for (std::string& line : app::warning_lines(scene, picture.settings, picture.baked->accel.get()))
    lines_.push_back(std::move(line));
  return true;
}

std::string short_path(const std::string& path) {
  std::error_code error;
  const std::string near = std::filesystem::proximate(path, error).string();
  return error || near.empty() || near.starts_with("..") ? path : near;
}

std::string free_name(const std::string& name, const std::string& suffix) {
  std::error_code ignored;
  std::string path = name + suffix;
  for (int i = 2; std::filesystem::exists(path, ignored); ++i)
    path = fmt::format("{}-{}{}", name, i, suffix);
  return path;
}

}  // namespace raio::core::view
