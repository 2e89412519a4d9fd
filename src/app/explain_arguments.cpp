// The arguments of `raio explain` and `raio grade`.
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include "app/arguments.h"

namespace raio::core::app {
namespace {

// Parses "12,40": column, row.
void add_pixel(CLI::App& app, std::array<int, 2>& pixel) {
  const auto set = [&pixel](const std::string& text) {
    const char* const end = text.data() + text.size();
    const auto x = std::from_chars(text.data(), end, pixel[0]);
    const bool comma = x.ec == std::errc() && x.ptr != end && *x.ptr == ',';
    const auto y = comma ? std::from_chars(x.ptr + 1, end, pixel[1]) : x;
    if (!comma || y.ec != std::errc() || y.ptr != end || pixel[0] < 0 || pixel[1] < 0)
      throw CLI::ValidationError(
          "--pixel",
          fmt::format("expected column and row from the upper left, as in 120,80, found '{}'",
                      text));
  };
  app.add_option_function<std::string>(
         "--pixel", set, "Column and row of the pixel, counted from 0 at the upper left")
      ->type_name("X,Y")
      ->required()
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void add_place(CLI::App& app, const std::string& name, std::optional<Vec3d>& place,
               const std::string& help) {
  const auto set = [&place, name](const std::string& text) {
    Vec3d p;
    const char *at = text.data(), *const end = at + text.size();
    for (int a = 0; a < 3; ++a) {
      const auto [rest, error] = std::from_chars(at, end, p[a]);
      const bool ended = a == 2 ? rest == end : rest != end && *rest == ',';
      if (error != std::errc() || !ended || !std::isfinite(p[a]))
        throw CLI::ValidationError(
            name, fmt::format("expected three coordinates, as in 1,2,3, found '{}'", text));
      at = rest + 1;
    }
    place = p;
  };
  app.add_option_function<std::string>(name, set, help)
      ->type_name("X,Y,Z")
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
}

void add_classic_options(CLI::App& app, RenderOptions& options) {
  add_render_options(app, options,
                     {"size",
                      "integrator",
                      "from",
                      "at",
                      "up",
                      "fov",
                      "projection",
                      "background",
                      "accel",
                      "grid-factor",
                      "grid-resolution",
                      "aa",
                      "soft-shadows",
                      "light-size",
                      "dof",
                      "aperture",
                      "focus",
                      "lens-samples",
                      "samples",
                      "sampler",
                      "filter",
                      "depth",
                      "no-reflection",
                      "no-refraction",
                      "shading",
                      "fresnel",
                      "gloss",
                      "translucency",
                      "shutter",
                      "one-sided",
                      "angle-to-centers",
                      "threads",
                      "seed"});
}

}  // namespace

void add_explain(CLI::App& app, ExplainCommand& explain, int& status) {
  auto* sub = app.add_subcommand("explain", "Trace one pixel and explain its colour, ray by ray");
  sub->footer(examples({"raio explain balls.nff --pixel 256,256",
                        "raio explain balls.nff --pixel 256,256 --accel grid --aa 4 --sample 7 "
                        "--json",
                        "raio explain balls.nff --pixel 256,256 --plot rays.svg"}));
  add_scene(*sub, explain.scene);
  add_read_options(*sub, explain.read);
  add_pixel(*sub, explain.pixel);
  add_number(*sub, "--sample", explain.sample, 0, kMaxSamples,
             "Sample of the pixel, counted from 0 (default: 0)", "N");
  sub->add_flag("--json", explain.json,
                "Print one JSON object, with the cells or nodes that each ray visits and the "
                "primitives it is tested against");
  add_file(*sub, "--plot", explain.plot,
           "Draw the rays in the scene, seen from the side; .png .svg .pdf by suffix");
  add_place(*sub, "--plot-from", explain.plot_from,
            "Position of the viewer of --plot (default: to the side and above)");
  add_classic_options(*sub, explain.options);
  sub->callback([&] {
    if (explain.plot_from && explain.plot.empty())
      throw CLI::ParseError("--plot-from has no effect without --plot; add it", kBadInput);
    if (explain.plot == "-")
      throw CLI::ParseError("--plot cannot use standard output, where the text goes; name a file",
                            kBadInput);
    refuse_conflict(explain.options, explain.read);
    status = run_until_signal(explain);
  });
}

void add_grade(CLI::App& app, GradeCommand& grade, int& status) {
  auto* sub = app.add_subcommand(
      "grade", "Compare a student's picture with the right one, and say what is wrong with it");
  sub->footer(examples({"raio grade solids.nff mine.png",
                        "raio grade solids.nff mine.png --size 180x120 -o difference.png",
                        "raio grade solids.nff mine.png --threshold 1 --json"}));
  add_scene(*sub, grade.scene);
  add_file(*sub, "student", grade.student,
           "The student's picture of this scene: PNG, JPEG, EXR, PPM or PFM", "STUDENT");
  sub->get_option("student")->required();
  add_read_options(*sub, grade.read);
  add_file(*sub, "--reference", grade.reference,
           "The right picture (default: rendered with the options below, in the size of STUDENT)",
           "IMAGE");
  add_number(*sub, "--threshold", grade.threshold, 0.0, 255.0,
             "Exit with status 1 if the root mean square of the differences is above X of 255 "
             "(default: 1)",
             "X");
  add_number(*sub, "--tolerance", grade.tolerance, 0, 255,
             "A pixel is wrong if red, green or blue differs by more than N of 255 (default: 8)",
             "N");
  add_file(*sub, "-o,--output", grade.output,
           "Write the right picture, the student's and their difference side by side", "IMAGE");
  add_file(*sub, "--counts", grade.counts,
           "Compare the numbers of rays in this text, which the student's program printed; JSON of "
           "raio render --stats, too; - is standard input");
  sub->add_flag("--json", grade.json, "Print one JSON object");
  add_classic_options(*sub, grade.options);
  sub->callback([&] {
    if (is_standard_output(grade.output))
      throw CLI::ParseError("-o cannot use standard output, where the report goes; name a file",
                            kBadInput);
    refuse_conflict(grade.options, grade.read);
    status = run_until_signal(grade);
  });
}

}  // namespace raio::core::app
