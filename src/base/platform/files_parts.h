// What the ways to write files share, whatever the system. For this folder.
#pragma once

#include <expected>
#include <filesystem>
#include <mutex>
#include <set>
#include <string>

#include "base/platform/files.h"

namespace raio {

/// The system's words for an errno.
std::string system_reason(int error);

/// Where a chain of links ends, with a path that exists or that may come to exist.
std::expected<std::filesystem::path, std::string> resolve_links(std::filesystem::path path);

/// The folder to make a file in that is to become `path`.
std::expected<std::filesystem::path, std::string> folder_of(const std::filesystem::path& path);

/// "cannot make a file in the folder FOLDER: WHY"
std::string cannot_create(const std::filesystem::path& folder, int error);

/// The temporary files there are, for remove_unfinished_files().
struct UnfinishedFiles {
  std::mutex mutex;
  std::set<std::filesystem::path> paths;
};
UnfinishedFiles& unfinished_files();

}  // namespace raio
