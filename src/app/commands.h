// The subcommands of the program. Each does what its help says, prints, and returns the exit
// status. Only this room prints.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/overlay.h"
#include "io/read_scene.h"
#include "measure/benchmark.h"
#include "render/job.h"
#include "render/options.h"

namespace raio::core::app {

/// Exit statuses, the same for every command.
enum Exit : int {
  kDone = 0,
  kCheckFailed = 1,    // a requested check failed
  kBadInput = 2,       // bad usage or bad input
  kNoResource = 3,     // could not write, or a resource ran out
  kInterrupted = 130,  // Ctrl-C
};

inline constexpr int kMaxPictures = 100000;  // per command

// Frames of a trajectory, as a Python slice: `first` up to but not including `last`; negative
// numbers count from the end.
struct FrameRange {
  std::optional<int> first, last;
  int step = 1;
};

// Renders one or many pictures. An empty output means <scene>.png in the current folder; a folder,
// <scene>.png in it.
struct RenderCommand : JobRequest, Annotations {
  std::vector<std::string> scenes;  // files; `scene` is set to each in turn
  std::string stats;                // file for the statistics; empty: none
  std::string progress = "auto";
  bool quiet = false;
  int turntable = 0;                 // number of pictures around the scene; 0: one, by its camera
  std::optional<FrameRange> frames;  // one picture each; absent: only the frame in `read`
};
int run(const RenderCommand& command);

struct MergeCommand {
  std::vector<std::string> parts;
  std::string output;
  bool quiet = false;
};
int run(const MergeCommand& command);

struct ViewCommand {
  std::string scene;     // empty: the window offers some
  std::string program;   // as it was started: "./raio"
  std::string compare;   // a picture by another program, shown beside; empty: none
  std::string language;  // of the window: "en" or "pt"; empty: the system's
  bool log = false;      // log events to standard error
  RenderOptions options;
  ReadOptions read = kForPictures;
};
/// Opens the window, which is a separate program (ARCHITECTURE.md): either directly, or by
/// replacing this process.
using OpenWindow = int (*)(const ViewCommand&);

struct BenchCommand {
  std::string scene;
  std::string json, csv, plot;  // files; empty: none. "-" for json or csv replaces the table
  std::string progress = "auto";
  BenchmarkRequest request;
};
int run(const BenchCommand& command);

struct InfoCommand {
  std::string scene;
  bool json = false;
  std::string color_bar = {};  // NOLINT(readability-redundant-member-init): optional
  ReadOptions read = {};
};
int run(const InfoCommand& command);

struct ExplainCommand {
  std::string scene;
  std::array<int, 2> pixel{0, 0};  // column, row
  int sample = 0;
  bool json = false;
  std::string plot = {};             // file; empty: none
  std::optional<Vec3d> plot_from{};  // viewpoint of the plot; absent: from the side
  RenderOptions options;
  ReadOptions read = kForPictures;
};
int run(const ExplainCommand& command);

struct GradeCommand {
  std::string scene, student;  // the picture to grade
  std::string reference;       // the right picture; empty: rendered
  std::string output;          // for the pictures and their difference; empty: none
  std::string counts;          // numbers of rays that the student's program printed; empty: none
  double threshold = 1;        // the largest RMSE that passes, of 255
  int tolerance = 8;           // a pixel is wrong if a channel differs by more, of 255
  bool json = false;
  RenderOptions options;
  ReadOptions read = kForPictures;
};
int run(const GradeCommand& command);

struct GenerateCommand {
  std::string name;
  int size = 0;
  std::string output;  // empty or "-": standard output
};
int run(const GenerateCommand& command);

struct ExportCommand {
  std::string scene, output;  // output empty: <scene>.pov in the current folder
  RenderOptions options;      // size, depth
  ReadOptions read = kForPictures;
};
int run(const ExportCommand& command);

struct ConvertCommand {
  std::string input, output;
  ReadOptions read = {};
};
int run(const ConvertCommand& command);

struct SpdVerifyCommand {
  std::vector<std::string> scenes;  // files, or names of standard scenes; empty: all of these
  std::string progress = "auto";
  bool json = false;
  RenderOptions options;  // threads
};
int run(const SpdVerifyCommand& command);

struct CompareCommand {
  std::string a, b, diff;   // the reference, the picture to check, and that of their differences
  double min_psnr_db = -1;  // negative: no check
  std::string explain{};    // the scene of both pictures; empty: none
  RenderOptions options{};  // its camera, structure, threads
};
int run(const CompareCommand& command);

}  // namespace raio::core::app
