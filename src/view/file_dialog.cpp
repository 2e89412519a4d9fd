#include "view/file_dialog.h"

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>

#include "io/file.h"
#include "io/scene_file.h"
#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace fs = std::filesystem;

bool has_picture_suffix(const fs::path& path) {
  constexpr std::array<std::string_view, 6> kSuffixes = {".png", ".jpg", ".jpeg",
                                                         ".exr", ".pfm", ".ppm"};
  return std::ranges::count(kSuffixes, lower_suffix(path)) > 0;
}

std::vector<std::string> entries_of(const fs::path& folder, FileKind kind) {
  const auto fits = [kind](const fs::path& path) {
    return kind == FileKind::all ||
           (kind == FileKind::scenes ? has_scene_suffix(path) : has_picture_suffix(path));
  };
  std::vector<std::string> folders, files;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with('.')) continue;
    if (entry.is_directory(error))
      folders.push_back(name + "/");
    else if (fits(entry.path()))
      files.push_back(name);
  }
  std::ranges::sort(folders);
  std::ranges::sort(files);
  folders.insert(folders.end(), files.begin(), files.end());
  return folders;
}

void FileDialog::ask(Purpose purpose, const fs::path& folder, std::string name) {
  purpose_ = purpose, name_ = std::move(name), is_open_ = true;
  enter(folder);
}

void FileDialog::enter(const fs::path& folder) {
  std::error_code error;
  const fs::path whole = fs::weakly_canonical(fs::absolute(folder, error), error);
  folder_ = error ? folder : whole;
  const bool compares = purpose_ == Purpose::compare;
  entries_ = entries_of(folder_, all_files_ ? FileKind::all
                                 : compares ? FileKind::pictures
                                            : FileKind::scenes);
}

// Enters a folder; a file ends the dialog.
std::optional<std::string> FileDialog::chosen(const std::string& name) {
  if (name.empty()) return std::nullopt;
  const fs::path path = folder_ / name;  // an absolute name replaces the folder
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    enter(path);
    if (purpose_ != Purpose::save) name_.clear();
    return std::nullopt;
  }
  is_open_ = false;
  return path.string();
}

std::optional<std::string> FileDialog::draw(const Layout& layout) {
  if (!is_open_) return std::nullopt;
  const float width = std::min(40 * em(), layout.tool_bar.right),
              height = std::min(32 * em(), layout.picture.height());
  ImGui::SetNextWindowPos({(layout.tool_bar.right - width) / 2,
                           layout.picture.top + (layout.picture.height() - height) / 2});
  ImGui::SetNextWindowSize({width, height});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0.5f * em());
  ImGui::PushStyleVar(ImGuiStyleVar_WindowBorderSize, 1);
  const bool saves = purpose_ == Purpose::save, compares = purpose_ == Purpose::compare;
  const char* const title = saves      ? tr("Save the scene")
                            : compares ? tr("Compare with a picture")
                                       : tr("Open a scene");
  ImGui::Begin(fmt::format("{}###file", title).c_str(), &is_open_,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                   ImGuiWindowFlags_NoSavedSettings);
  std::optional<std::string> wanted;
  if (ImGui::Button(tr("up"))) wanted = "..";
  ImGui::SameLine();
  ImGui::AlignTextToFramePadding();
  faint_text(folder_.string());
  const float rows = 3 * ImGui::GetFrameHeightWithSpacing();
  ImGui::BeginChild("entries", {0, -rows}, true);
  show_letters(name_);
  for (const std::string& entry : entries_) {
    show_letters(entry);
    if (ImGui::Selectable(entry.c_str())) {
      if (saves && !entry.ends_with('/'))
        name_ = entry;  // proposes the name; replacing the file takes another click
      else
        wanted = entry;
    }
  }
  if (entries_.empty())
    faint_text(all_files_ ? tr("nothing here")
               : compares ? tr("no pictures here")
                          : tr("no scenes here"));
  ImGui::EndChild();
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1);
  if (ImGui::InputTextWithHint("##name", tr("file name"), &name_,
                               ImGuiInputTextFlags_EnterReturnsTrue))
    wanted = name_;
  std::error_code ignored;
  const bool exists = !name_.empty() && fs::is_regular_file(folder_ / name_, ignored);
  if (saves)
    faint_text(exists ? tr("this file exists and will be replaced") : " ");
  else if (ImGui::Checkbox(tr("all files"), &all_files_))
    enter(folder_);
  const char* const action = !saves ? tr("Open") : exists ? tr("Replace") : tr("Save");
  if (ImGui::Button(fmt::format("{}###do", action).c_str(), {7 * em(), 0})) wanted = name_;
  ImGui::SameLine();
  if (ImGui::Button(tr("Cancel"), {7 * em(), 0})) is_open_ = false;
  ImGui::End();
  ImGui::PopStyleVar(2);
  return wanted ? chosen(*wanted) : std::nullopt;
}

}  // namespace raio::core::view
