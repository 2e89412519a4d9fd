// How fast pictures converge: the error of each sampler with each effect against the number of
// samples per pixel, plain and blurred; the blur leaves the low frequencies that eyes see best.
// Discussed in docs/sampling.md.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "bench/log_plot.h"
#include "bench/suites.h"
#include "io/image/image.h"
#include "render/options.h"
#include "render/render.h"

namespace raio::core::bench {
namespace {

struct Effect {
  const char* name;
  bool aa, soft, dof;
};
constexpr Effect kEffectsAlone[] = {{"antialiasing", true, false, false},
                                    {"soft shadows", false, true, false},
                                    {"depth of field", false, false, true},
                                    {"all three", true, true, true}};

constexpr int kSides[] = {1, 2, 3, 4, 6, 8, 12, 16};  // square roots of the numbers of samples
constexpr int kReferenceSide = 64;
constexpr uint32_t kReferenceSeed = 4711;
constexpr double kBlur = 1;  // standard deviation in pixels
constexpr const char* kSamplers[] = {"random", "jitter", "sobol"};
constexpr const char *kPlain = "as it is", *kBlurred = "blurred";

struct Subject {
  const Scene& scene;
  const Accel& accel;
  Effect effect;
  RenderOptions options;  // with the effect, without samples
};

Image picture(const Subject& subject, const RenderOptions& request) {
  const RenderSettings o = resolve_options(request, subject.scene);
  const auto film = make_film(subject.scene, o);
  if (!film) give_up(3, film.error().text());
  WorkControl control;
  render(subject.scene, subject.accel, o, **film, control);
  return (*film)->resolve();
}

// With side x side samples.
Image by_jitter(const Subject& subject, int side, uint32_t seed) {
  RenderOptions o = subject.options;
  o.seed = seed;
  o.aa = subject.effect.aa ? side : 1;
  o.lens_samples = subject.effect.aa ? 1 : side * side;
  return picture(subject, o);
}

Image by_sobol(const Subject& subject, int samples, uint32_t seed) {
  RenderOptions o = subject.options;
  o.seed = seed;
  o.aa = subject.effect.aa ? 0 : 1;
  o.samples = samples;
  return picture(subject, o);
}

struct Error {
  double plain, blurred;  // root mean squares over channels and pixels
};

// Blurs rows, then transposes: twice, and everything is blurred and in its original orientation.
std::vector<double> blurred_rows(const std::vector<double>& in, int width, int height) {
  const int reach = int(std::ceil(3 * kBlur));
  std::vector<double> out(in.size());
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      double sum = 0, weights = 0;
      for (int k = std::max(0, x - reach); k <= std::min(width - 1, x + reach); ++k) {
        const double weight = std::exp(-0.5 * (k - x) * (k - x) / (kBlur * kBlur));
        sum += weight * in[size_t(y) * size_t(width) + size_t(k)], weights += weight;
      }
      out[size_t(x) * size_t(height) + size_t(y)] = sum / weights;
    }
  return out;
}

Error error_of(const Image& a, const Image& reference) {
  Error squares{0, 0};
  for (const int axis : {0, 1, 2}) {
    std::vector<double> e(a.pixels.size());
    for (size_t i = 0; i < e.size(); ++i)
      e[i] = double(a.pixels[i][axis]) - double(reference.pixels[i][axis]);
    for (const double v : e) squares.plain += v * v;
    for (const double v : blurred_rows(blurred_rows(e, a.width, a.height), a.height, a.width))
      squares.blurred += v * v;
  }
  const double count = 3 * double(a.pixels.size());
  return {std::sqrt(squares.plain / count), std::sqrt(squares.blurred / count)};
}

// A straight line through the logarithms, by least squares.
double slope(const std::vector<double>& samples, const std::vector<double>& errors) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const double n = double(samples.size());
  for (size_t i = 0; i < samples.size(); ++i) {
    const double u = std::log(samples[i]), v = std::log(errors[i]);
    x += u, y += v, xx += u * u, xy += u * v;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

// The error for each number of samples.
std::vector<Error> errors(const Subject& subject, const std::string& sampler,
                          const Image& reference) {
  std::vector<Error> out;
  Image sum(reference.width, reference.height);  // of single random samples
  uint32_t summed = 0;
  for (const int side : kSides) {
    const int samples = side * side;
    if (sampler == "random") {
      for (; summed < uint32_t(samples); ++summed) {
        const Image one = by_sobol(subject, 1, 1 + summed);
        for (size_t i = 0; i < sum.pixels.size(); ++i)
          sum.pixels[i] = sum.pixels[i] + one.pixels[i];
      }
      Image mean = sum;
      for (Rgb& c : mean.pixels) c = c * (1 / float(samples));
      out.push_back(error_of(mean, reference));
    } else {
      const uint32_t seed = subject.options.seed;
      out.push_back(error_of(
          sampler == "jitter" ? by_jitter(subject, side, seed) : by_sobol(subject, samples, seed),
          reference));
    }
  }
  return out;
}

std::vector<Json> measure(const Subject& subject) {
  const Image reference = by_jitter(subject, kReferenceSide, kReferenceSeed);
  std::vector<Json> rows;
  for (const char* sampler : kSamplers) {
    const std::vector<Error> all = errors(subject, sampler, reference);
    for (const auto& [what, member] :
         {std::pair(kPlain, &Error::plain), std::pair(kBlurred, &Error::blurred)}) {
      Json row;
      row["scene"] = subject.scene.name, row["effect"] = subject.effect.name;
      row["sampler"] = sampler, row["error"] = what;
      std::vector<double> samples, values;
      for (size_t i = 0; i < all.size(); ++i) {
        samples.push_back(kSides[i] * kSides[i]), values.push_back(all[i].*member);
        row[fmt::format("{}", kSides[i] * kSides[i])] = values.back();
      }
      row["order"] = -slope(samples, values);
      rows.push_back(std::move(row));
    }
  }
  return rows;
}

// The geometric mean over the scenes.
LogLine mean_line(const std::vector<Json>& rows, const char* effect, const char* sampler,
                  const char* error, Ink ink) {
  LogLine line{fmt::format("{}, {}", sampler, error), ink, error == kBlurred, {}};
  for (const int side : kSides) {
    double logarithms = 0, count = 0;
    for (const Json& row : rows)
      if (row["effect"] == effect && row["sampler"] == sampler && row["error"] == error)
        logarithms += std::log(row[fmt::format("{}", side * side)].get<double>()), ++count;
    line.points.emplace_back(side * side, std::exp(logarithms / count));
  }
  return line;
}

void plot_errors(const std::vector<Json>& rows, const std::string& path) {
  constexpr Ink kInks[] = {kGrey, kVermilion, kBlue};
  write_page(path, [&](const Canvas& canvas) {
    canvas.text(40, 60, "Error against samples per pixel", kBlack, Align::left, 38, true);
    for (int i = 0; i < 4; ++i) {
      const double left = 110 + 640 * (i % 2), top = 160 + 430 * (i / 2);
      LogPlot plot{left,
                   left + 520,
                   top,
                   top + 320,
                   kEffectsAlone[i].name,
                   "samples per pixel",
                   +[](double error) { return fmt::format("{:g}", error); },
                   {}};
      for (const char* error : {kPlain, kBlurred})
        for (size_t k = 0; k < std::size(kSamplers); ++k)
          plot.lines.push_back(mean_line(rows, plot.title.c_str(), kSamplers[k], error, kInks[k]));
      draw_log_plot(canvas, plot);
      if (i == 1) draw_legend(canvas, plot.right + 30, plot.top + 20, plot.lines);
    }
  });
}

// A part of a soft shadow, enlarged: jitter above, sobol below, with 1, 4 and 16 samples per pixel.
void save_crops(const Settings& s, const std::string& path) {
  constexpr int kX = 100, kY = 160, kWide = 96, kHigh = 80, kTimes = 3, kGap = 6;
  const Scene scene = get_scene("balls_low");
  const auto accel = build_structure(scene, AccelKind::automatic, s);
  Subject subject{scene, *accel, kEffectsAlone[1], s.options};
  RenderOptions& o = subject.options;
  o.width = o.height = 256, o.soft_shadows = true, o.light_size = 2;
  Image page(3 * kWide * kTimes + 2 * kGap, 2 * kHigh * kTimes + kGap);
  std::ranges::fill(page.pixels, Rgb(1));
  for (int i = 0; i < 6; ++i) {
    const int side = 1 << i % 3;
    const Image p =
        i < 3 ? by_jitter(subject, side, o.seed) : by_sobol(subject, side * side, o.seed);
    const int left = i % 3 * (kWide * kTimes + kGap), top = i / 3 * (kHigh * kTimes + kGap);
    for (int y = 0; y < kHigh * kTimes; ++y)
      for (int x = 0; x < kWide * kTimes; ++x)
        page.at(left + x, top + y) = p.at(kX + x / kTimes, kY + y / kTimes);
  }
  if (const auto written = write_image(page, path); !written) give_up(3, written.error().text());
}

}  // namespace

std::vector<Json> converge_suite(const Settings& request) {
  Settings s = request.with_defaults({"balls:2", "mount:4", "gears:2"}, {AccelKind::automatic}, 1);
  if (s.options.width == 0) s.options.width = s.options.height = 64;
  std::vector<Json> rows;
  for (const std::string& name : s.scenes) {
    const Scene scene = get_scene(name);
    const auto accel = build_structure(scene, s.structures.front(), s);
    for (const Effect& effect : kEffectsAlone) {
      tell(fmt::format("{}, {}", name, effect.name));
      Subject subject{scene, *accel, effect, s.options};
      subject.options.soft_shadows = effect.soft, subject.options.dof = effect.dof;
      std::ranges::move(measure(subject), std::back_inserter(rows));
    }
  }
  print_table(rows, {{"scene", "scene"},
                     {"effect", "effect"},
                     {"sampler", "sampler"},
                     {"error", "error x 1000"},
                     {"1", "1 sample", 1e3},
                     {"4", "4", 1e3},
                     {"9", "9", 1e3},
                     {"16", "16", 1e3},
                     {"36", "36", 1e3},
                     {"64", "64", 1e3},
                     {"144", "144", 1e3},
                     {"256", "256", 1e3},
                     {"order", "order"}});
  fmt::print(
      "\nroot mean squares; the reference is {} samples of jitter with seed {}; blurred: by a "
      "Gaussian of {} pixel; order: the error falls as samples to the power of -order\n",
      kReferenceSide * kReferenceSide, kReferenceSeed, kBlur);
  if (!s.plot.empty()) plot_errors(rows, s.plot);
  if (!s.crops.empty()) save_crops(s, s.crops);
  return rows;
}

}  // namespace raio::core::bench
