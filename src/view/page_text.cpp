#include "view/page_text.h"

#include <imgui.h>

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <vector>

#include "view/panel_parts.h"
#include "view/texts.h"
#include "view/theme.h"

namespace raio::core::view {
namespace {

constexpr float kLeading = 0.3f;   // between lines of text, ems
constexpr float kBlockGap = 0.1f;  // between blocks, in addition to that of all controls, ems
constexpr float kSlope = 0.2f;     // of italics
constexpr float kPicture = 12;     // share of a picture in a table's width, relative to text in ems
constexpr float kWidestPicture = 36;         // ems
constexpr float kLeastFormula = 0.8f;        // relative to code
constexpr const char* kFormulaGap = "    ";  // between parts of a line
constexpr float kBulletIndent = 1.4f;        // ems

float size_of(const ImFont* font) { return font->FontSize * ImGui::GetIO().FontGlobalScale; }

float width_of(const ImFont* font, std::string_view text) {
  return font->CalcTextSizeA(size_of(font), FLT_MAX, 0, text.data(), text.data() + text.size()).x;
}

// Text of one style without blanks.
struct Piece {
  const Run* run;
  ImFont* font;
  std::string_view text;
  bool begins_word;
  float width;
  float blank = 0;  // before it, of the same run and on the same line
};

ImFont* font_of(const Run& run, ImFont* usual) {
  return run.code ? code_font() : run.bold ? heading_font() : usual;
}

std::vector<Piece> pieces_of(const Runs& runs, ImFont* usual) {
  std::vector<Piece> pieces;
  bool begins_word = true;
  for (const Run& run : runs) {
    show_letters(run.text);
    ImFont* const font = font_of(run, usual);
    for (size_t at = 0; at < run.text.size();) {
      const size_t end = std::min(run.text.find(' ', at), run.text.size());
      const std::string_view text(run.text.data() + at, end - at);
      if (!text.empty()) pieces.push_back({&run, font, text, begins_word, width_of(font, text)});
      begins_word = end < run.text.size();
      at = end + 1;
    }
  }
  return pieces;
}

struct Writer {
  PagePictures& pictures;
  PageEvents& events;

  void draw(const Blocks& blocks) {
    for (const Block& block : blocks) {
      if (&block != blocks.data()) ImGui::Dummy({0, kBlockGap * em()});
      ImGui::PushID(&block);
      draw(block);
      ImGui::PopID();
    }
  }

  void draw(const Block& block) {
    switch (block.kind) {
      case Block::Kind::heading:
        ImGui::Dummy({0, 0.5f * em()});
        return draw(block.runs, heading_font(), false);
      case Block::Kind::paragraph:
        return draw(block.runs, ImGui::GetFont(), true);
      case Block::Kind::formula:
        return draw_formula(block);
      case Block::Kind::commands:
        return draw_commands(block);
      case Block::Kind::list:
        return draw_list(block);
      case Block::Kind::table:
        return draw_table(block);
      case Block::Kind::answers:
        return;  // not part of the text
    }
  }

  // Wraps words; those of several styles are not separated. With `marks_code`, code has a ground.
  void draw(const Runs& runs, ImFont* usual, bool marks_code) {
    const float width = ImGui::GetContentRegionAvail().x;
    const float line = size_of(usual) + kLeading * em(), blank = width_of(usual, " ");
    std::vector<Piece> pieces = pieces_of(runs, usual);
    ImVec2 at = ImGui::GetCursorScreenPos();
    const float left = at.x;
    int link = 0;
    for (size_t i = 0; i < pieces.size(); ++i) {
      Piece& piece = pieces[i];
      if (!piece.run->picture.empty()) {
        // Once, by its first word.
        const bool is_first = i == 0 || pieces[i - 1].run != piece.run;
        if (is_first)
          at = draw_picture(*piece.run, {left, at.x > left ? at.y + line : at.y}, width);
        continue;
      }
      if (piece.begins_word) {
        float word = piece.width;
        for (size_t k = i + 1; k < pieces.size() && !pieces[k].begins_word; ++k)
          word += pieces[k].width;
        if (at.x > left && at.x + blank + word > left + width)
          at = {left, at.y + line};
        else if (at.x > left)
          at.x += blank, piece.blank = pieces[i - 1].run == piece.run ? blank : 0;
      }
      if (ImGui::IsRectVisible(at, {at.x + piece.width, at.y + line}))
        draw_piece(piece, at, usual, marks_code, link);
      at.x += piece.width;
    }
    const float top = ImGui::GetCursorScreenPos().y;
    if (at.x > left) at.y += line;
    ImGui::Dummy({width, std::max(at.y - top - kLeading * em(), 0.0f)});
  }

