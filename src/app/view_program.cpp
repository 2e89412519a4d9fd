// Starts the window, which is a separate program.
#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "app/output.h"

namespace raio::core::app {

int become_view_program(char** argv) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::string program = (self.parent_path() / "raio_view").string();
  if (!error) ::execv(program.c_str(), argv);
  return bad_input(fmt::format("cannot start the window, {}: {}", program,
                               std::generic_category().message(errno)));
}

}  // namespace raio::core::app
