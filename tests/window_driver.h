// A separate display (Xvfb) with raio view on it, driven by keys and mouse events through XTest,
// like a person. Its log shows what the program did; nothing depends on timing.
#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <regex>
#include <string>
#include <thread>
#include <vector>

struct _XDisplay;

namespace raio::core {

/// An X server without a screen.
class Display {
 public:
  Display();
  ~Display();
  Display(const Display&) = delete;
  Display& operator=(const Display&) = delete;

  const std::string& name() const { return name_; }  // ":42"; empty where Xvfb did not start

 private:
  std::string name_;
  int process_ = -1;
};

class WindowDriver {
 public:
  /// Starts `raio view ARGUMENTS --log` in `folder` and waits for its first whole picture.
  WindowDriver(const Display& display, const std::vector<std::string>& arguments,
               const std::string& folder);
  ~WindowDriver();
  WindowDriver(const WindowDriver&) = delete;
  WindowDriver& operator=(const WindowDriver&) = delete;

  /// Later searches start after this position in the log.
  size_t mark() const;
  /// The first line since `from` that has a match, with its groups; waits for it. Nothing when the
  /// program has ended, or after minutes.
  struct Line {
    std::vector<std::string> groups;  // the whole match first
    size_t next = 0;                  // the position after the line
    std::chrono::steady_clock::time_point time;
  };
  std::optional<Line> wait_for(const std::string& pattern, size_t from);

  /// The full picture, with at least this many samples, of a request made since `from`.
  struct Picture {
    int samples = 0;
    std::string sum;
  };
  std::optional<Picture> picture(size_t from, int samples = 1);

  // Places are those in the picture with which the window opens.
  enum class Held { nothing, shift, ctrl, ctrl_shift };
  void key(unsigned long keysym, Held held = Held::nothing);
  void hold(unsigned long keysym, bool down);
  void move(int x, int y);
  void button(int number, bool down);
  void click(int x, int y);
  void drag(int x0, int y0, int x1, int y1, int number = 1);
  void wheel(int x, int y, int steps);
  void resize(int width, int height);
  void minimise(bool on);
  std::string title() const;

  /// Processor time of the program so far, in seconds, to a hundredth.
  double processor_s() const;

  bool is_running();
  /// Waits for the end; the exit status, -1 for a signal.
  int end();
  std::string log() const;

 private:
  void read_log();

  _XDisplay* x_ = nullptr;
  unsigned long window_ = 0;
  int left_ = 0, top_ = 0;
  std::map<unsigned long, std::chrono::steady_clock::time_point> last_presses_;  // by key
  int process_ = -1, status_ = 0, log_end_ = -1;
  mutable std::mutex mutex_;
  std::condition_variable news_;
  std::vector<std::pair<std::string, std::chrono::steady_clock::time_point>> lines_;
  bool log_is_closed_ = false;
  std::thread reader_;
};

}  // namespace raio::core
