#include "view/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <system_error>

#include "io/file.h"
#include "io/scene_file.h"

namespace raio::core::view {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxRecent = 12;

const char* variable(const char* name) {
  const char* const value = std::getenv(name);  // NOLINT(concurrency-mt-unsafe)
  return value && *value ? value : nullptr;
}

std::vector<std::string> scenes_in(const fs::path& folder) {
  std::vector<std::string> scenes;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (has_scene_suffix(entry.path())) scenes.push_back(entry.path().string());
  std::ranges::sort(scenes);
  return scenes;
}

}  // namespace

void Memory::opened(const std::string& path) {
  std::error_code ignored;
  const std::string whole = fs::absolute(path, ignored).lexically_normal().string();
  std::erase(recent, whole);
  recent.insert(recent.begin(), whole);
  if (recent.size() > kMaxRecent) recent.resize(kMaxRecent);
}

fs::path memory_file() {
  if (const char* state = variable("XDG_STATE_HOME")) return fs::path(state) / "raio" / "window";
  if (const char* home = variable("HOME")) return fs::path(home) / ".local/state/raio/window";
  return {};
}

Memory recall(const fs::path& file) {
  Memory memory;
  const auto text = read_file(file, 1 << 20);
  if (!text) return memory;
  std::istringstream lines(*text);
  for (std::string line; std::getline(lines, line);) {
    std::error_code ignored;
    if (line == "light") memory.look.light = true;
    if (line == "projector") memory.look.projector = true;
    if (line == "language en") memory.language = Language::english;
    if (line == "language pt") memory.language = Language::portuguese;
    if (line.starts_with("section ")) memory.sections.insert(line.substr(8));
    if (line == "costs as reported") memory.costs_as_reported = true;
    if (line == "no panel") memory.panel = false;
    if (line.starts_with("size "))
      std::istringstream(line.substr(5)) >> memory.width >> memory.height;
    if (line.starts_with("recent ") && memory.recent.size() < kMaxRecent &&
        fs::exists(line.substr(7), ignored))
      memory.recent.push_back(line.substr(7));
  }
  return memory;
}

void remember(const Memory& memory, const fs::path& file) {
  if (file.empty()) return;
  std::string text;
  if (memory.look.light) text += "light\n";
  if (memory.look.projector) text += "projector\n";
  if (memory.language)
    text += *memory.language == Language::portuguese ? "language pt\n" : "language en\n";
  if (memory.width > 0 && memory.height > 0)
    text += fmt::format("size {} {}\n", memory.width, memory.height);
  if (!memory.panel) text += "no panel\n";
  if (memory.costs_as_reported) text += "costs as reported\n";
  for (const std::string& name : memory.sections) text += "section " + name + "\n";
  for (const std::string& path : memory.recent)
    if (path.find('\n') == std::string::npos) text += "recent " + path + "\n";
  std::error_code ignored;
  fs::create_directories(file.parent_path(), ignored);
  (void)write_file(file, text);
}

void MemoryKeeper::opened(const std::string& path) {
  memory_.opened(path);
  remember(memory_, memory_file());
}

void MemoryKeeper::looks(const Theme& look, Language now) {
  Memory next = memory_;
  next.look = look;
  if (std::exchange(language_, now) != now) next.language = now;
  if (next == memory_) return;
  memory_ = std::move(next);
  remember(memory_, memory_file());
}

void MemoryKeeper::closed(const Memory& now) {
  if (now == memory_) return;
  memory_ = now;
  remember(memory_, memory_file());
}

fs::path root_folder() {
  std::error_code error;
  fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (int up = 0; up < 4 && !folder.empty(); ++up, folder = folder.parent_path())
    for (const fs::path& there : {folder, folder / "share/raio"})
      if (!scenes_in(there / "scenes").empty()) return there;
  return {};
}

SampleScenes sample_scenes() {
  const fs::path root = root_folder();
  if (root.empty()) return {};
  return {scenes_in(root / "scenes/course"), scenes_in(root / "scenes")};
}

}  // namespace raio::core::view
