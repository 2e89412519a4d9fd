// Checks the window's figures for docs/view.md. The real program on a separate display measures the
// costs of effects after a change of size and two key presses, and reports the effect of a change
// of structure; `raio bench` and `raio render` measure the same picture before and after, so other
// load affects both alike.
#include <X11/keysym.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include "base/median.h"
#include "window_driver.h"

namespace {

using raio::core::MedianInterval;
using Json = nlohmann::json;

constexpr double kClose = 1.15;  // times too much or too little that is still called the same
constexpr int kRounds = 3;       // of the benchmark, before the window and again after it
constexpr int kPairs = 4;        // of renders, likewise
constexpr int kSamples = 32;     // of a render that measures one sample's time

/// An effect as the window names it, and as the benchmark does.
struct Row {
  const char *name, *word;
};
constexpr std::array<Row, 5> kRows = {{{"antialiasing", "aa"},
                                       {"soft shadows", "soft-shadows"},
                                       {"depth of field", "dof"},
                                       {"gloss", "gloss"},
                                       {"translucency", "translucency"}}};

/// Keeps one core busy while it lives.
class Busy {
 public:
  Busy() {
    const pid_t parent = ::getpid();
    process_ = ::fork();
    if (process_ != 0) return;
    while (::getppid() == parent) {
    }
    ::_exit(0);
  }
  ~Busy() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
  }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  pid_t process_ = -1;
};

std::string in_quotes(const std::string& word) {
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? "'\\''" : std::string(1, c);
  return quoted + "'";
}

