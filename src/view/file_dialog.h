// A dialog for choosing a file to open or to write.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "view/layout.h"

namespace raio::core::view {

/// The subfolders (first, with a trailing "/") and files of a folder, by name, without hidden ones:
/// scenes or pictures by their suffixes, or all files.
enum class FileKind { scenes, pictures, all };
std::vector<std::string> entries_of(const std::filesystem::path& folder,
                                    FileKind kind = FileKind::scenes);

/// Whether read_picture() (io/image/image.h) reads such files.
bool has_picture_suffix(const std::filesystem::path& path);

class FileDialog {
 public:
  enum class Purpose { open, compare, save };

  /// Starts in that folder; `name` is the proposal.
  void ask(Purpose purpose, const std::filesystem::path& folder, std::string name);
  bool is_open() const { return is_open_; }
  void close() { is_open_ = false; }
  Purpose purpose() const { return purpose_; }

  /// Draws it; returns the chosen file, once.
  std::optional<std::string> draw(const Layout& layout);

 private:
  void enter(const std::filesystem::path& folder);
  std::optional<std::string> chosen(const std::string& name);

  bool is_open_ = false;
  Purpose purpose_ = Purpose::open;
  std::filesystem::path folder_;
  std::vector<std::string> entries_;
  std::string name_;
  bool all_files_ = false;
};

}  // namespace raio::core::view
