// Frames of Dear ImGui without a window, with a mouse and a keyboard.
#pragma once

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <ranges>
#include <string>
#include <vector>

#include "view/layout.h"
#include "view/state.h"
#include "view/theme.h"

namespace raio::core::view {

inline constexpr float kWidth = 420, kHeight = 3400;

inline ViewState state_of_three() {
  Scene s;
  s.name = "three";
  s.camera.from = {0, -6, 2}, s.camera.at = {0, 0, 0.5f}, s.camera.up = {0, 0.1f, 1};
  s.background = {0.25f, 0.5f, 0.75f};
  for (int i = 0; i < 3; ++i) {
    s.lights.push_back({{3, -4, 5.0f + float(i)}, Rgb(0.5f)});
    s.materials.push_back({{0.5f, 0.5f, 0.25f + 0.125f * float(i)}, 0.5f, 0.25f, 10, 0.25f, 1.5f});
    s.spheres.push_back({{float(i), 0, 0}, 0.5f});
    s.sphere_materials.push_back(uint32_t(i));
  }
  ViewState state("three.nff", std::make_shared<const Scene>(std::move(s)), {});
  state.chosen_light = state.chosen_material = 1;
  return state;
}

class Screen {
 public:
  explicit Screen(std::function<void()> draw, ImVec2 size = {kWidth, kHeight})
      : context_(ImGui::CreateContext()), draw_(draw), size_(size) {
    ImGui::SetCurrentContext(context_);
    ImGuiIO& io = ImGui::GetIO();
    io.DisplaySize = size, io.IniFilename = nullptr;
    io.KeyMap[ImGuiKey_Enter] = kEnter;
    apply_look({}, 1);
    unsigned char* pixels = nullptr;
    int width = 0, height = 0;
    io.Fonts->GetTexDataAsRGBA32(&pixels, &width, &height);
    frame(), frame();
  }
  ~Screen() { ImGui::DestroyContext(context_); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void frame() {
    ImGui::GetIO().DeltaTime = 0.5f;  // so that no two clicks are a double one
    ImGui::NewFrame();
    draw_();
    ImGui::Render();
  }
  void move(ImVec2 to) { ImGui::GetIO().MousePos = to, frame(); }
  void button(bool down) { ImGui::GetIO().MouseDown[0] = down, frame(); }
  void click(ImVec2 at) { move(at), button(true), button(false), frame(); }
  void drag(ImVec2 from) {
    move(from), button(true);
    for (int i = 1; i <= 4; ++i) move({from.x + 5.0f * float(i), from.y});
    button(false), frame();
  }
  // Into the field that has the keyboard, and Enter.
  void type(const char* text) {
    ImGuiIO& io = ImGui::GetIO();
    io.AddInputCharactersUTF8(text), frame();
    io.KeysDown[kEnter] = true, frame();
    io.KeysDown[kEnter] = false, frame();
  }
  // Every control that reacts to the cursor, each with a position where it does.
  std::map<ImGuiID, ImVec2> widgets() { return widgets({0, 0, size_.x, size_.y}); }
  std::map<ImGuiID, ImVec2> widgets(const Rect& area) {
    std::map<ImGuiID, std::vector<ImVec2>> places;
    for (float y = area.top + 2; y < area.bottom; y += 7)
      for (float x = area.left + 4; x < area.right; x += 9) {
        move({x, y});
        if (const ImGuiID id = context_->HoveredId) places[id].push_back({x, y});
      }
    // Excludes areas that only scroll.
    for (const ImGuiWindow* window : context_->Windows)
      for (const char* bar : {"#SCROLLX", "#SCROLLY"}) places.erase(ImHashStr(bar, 0, window->ID));
    std::map<ImGuiID, ImVec2> middles;
    for (const auto& [id, all] : places) {
      ImVec2 sum(0, 0);
      for (const ImVec2& p : all) sum.x += p.x, sum.y += p.y;
      const auto count = float(all.size());
      middles[id] = *std::ranges::min_element(all, {}, [&](const ImVec2& p) {
        return std::hypot(p.x - sum.x / count, p.y - sum.y / count);
      });
    }
    return middles;
  }
  // The entries of the open list, from the top.
  std::vector<ImVec2> entries() {
    const ImGuiWindow& list = *context_->OpenPopupStack.back().Window;
    std::vector<ImVec2> places;
    const ImVec2 lo = list.Pos, hi(lo.x + list.Size.x, lo.y + list.Size.y);
    for (const ImVec2 p : widgets({lo.x, lo.y, hi.x, hi.y}) | std::views::values)
      places.push_back(p);
    std::ranges::sort(places, {}, &ImVec2::y);
    return places;
  }
  // The screen with the cursor out of the way.
  uint64_t sum() {
    move({-1, -1}), frame();
    std::string bytes;
    const ImDrawData& data = *ImGui::GetDrawData();
    for (int i = 0; i < data.CmdListsCount; ++i) {
      const ImDrawList& list = *data.CmdLists[i];
      bytes.append(reinterpret_cast<const char*>(list.VtxBuffer.Data),
                   size_t(list.VtxBuffer.size_in_bytes()));
    }
    return std::hash<std::string>()(bytes);
  }
  bool is_popup_open() const { return context_->OpenPopupStack.Size > 0; }
  ImGuiContext& context() { return *context_; }

 private:
  static constexpr int kEnter = 1;

  ImGuiContext* context_;
  std::function<void()> draw_;
  ImVec2 size_;
};

}  // namespace raio::core::view
