// Shared by all commands: messages on standard error, interruption, the progress line.
#pragma once

#include <expected>
#include <memory>
#include <string>
#include <string_view>

#include "base/parallel.h"
#include "io/read_scene.h"
#include "render/render.h"
#include "scene/scene.h"

namespace raio::core::app {

/// Prints a line to standard error, in place of the progress line if there is one. Always one line,
/// without control characters, whatever names it contains; lost if it cannot be written.
void print_line(std::string_view line);

/// "raio: error: ...".
void print_error(std::string_view message);

/// Prints "raio: interrupted; nothing was written"; returns the exit status.
int interrupted();

/// Prints a reader's diagnostics; of notices the first few, with a hint to `raio info` for the
/// others.
void print_diagnostics(const Diagnostics& said);

/// Prints why a file could not be read, or that it was interrupted; the exit status for it.
int refuse(const Diagnostics& said);

/// Reads a scene file and prints its diagnostics; appends the warnings to `warnings`; on failure
/// returns the exit status.
std::expected<Scene, int> load_scene(const std::string& path, bool quiet = false,
                                     Diagnostics* warnings = nullptr,
                                     const ReadOptions& options = {});

/// While it lives, Ctrl-C (also SIGTERM, and SIGHUP of a closed terminal) asks the command to stop,
/// through `stop` of the control if there is one. If the command does not stop soon, or at the
/// second Ctrl-C, the program exits with status 130 and without partial files. Ignored signals stay
/// ignored. One at a time. Without POSIX or threads the first Ctrl-C only asks, or ends a command
/// without a control, and the second has the system's default action.
class StopOnSignal {
 public:
  explicit StopOnSignal(WorkControl* control = nullptr);

  /// The command will stop by itself, but has to save something first, which may take longer.
  void be_patient();

  ~StopOnSignal();
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A line on standard error with the current stage, per cent, rays per second and time left,
/// updated four times a second while it lives; wiped at the end, never wider than the terminal.
/// `mode`: "on", "off", or "auto", which is on when standard error is a terminal. Nothing without
/// threads.
class ProgressLine {
 public:
  ProgressLine(const WorkControl& control, std::string_view mode, std::string label = {});
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

 private:
  Ticker ticker_;
};

/// Human-readable seconds, bytes and counts: "12.3 ms", "4.5 MB", "1.25 M".
std::string human_seconds(double seconds);
std::string human_bytes(double bytes);
std::string human_count(double count);

/// "778 rays/s", "12.5 Mrays/s".
std::string human_quantity(double value, std::string_view unit);

/// "1 cell", "0 cells", "1.25 M cells".
std::string counted(double count, std::string_view thing);

/// Whether standard output is a terminal. The bytes of a picture are useless there, and may do
/// harm.
bool standard_output_is_terminal();

/// Whether standard error is a terminal, and how wide. If unknown: no terminal, of maximum width.
bool is_terminal();
size_t terminal_columns();

/// Replaces this program by the window's, in the same folder; returns the exit status if that
/// fails.
int become_view_program(char** argv);

}  // namespace raio::core::app
