#include "view/theme.h"

#include <imgui_internal.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>
#include <system_error>
#include <vector>

namespace raio::core::view {
namespace {

constexpr float kTextSize = 15, kProjector = 1.5f;

ImVec4 rgb(unsigned hex) {
  return {float(hex >> 16 & 255) / 255, float(hex >> 8 & 255) / 255, float(hex & 255) / 255, 1};
}

const Palette kDark{.mat = rgb(0x101114),
                    .ground = rgb(0x1b1d22),
                    .raised = rgb(0x2a2d34),
                    .hovered = rgb(0x383c45),
                    .line = rgb(0x33363e),
                    .text = rgb(0xe6e7ea),
                    .faint = rgb(0x999da7),
                    .accent = rgb(0x4c8dff),
                    .on_accent = rgb(0xffffff),
                    .good = rgb(0x54c08a),
                    .busy = rgb(0x5aa9f0),
                    .warning = rgb(0xf0b04a),
                    .bad = rgb(0xff7468)};
const Palette kLight{.mat = rgb(0xd3d6dc),
                     .ground = rgb(0xf6f7f9),
                     .raised = rgb(0xe4e7ec),
                     .hovered = rgb(0xd5dae2),
                     .line = rgb(0xcfd3da),
                     .text = rgb(0x1c1f25),
                     .faint = rgb(0x5d636f),
                     .accent = rgb(0x1f5fd6),
                     .on_accent = rgb(0xffffff),
                     .good = rgb(0x187a48),
                     .busy = rgb(0x1d63b5),
                     .warning = rgb(0x96590a),
                     .bad = rgb(0xb92318)};

Palette g_palette = kDark;
float g_em = kTextSize;
ImFont *g_heading = nullptr, *g_title = nullptr, *g_code = nullptr;

// The usual locations; without these files, ImGui's built-in pixel font is used.
constexpr std::array kRegular = {"/usr/share/fonts/opentype/inter/Inter-Regular.otf",
                                 "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
                                 "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
                                 "/usr/share/fonts/TTF/DejaVuSans.ttf"};
constexpr std::array kHeavy = {"/usr/share/fonts/opentype/inter/Inter-SemiBold.otf",
                               "/usr/share/fonts/truetype/dejavu/DejaVuSans-Bold.ttf",
                               "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans-Bold.ttf",
                               "/usr/share/fonts/TTF/DejaVuSans-Bold.ttf"};
constexpr std::array kMedium = {"/usr/share/fonts/opentype/inter/Inter-Medium.otf"};
constexpr std::array kCode = {"/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf",
                              "/usr/share/fonts/dejavu-sans-mono-fonts/DejaVuSansMono.ttf",
                              "/usr/share/fonts/TTF/DejaVuSansMono.ttf"};
// For other letters in names: Latin, Greek and Cyrillic, then Chinese, Japanese and Korean. All
// available ones are tried in turn.
constexpr std::array kOtherScripts = {
    "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
    "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf",
    "/usr/share/fonts/TTF/DejaVuSans.ttf",
    "/usr/share/fonts/opentype/noto/NotoSansCJK-Regular.ttc",
    "/usr/share/fonts/google-noto-sans-cjk-fonts/NotoSansCJK-Regular.ttc",
    "/usr/share/fonts/noto-cjk/NotoSansCJK-Regular.ttc",
    "/usr/share/fonts/truetype/wqy/wqy-microhei.ttc",
    "/usr/share/fonts/wqy-microhei/wqy-microhei.ttc",
    "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",
    "/usr/share/fonts/opentype/ipafont-gothic/ipag.ttf",
    "/usr/share/fonts/truetype/nanum/NanumGothic.ttf"};
constexpr size_t kMaxLetters = 2000;  // each uses space in a texture

std::set<ImWchar> g_letters;  // that occur in names
bool g_wants_letters = false;

// In ImGui's format, read when the texture is made.
const ImWchar* other_letters() {
  static std::vector<ImWchar> ranges;
  ranges.clear();
  for (const ImWchar letter : g_letters) ranges.insert(ranges.end(), 2, letter);
  ranges.push_back(0);
  return ranges.data();
}

// Adds them to the font that was loaded last, from it and from others.
void load_other_letters(const char* own, float size) {
  if (g_letters.empty()) return;
  ImFontConfig merges;
  merges.MergeMode = true;
  const ImWchar* const letters = other_letters();
  std::error_code ignored;
  const auto merge = [&](const char* file) {
    if (std::filesystem::exists(file, ignored))
      ImGui::GetIO().Fonts->AddFontFromFileTTF(file, std::round(size), &merges, letters);
  };
  merge(own);
  for (const char* file : kOtherScripts) merge(file);
}

// Titles contain no names.
enum class Letters { of_names_too, own };

template <size_t N>
ImFont* load(const std::array<const char*, N>& files, float size, const ImWchar* letters,
             Letters which) {
  std::error_code ignored;
  for (const char* file : files) {
    if (!std::filesystem::exists(file, ignored)) continue;
    ImFont* const font =
        ImGui::GetIO().Fonts->AddFontFromFileTTF(file, std::round(size), nullptr, letters);
    if (font && which == Letters::of_names_too) load_other_letters(file, size);
    return font;
  }
  return nullptr;
}

void load_fonts(const Theme& look, float scale) {
  ImGuiIO& io = ImGui::GetIO();
  io.Fonts->Clear();
  g_wants_letters = false;
  // Western Europe's letters and the infinity sign; only the title's letters for the title font.
  // Each letter costs time when the window opens.
  static constexpr std::array<ImWchar, 5> kAll = {0x20, 0xff, 0x221e, 0x221e, 0};
  static constexpr std::array<ImWchar, 3> kAscii = {0x20, 0x7e, 0};
  static constexpr std::array<ImWchar, 9> kTitle = {'R', 'R', 'a', 'a', 'i', 'i', 'o', 'o', 0};
  ImFont* body = look.projector ? load(kMedium, g_em, kAll.data(), Letters::of_names_too) : nullptr;
  if (!body) body = load(kRegular, g_em, kAll.data(), Letters::of_names_too);
  g_heading = load(kHeavy, g_em, kAll.data(), Letters::of_names_too);
  g_title = load(kHeavy, 2 * g_em, kTitle.data(), Letters::own);
  g_code = load(kCode, 0.9f * g_em, kAscii.data(), Letters::of_names_too);
  io.FontGlobalScale = 1;
  if (!body) {
    body = io.Fonts->AddFontDefault();
    io.FontGlobalScale = scale * (look.projector ? kProjector : 1);
  }
  if (!g_heading) g_heading = body;
  if (!g_title) g_title = body;
  if (!g_code) g_code = body;
  io.FontDefault = body;
}

void set_colors(const Palette& p) {
  auto& c = ImGui::GetStyle().Colors;
  const auto clear = ImVec4(0, 0, 0, 0);
  c[ImGuiCol_Text] = p.text, c[ImGuiCol_TextDisabled] = p.faint;
  c[ImGuiCol_WindowBg] = c[ImGuiCol_PopupBg] = p.ground, c[ImGuiCol_ChildBg] = clear;
  c[ImGuiCol_Border] = c[ImGuiCol_Separator] = p.line, c[ImGuiCol_BorderShadow] = clear;
  c[ImGuiCol_FrameBg] = c[ImGuiCol_Button] = p.raised;
  c[ImGuiCol_FrameBgHovered] = c[ImGuiCol_ButtonHovered] = p.hovered;
  c[ImGuiCol_FrameBgActive] = c[ImGuiCol_ButtonActive] = p.hovered;
  c[ImGuiCol_Header] = p.raised;
  c[ImGuiCol_HeaderHovered] = c[ImGuiCol_HeaderActive] = p.hovered;
  c[ImGuiCol_CheckMark] = c[ImGuiCol_SliderGrab] = c[ImGuiCol_SliderGrabActive] = p.accent;
  c[ImGuiCol_TextSelectedBg] = {p.accent.x, p.accent.y, p.accent.z, 0.35f};
  c[ImGuiCol_NavHighlight] = p.accent;
  c[ImGuiCol_ScrollbarBg] = clear, c[ImGuiCol_ScrollbarGrab] = p.hovered;
  c[ImGuiCol_ScrollbarGrabHovered] = c[ImGuiCol_ScrollbarGrabActive] = p.faint;
  c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = p.raised;
  c[ImGuiCol_TableHeaderBg] = p.raised, c[ImGuiCol_TableRowBg] = clear;
  c[ImGuiCol_TableRowBgAlt] = {p.text.x, p.text.y, p.text.z, 0.04f};
  c[ImGuiCol_TableBorderStrong] = c[ImGuiCol_TableBorderLight] = p.line;
  c[ImGuiCol_PlotHistogram] = p.accent;
  c[ImGuiCol_ModalWindowDimBg] = {0, 0, 0, 0.45f};
}

}  // namespace

void apply_look(const Theme& look, float scale) {
  g_palette = look.light ? kLight : kDark;
  if (look.projector) g_palette.faint = g_palette.text;  // grey is unreadable in a lecture hall
  g_em = em_of(look, scale);
  load_fonts(look, scale);
  ImGuiStyle& style = ImGui::GetStyle() = ImGuiStyle();
  set_colors(g_palette);
  const auto ems = [](float x, float y) {
    return ImVec2(std::round(x * g_em), std::round(y * g_em));
  };
  style.WindowRounding = style.WindowBorderSize = 0;
  style.FrameRounding = style.GrabRounding = style.PopupRounding = std::round(0.3f * g_em);
  style.ScrollbarRounding = style.FrameRounding;
  style.PopupBorderSize = 1, style.FrameBorderSize = 0;
  style.WindowPadding = ems(0.8f, 0.7f), style.FramePadding = ems(0.5f, 0.2f);
  style.ItemSpacing = ems(0.5f, 0.33f), style.ItemInnerSpacing = ems(0.45f, 0.3f);
  style.CellPadding = ems(0.3f, 0.15f), style.IndentSpacing = g_em;
  style.ScrollbarSize = std::round(0.6f * g_em), style.GrabMinSize = 0.7f * g_em;
}

void show_letters(std::string_view text) {
  for (const char *at = text.data(), *const end = at + text.size(); at < end;) {
    if (static_cast<unsigned char>(*at) < 0x80) {
      ++at;
      continue;
    }
    unsigned letter = 0;
    at += std::max(1, ImTextCharFromUtf8(&letter, at, end));
    // Code points beyond ImWchar have no glyph.
    if (letter <= 0xff || letter >= IM_UNICODE_CODEPOINT_INVALID) continue;
    if (g_letters.size() < kMaxLetters && g_letters.insert(ImWchar(letter)).second)
      g_wants_letters = true;
  }
}

bool wants_letters() { return g_wants_letters; }

const Palette& palette() { return g_palette; }
float em() { return g_em; }
float em_of(const Theme& look, float scale) {
  return std::round(kTextSize * scale * (look.projector ? kProjector : 1));
}
ImFont* heading_font() { return g_heading; }
ImFont* title_font() { return g_title; }
ImFont* code_font() { return g_code; }

}  // namespace raio::core::view
