// What the window remembers from one time to the next: how it looks and which scenes were open. A
// small text in the user's folder for such things; without it nothing is missing but comfort.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "view/texts.h"
#include "view/theme.h"

namespace raio::view {

struct Memory {
  Theme look;
  std::optional<Language> language;  // none: nobody has chosen one
  std::vector<std::string> recent;   // absolute paths, the newest first

  /// Puts a scene at the head of the list, once, and forgets the oldest.
  void opened(const std::string& path);

  friend bool operator==(const Memory&, const Memory&) = default;
};

/// $XDG_STATE_HOME/raio/window, else ~/.local/state/raio/window; empty where there is no home.
std::filesystem::path memory_file();

/// What is not there, or not understood, is as at first. Scenes that are gone are left out.
Memory recall(const std::filesystem::path& file);

/// A file that cannot be written is no error: the window works without.
void remember(const Memory& memory, const std::filesystem::path& file);

/// Writes what is new to the user's file at once.
class MemoryKeeper {
 public:
  explicit MemoryKeeper(Memory memory) : memory_(std::move(memory)), language_(language()) {}

  const Memory& memory() const { return memory_; }
  void opened(const std::string& path);
  /// A language counts once it has been changed.
  void looks(const Theme& look, Language now);

 private:
  Memory memory_;
  Language language_;
};

/// The scenes that come with Raio: in "scenes" of a folder above that of the program, or where they
/// are installed.
std::vector<std::string> sample_scenes();

}  // namespace raio::view
