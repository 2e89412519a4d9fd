// Published counts for the Standard Procedural Databases at their default sizes.
//
// Haines: the table of 1987 in the databases' Readme.txt. Havran: Havran and Sixta 1999, the
// databases' docs/havran_stats_grids.txt. Both trace 513 x 513 rays through the corners of 512 x
// 512 pixels, five levels deep, with reflected and refracted rays from all transparent surfaces and
// a shadow ray to every light that a surface faces.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace raio::core::app {

struct HainesCounts {
  uint64_t eye_hits, reflection, refraction, shadow;
};

struct HavranCounts {
  uint64_t eye_hits, secondary, shadow, blocked;  // secondary: reflection and refraction
};

/// Havran's uniform grid: each primitive in all cells that its box overlaps, without mailboxing.
struct HavranGrid {
  std::array<int, 3> resolution;
  uint64_t references;
  double tests, steps;  // per ray
};

/// Known deviations of Raio's counts from Havran's, relative to his, explained in docs/verify.md.
/// Zero: none.
struct Departures {
  double blocked = 0;
  struct Grid {
    double references = 0, tests = 0, steps = 0;
  };
  std::array<Grid, 2> grids{};
};

struct PublishedScene {
  std::string_view name;
  std::optional<HainesCounts> haines;
  HavranCounts havran;
  std::array<HavranGrid, 2> grids;  // about one cell per primitive, and ten
  Departures known;
};

inline constexpr auto kPublished = std::to_array<PublishedScene>({
    {"balls",
     {{263169, 175095, 0, 954368}},
     {263169, 179884, 959244, 285178},
     {{{{46, 46, 3}, 10240, 358.66, 5.69}, {{103, 103, 7}, 19966, 72.54, 12.40}}},
     {}},
    {"gears",
     {{245086, 304643, 207564, 2246955}},
     {245332, 494338, 2088012, 1057557},
     {{{{32, 33, 9}, 39344, 39.76, 6.84}, {{71, 71, 18}, 110029, 22.82, 13.83}}},
     {.blocked = 0.158, .grids = {{{0.822, 0.494, -0.162}, {0.221, 0, -0.178}}}}},
    {"lattice",
     {},
     {261170, 243210, 1180774, 943159},
     {{{{20, 20, 20}, 32152, 20.67, 5.09}, {{44, 44, 44}, 90368, 9.26, 10.56}}},
     {}},
    {"mount",
     {{173125, 354769, 354769, 412922}},
     {173685, 710436, 361037, 74555},
     {{{{20, 20, 20}, 21746, 19.01, 8.85}, {{44, 44, 42}, 51144, 13.17, 18.43}}},
     {.blocked = 2.411, .grids = {{{0, 0, -0.106}, {0, -0.114, -0.115}}}}},
    {"rings",
     {{263169, 315236, 0, 1085002}},
     {263169, 312879, 1077336, 510719},
     {{{{21, 20, 21}, 27666, 45.29, 11.78}, {{44, 43, 44}, 71303, 23.36, 24.51}}},
     {}},
    {"teapot",
     {{161120, 225248, 0, 407656}},
     {161546, 226235, 406340, 34757},
     {{{{28, 29, 11}, 22982, 33.65, 14.98}, {{61, 61, 25}, 52781, 15.13, 32.50}}},
     {.blocked = 0.111}},
    {"tetra",
     {{49788, 0, 0, 46112}},
     {49950, 0, 46262, 5538},
     {{{{16, 16, 16}, 12556, 20.64, 7.43}, {{35, 35, 35}, 35936, 10.01, 15.97}}},
     {.grids = {{{1.371, 1.334, 0}, {}}}}},
    {"tree",
     {{169836, 0, 0, 1097419}},
     {169907, 0, 1110323, 47506},
     {{{{52, 52, 3}, 11102, 727.62, 7.60}, {{117, 118, 5}, 22407, 246.08, 15.45}}},
     {.blocked = -0.086}},
});

}  // namespace raio::core::app
