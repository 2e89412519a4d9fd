#include <fmt/format.h>

#include <filesystem>

#include "app/commands.h"
#include "app/output.h"
#include "app/terminal.h"
#include "io/pov_write.h"
#include "io/scene_file.h"

namespace raio::core::app {

int run(const ExportCommand& command) {
  const std::filesystem::path scene_path(command.scene);
  const std::string output =
      !command.output.empty()
          ? command.output
          : (command.scene == "-" ? "stdin" : scene_path.stem().string()) + ".pov";
  if (output != "-" && std::filesystem::path(output).extension() != ".pov")
    return bad_input(fmt::format("expected a file that ends with .pov, found '{}'", output));
  if (const auto writable = check_writable(output); !writable) return fail(writable.error());
  auto scene = load_scene(command.scene, false, nullptr, command.read);
  if (!scene) return scene.error();
  if (const std::string lost = lost_features(*scene, SceneFormat::pov); !lost.empty())
    print_line(fmt::format("{}: warning: lost in this format: {}; a .raio scene stores everything",
                           output, lost));

  const RenderSettings settings = resolve_options(command.options, *scene);
  scene->camera = settings.camera;
  const PovPicture picture{
      .name = output == "-" ? scene->name : std::filesystem::path(output).stem().string(),
      .width = settings.width,
      .height = settings.height,
      .depth = settings.depth};
  return deliver(output,
                 write_pov(*scene, picture,
                           fmt::format("{}, exported by raio {}", scene->name, RAIO_VERSION)));
}

}  // namespace raio::core::app
