#include "view/files.h"

#include <fmt/format.h>

#include <new>
#include <system_error>

#include "app/warnings.h"
#include "base/executor.h"
#include "io/file.h"
#include "render/picture.h"
#include "render/render.h"
#include "view/texts.h"

namespace raio::core::view {
namespace {

constexpr std::chrono::milliseconds kLook(150);

}  // namespace

FileWatch::FileWatch(std::string path)
    : path_(std::move(path)), read_(stamp(path_)), seen_(read_), next_look_(Clock::now() + kLook) {}

FileWatch::Stamp FileWatch::stamp(const std::string& path) {
  std::error_code error;
  const auto time = std::filesystem::last_write_time(path, error);
  if (error) return {};
  const auto size = std::filesystem::file_size(path, error);
  return {time, error ? 0 : size};
}

FileWatch::Seen FileWatch::look() {
  const auto now = Clock::now();
  if (now < next_look_) return Seen::nothing;
  next_look_ = now + kLook;
  // A file that still changes, or is missing for a moment, is being written.
  const Stamp before = std::exchange(seen_, stamp(path_));
  if (seen_ != before || seen_ == read_) return Seen::nothing;
  read_ = seen_;
  return seen_ == Stamp() ? Seen::gone : Seen::changed;
}

void SceneFile::follow(std::string path) { watch_ = FileWatch(std::move(path)), frames_ = nullptr; }

void SceneFile::start(Work work, int threads) {
  auto frames = work.path == watch_.path() ? frames_ : nullptr;
  if (!frames) frames = std::make_shared<SceneFrames>(work.path);
  reading_ = std::async(std::launch::async, [this, work = std::move(work), frames, threads] {
    auto read = Executor(threads, &control_).run([&] { return frames->read(work.options); });
    Read out{work.path, nullptr, {}, work.options, nullptr, work.is_reread};
    if (!read) {
      out.scene = std::unexpected(std::move(read.error()));
      return std::pair(std::move(out), frames);
    }
    for (const Diagnostic& d : read->notices) out.warnings.push_back(d.text());
    out.file = std::make_shared<const ReadScene>(*std::move(read));
    out.scene = std::shared_ptr<const Scene>(out.file, &out.file->scene);
    return std::pair(std::move(out), frames);
  });
}

std::optional<SceneFile::Read> SceneFile::poll(int threads, const ReadOptions& options) {
  if (is_ready(reading_)) {
    auto [read, frames] = reading_.get();
    if (!read.scene) return std::move(read);
    if (read.path != watch_.path()) follow(read.path);
    // The text of a trajectory is worth its memory.
    frames_ = read.file->frames > 1 ? std::move(frames) : nullptr;
    return std::move(read);
  }
  if (reading_.valid()) return std::nullopt;
  if (waiting_) {
    start(*std::exchange(waiting_, std::nullopt), threads);
    return std::nullopt;
  }
  const FileWatch::Seen seen = watch_.look();
  if (seen == FileWatch::Seen::nothing) return std::nullopt;
  frames_ = nullptr;
  if (seen == FileWatch::Seen::gone) {
    Diagnostic gone;
    gone.file = watch_.path();
    gone.message = tr("the file is gone; the picture shows its last version");
    return Read{watch_.path(), std::unexpected(Diagnostics{gone}), {}, options};
  }
  start({watch_.path(), options}, threads);
  return std::nullopt;
}

PictureWriter::~PictureWriter() {
  for (auto& one : writing_) one.wait();
}

void PictureWriter::write(std::shared_ptr<const Image> image, std::string path, Metadata metadata,
                          std::string command, Overlay overlay) {
  writing_.push_back(std::async(
      std::launch::async, [image = std::move(image), path = std::move(path),
                           metadata = std::move(metadata), command = std::move(command),
                           overlay = std::move(overlay), executor = Executor(max_concurrency())] {
        return Written{path, command, executor.run([&] {
                         return write_picture({*image, {}, {}}, path, metadata, overlay);
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

void PrintJob::start(JobRequest request, std::string command) {
  control_.stop = false;
  running_ = std::async(std::launch::async,
                        [this, request = std::move(request), command = std::move(command)] {
                          PictureWriter::Written written{request.output, command, {}};
                          try {
                            RenderJob job(request, {}, &control_);
                            written.result = job.prepare();
                            if (written.result) written.result = job.run();
                            if (written.result) written.result = job.write();
                          } catch (const std::bad_alloc&) {
                            written.result = std::unexpected(memory_error(request.output));
                          }
                          on_end_();
                          return written;
                        });
}

double PrintJob::share() const {
  return control_.stage == core::Stage::rendering ? control_.share() : 0;
}

std::optional<PictureWriter::Written> PrintJob::poll() {
  if (!is_ready(running_)) return std::nullopt;
  return running_.get();
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
