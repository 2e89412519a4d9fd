#include "app/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>
#include <ranges>
#include <vector>

#include "app/arguments.h"
#include "app/bench.h"
#include "app/commands.h"
#include "app/help.h"
#include "app/manual.h"
#include "app/outline.h"
#include "app/output.h"
#include "app/shown_scene.h"
#include "app/terminal.h"
#include "app/version.h"
#include "app/window_keys.h"
#include "base/executor.h"
#include "base/memory.h"
#include "io/generate/generate.h"
#include "render/picture_options.h"
#include "render/read_options.h"
#include "render/render.h"

namespace raio::core::app {
namespace {

constexpr double kMinMemory = 64 << 20;  // for threads and libraries

// How the program was started.
struct Invocation {
  char** argv;
  OpenWindow open_window;
};

void add_progress(CLI::App& app, std::string& mode) {
  const auto check = [](const std::string& text) -> std::string {
    if (text == "on" && !kHasThreads)
      return "this build has no threads and no progress line; leave it out";
    if (text == "auto" || text == "on" || text == "off") return {};
    return fmt::format("expected auto, on or off, found '{}'", text);
  };
  app.add_option("--progress", mode,
                 "Progress line: auto (on a terminal), on or off (default: auto)")
      ->check(CLI::Validator(check, ""))
      ->type_name("MODE:{auto,on,off}")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

std::vector<std::string_view> recipe_names() {
  std::vector<std::string_view> names;
  for (const SceneRecipe& recipe : scene_recipes()) names.push_back(recipe.name);
  return names;
}

std::string recipe_list() {
  std::vector<std::pair<std::string, std::string>> rows;
  for (const SceneRecipe& recipe : scene_recipes()) {
    std::string text(recipe.summary);
    if (recipe.max_size > 0)
      text += fmt::format(" (N from 1 to {}, default {})", recipe.max_size, recipe.default_size);
    rows.emplace_back(recipe.name, text);
  }
  return "Scenes:\n" + two_columns(rows);
}

void refuse_terminal(const std::string& output, std::string_view option) {
  if (is_standard_output(output) && standard_output_is_terminal())
    throw CLI::ParseError(
        fmt::format("{0} - would write the picture to the terminal; redirect standard output, as "
                    "in {0} - > picture.png, or name a file, as in {0} picture.png",
                    option),
        kBadInput);
}

int usage_error(const CLI::App& command, const std::string& message) {
  return bad_input(fmt::format("{}; see {} --help", message, full_name(command)));
}

// CLI11 also throws for help and version.
int report(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App* command = &app;
  for (auto chosen = app.get_subcommands(); !chosen.empty(); chosen = command->get_subcommands())
    command = chosen.front();
  if (dynamic_cast<const CLI::CallForVersion*>(&error))
    return deliver("-", error.what() + std::string("\n"));
  if (dynamic_cast<const CLI::CallForHelp*>(&error)) return deliver("-", brief_help(*command));
  if (dynamic_cast<const CLI::CallForAllHelp*>(&error)) return deliver("-", help_text(*command));
  return usage_error(*command, error.what());
}

// A thread may fail to start for lack of memory for its stack.
constexpr std::string_view kMemoryAdvice = "a larger --memory-limit or fewer --threads may help";

// Libraries terminate if a thread or memory is refused. Reports that once, without allocating.
[[noreturn]] void end_without_memory() {
  static std::atomic_flag ending;
  while (ending.test_and_set()) {  // another thread is ending the program
  }
  remove_unfinished_files();
  char error[128];
  *fmt::format_to_n(error, sizeof(error) - 1, "raio: error: out of memory; {}\n", kMemoryAdvice)
       .out = 0;
  std::fputs(error, stderr);  // unbuffered
  std::_Exit(kNoResource);
}

// Parses "4G": bytes, or KiB, MiB, GiB, TiB with a letter. The limit takes effect during parsing.
void add_memory_limit(CLI::App& app) {
  const auto set = [](const std::string& text) {
    double value = 0;
    const char* const text_end = text.data() + text.size();
    const auto [end, error] = std::from_chars(text.data(), text_end, value);
    const size_t unit = end < text_end ? std::string_view("KMGT").find(*end) : 0;
    const double bytes = std::ldexp(value, end < text_end ? 10 * int(unit + 1) : 0);
    if (error != std::errc() || text_end - end > 1 || unit == std::string_view::npos ||
        !(bytes >= kMinMemory && bytes <= 1e18))
      throw CLI::ValidationError(
          "--memory-limit",
          fmt::format("expected a size of 64M or more, as in 900M or 4G, found '{}'", text));
    if (const auto limited = limit_memory(size_t(bytes)); !limited)
      throw CLI::ValidationError("--memory-limit", limited.error() + "; leave it out");
    std::set_terminate(end_without_memory);
  };
  app.add_option_function<std::string>(
         "--memory-limit", set,
         "Exit rather than use more memory than SIZE, as in 4G; K, M, G and T are powers of 1024 "
         "bytes (default: no limit)")
      ->type_name("SIZE")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void add_long_render(CLI::App& app, RenderCommand& render) {
  add_job_options(app, render, {"checkpoint", "checkpoint-interval", "resume"});
  add_number(app, "--add-samples", render.add_samples, 1, kMaxSamples,
             "Add N samples per pixel to the --checkpoint file, with the options stored in it",
             "N");
  add_job_options(app, render, {"time-limit"});
  add_memory_limit(app);
  add_job_options(app, render, {"shard", "sample-range"});
  add_file(app, "--repeat", render.repeat,
           "Render this PNG or EXR again with the settings stored in it; without SCENE, use the "
           "stored scene name in the folder of the picture",
           "IMAGE");
}

void refuse_for_many_pictures(const RenderCommand& render) {
  const bool frames = render.frames.has_value(), turns = render.turntable > 0;
  if (!turns && !frames && render.scenes.size() < 2) return;
  const auto refuse = [](const std::string& why) { throw CLI::ParseError(why, kBadInput); };
  if (frames && turns)
    refuse("--frame A:B cannot be combined with --turntable; leave one of them out");
  if (frames && (render.scenes.size() > 1 || render.scenes == std::vector<std::string>{"-"}))
    refuse("--frame A:B needs one scene file, not standard input or several");
  for (const auto& [option, given] : {std::pair("--checkpoint", !render.checkpoint.empty()),
                                      {"--resume", render.resume},
                                      {"--add-samples", render.add_samples > 0},
                                      {"--shard", render.shards > 1},
                                      {"--sample-range", !render.sample_range.empty()},
                                      {"--repeat", !render.repeat.empty()},
                                      {"--stats", !render.stats.empty()}})
    if (given)
      refuse(fmt::format("{} works for one picture only; {}", option,
                         frames  ? "leave it out, or give one frame"
                         : turns ? "leave it out, or leave out --turntable"
                                 : "give one scene"));
  if (is_standard_output(render.output))
    refuse(fmt::format("standard output takes one picture; name {}",
                       turns || frames ? "a file, as in -o turn.png, for turn-0001.png and so on"
                                       : "a folder, as in -o pictures/"));
}

void add_render(CLI::App& app, RenderCommand& render, int& status) {
  auto* sub = app.add_subcommand("render", "Render a scene to a picture");
  sub->footer(
      examples({"raio render balls.nff --size 1024x768 --aa 4 --soft-shadows -o balls.png",
                "raio generate tree | raio render /dev/stdin -o - --stats tree.json > tree.png",
                "raio render balls.nff --samples 4096 --dof --checkpoint balls.raio --resume",
                "raio render balls.nff --aa 16 --shard 1/4 -o part1.raio",
                "raio render --repeat balls.png balls.nff -o again.png",
                "raio render balls.nff tree.nff --aa 4 -o pictures/"}));
  sub->add_option("scene", render.scenes,
                  "NFF, P3F, .raio, PDB, PQR, CIF, GRO, XYZ, LAMMPS, PLY, STL, OBJ, OFF or glTF; - "
                  "is standard input; several files are rendered one after another")
      ->check(CLI::Validator(file_name_problem, ""))
      ->type_name("SCENE");
  add_read_options(*sub, render.read, &render.frames);
  begin_group(*sub, OptionGroup::output);
  add_file(*sub, "-o,--output", render.output,
           "Output picture; .png .exr .npz .npy .ppm .pfm by suffix, or .raio for a part file; - "
           "writes PNG to standard output; a name that ends in / is a folder for SCENE.png "
           "(default: SCENE.png)",
           "IMAGE");
  add_render_options(*sub, render.options);
  begin_group(*sub, OptionGroup::figures);
  sub->add_flag("--color-bar", render.color_bar,
                "Draw a colour bar with the values of --color-by on the picture");
  static constexpr std::string_view kSides[] = {"right", "left"};
  sub->add_option("--color-bar-side", render.color_bar_side,
                  "Side of --color-bar: right or left (default: right)")
      ->check(CLI::IsMember({"right", "left"}).description(""))
      ->needs(sub->get_option("--color-bar"))
      ->type_name(value_type("SIDE", kSides))
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  sub->add_flag("--legend", render.legend,
                "Draw a legend of elements, types, chains or residues on the picture");
  sub->add_flag("--scale-bar", render.scale_bar,
                "Draw a scale bar, valid at the distance of the point looked at");
  begin_group(*sub, OptionGroup::output);
  add_number(*sub, "--turntable", render.turntable, 1, kMaxPictures,
             "Render N pictures from positions evenly spaced around the scene, about the up "
             "direction through the point looked at, to picture-0001.png and so on",
             "N");
  begin_group(*sub, OptionGroup::diagnostics);
  add_file(*sub, "--stats", render.stats, "Write times and counts as JSON; - for standard output");
  sub->add_flag("--quiet", render.quiet, "Print errors only");
  add_progress(*sub, render.progress);
  begin_group(*sub, OptionGroup::long_renders);
  add_long_render(*sub, render);
  sub->callback([&, sub] {
    for (const OptionSpec& spec : render_option_table())
      if (const std::string name = "--" + std::string(spec.name);
          spec.of_picture && sub->get_option(name)->count() > 0)
        render.of_picture.emplace_back(spec.name);
    if (sub->get_option("--checkpoint-interval")->count() > 0 && render.checkpoint.empty())
      throw CLI::ParseError("--checkpoint-interval has no effect without --checkpoint; add it",
                            kBadInput);
    for (const ReadOptionSpec& spec : read_option_table())
      render.reads_as_given |= sub->count("--" + std::string(spec.name)) > 0;
    if (render.scenes.empty() && render.repeat.empty())
      throw CLI::ParseError("SCENE is missing; name a file, as in raio render balls.nff",
                            kBadInput);
    refuse_for_many_pictures(render);
    refuse_conflict(render.options, render.read);
    refuse_terminal(render.output, "-o");
    status = run_on_threads(render);
  });
}

void add_view(CLI::App& app, ViewCommand& view, const Invocation& invocation, int& status) {
  auto* sub = app.add_subcommand("view", "Explore a scene in a window");
  sub->footer(examples({"raio view balls.nff --soft-shadows"}) + "\n" + list_of_keys());
  add_file(*sub, "scene", view.scene,
           "Scene file, of any format that raio render reads (default: choose in the window)",
           "SCENE");
  add_read_options(*sub, view.read);
  add_render_options(*sub, view.options);
  // Hidden, not unknown: window_conflict() says why the window refuses them.
  for (const OptionSpec& spec : render_option_table())
    if (!spec.of_window) sub->get_option("--" + std::string(spec.name))->group("");
  add_file(*sub, "--compare", view.compare,
           "Compare with this picture by another program, such as yours: side by side, their "
           "differences, the rays of a pixel; it is read again whenever it changes",
           "IMAGE");
  static constexpr std::string_view kLanguages[] = {"en", "pt"};
  sub->add_option(
         "--language", view.language,
         "Language of the window: en or pt (Portuguese) (default: the last chosen, else the "
         "system's)")
      ->check(CLI::IsMember({"en", "pt"}).description(""))
      ->type_name(value_type("LANGUAGE", kLanguages))
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  sub->add_flag("--log", view.log, "Log events to standard error");
  sub->callback([&] {
    refuse_conflict(view.options, view.read);
    if (!view.compare.empty() && view.scene.empty())
      throw CLI::ParseError("--compare needs the scene of the picture; name its file, too",
                            kBadInput);
    if (const auto why = window_conflict(view.options))
      throw CLI::ParseError(text_of(*why), kBadInput);
    view.program = invocation.argv[0];
    // The window is another program, but its arguments are checked here.
    status = invocation.open_window ? invocation.open_window(view)
                                    : become_view_program(invocation.argv);
  });
}

void add_merge(CLI::App& app, MergeCommand& merge, int& status) {
  auto* sub = app.add_subcommand(
      "merge", "Merge the parts of a picture rendered with --shard and --sample-range");
  sub->footer(examples({"raio merge part1.raio part2.raio part3.raio -o balls.png"}));
  sub->add_option("parts", merge.parts, "Part files of the same picture")
      ->required()
      ->type_name("PART");
  add_file(*sub, "-o,--output", merge.output,
           "Output picture; .png .exr .npz .npy .ppm .pfm by suffix, or .raio for a part file; - "
           "writes PNG to standard output",
           "IMAGE");
  sub->get_option("--output")->required();
  sub->add_flag("--quiet", merge.quiet, "Print errors only");
  sub->callback([&] {
    refuse_terminal(merge.output, "-o");
    status = run_until_signal(merge);
  });
}

template <class T>
void add_list(CLI::App& app, const std::string& name, T& value,
              std::expected<T, std::string> (*parse)(std::string_view), const std::string& help) {
  const auto set = [&value, parse, name](const std::string& text) {
    auto parsed = parse(text);
    if (!parsed) throw CLI::ValidationError(name, parsed.error());
    value = std::move(*parsed);
  };
  app.add_option_function<std::string>(name, set, help)
      ->type_name("LIST")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void add_bench(CLI::App& app, BenchCommand& bench, int& status) {
  auto* sub = app.add_subcommand(
      "bench", "Time all combinations of effects with brute force, grid and tree");
  sub->footer(
      examples({"raio bench balls_medium.nff --repeat 3 --csv balls.csv --plot balls.svg",
                "raio bench balls_high.nff --accel grid,bvh,embree --effects aa,soft-shadows"}));
  add_scene(*sub, bench.scene);
  add_file(*sub, "--json", bench.json, "Write the table as JSON; - for standard output");
  add_file(*sub, "--csv", bench.csv, "Write the table as CSV; - for standard output");
  add_file(*sub, "--plot", bench.plot, "Plot the table; .png .svg .pdf by suffix");
  BenchmarkRequest& request = bench.request;
  add_list(*sub, "--accel", request.structures, parse_structures,
           "Structures to time: none (brute force), grid, bvh, embree (default: none,grid,bvh)");
  std::string words;
  for (const BenchmarkEffect& effect : kBenchmarkEffects)
    words += (words.empty() ? "" : ", ") + effect_word(effect);
  add_list(*sub, "--effects", request.effects, parse_effects,
           "Effects to time in all combinations: " + words +
               fmt::format("; none for the plain picture alone; roughness comes from --gloss and "
                           "--translucency, else from the materials, else it is {} (default: "
                           "aa,soft-shadows,dof)",
                           kUsualRoughness));
  add_number(*sub, "--repeat", request.repeat, 1, 1000,
             "Renders of each combination; the table shows the median (default: 1)", "N");
  add_render_options(*sub, request.options,
                     {"size", "grid-factor", "light-size", "aperture", "focus", "depth", "gloss",
                      "translucency", "shutter", "one-sided", "threads", "seed"});
  add_progress(*sub, bench.progress);
  sub->callback([&] {
    if (const auto why = bench_conflict(bench.request); !why.empty())
      throw CLI::ParseError(why, kBadInput);
    status = Executor(bench.request.options.threads).run([&] { return run(bench); });
  });
}

void add_info(CLI::App& app, InfoCommand& info, int& status) {
  auto* sub =
      app.add_subcommand("info", "Describe a scene: primitives, bounds, camera, lights, warnings");
  sub->footer(examples({"raio info balls.nff --json"}));
  add_scene(*sub, info.scene);
  add_read_options(*sub, info.read);
  sub->add_flag("--json", info.json, "Print one JSON object");
  add_file(*sub, "--color-bar", info.color_bar,
           "Draw a colour bar with the values of --color-by; .png .svg .pdf by suffix");
  sub->callback([&] { status = run_until_signal(info); });
}

void add_generate(CLI::App& app, GenerateCommand& generate, int& status) {
  auto* sub = app.add_subcommand("generate", "Write a standard procedural scene as NFF");
  sub->footer(recipe_list() + "\n" + examples({"raio generate balls --size 3 -o balls.nff"}));
  sub->add_option("name", generate.name, "Name of the scene, from the list below")
      ->required()
      ->type_name(value_type("NAME", recipe_names()));
  add_number(*sub, "--size", generate.size, 1, 1000000, "Size factor (default: the scene's own)",
             "N");
  add_file(*sub, "-o,--output", generate.output, "Output file (default: standard output)");
  sub->callback([&] { status = run_until_signal(generate); });
}

void add_export(CLI::App& app, ExportCommand& command, int& status) {
  auto* sub = app.add_subcommand("export", "Convert a scene to POV-Ray");
  sub->footer(examples({"raio export balls.nff -o balls.pov"}));
  add_scene(*sub, command.scene);
  add_read_options(*sub, command.read);
  add_file(*sub, "-o,--output", command.output,
           "Output file, .pov; - for standard output (default: SCENE.pov)");
  add_render_options(*sub, command.options, {"size", "projection", "depth"});
  sub->callback([&] { status = run_until_signal(command); });
}

void add_convert(CLI::App& app, ConvertCommand& command, int& status) {
  auto* sub = app.add_subcommand("convert", "Write a scene in another format");
  sub->footer(examples({"raio convert balls.nff balls.raio", "raio convert balls.raio balls.pov"}));
  add_file(*sub, "in", command.input,
           "NFF, P3F, .raio, PDB, PQR, CIF, GRO, XYZ, LAMMPS, PLY, STL, OBJ, OFF or glTF", "IN");
  add_read_options(*sub, command.read);
  add_file(
      *sub, "out", command.output,
      ".nff, .p3f, .raio, .ply, .glb, .gltf or .pov by suffix; - writes NFF to standard output",
      "OUT");
  for (const char* scene : {"in", "out"}) sub->get_option(scene)->required();
  sub->callback([&] { status = run_until_signal(command); });
}

void add_compare(CLI::App& app, CompareCommand& compare, int& status) {
  auto* sub = app.add_subcommand("compare", "Measure the difference between two pictures");
  sub->footer(examples({"raio compare before.png after.exr --min-psnr 40 --diff apart.png",
                        "raio compare raio.png mine.png --explain scene.nff"}));
  add_file(*sub, "a", compare.a, "Reference, such as Raio's picture: PNG, JPEG, EXR, PPM or PFM",
           "A");
  add_file(*sub, "b", compare.b, "Picture to check, such as your program's, of the same size", "B");
  for (const char* picture : {"a", "b"}) sub->get_option(picture)->required();
  add_number(*sub, "--min-psnr", compare.min_psnr_db, 0.0, 1000.0,
             "Exit with status 1 if the PSNR is below X dB", "X");
  add_file(*sub, "--diff", compare.diff,
           "Write the differences as a picture; - writes PNG to standard output");
  add_file(*sub, "--explain", compare.explain,
           "Say where B differs from A in this scene: at edges, in shadows, mirrors, on lit "
           "surfaces; and what to check first");
  add_render_options(
      *sub, compare.options,
      {"from", "at", "up", "fov", "projection", "angle-to-centers", "accel", "threads"});
  for (const char* camera :
       {"--from", "--at", "--up", "--fov", "--projection", "--angle-to-centers", "--accel"})
    sub->get_option(camera)->needs(sub->get_option("--explain"));
  sub->callback([&] {
    refuse_terminal(compare.diff, "--diff");
    status = run_on_threads(compare);
  });
}

void add_spd(CLI::App& app, SpdVerifyCommand& verify, int& status) {
  auto* spd = app.add_subcommand("spd", "The Standard Procedural Databases");
  spd->footer(examples({"raio spd verify balls tree"}));
  spd->require_subcommand(1);
  auto* sub = spd->add_subcommand(
      "verify", "Check counts of rays, cells and tests against the published ones");
  sub->footer(examples({"raio spd verify", "raio spd verify balls tree old/gears.nff --json"}));
  sub->add_option("scenes", verify.scenes,
                  "Names of standard scenes, or files with these names (default: all)")
      ->type_name(value_type("SCENE", recipe_names()));
  sub->add_flag("--json", verify.json, "Print one JSON object");
  add_render_options(*sub, verify.options, {"threads"});
  add_progress(*sub, verify.progress);
  sub->callback([&] { status = run_on_threads(verify); });
}

int parse_and_run(std::vector<std::string> arguments, const Invocation& invocation) {
  CLI::App app("Raio: a fast, reproducible ray tracer for scenes, molecules, particles and meshes");
  app.name("raio");
  app.allow_windows_style_options(false);  // a path may begin with a slash
  app.set_help_flag("-h", "Print the most common options");
  app.set_help_all_flag("--help", "Print all options; if one is repeated, the last counts");
  app.set_version_flag("--version", version_text(),
                       "Print the version and the commit it was built from");
  app.footer(examples({"raio generate balls -o balls.nff",
                       "raio render balls.nff --size 1024x768 --aa 4 --soft-shadows"}));
  app.require_subcommand(1);

  int status = kDone;
  RenderCommand render;
  ViewCommand view;
  MergeCommand merge;
  BenchCommand bench;
  InfoCommand info;
  ExplainCommand explain;
  GradeCommand grade;
  GenerateCommand generate;
  ExportCommand exporting;
  ConvertCommand convert;
  CompareCommand compare;
  SpdVerifyCommand verify;
  add_render(app, render, status);
  add_view(app, view, invocation, status);
  add_merge(app, merge, status);
  add_bench(app, bench, status);
  add_info(app, info, status);
  add_explain(app, explain, status);
  add_grade(app, grade, status);
  add_generate(app, generate, status);
  add_export(app, exporting, status);
  add_convert(app, convert, status);
  add_compare(app, compare, status);
  add_spd(app, verify, status);
  add_manual_commands(app, status);

  if (arguments.empty()) {
    for (const auto line : std::views::split(list_of_commands(app), '\n'))
      print_line({line.begin(), line.end()});
    return kBadInput;
  }
  if (const std::string why = usage_problem(app, arguments); !why.empty())
    return usage_error(chosen_command(app, arguments), why);
  try {
    std::ranges::reverse(arguments);  // as CLI11 expects them
    app.parse(std::move(arguments));
  } catch (const CLI::ParseError& error) {
    return report(app, error);
  }
  return status;
}

}  // namespace

std::optional<ShownScene> shown_scene(const std::vector<std::string>& words) {
  const std::string command = words.empty() ? "" : words.front();
  CLI::App app;
  app.allow_windows_style_options(false);
  int status = kDone;
  RenderCommand render;
  ViewCommand view;
  ExplainCommand explain;
  const Invocation nothing{};
  if (command == "render")
    add_render(app, render, status);
  else if (command == "view")
    add_view(app, view, nothing, status);
  else if (command == "explain")
    add_explain(app, explain, status);
  else
    return std::nullopt;
  CLI::App& sub = *app.get_subcommand(command);
  sub.callback([] {});  // does not run the command
  // Its limit would take effect during parsing.
  if (auto* limit = sub.get_option_no_throw("--memory-limit")) sub.remove_option(limit);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // as CLI11 expects them
  } catch (const CLI::ParseError&) {
    return std::nullopt;
  }
  ShownScene shown;
  if (command == "render") {
    if (render.scenes.size() != 1 || render.turntable > 0 || render.frames) return std::nullopt;
    shown = {render.scenes.front(), render.options, render.read};
  } else if (command == "view") {
    shown = {view.scene, view.options, view.read};
  } else {
    shown = {explain.scene, explain.options, explain.read, explain.pixel};
    if (explain.options.width > 0) shown.size = {explain.options.width, explain.options.height};
  }
  RenderOptions& options = shown.options;
  options.width = options.height = options.threads = 0;
  options.dpi = 0, options.channels = {};
  options.print.reset(), options.crop.reset();
  if (read_background(options, shown.read)) return std::nullopt;
  if (shown.scene.empty() || is_standard_output(shown.scene) || option_conflict(options) ||
      window_conflict(options))
    return std::nullopt;
  return shown;
}

int run_command_line(int argc, char** argv, OpenWindow open_window) {
  try {
    return Executor().run([&] {
      return parse_and_run({argv + std::min(argc, 1), argv + argc}, {argv, open_window});
    });
  } catch (const Stopped&) {
    return interrupted();
  } catch (const std::bad_alloc&) {
    return no_resource(fmt::format("out of memory; {}", kMemoryAdvice));
  } catch (const std::exception& error) {
    return no_resource(fmt::format("{}; {}", error.what(), kMemoryAdvice));
  }
}

}  // namespace raio::core::app
