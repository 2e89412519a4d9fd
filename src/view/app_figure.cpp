// Figures: how the file is read, frames in time, pictures for print.
#include <algorithm>
#include <array>
#include <set>
#include <utility>

#include "base/platform/memory.h"
#include "io/atoms/labels.h"
#include "io/image/image.h"
#include "render/render.h"
#include "view/app_state.h"
#include "view/texts.h"

namespace raio::core::view {

void AppState::use_figure_panel(const FigureResult& did) {
  for (const ReadChange& change : did.reads) change_read_option(change);
  if (did.stops_printing) ask(request::StopPrinting{});
  if (did.prints || did.copies_print) print_picture(did.copies_print);
}

void AppState::change_read_option(const ReadChange& change) {
  const auto& [option, text] = change;
  view.form.option = option->name, view.form.typed = text, view.form.problem.clear();
  refresh();
  ReadOptions next = read_options();
  if (text.empty()) {
    option->value.reset(next);
  } else if (const auto set = option->set(next, text); !set) {
    view.form.problem = set.error();
    return;
  }
  // A range belongs to a column, and a map to numbers.
  if (option->name == "color-by" && next.color_by != read_options().color_by) {
    constexpr std::array<std::string_view, 5> kNames = {"", "element", "chain", "residue", "type"};
    next.color_range.reset();
    if (std::ranges::count(kNames, next.color_by) > 0) next.colormap.clear();
  }
  if (next == read_options())
    view.form.option.clear();
  else
    read_again(next);
}

void AppState::change_read_option(std::string_view option, const std::string& text) {
  change_read_option({&read_option_of(option), text});
}

std::string AppState::selected(SelectionUse use) const {
  if (!view.file || !view.file->atoms) return {};
  const AtomLabels& labels = *view.file->atoms;
  std::vector<uint32_t> atoms;
  std::set<std::string> parts;
  for (const Pick& pick : selection.picks()) {
    if (!pick.atom) continue;
    atoms.push_back(*pick.atom);
    if (use == SelectionUse::hide_residue || use == SelectionUse::color_residue)
      parts.insert(labels.select_residue(*pick.atom));
    if (use == SelectionUse::hide_chain || use == SelectionUse::color_chain)
      parts.insert(labels.select_chain(*pick.atom));
  }
  if (parts.empty()) return labels.select(atoms);
  std::string chosen;
  for (const std::string& part : parts)
    if (!part.empty()) chosen = either(chosen, part);
  return chosen;
}

// Adds them to `hide`, and takes them out of `show`, which outranks it.
void AppState::hide_selected(SelectionUse use) {
  const std::string chosen = selected(use);
  if (chosen.empty()) return;
  const ReadOptions before = read_options();
  change_read_option("hide", either(before.hide, chosen));
  if (!before.show.empty()) change_read_option("show", but_not(before.show, chosen));
}

void AppState::color_selected(SelectionUse use) {
  const std::string chosen = selected(use);
  if (chosen.empty()) return;
  ReadOptions next = read_options();
  std::erase_if(next.color_atoms, [&](const AtomColor& color) { return color.atoms == chosen; });
  const auto byte = [&](int c) { return int(to_byte(view.form.own_color[c])); };
  next.color_atoms.push_back(
      {chosen, {}, fmt::format("#{:02x}{:02x}{:02x}", byte(0), byte(1), byte(2))});
  change_read_option("color-atoms", read_option_of("color-atoms").text(next));
}

void AppState::read_again(const ReadOptions& options) {
  if (!is_reading()) reading_since_ = facts_.now;
  wanted_read_ = options;
  ask(request::Reread{options});
}

bool AppState::waits_for_file() const {
  constexpr double kLong = 0.4;
  return is_reading() && facts_.now > reading_since_ + kLong;
}

// Undo, or another file, may have made it useless. A result of earlier options is welcome while
// later ones are being read: a slider is being dragged.
bool AppState::is_wanted(const SceneFile::Read& read) const {
  if (!read.is_reread) return true;
  if (read.path != view.path || !is_reading()) return false;
  return read.scene || read.options == *wanted_read_;
}

void AppState::refuse_reading(const SceneFile::Read& read) {
  const Diagnostic& why = read.scene.error().front();
  wanted_read_.reset();
  view.form.plays = false, view.form.problem = why.message;
  complain(why.text("--"));
}

void AppState::play() {
  if (!view.form.plays) return;
  const int frames = view.frames();
  if (frames < 2 || is_reading()) {
    view.form.plays &= frames >= 2;
    return;
  }
  const double now = facts_.now;
  const bool is_shown = picture && picture->request == request && picture->samples > 0;
  if ((!is_shown && !is_moving()) || now < next_frame_at_) return;
  // At the rate requested, if rendering keeps up.
  const double step = 1.0 / std::max(1, view.form.frames_per_s);
  next_frame_at_ = next_frame_at_ + step < now ? now + step : next_frame_at_ + step;
  ReadOptions next = view.read_options;
  next.frame = (view.frame() + 1) % frames;
  read_again(next);
}

void AppState::print_picture(bool only_copies) {
  const RenderOptions o = view.print_request(stage.picture_width, stage.picture_height);
  if (const auto why = option_conflict(o, view.scene.get())) return complain(why->text("--"));
  if (only_copies) return copy_command(view.command_line(o, view.scene->name + ".png"));
  if (std::exchange(is_printing_, true)) return;
  ask(request::PrintPicture{is_scene_of_file() ? nullptr : view.scene, o});
  refresh();
}

void AppState::limit_history() {
  const double most = double(available_memory_bytes()) / 4;
  const auto size = [this] {
    std::set<const ReadScene*> seen;
    double sum = 0;
    for (const ViewState& state : history.states())
      if (state.file && seen.insert(state.file.get()).second)
        sum += double(memory_bytes(state.file->scene));
    return sum;
  };
  while (size() > most && history.forget_oldest()) {
  }
}

bool AppState::is_scene_of_file() const {
  const bool is_as_read = view.file && view.scene.get() == &view.file->scene;
  return view.scene == saved_scene || (is_as_read && view.file_version == file_version_);
}

}  // namespace raio::core::view
