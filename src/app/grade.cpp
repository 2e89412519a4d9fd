// raio grade: compares a student's picture with the right one and looks for the fault.
#include "app/grade.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <expected>
#include <memory>
#include <utility>

#include "app/explain.h"
#include "app/output.h"
#include "app/terminal.h"
#include "io/file.h"
#include "measure/imitation.h"
#include "render/provenance.h"
#include "render/render.h"

namespace raio::core::app {
namespace {

constexpr uint64_t kMaxCountsBytes = 1 << 20;

int apart(const Rgb& a, const Rgb& b) {
  const auto p = display_bytes(a), q = display_bytes(b);
  int largest = 0;
  for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(p[c] - q[c]));
  return largest;
}

Grade::Errors errors_of(const Image& right, const Image& student, int tolerance) {
  Grade::Errors errors{.difference = compare(right, student)};
  uint64_t sum = 0;
  for (size_t i = 0; i < right.pixels.size(); ++i) {
    const auto p = display_bytes(right.pixels[i]), q = display_bytes(student.pixels[i]);
    for (int c = 0; c < 3; ++c) sum += uint64_t(std::abs(p[c] - q[c]));
    errors.wrong += apart(right.pixels[i], student.pixels[i]) > tolerance;
  }
  errors.mean = double(sum) / (3 * double(std::max<size_t>(right.pixels.size(), 1)));
  return errors;
}

// The right picture, the student's and their difference, with white gaps.
Image side_by_side(const Image& right, const Image& student) {
  constexpr int kGap = 4;
  const Image difference = difference_image(right, student);
  Image out(3 * right.width + 2 * kGap, right.height);
  std::ranges::fill(out.pixels, Rgb(1));
  int left = 0;
  for (const Image* part : {&right, &student, &difference}) {
    for (int y = 0; y < part->height; ++y)
      for (int x = 0; x < part->width; ++x) out.at(left + x, y) = part->at(x, y);
    left += right.width + kGap;
  }
  return out;
}

/// The scene with its structure and Raio's picture of it.
struct Rendered {
  const Scene& scene;
  RenderSettings settings;
  std::unique_ptr<const Accel> accel;
  Image picture;
  RayCounts rays;
};

std::expected<Rendered, Error> render_reference(const Scene& scene, const RenderOptions& options) {
  if (auto why = explain_conflict(options, scene)) return std::unexpected(std::move(*why));
  Rendered out{scene, explained_settings(options, scene), nullptr, {}, {}};
  if (out.settings.integrator != IntegratorKind::classic)
    return std::unexpected(bad_option("integrator",
                                      "only pictures of classic can be graded; add `integrator` "
                                      "classic"));
  auto accel = build_accel(scene, out.settings.accel, out.settings.one_sided);
  if (!accel) return std::unexpected(std::move(accel.error()));
  out.accel = std::move(*accel);
  const auto film = make_film(scene, out.settings);
  if (!film) return std::unexpected(film.error());
  WorkControl control;
  render(scene, *out.accel, out.settings, **film, control);
  check_stop();
  out.picture = picture_of(**film), out.rays = (*film)->rays();
  tone_map(out.picture, {}, out.settings.tone, out.settings.exposure);
  return out;
}

std::expected<Grade::WrongPixel, Error> wrong_pixel(const Rendered& by, const Image& right,
                                                    const Image& student, int x, int y) {
  const auto sample = explain_sample(by.scene, *by.accel, by.settings, x, y, 0);
  if (!sample) return std::unexpected(sample.error());
  const auto logs = logs_of(*sample, *by.accel);
  const Explained what{by.scene, *by.accel, by.settings, {x, y}, 0, *sample, logs};
  return Grade::WrongPixel{.at = {x, y},
                           .expected = display_bytes(right.at(x, y)),
                           .found = display_bytes(student.at(x, y)),
                           .text = explained_text(what),
                           .json = explained_json(what)};
}

std::expected<void, Error> find_wrong_pixels(Grade& grade, const Rendered& by, const Image& right,
                                             const Image& student, int tolerance) {
  const auto is_wrong = [&](size_t i) {
    return apart(right.pixels[i], student.pixels[i]) > tolerance;
  };
  size_t first = 0, worst = 0;
  while (first < right.pixels.size() && !is_wrong(first)) ++first;
  if (first == right.pixels.size()) return {};
  for (size_t i = 0; i < right.pixels.size(); ++i)
    if (apart(right.pixels[i], student.pixels[i]) >
        apart(right.pixels[worst], student.pixels[worst]))
      worst = i;
  for (auto [pixel, index] : {std::pair(&grade.first, first), {&grade.worst, worst}}) {
    auto found = wrong_pixel(by, right, student, int(index % size_t(right.width)),
                             int(index / size_t(right.width)));
    if (!found) return std::unexpected(std::move(found.error()));
    *pixel = std::move(*found);
  }
  return {};
}

// Looks for the fault, unless the difference is no more than the rounding of another correct
// program.
void find_causes(Grade& grade, const Rendered& by, const Image& right, const Image& student) {
  constexpr double kRoundings = 0.5;
  if (grade.passed && grade.errors->difference.rmse <= kRoundings) return;
  // Another program's picture may differ from Raio's at a few edges.
  constexpr double kSame = 2;
  grade.is_rendered = compare(right, by.picture).rmse <= kSame;
  const Image& reference = grade.is_rendered ? by.picture : right;
  Imitation rendered;
  rendered.scene = by.scene, rendered.settings = by.settings;
  grade.causes = causes_of_difference(rendered, reference, student, !grade.is_rendered);
  if (!grade.causes.empty()) return;
  const WorkControl control;
  const std::vector<Region> regions = regions_of(by.scene, *by.accel, by.settings, control);
  check_stop();
  grade.region = suspect(differences(right, student, regions));
}

std::expected<Grade, Error> graded(const GradeCommand& command, const Scene& scene,
                                   const Image& student, const std::optional<Image>& given,
                                   const std::optional<std::string>& counts) {
  RenderOptions options = command.options;
  const Image& like = given ? *given : student;
  if (given || (options.width == 0 && !options.print))
    options.width = like.width, options.height = like.height;
  auto by = render_reference(scene, options);
  if (!by) return std::unexpected(std::move(by.error()));
  const Image& right = given ? *given : by->picture;

  Grade grade;
  grade.scene = scene.name;
  grade.size = {student.width, student.height};
  grade.expected_size = {right.width, right.height};
  if (counts) grade.counts = counts_in(*counts, by->rays);
  if (grade.size != grade.expected_size) return grade;
  grade.errors = errors_of(right, student, command.tolerance);
  grade.passed = grade.errors->difference.rmse <= command.threshold;
  find_causes(grade, *by, right, student);
  if (auto found = find_wrong_pixels(grade, *by, right, student, command.tolerance); !found)
    return std::unexpected(std::move(found.error()));
  if (!command.output.empty()) {
    auto written = write_image(side_by_side(right, student), command.output);
    if (!written) return std::unexpected(std::move(written.error()));
  }
  return grade;
}

}  // namespace

int run(const GradeCommand& command) {
  if (!command.output.empty()) {
    if (const auto format = image_format(command.output); !format) return fail(format.error());
    if (const auto writable = check_writable(command.output); !writable)
      return fail(writable.error());
  }
  const auto student = read_displayed(command.student);
  if (!student) return fail(student.error());
  std::optional<Image> given;
  if (!command.reference.empty()) {
    auto read = read_displayed(command.reference);
    if (!read) return fail(read.error());
    given = std::move(*read);
  }
  std::optional<std::string> counts;
  if (!command.counts.empty()) {
    auto read = read_file(command.counts == "-" ? "/dev/stdin" : command.counts, kMaxCountsBytes);
    if (!read) return fail(read.error());
    counts = std::move(*read);
  }
  const auto scene = load_scene(command.scene, false, nullptr, command.read);
  if (!scene) return scene.error();

  const auto grade = graded(command, *scene, *student, given, counts);
  if (!grade) return fail(grade.error());
  const int status =
      deliver("-", command.json ? grade_json(*grade, command) : grade_text(*grade, command));
  if (status != kDone) return status;
  return grade->passed ? kDone : kCheckFailed;
}

}  // namespace raio::core::app