// A command's output; null if it fails.
Json json_of(const std::string& command) {
  std::string text;
  FILE* const pipe = ::popen((command + " 2>/dev/null").c_str(), "r");
  if (!pipe) return {};
  std::array<char, 4096> buffer{};
  while (const size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
    text.append(buffer.data(), count);
  if (::pclose(pipe) != 0) return {};
  return Json::parse(text, nullptr, false);
}

// The statistics of a render; null if it fails.
Json stats_of(const std::string& arguments) {
  const auto picture = std::filesystem::temp_directory_path() / "raio-window-costs.png";
  Json stats = json_of(fmt::format("{} render {} --quiet --stats - -o {}", in_quotes(RAIO_PROGRAM),
                                   arguments, in_quotes(picture.string())));
  std::error_code ignored;
  std::filesystem::remove(picture, ignored);
  return stats;
}

// Seconds of a render without reading, building and writing; NAN when it fails.
double render_s(const std::string& arguments) {
  const Json stats = stats_of(arguments);
  return stats.is_object() ? stats["time_s"]["render"].get<double>() : NAN;
}

/// The programs of the command line on one picture. Ratios gather in it, a value a round.
class CommandLine {
 public:
  CommandLine(const std::string& scene, const std::string& size, std::string accel)
      : scene_(in_quotes(scene) + " --size " + size), accel_(std::move(accel)) {}

  void measure_effects() {
    for (const Row& row : kRows)
      bench(row.name, fmt::format("--accel {} --effects {} --repeat {}", accel_, row.word, kRounds),
            1, 0);
    const Json stats = stats_of(scene_ + " --samples 1");
    for (const std::string name : {"reflection", "refraction"}) {
      if (!stats.is_object() || stats["rays"][name] == 0) continue;
      const std::string without = " --no-" + name;
      for (int i = 0; i < kPairs; ++i) {
        const bool first = i % 2 == 0;  // by turns
        const double a = plain(first ? "" : without), b = plain(first ? without : "");
        ratios_[name].push_back(first ? a / b : b / a);
      }
    }
  }
  /// How many times as fast the structure is.
  void measure_structure() {
    bench("structure", fmt::format("--accel none,{} --effects none --repeat {}", accel_, kRounds),
          0, 1);
  }

  std::optional<MedianInterval> factor(const std::string& name) const {
    const auto found = ratios_.find(name);
    if (found == ratios_.end() || found->second.empty()) return std::nullopt;
    return raio::core::median_interval(found->second);
  }

 private:
  void bench(const char* name, const std::string& what, size_t over, size_t under) {
    const Json table =
        json_of(fmt::format("{} bench {} {} --json -", in_quotes(RAIO_PROGRAM), scene_, what));
    if (!table.is_object()) return;  // the scene has no such effect
    const auto runs = [&](size_t row) {
      return table["rows"].at(row)["runs_s"].get<std::vector<double>>();
    };
    const std::vector<double> with = runs(over), without = runs(under);
    for (size_t i = 0; i < with.size(); ++i) ratios_[name].push_back(with[i] / without[i]);
  }
  double plain(const std::string& options) const {
    return render_s(
               fmt::format("{} --accel {} --samples {}{}", scene_, accel_, kSamples, options)) /
           kSamples;
  }

  std::string scene_, accel_;
  std::map<std::string, std::vector<double>> ratios_;
};

/// Two measurements of the same, repeatedly.
class Tally {
 public:
  void add(const MedianInterval& shown, const MedianInterval& held) {
    ++count_;
    const double off = std::max(shown.median / held.median, held.median / shown.median);
    const bool is_close = off <= kClose;
    const bool overlaps = shown.low <= held.high && held.low <= shown.high;
    close_ += is_close, overlaps_ += overlaps, either_ += is_close || overlaps;
    if (!(off <= worst_off_)) worst_off_ = off, worst_ = {shown, held};
  }
  bool all() const { return either_ == count_; }
  std::string line() const {
    const auto text = [](const MedianInterval& m) {
      return fmt::format("{:.3g} ±{:.0f}%", m.median, 100 * m.half_width());
    };
    return fmt::format(
        "{:2} of {:2} agree ({} within 15 %, {} overlap); worst {} and {}: {:+.0f} %", either_,
        count_, close_, overlaps_, text(worst_.first), text(worst_.second),
        100 * (worst_.first.median / worst_.second.median - 1));
  }

 private:
  int count_ = 0, close_ = 0, overlaps_ = 0, either_ = 0;
  double worst_off_ = 0;
  std::pair<MedianInterval, MedianInterval> worst_;
};

// "±3%", or nothing, which is less than half a per cent.
MedianInterval with_spread(double value, const std::string& spread) {
  const double part = spread.empty() ? 0.005 : std::stod(spread) / 100;
  return {value * (1 - part), value, value * (1 + part)};
}

// "28.6 ms", as the window writes seconds.
double seconds_of(const std::string& number, const std::string& unit) {
  return std::stod(number) * (unit == "us" ? 1e-6 : unit == "ms" ? 1e-3 : unit == "min" ? 60 : 1);
}

class Trial {
 public:
  Trial(const raio::core::Display& display, std::string scene, std::string accel)
      : display_(display), scene_(std::move(scene)), accel_(std::move(accel)) {}

  /// Once more. Whether the window lived through it.
  bool run(int number) {
    const auto folder = std::filesystem::temp_directory_path() / "raio-window-costs";
    std::filesystem::create_directories(folder / "state/raio");
    std::ofstream(folder / "state/raio/window")
        << "section What each effect costs\ncosts as reported\n";
    // Some scenes ask for antialiasing, which the benchmark's rows of other effects do not have.
    raio::core::WindowDriver window(display_, {scene_, "--aa", "1", "--accel", accel_},
                                    folder.string());
    size_t from = window.mark();
    window.resize(820 + 8 * number, 800);
    const auto size = window.wait_for("size: ([0-9x]+)", from);
    if (!size) return fmt::print("{}", window.log()), false;
    // It measures at rest; until then the benchmark has the machine.
    window.key(XK_space);
    (void)window.picture(from);
    CommandLine commands(scene_, size->groups[1], accel_);
    commands.measure_effects();
    from = window.mark();
    for (const unsigned long key : {XK_space, XK_d, XK_d}) {
      window.key(key);
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
    const auto begun = window.wait_for("measures the costs", from);
    const auto end = window.wait_for("measured the costs", begun ? begun->next : from);
    if (!begun || !end) return fmt::print("{}", window.log()), false;
    seconds_.push_back(std::chrono::duration<double>(end->time - begun->time).count());
    window.key(XK_space);
    commands.measure_effects();
    commands.measure_structure();
    for (size_t at = begun->next; at < end->next;) {
      const auto line = window.wait_for(
          "[0-9.]+ ([a-z ]+): (not in|([0-9.]+) x( faster)?( ±([0-9]+)%)?;|\\.\\.\\.)|measured the "
          "costs",
          at);
      if (!line || line->next >= end->next) break;
      take(line->groups, commands);
      at = line->next;
    }
    window.key(XK_space);
    return accel_ != "bvh" || press_keys(window, number);
  }

  /// Whether all figures are true.
  bool tell() const {
    bool all = true;
    fmt::print("what effects cost: the window, and raio bench or render\n");
    for (const auto& [name, tally] : effects_)
      fmt::print("  {:15} {}\n", name, tally.line()), all &= tally.all();
    for (const auto& [name, count] : absent_) fmt::print("  {:15} absent {} times\n", name, count);
    for (const std::string& line : wrong_) fmt::print("  WRONG {}\n", line), all = false;
    if (!seconds_.empty())
      fmt::print("  measured in {:.1f} s; longest {:.1f}\n",
                 raio::core::median_interval(seconds_).median, std::ranges::max(seconds_));
    fmt::print("what a key says after a s d g g g g: the window, and raio render\n");
    for (const auto& [name, tally] : keys_)
      fmt::print("  {:15} {}\n", name, tally.line()), all &= tally.all();
    if (no_sample_) fmt::print("  'no whole sample before' {} times\n", no_sample_);
    return all;
  }

 private:
  void take(const std::vector<std::string>& groups, const CommandLine& commands) {
    const std::string& name = groups[1];
    const auto held = commands.factor(name);
    if (groups[2] == "...") {
      wrong_.push_back(name + " was not measured");
    } else if (groups[3].empty()) {
      ++absent_[name];
      if (held) wrong_.push_back(groups[0] + ", which the benchmark measures");
    } else if (!held) {
      wrong_.push_back(groups[0] + ", which the benchmark does not find in the scene");
    } else {
      effects_[name].add(with_spread(std::stod(groups[3]), groups[6]), *held);
    }
  }

  // All structures in quick succession; the last report is compared with renders.
  bool press_keys(raio::core::WindowDriver& window, int number) {
    const size_t from = window.mark();
    for (const unsigned long key : {XK_a, XK_s, XK_d, XK_g, XK_g, XK_g}) {
      window.key(key);
      std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }
    // From a moment to two seconds.
    std::this_thread::sleep_for(std::chrono::milliseconds(300 + 400 * (number % 5)));
    window.key(XK_g);
    const auto line = window.wait_for(
        "structure bvh: ~?([0-9.]+) ([a-z]+)( ±([0-9]+)%)? per sample, "
        "(no whole sample before|before ~?([0-9.]+) ([a-z]+)( ±([0-9]+)%)?)",
        from);
    if (!line) return fmt::print("{}", window.log()), false;
    window.key(XK_space);
    window.key(XK_c);
    const auto command =
        window.wait_for("command: [^ ]+ render (.*) --samples [0-9]+(.*) -o ", line->next);
    if (!command) return fmt::print("{}", window.log()), false;
    std::string picture = command->groups[1] + command->groups[2];
    const auto held = [&](int times, int samples) {
      std::vector<double> runs_s;
      for (int i = 0; i < times; ++i)
        runs_s.push_back(render_s(fmt::format("{} --samples {}", picture, samples)) / samples);
      return raio::core::median_interval(std::move(runs_s));
    };
    const auto shown = [&](size_t at) {
      return with_spread(seconds_of(line->groups[at], line->groups[at + 1]), line->groups[at + 3]);
    };
    if (picture.find("--accel") == std::string::npos) picture += " --accel bvh";
    keys_["bvh"].add(shown(1), held(5, kSamples));
    if (line->groups[6].empty()) return ++no_sample_, true;
    picture.replace(picture.find("--accel bvh"), 11, "--accel none");
    keys_["none, before"].add(shown(6), held(3, 1));
    return true;
  }

  const raio::core::Display& display_;
  std::string scene_, accel_;
  std::map<std::string, Tally> effects_, keys_;
  std::map<std::string, int> absent_;
  std::vector<std::string> wrong_;
  std::vector<double> seconds_;
  int no_sample_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool busy = std::erase(arguments, "--busy") > 0;
  const bool grid = std::erase(arguments, "--grid") > 0;
  int times = 0;
  if (arguments.size() == 2)
    std::from_chars(arguments[1].data(), arguments[1].data() + arguments[1].size(), times);
  if (times < 1) {
    fmt::print(stderr, "usage: raio_window_costs SCENE.nff TIMES [--grid] [--busy]\n");
    return 2;
  }
  const raio::core::Display display;
  std::optional<Busy> other;
  if (busy) other.emplace();
  Trial trial(display, std::filesystem::absolute(arguments[0]).string(), grid ? "grid" : "bvh");
  for (int i = 0; i < times; ++i) {
    if (!trial.run(i)) return 1;
    fmt::print(stderr, "{} of {}\n", i + 1, times);
  }
  return trial.tell() ? 0 : 1;
}
