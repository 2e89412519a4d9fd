// The suite of whole processes.
#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "bench/suites.h"
#include "io/file.h"
#include "io/nff/nff.h"

namespace raio::core::bench {
namespace {

using Command = std::vector<std::string>;

// Runs a program without input and output. Returns its exit status; 127 if it cannot run.
int run(const Command& command) {
  std::vector<char*> arguments;
  for (const std::string& a : command) arguments.push_back(const_cast<char*>(a.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t silent;
  posix_spawn_file_actions_init(&silent);
  posix_spawn_file_actions_addopen(&silent, 0, "/dev/null", O_RDONLY, 0);
  for (const int out : {1, 2})
    posix_spawn_file_actions_addopen(&silent, out, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const int error = posix_spawnp(&child, arguments[0], &silent, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&silent);
  int status = 0;
  if (error != 0 || waitpid(child, &status, 0) < 0) return 127;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

// A temporary folder, removed with its files.
struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / fmt::format("raio_bench_{}", getpid());
  Folder() { std::filesystem::create_directory(path); }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string operator/(const char* name) const { return (path / name).string(); }
};

// The available programs for the scene, each writing its picture into the folder.
std::vector<std::pair<std::string, Command>> programs(const std::string& file, const Folder& folder,
                                                      const Settings& s) {
  std::vector<std::pair<std::string, Command>> all;
  const std::string threads = std::to_string(s.options.threads);
  const auto add_if_present = [&](const std::string& name, const Command& command) {
    const int status = run(command);
    if (status == 0)
      all.emplace_back(name, command);
    else
      tell(fmt::format(
          "{} is left out: {}", name,
          status == 127 ? "not installed" : fmt::format("it ends with status {}", status)));
  };
  add_if_present("raio", {s.raio, "render", file, "-o", folder / "raio.png", "--threads", threads});
  if (all.empty()) give_up(3, s.raio + " cannot render " + file);
  add_if_present("tachyon", {"tachyon", file, "-fullshade", "-numthreads", threads, "-format",
                             "PPM", "-o", folder / "tachyon.ppm"});
  if (s.pov_converter.empty()) {
    tell("povray is left out: no --pov-converter");
  } else if (run({"python3", s.pov_converter, file, folder / "scene.pov"}) != 0) {
    tell("povray is left out: the converter fails");
  } else {
    add_if_present("povray", {"povray", "+I" + (folder / "scene.pov"), "+O" + (folder / "pov.png"),
                              "+W512", "+H512", "+WT" + threads, "-D", "-A"});
  }
  return all;
}

}  // namespace

std::vector<Json> process_suite(const Settings& request) {
  const Settings s = request.with_defaults({"balls_medium"}, {}, 21);
  std::vector<Json> rows;
  for (const std::string& name : s.scenes) {
    tell(name);
    const Folder folder;
    std::string file = name;
    if (!std::filesystem::exists(name)) {
      file = folder / "scene.nff";
      if (const auto written = write_file(file, write_nff(get_scene(name))); !written)
        give_up(3, written.error().text());
    }
    const auto all = programs(file, folder, s);
    std::vector<Contender> contenders;
    contenders.reserve(all.size());
    for (const auto& [program, arguments] : all)
      contenders.push_back([&command = arguments] { return seconds_of([&] { run(command); }); });
    const auto seconds = alternate(contenders, s.repeat);
    for (size_t i = 0; i < all.size(); ++i) {
      Json row;
      row["scene"] = std::filesystem::path(name).stem().string(), row["program"] = all[i].first;
      add_times(row, seconds[i], seconds[0]);
      rows.push_back(std::move(row));
    }
  }
  print_table(rows, {{"scene", "scene"},
                     {"program", "program"},
                     {"median_s", "ms", 1e3},
                     {"least_s", "least ms", 1e3},
                     {"ratio", "ratio"}});
  fmt::print("\nwhole processes, picture file included; medians of {} runs; {}\n", s.repeat,
             kRatioNote);
  return rows;
}

}  // namespace raio::core::bench
