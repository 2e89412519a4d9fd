// What all commands share: messages on standard error, interruption, the progress line.
#pragma once

#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "base/parallel.h"
#include "io/read_scene.h"
#include "render/render.h"
#include "scene/scene.h"

namespace raio::app {

/// A line on standard error, in place of the progress line if there is one. Always one line,
/// without control characters, whatever names it contains; where it cannot be written it is lost.
void print_line(std::string_view line);

/// "raio: error: ...".
void print_error(std::string_view message);

/// "raio: interrupted; nothing was written", and the exit status for it.
int interrupted();

/// What a reader said of a file, line by line; of notices the first few, and that `raio info` has
/// the others.
void print_diagnostics(const Diagnostics& said);

/// Reads a scene file and prints its diagnostics, of which `warnings` gets the warnings, too; on
/// failure the exit status.
std::expected<Scene, int> load_scene(const std::string& path, bool quiet = false,
                                     Diagnostics* warnings = nullptr,
                                     const ReadOptions& options = {});

/// While it lives, Ctrl-C (also SIGTERM, and SIGHUP of a closed terminal) asks the command to end,
/// by `stop` of the control if there is one. If it does not soon, or at the second Ctrl-C, the
/// program ends from within, with status 130 and without half-written files. Signals that were
/// ignored stay ignored. One at a time. Without POSIX or threads the first Ctrl-C only asks, or
/// ends a command without a control, and the second is the system's.
class StopOnSignal {
 public:
  explicit StopOnSignal(RenderControl* control = nullptr);

  /// The command will end by itself, but has something to put away before, which may take longer.
  void be_patient();

  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A line on standard error with per cent, rays per second and time left, four times a second while
/// it lives; wiped at the end, never wider than the terminal. `mode`: "on", "off", or "auto", which
/// is on when standard error is a terminal. Nothing without threads.
class ProgressLine {
 public:
  ProgressLine(const RenderControl& control, std::string_view mode, std::string label = {});
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

 private:
  Ticker ticker_;
};

/// Seconds, bytes and counts as people read them: "12.3 ms", "4.5 MB", "1.25 M".
std::string human_seconds(double seconds);
std::string human_bytes(double bytes);
std::string human_count(double count);

/// "778 rays/s", "12.5 Mrays/s".
std::string human_quantity(double value, std::string_view unit);

/// "1 cell", "0 cells", "1.25 M cells".
std::string counted(double count, std::string_view thing);

/// Where the bytes of a picture are of no use, and may do harm.
bool standard_output_is_terminal();

/// Is standard error a terminal, and how wide is it? Unknown is no terminal, and as wide as can be.
bool is_terminal();
size_t terminal_columns();

/// Replaces this program by the one with the window, beside it; the exit status where it cannot.
int become_view_program(char** argv);

}  // namespace raio::app
