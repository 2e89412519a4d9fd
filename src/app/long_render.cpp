#include "app/long_render.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>

#include "app/output.h"
#include "app/terminal.h"
#include "render/render.h"

namespace raio::app {
namespace {

namespace fs = std::filesystem;

/// Whole samples by Sobol's sequence, to which any number may be added.
bool is_extensible(int samples) { return samples > 0; }

// Beside the picture, if the command does not name one.
std::string scene_of(const RenderCommand& command, const Metadata& settings) {
  if (!command.scene.empty()) return command.scene;
  const fs::path name = fs::path(setting(settings, "scene")).filename();
  return (fs::path(command.repeat).parent_path() / name).string() + ".nff";
}

// What the picture does not depend on stays as the command has it.
void take_picture_options(RenderCommand& command, RenderOptions options) {
  options.threads = command.options.threads;
  options.accel.counters = command.options.accel.counters;
  command.options = options;
}

// Of a picture that --time-limit ended: the number of its samples, or 0 where it has none.
uint32_t samples_done(std::string_view text) {
  uint32_t samples = 0;
  const char* const text_end = text.data() + text.size();
  const auto [end, error] = std::from_chars(text.data(), text_end, samples);
  return error == std::errc() && end == text_end ? samples : 0;
}

std::expected<RenderStart, int> start_by_repeat(const RenderCommand& command) {
  const auto refused = [&](std::string_view why) {
    return std::unexpected(fail(read_error(command.repeat, why)));
  };
  auto settings = read_metadata(command.repeat);
  if (!settings) return std::unexpected(fail(settings.error()));
  const auto options = options_from(*settings);
  if (!options) return refused(options.error());
  RenderStart start{command, std::move(*settings), 0, nullptr};
  take_picture_options(start.command, *options);
  start.command.scene = scene_of(command, start.settings);
  if (const auto done = setting(start.settings, "samples_done"); !done.empty()) {
    start.samples = samples_done(done);
    if (start.samples == 0 || start.samples > uint32_t(samples_per_pixel(*options)))
      return refused(fmt::format("it holds {} samples of its pixels, which do not repeat", done));
  }
  return start;
}

std::expected<RenderStart, int> start_by_part(const RenderCommand& command) {
  auto part = read_part(command.checkpoint);
  if (!part) return std::unexpected(fail(part.error()));
  const auto refused = [&](std::string why) {
    return std::unexpected(bad_input(command.checkpoint + ": " + std::move(why)));
  };
  if (part->header.shard != command.shard || part->header.shards != command.shards)
    return refused(part->header.shards > 1
                       ? fmt::format("it is shard {}/{} of a picture; add --shard {}/{}",
                                     part->header.shard + 1, part->header.shards,
                                     part->header.shard + 1, part->header.shards)
                       : "it is no shard of a picture; leave out --shard");
  RenderStart start{command, part->header.settings, 0, nullptr};
  if (command.add_samples > 0) {
    RenderOptions options = *options_from(part->header.settings);
    const SampleRange has = samples_of(*part);
    if (!is_extensible(options.samples))
      return refused(
          "its samples share out the cells of --aa and --lens-samples, so that none can be added; "
          "pictures made with --samples take more");
    if (has.fewest != has.most)
      return refused(fmt::format(
          "it is not finished: its tiles have {} to {} samples a pixel; go on with it by --resume "
          "first",
          has.fewest, has.most));
    if (has.most + uint64_t(command.add_samples) > uint64_t(kMaxSamples))
      return refused(fmt::format("more than {} samples a pixel cannot be", kMaxSamples));
    options.samples = int(has.most) + command.add_samples;
    take_picture_options(start.command, options);
  }
  start.film = std::move(part->film);
  return start;
}

}  // namespace

std::string long_render_conflict(const RenderCommand& c) {
  if (c.scene.empty() && c.repeat.empty())
    return "SCENE is missing: Scene file in the format NFF or P3F";
  const auto without = [](std::string_view option, std::string_view other) {
    return fmt::format("{0} has no effect without {1}; add {1} or leave {0} out", option, other);
  };
  if (c.checkpoint.empty()) {
    if (c.resume) return without("--resume", "--checkpoint");
    if (c.add_samples > 0) return without("--add-samples", "--checkpoint");
  }
  const std::string_view taker = !c.repeat.empty()   ? "--repeat"
                                 : c.add_samples > 0 ? "--add-samples"
                                                     : "";
  if (!taker.empty() && !c.of_picture.empty())
    return fmt::format("{} takes the options of the picture from its file; leave out {}", taker,
                       c.of_picture.front());
  if (!c.repeat.empty() && c.add_samples > 0)
    return "--repeat and --add-samples make different pictures; give one of them";
  if (c.shards > 1 && !is_part_path(c.output))
    return "--shard makes a part of a picture; give it a name in .raio, as in -o part1.raio";
  if (c.shards > 1 && c.time_limit_s > 0)
    return "shards under --time-limit would not have equally many samples; leave out one of them";
  return {};
}

std::expected<RenderStart, int> find_start(const RenderCommand& command) {
  std::error_code ignored;
  const bool kept = !command.checkpoint.empty() && fs::exists(command.checkpoint, ignored);
  if (kept && !command.resume && command.add_samples == 0)
    return std::unexpected(bad_input(
        fmt::format("{} exists; --resume goes on with it, otherwise remove it or give --checkpoint "
                    "another name",
                    command.checkpoint)));
  if (kept || command.add_samples > 0) {
    auto start = start_by_part(command);
    if (!start || command.repeat.empty()) return start;
    auto repeated = start_by_repeat(command);
    if (repeated) repeated->film = std::move(start->film);
    return repeated;
  }
  if (!command.repeat.empty()) return start_by_repeat(command);
  return RenderStart{command, {}, 0, nullptr};
}

std::expected<std::unique_ptr<Film>, int> film_of(RenderStart& start, const Scene& scene,
                                                  const RenderSettings& used,
                                                  const Metadata& settings) {
  const RenderCommand& command = start.command;
  const std::string& file = command.repeat.empty() ? command.checkpoint : command.repeat;
  const auto refused = [&](std::string_view why) {
    return std::unexpected(bad_input(fmt::format("{}: {}", file, why)));
  };
  if (!start.settings.empty()) {
    Metadata before = start.settings;
    // Of samples by Sobol's sequence any number is the beginning of more.
    if (is_extensible(used.samples) && command.repeat.empty())
      for (auto& [key, text] : before)
        if (key == "samples") text = setting(settings, "samples");
    const std::string version(setting(before, "version"));
    if (!command.repeat.empty() && version != RAIO_VERSION) {
      print_line(
          fmt::format("raio: warning: {} was made by Raio {}, this is {}; the picture may differ",
                      file, version, RAIO_VERSION));
      for (auto& [key, text] : before)
        if (key == "version") text = RAIO_VERSION;
    }
    if (const std::string why = difference(before, settings); !why.empty()) return refused(why);
  }
  auto film = make_film(scene, used);
  if (!film) return std::unexpected(no_resource(film.error()));
  if (!start.film) return std::move(*film);
  if (start.film->bound() != (*film)->bound()) return refused("its film is not made for the scene");
  for (size_t t = 0; t < start.film->tiles(); ++t)
    if (const uint32_t has = start.film->samples(t); has > uint32_t(used.samples_per_pixel()))
      return refused(
          fmt::format("it has {} samples a pixel already; ask for at least as many", has));
  return std::move(start.film);
}

Checkpoint::Checkpoint(const RenderCommand& command, PartHeader header, const Film& film)
    : path_(command.checkpoint), header_(std::move(header)), film_(film) {
  if (path_.empty()) return;
  ticker_ = Ticker(command.checkpoint_interval_s, [this] {
    const auto written = write_part(path_, header_, film_);
    if (!written && !told_)
      print_line(fmt::format("raio: warning: {}; the work goes on", written.error().message));
    told_ = !written;
  });
}

std::expected<void, FileError> Checkpoint::finish() {
  if (path_.empty()) return {};
  ticker_ = {};
  return write_part(path_, header_, film_);
}

}  // namespace raio::app
