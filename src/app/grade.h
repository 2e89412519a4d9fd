// The output of `raio grade`: text or JSON.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/commands.h"
#include "io/image/image.h"
#include "measure/faults.h"
#include "render/regions.h"

namespace raio::core::app {

struct Grade {
  struct Errors {
    ImageDifference difference;
    double mean = 0;   // of the absolute differences, of 255
    size_t wrong = 0;  // pixels
  };
  // With the rays of its first sample in the right picture, as `raio explain` prints them.
  struct WrongPixel {
    std::array<int, 2> at{};                 // column, row
    std::array<int, 3> expected{}, found{};  // red, green, blue
    std::string text, json;
  };
  struct Count {
    std::string_view name;
    double expected = 0;
    std::optional<double> found;
  };

  std::string scene;                           // its name
  std::array<int, 2> size{}, expected_size{};  // width, height
  bool passed = false;
  std::optional<Errors> errors;  // nothing if the sizes differ, and nothing below
  std::vector<Cause> causes;
  std::optional<Region> region;            // that differs most, if no cause was found
  std::optional<WrongPixel> first, worst;  // from the upper left, row by row
  bool is_rendered = true;    // else Raio's picture is not the reference: see only_of_file
  std::vector<Count> counts;  // empty unless given
};

/// The numbers in a text that a program printed, by the words before them; see docs/grade.md.
std::vector<Grade::Count> counts_in(std::string_view text, const RayCounts& expected);

std::string grade_text(const Grade& grade, const GradeCommand& command);
std::string grade_json(const Grade& grade, const GradeCommand& command);

}  // namespace raio::core::app
