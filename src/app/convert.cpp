#include <fmt/format.h>

#include "app/commands.h"
#include "app/output.h"
#include "app/terminal.h"
#include "io/scene_file.h"

namespace raio::core::app {

int run(const ConvertCommand& command) {
  const auto format = scene_format(command.output);
  if (!format) return fail(format.error());
  if (const auto writable = check_writable(command.output); !writable)
    return fail(writable.error());
  ReadOptions read = command.read;
  read.instances = *format == SceneFormat::raio || *format == SceneFormat::gltf;
  const auto scene = load_scene(command.input, false, nullptr, read);
  if (!scene) return scene.error();

  if (const std::string lost = lost_features(*scene, *format); !lost.empty())
    print_line(fmt::format("{}: warning: lost in this format: {}; a .raio scene stores everything",
                           command.output, lost));
  const auto comment = fmt::format("{}, written by raio {}", scene->name, RAIO_VERSION);
  const auto written = write_scene(*scene, command.output, comment);
  return written ? int(kDone) : fail(written.error());
}

}  // namespace raio::core::app
