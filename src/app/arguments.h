// Building blocks of the command line: options by type of value, with checks, and options shared by
// several commands. If an option is repeated, the last one counts.
#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>

#include "app/commands.h"
#include "app/output.h"
#include "base/parallel.h"
#include "io/read_scene.h"
#include "render/options.h"

namespace raio::core::app {

/// Why the text is not a file name; empty if it is one.
std::string file_name_problem(const std::string& text);

void add_file(CLI::App& app, const std::string& name, std::string& path, const std::string& help,
              const std::string& value_name = "FILE");

/// The scene file of a command.
void add_scene(CLI::App& app, std::string& path);

/// The options of read_option_table(); with `frames`, --frame also takes ranges.
void add_read_options(CLI::App& app, ReadOptions& options,
                      std::optional<FrameRange>* frames = nullptr);

/// A number from `least` to `most`.
template <class T>
void add_number(CLI::App& app, const std::string& name, T& value, T least, T most,
                const std::string& help, const std::string& value_name) {
  const auto check = [=](const std::string& text) -> std::string {
    T number{};
    const char* const text_end = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), text_end, number);
    if (error == std::errc() && end == text_end && number >= least && number <= most) return {};
    return fmt::format("expected a {} from {} to {}, found '{}'",
                       std::is_integral_v<T> ? "whole number" : "number", least, most, text);
  };
  app.add_option(name, value, help)
      ->check(CLI::Validator(check, ""))
      ->type_name(value_name)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

/// Adds the `wanted` options of render_option_table(), or all if that list is empty.
void add_render_options(CLI::App& app, RenderOptions& options,
                        std::initializer_list<std::string_view> wanted = {});

/// Adds the `wanted` options of job_option_table().
void add_job_options(CLI::App& app, JobRequest& request,
                     std::initializer_list<std::string_view> wanted);

/// Throws a CLI::ParseError for options that cannot be combined. A background that lights the scene
/// becomes an option of reading.
void refuse_conflict(RenderOptions& options, ReadOptions& read);

/// The end of a command's help.
std::string examples(std::initializer_list<std::string_view> lines);

/// Runs a whole command, from reading to writing, with the requested number of threads.
template <class Command>
int run_on_threads(const Command& command, WorkControl* control = nullptr) {
  if (command.options.threads > 1 && !kHasThreads)
    return bad_input("this build has no threads; leave out --threads");
  return Executor(command.options.threads, control).run([&] { return run(command); });
}

/// Runs a whole command that does not have its own control; a signal stops it.
template <class Command>
int run_until_signal(const Command& command) {
  WorkControl control;
  const StopOnSignal stop(&control);
  if constexpr (requires { command.options.threads; })
    return run_on_threads(command, &control);
  else
    return Executor(0, &control).run([&] { return run(command); });
}

/// The commands `raio explain` and `raio grade`, which render as the integrator `classic` does.
void add_explain(CLI::App& app, ExplainCommand& explain, int& status);
void add_grade(CLI::App& app, GradeCommand& grade, int& status);

}  // namespace raio::core::app
