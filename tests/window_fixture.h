// The real window, with a scene in a separate folder, on a display shared by all tests of a suite.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "temporary_folder.h"
#include "window_driver.h"

namespace raio::core {

// A mirror, a ball of glass and a coloured one over a floor.
inline constexpr std::string_view kWindowScene =
    "b 0.1 0.2 0.3\n"
    "v\nfrom 0 -6 2\nat 0 0 0.5\nup 0 0 1\nangle 40\nhither 0\nresolution 160 120\n"
    "l 3 -4 5\n"
    "f 1 0 0 0.8 0.4 10 0 1\ns 0 0 0.7 0.7\n"
    "f 0 1 0 0.8 0 1 0 1\ns 1.4 -0.5 0.5 0.5\n"
    "f 1 1 1 0.1 0.1 10 0.8 1.5\ns -1.4 -0.8 0.5 0.5\n"
    "f 0.8 0.8 0.7 0.9 0 1 0 1\np 4\n-5 -5 0\n5 -5 0\n5 5 0\n-5 5 0\n";

class WindowTest : public TemporaryFolder {
 protected:
  static void SetUpTestSuite() { display_ = new Display; }
  static void TearDownTestSuite() { delete std::exchange(display_, nullptr); }

  void SetUp() override {
    ASSERT_FALSE(display_->name().empty()) << "Xvfb does not start; packages.txt has it";
    put(file("scene.nff"), kWindowScene);
  }

  // With a picture of 160x120, unless the arguments have another size.
  std::unique_ptr<WindowDriver> open(std::vector<std::string> arguments = {}) const {
    if (std::ranges::find(arguments, "--size") == arguments.end())
      arguments.insert(arguments.begin(), {"--size", "160x120"});
    arguments.insert(arguments.begin(), "scene.nff");
    return std::make_unique<WindowDriver>(*display_, arguments, folder().string());
  }

  // With a picture that fills a window of this size, as remembered.
  std::unique_ptr<WindowDriver> open_filled(int width, int height) const {
    remember(fmt::format("size {} {}", width, height));
    return std::make_unique<WindowDriver>(*display_, std::vector<std::string>{"scene.nff"},
                                          folder().string());
  }

  // A line of the file in which the window remembers its settings.
  void remember(const std::string& line) const {
    std::filesystem::create_directories(folder() / "state/raio");
    put(folder() / "state/raio/window", line + "\n");
  }

  std::unique_ptr<WindowDriver> open_without_scene(std::vector<std::string> arguments = {}) const {
    return std::make_unique<WindowDriver>(*display_, arguments, folder().string());
  }

  // Runs a command line of the log with another name for the picture.
  void run(std::string command, const std::string& output) const {
    ASSERT_TRUE(command.starts_with(RAIO_PROGRAM " render ")) << command;
    command = command.substr(0, command.rfind(" -o ")) + " -o " + output;
    ASSERT_EQ(std::system(("cd " + folder().string() + " && " + command + " --quiet").c_str()), 0)
        << command;
  }

  static inline Display* display_ = nullptr;
};

}  // namespace raio::core
