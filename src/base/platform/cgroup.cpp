#include "base/platform/cgroup.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <memory>
#include <string_view>

namespace raio::core {
namespace {

// Nothing if the file is missing. Uses no stream: the first one would take longer than all of this.
std::optional<std::string> read_all(const std::string& path) {
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"),
                                                             &std::fclose);
  if (!file) return std::nullopt;
  std::string text;
  std::array<char, 4096> piece;
  while (const size_t got = std::fread(piece.data(), 1, piece.size(), file.get()))
    text.append(piece.data(), got);
  if (std::ferror(file.get())) return std::nullopt;
  return text;
}

// Removes the text before the next `end`, and `end`, from `rest`; returns the text.
std::string_view take(std::string_view& rest, char end) {
  const size_t size = std::min(rest.find(end), rest.size());
  const std::string_view taken = rest.substr(0, size);
  rest.remove_prefix(std::min(size + 1, rest.size()));
  return taken;
}

// Whether the comma-separated list contains the word.
bool lists(std::string_view words, std::string_view word) {
  while (!words.empty())
    if (take(words, ',') == word) return true;
  return false;
}

// Octal escapes such as "\040" are characters that would end a field.
std::string unescaped(std::string_view field) {
  std::string out;
  for (size_t i = 0; i < field.size(); ++i) {
    int code = 0;
    const char* const digits = field.data() + i + 1;
    if (field[i] == '\\' && i + 3 < field.size() &&
        std::from_chars(digits, digits + 3, code, 8).ptr == digits + 3) {
      out += char(code);
      i += 3;
    } else {
      out += field[i];
    }
  }
  return out;
}

// A line with nothing but an integer; nothing for "max" and other words.
std::optional<long long> number(std::string_view text) {
  text = take(text, '\n');
  long long value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<long long> number_in(const std::string& path) {
  const auto text = read_all(path);
  return text ? number(*text) : std::nullopt;
}

// The value of a name in a file of lines "name value"; 0 if missing.
long long value_in(const std::string& path, std::string_view name) {
  const auto text = read_all(path);
  std::string_view rest = text ? std::string_view(*text) : std::string_view();
  while (!rest.empty()) {
    std::string_view line = take(rest, '\n');
    if (take(line, ' ') == name) return number(line).value_or(0);
  }
  return 0;
}

// "quota period" in microseconds; "max" is no limit.
std::optional<double> cores_v2(const std::string& folder) {
  const auto text = read_all(folder + "/cpu.max");
  if (!text) return std::nullopt;
  std::string_view rest = *text;
  const auto quota = number(take(rest, ' ')), period = number(rest);
  if (!quota || !period || *quota <= 0 || *period <= 0) return std::nullopt;
  return double(*quota) / double(*period);
}

// A quota of -1 is no limit.
std::optional<double> cores_v1(const std::string& folder) {
  const auto quota = number_in(folder + "/cpu.cfs_quota_us");
  const auto period = number_in(folder + "/cpu.cfs_period_us");
  if (!quota || !period || *quota <= 0 || *period <= 0) return std::nullopt;
  return double(*quota) / double(*period);
}

struct Files {
  const char *limit, *used, *cached;
};

}  // namespace

ControlGroups::ControlGroups(std::string root) : root_(std::move(root)) {
  const auto groups = read_all(root_ + "/proc/self/cgroup");
  const auto mounts = read_all(root_ + "/proc/self/mountinfo");
  if (!groups || !mounts) return;
  cpu_ = hierarchy_of("cpu", *groups, *mounts);
  memory_ = hierarchy_of("memory", *groups, *mounts);
}

// A line of `groups` is "number:controllers:path"; in version 2 it lists no controllers. A
// controller is in one hierarchy only. A line of `mounts` (proc_pid_mountinfo(5)) is "number parent
// device root point options [tags] - type source options": `root` is the group mounted at `point`.
ControlGroups::Hierarchy ControlGroups::hierarchy_of(std::string_view controller,
                                                     std::string_view groups,
                                                     std::string_view mounts) const {
  std::optional<std::string> path;
  Hierarchy found;
  while (!groups.empty()) {
    std::string_view line = take(groups, '\n');
    const bool is_v2 = take(line, ':') == "0";
    const std::string_view controllers = take(line, ':');
    if (lists(controllers, controller)) {
      path = line, found.is_v2 = false;
      break;
    }
    if (is_v2 && controllers.empty()) path = line, found.is_v2 = true;
  }
  if (!path) return {};
  while (!mounts.empty()) {
    std::string_view line = take(mounts, '\n');
    for (int skipped = 0; skipped < 3; ++skipped) take(line, ' ');
    const std::string of_root = unescaped(take(line, ' ')), point = unescaped(take(line, ' '));
    while (!line.empty() && take(line, ' ') != "-") {
    }
    const std::string_view type = take(line, ' ');
    take(line, ' ');
    if (found.is_v2 ? type != "cgroup2" : type != "cgroup" || !lists(line, controller)) continue;
    // In containers of version 1, paths are those of the host. A group outside the mounted one then
    // has its files at the mount point.
    std::string below = *path;
    if (of_root != "/" && below.starts_with(of_root) &&
        (below.size() == of_root.size() || below[of_root.size()] == '/'))
      below.erase(0, of_root.size());
    else if (of_root != "/" || below.starts_with("/.."))
      below.clear();
    while (below.ends_with('/')) below.pop_back();
    for (;;) {
      found.folders.push_back(std::string(root_).append(point).append(below));
      if (below.empty()) return found;
      below.erase(below.rfind('/'));
    }
  }
  return {};
}

std::optional<double> ControlGroups::cores() const {
  std::optional<double> least;
  for (const std::string& folder : cpu_.folders)
    if (const auto cores = cpu_.is_v2 ? cores_v2(folder) : cores_v1(folder))
      least = std::min(*cores, least.value_or(*cores));
  return least;
}

std::optional<ControlGroups::Memory> ControlGroups::memory() const {
  const Files files = memory_.is_v2 ? Files{"/memory.max", "/memory.current", "inactive_file"}
                                    : Files{"/memory.limit_in_bytes", "/memory.usage_in_bytes",
                                            "total_inactive_file"};
  // Version 1 writes the largest number of whole pages for "no limit".
  constexpr long long kNoLimit = 1LL << 62;
  std::optional<Memory> least;
  for (const std::string& folder : memory_.folders) {
    const auto limit = number_in(folder + files.limit);
    if (!limit || *limit < 0 || *limit >= kNoLimit) continue;
    const long long used = number_in(folder + files.used).value_or(0);
    const long long cached = value_in(folder + "/memory.stat", files.cached);
    const auto left = size_t(std::max(0LL, *limit - std::max(0LL, used - cached)));
    if (!least || left < least->available) least = Memory{left, folder + files.limit};
  }
  return least;
}

}  // namespace raio::core
