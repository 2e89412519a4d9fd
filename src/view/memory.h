// The window's settings that outlast a run: its appearance, its size and recent scenes. A small
// text file in the user's state folder; everything works without it.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {

struct Memory {
  Theme look;
  std::optional<Language> language;  // none: never chosen
  std::vector<std::string> recent;   // absolute paths, the newest first
  int width = 0, height = 0;         // of the window, in its units; 0: never closed
  bool panel = true;
  bool costs_as_reported = false;  // CostOf::report
  std::set<std::string> sections;  // switched_sections() in panel_parts.h

  /// Moves a scene to the head of the list, and drops the oldest.
  void opened(const std::string& path);

  friend bool operator==(const Memory&, const Memory&) = default;
};

/// $XDG_STATE_HOME/raio/window, else ~/.local/state/raio/window; empty without a home folder.
std::filesystem::path memory_file();

/// Missing or invalid settings have their defaults. Deleted scenes are omitted.
Memory recall(const std::filesystem::path& file);

/// A file that cannot be written is no error: the window works without.
void remember(const Memory& memory, const std::filesystem::path& file);

/// Writes changes to the user's file at once.
class MemoryKeeper {
 public:
  explicit MemoryKeeper(Memory memory) : memory_(std::move(memory)), language_(language()) {}

  const Memory& memory() const { return memory_; }
  void opened(const std::string& path);
  /// Stores a language once it has been changed.
  void looks(const Theme& look, Language now);
  /// The window's size and layout, which change too often to be written at once.
  void closed(const Memory& now);

 private:
  Memory memory_;
  Language language_;
};

/// The folder with Raio's scenes/ and docs/: a parent folder of the program, or where they are
/// installed; empty if there is none.
std::filesystem::path root_folder();

/// The scenes that come with Raio, and those of the course.
struct SampleScenes {
  std::vector<std::string> course, others;
};
SampleScenes sample_scenes();

}  // namespace raio::core::view