  // Returns the place below it. The cursor stays.
  ImVec2 draw_picture(const Run& run, ImVec2 at, float width) {
    const ImVec2 before = ImGui::GetCursorScreenPos();
    ImGui::SetCursorScreenPos(at);
    pictures.draw(run.picture, run.text, std::min(width, kWidestPicture * em()));
    const float bottom = ImGui::GetItemRectMax().y;
    ImGui::SetCursorScreenPos(before);
    return {at.x, bottom + kLeading * em()};
  }

  void draw_piece(const Piece& piece, ImVec2 at, const ImFont* usual, bool marks_code, int& link) {
    ImDrawList& draw = *ImGui::GetWindowDrawList();
    const Palette& p = palette();
    const Run& run = *piece.run;
    const float size = size_of(piece.font), scale = ImGui::GetIO().FontGlobalScale;
    const float base = at.y + usual->Ascent * scale;  // all styles stand on it
    const ImVec2 lo(at.x, base - piece.font->Ascent * scale);
    ImVec4 ink = p.text;
    if (!run.lesson.empty()) {
      const ImVec2 cursor = ImGui::GetCursorScreenPos();
      ImGui::SetCursorScreenPos(at);
      ImGui::PushID(link++);
      if (ImGui::InvisibleButton("link", {piece.width, size})) events.page = run.lesson.string();
      if (ImGui::IsItemHovered()) ImGui::SetMouseCursor(ImGuiMouseCursor_Hand);
      ImGui::PopID();
      ImGui::SetCursorScreenPos(cursor);
      ink = p.accent;
    }
    if (run.code && marks_code)
      draw.AddRectFilled({at.x - piece.blank, at.y}, {at.x + piece.width, at.y + size_of(usual)},
                         color(p.raised));
    const int first = draw.VtxBuffer.Size;
    draw.AddText(piece.font, size, lo, color(ink), piece.text.data(),
                 piece.text.data() + piece.text.size());
    if (!run.italic) return;
    for (int i = first; i < draw.VtxBuffer.Size; ++i)
      draw.VtxBuffer[i].pos.x += kSlope * (base - draw.VtxBuffer[i].pos.y);
  }

  // Its columns stay below each other. If a line is too wide, its parts are, and then it is
  // smaller.
  static void draw_formula(const Block& block) {
    ImFont* const font = code_font();
    const float pad = 0.5f * em(), width = ImGui::GetContentRegionAvail().x, room = width - 2 * pad;
    std::vector<std::string> lines;
    for (const CodeLine& line : block.lines) {
      show_letters(line.text);
      lines.push_back(line.text);
      for (size_t gap = 0; width_of(font, lines.back()) > room / kLeastFormula &&
                           (gap = lines.back().find(kFormulaGap)) != std::string::npos;) {
        const size_t next = lines.back().find_first_not_of(' ', gap);
        std::string rest = lines.back().substr(std::min(next, lines.back().size()));
        lines.back().resize(gap);
        lines.push_back(std::move(rest));
      }
    }
    float widest = 1;
    for (const std::string& line : lines) widest = std::max(widest, width_of(font, line));
    const float size = size_of(font) * std::min(1.0f, room / widest);
    const float step = size + kLeading * em();
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy({width, step * float(lines.size()) - kLeading * em() + 2 * pad});
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.AddRectFilled(at, ImGui::GetItemRectMax(), color(palette().raised, 0.6f), 0.3f * em());
    float y = at.y + pad;
    for (const std::string& line : lines) {
      list.AddText(font, size, {at.x + pad, y}, color(palette().text), line.c_str());
      y += step;
    }
  }

