// Runs the program as users do.
#pragma once

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "sanitized.h"
#include "temporary_folder.h"

namespace raio::core {

using testing::EndsWith;
using testing::HasSubstr;
using testing::StartsWith;

inline constexpr std::string_view kScene =
    "b 0.1 0.2 0.3\n"
    "v\nfrom 0 -5 0\nat 0 0 0\nup 0 0 1\nangle 40\nhither 0\nresolution 24 16\n"
    "l 3 -4 5\n"
    "f 1 0 0 0.8 0.2 10 0 1\ns 0 0 0 1\ns 1.5 0 0.5 0.4\n"
    "f 0 1 0 0.5 0 1 0.5 1.5\nc -2 0 0 0.3 -2 0 1 0.3\n"
    "p 4\n-5 -5 -1\n5 -5 -1\n5 5 -1\n-5 5 -1\n";

inline std::string replaced(std::string_view from, std::string_view to) {
  std::string text(kScene);
  return text.replace(text.find(from), from.size(), to);
}

struct Redirections {
  std::string input = "/dev/null", output, errors;  // empty: a file with contents that are returned
  bool close_output = false;
};

inline constexpr double kAtOnce = tests::if_sanitized(20, 1);  // seconds

struct Outcome {
  int status = -1;  // minus the signal that ended it
  std::string out, err;
  double seconds = 0, processor_seconds = 0;
};

class CommandLine : public TemporaryFolder {
 protected:
  CommandLine() { put(file("ok.nff"), kScene); }

  // A running program; its two streams go to files next to its working folder.
  class Running {
   public:
    Running(const CommandLine& test, std::vector<std::string> arguments, const Redirections& to)
        : out_(to.output.empty() ? test.file("../" + test.stream_name("out")).string() : to.output),
          err_(to.errors.empty() ? test.file("../" + test.stream_name("err")).string() : to.errors),
          to_(to) {
      posix_spawn_file_actions_t actions;
      posix_spawn_file_actions_init(&actions);
      constexpr int kMake = O_WRONLY | O_CREAT | O_TRUNC;
      posix_spawn_file_actions_addopen(&actions, 0, to.input.c_str(), O_RDONLY, 0);
      posix_spawn_file_actions_addopen(&actions, 1, out_.c_str(), kMake, 0600);
      posix_spawn_file_actions_addopen(&actions, 2, err_.c_str(), kMake, 0600);
      if (to.close_output) posix_spawn_file_actions_addclose(&actions, 1);
      posix_spawn_file_actions_addchdir_np(&actions, test.folder().c_str());
      // Whoever runs the tests may ignore signals.
      posix_spawnattr_t attributes;
      posix_spawnattr_init(&attributes);
      sigset_t signals;
      sigfillset(&signals);
      posix_spawnattr_setsigdefault(&attributes, &signals);
      posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGDEF);

      arguments.insert(arguments.begin(), RAIO_PROGRAM);
      std::vector<char*> argv;
      for (std::string& argument : arguments) argv.push_back(argument.data());
      argv.push_back(nullptr);
      EXPECT_EQ(posix_spawn(&id_, RAIO_PROGRAM, &actions, &attributes, argv.data(), environ), 0);
      posix_spawn_file_actions_destroy(&actions);
      posix_spawnattr_destroy(&attributes);
    }

    void send(int signal) const { ::kill(id_, signal); }

    /// Waits until the program handles the signal, which a slow or busy machine delays.
    void wait_for_handler(int signal) const {
      const std::string path = "/proc/" + std::to_string(id_) + "/status";
      const auto handles = [&] {
        const std::string status = get(path), field = "SigCgt:";
        return status.find("State:\tZ") != std::string::npos ||  // it has ended
               (std::stoull(status.substr(status.find(field) + field.size()), nullptr, 16) >>
                    (signal - 1) &
                1) != 0;
      };
      while (!handles()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }

    Outcome wait() const {
      Outcome outcome;
      int status = 0;
      rusage usage{};
      ::wait4(id_, &status, 0, &usage);
      for (const timeval& t : {usage.ru_utime, usage.ru_stime})
        outcome.processor_seconds += double(t.tv_sec) + 1e-6 * double(t.tv_usec);
      outcome.status = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
      outcome.seconds =
          std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
      if (to_.output.empty()) outcome.out = get(out_), std::filesystem::remove(out_);
      if (to_.errors.empty()) outcome.err = get(err_), std::filesystem::remove(err_);
      return outcome;
    }

   private:
    std::string out_, err_;
    Redirections to_;
    pid_t id_ = 0;
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  };

  Outcome raio(std::vector<std::string> arguments, const Redirections& to = {}) const {
    return Running(*this, std::move(arguments), to).wait();
  }

  // Expects one line on standard error, no other output, immediate exit and no new file.
  void expect_refusal(std::vector<std::string> arguments, int status, std::string_view message,
                      const Redirections& to = {}) const {
    std::string shown;
    for (const std::string& a : arguments) shown += a + " ";
    const testing::Message where = testing::Message() << shown;
    const long before = entries();
    const Outcome o = raio(std::move(arguments), to);
    EXPECT_EQ(o.status, status) << where;
    EXPECT_EQ(o.out, "") << where;
    EXPECT_THAT(o.err, HasSubstr(message)) << where;
    EXPECT_THAT(o.err, HasSubstr("error: ")) << where;
    EXPECT_EQ(std::ranges::count(o.err, '\n'), 1) << where << o.err;
    EXPECT_THAT(o.err, EndsWith("\n")) << where;
    // The processor's own time does not grow on a busy machine.
    EXPECT_LT(o.processor_seconds, kAtOnce) << where;
    EXPECT_EQ(entries(), before) << where;
  }

  // With where help is.
  void expect_usage_error(std::vector<std::string> arguments, std::string_view message) const {
    const bool has_command = !arguments.empty() && arguments[0] == "render";
    const std::string help = has_command ? "; see raio render --help\n" : "; see raio --help\n";
    const Outcome o = raio(arguments);
    EXPECT_THAT(o.err, StartsWith("raio: error: "));
    EXPECT_THAT(o.err, EndsWith(help));
    expect_refusal(std::move(arguments), 2, message);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder()))
      names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }

 private:
  std::string stream_name(std::string_view stream) const {
    return folder().filename().string() + "." + std::string(stream);
  }
};

}  // namespace raio::core
