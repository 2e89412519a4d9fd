// Shared by the implementations of files.h.
#pragma once

#include <expected>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>

#include "base/platform/files.h"

namespace raio::core {

/// The system's text for an errno.
std::string system_reason(int error);

/// Follows a chain of links to a path that exists or can be created.
std::expected<std::filesystem::path, std::string> resolve_links(std::filesystem::path path);

/// The folder in which to create the temporary file for `path`.
std::expected<std::filesystem::path, std::string> folder_of(const std::filesystem::path& path);

/// "cannot create a file in the folder FOLDER: WHY"
std::string cannot_create(const std::filesystem::path& folder, int error);

/// The existing temporary files, for remove_unfinished_files().
struct UnfinishedFiles {
  std::mutex mutex;
  std::set<std::filesystem::path> paths;
};
UnfinishedFiles& unfinished_files();

}  // namespace raio::core