  void draw_commands(const Block& block) {
    ImDrawList& list = *ImGui::GetWindowDrawList();
    list.ChannelsSplit(2);  // the ground is drawn last, below
    list.ChannelsSetCurrent(1);
    const float pad = 0.5f * em(), width = ImGui::GetContentRegionAvail().x;
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::Dummy({0, pad - ImGui::GetStyle().ItemSpacing.y});
    ImGui::Indent(pad);
    for (const CodeLine& line : block.lines) {
      const size_t blanks = std::min(line.text.find_first_not_of(' '), line.text.size());
      const float indent = width_of(code_font(), " ") * float(blanks) + 1e-3f;
      ImGui::Indent(indent);
      draw({{.text = line.text.substr(blanks), .code = true}}, code_font(), false);
      draw_buttons(line);
      ImGui::Unindent(indent);
    }
    if (ImGui::SmallButton(tr("Copy"))) {
      events.copied.emplace();
      for (const CodeLine& line : block.lines) *events.copied += line.text + '\n';
    }
    ImGui::Unindent(pad);
    ImGui::Dummy({width, pad - ImGui::GetStyle().ItemSpacing.y});
    list.ChannelsSetCurrent(0);
    list.AddRectFilled(at, {at.x + width, ImGui::GetItemRectMax().y}, color(palette().raised, 0.6f),
                       0.3f * em());
    list.ChannelsMerge();
  }

  void draw_buttons(const CodeLine& line) {
    if (line.buttons.empty()) return;
    ImGui::PushID(&line);
    ImGui::PushStyleColor(ImGuiCol_Button, palette().accent);
    ImGui::PushStyleColor(ImGuiCol_Text, palette().on_accent);
    const float right = ImGui::GetCursorScreenPos().x + ImGui::GetContentRegionAvail().x;
    for (const Button& button : line.buttons) {
      ImGui::PushID(&button);
      const std::string name =
          button.value.empty() ? tr("Show") : std::string(tr("Show")) + ' ' + button.value;
      const float width =
          ImGui::CalcTextSize(name.c_str()).x + 2 * ImGui::GetStyle().FramePadding.x;
      const float next = ImGui::GetItemRectMax().x + ImGui::GetStyle().ItemSpacing.x;
      if (&button != line.buttons.data() && next + width <= right) ImGui::SameLine();
      if (ImGui::Button(name.c_str())) events.show = button.shown;
      ImGui::PopID();
    }
    ImGui::PopStyleColor(2);
    ImGui::PopID();
  }

  void draw_list(const Block& block) {
    int number = block.first;
    for (const Blocks& item : block.items) {
      const ImVec2 at = ImGui::GetCursorScreenPos();
      ImDrawList& list = *ImGui::GetWindowDrawList();
      if (block.first > 0)
        list.AddText(at, color(palette().text), fmt::format("{}.", number++).c_str());
      else
        list.AddCircleFilled({at.x + 0.5f * em(), at.y + 0.5f * em()}, 0.14f * em(),
                             color(palette().text));
      ImGui::Indent(kBulletIndent * em());
      draw(item);
      ImGui::Unindent(kBulletIndent * em());
    }
  }

  // Of its contents, which the columns share in proportion.
  static float weight_of(const Runs& cell) {
    float weight = em();
    for (const Run& run : cell)
      weight += run.picture.empty() ? width_of(font_of(run, ImGui::GetFont()), run.text)
                                    : kPicture * em();
    return std::min(weight, (kPicture + 1) * em());
  }

  void draw_table(const Block& block) {
    if (block.rows.empty() || block.rows.front().empty()) return;
    const size_t columns = block.rows.front().size();
    if (!ImGui::BeginTable("table", int(columns),
                           ImGuiTableFlags_RowBg | ImGuiTableFlags_BordersInnerH |
                               ImGuiTableFlags_SizingStretchProp))
      return;
    for (size_t c = 0; c < columns; ++c) {
      float weight = 0;
      for (const auto& row : block.rows)
        if (c < row.size()) weight = std::max(weight, weight_of(row[c]));
      ImGui::TableSetupColumn("", ImGuiTableColumnFlags_WidthStretch, weight);
    }
    for (const auto& row : block.rows) {
      ImGui::TableNextRow();
      for (const Runs& cell : row) {
        ImGui::TableNextColumn();
        draw(cell, &row == block.rows.data() ? heading_font() : ImGui::GetFont(), true);
      }
    }
    ImGui::EndTable();
  }
};

}  // namespace

void draw_blocks(const Blocks& blocks, PagePictures& pictures, PageEvents& events) {
  Writer{pictures, events}.draw(blocks);
}

}  // namespace raio::core::view
