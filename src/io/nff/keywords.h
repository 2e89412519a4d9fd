// What an NFF text is made of: a row for each keyword, the words of `v`, and the words of dialects
// that are not read. For the NFF reader.
//
// A row stands with the functions that read and write what it names, in the file of its family:
// camera.cpp, surroundings.cpp, rounds.cpp (NFF's), flats.cpp (NFF's and P3F's), additions.cpp
// (Raio's own) and movements.cpp (P3F's and Raio's own). A new keyword is a row there and nothing
// elsewhere.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace raio::nff {

class Parser;

/// What it may mean that so many numbers too many follow an entity.
struct Surplus {
  size_t numbers = 0;
  std::string_view advice = {};  // NOLINT(readability-redundant-member-init)
};

/// What begins with a keyword.
struct Entity {
  /// What it leaves behind: a material or objects and nothing else, or something else, too.
  enum class Leaves { objects, more };

  std::string_view word;   // the keyword
  std::string_view noun;   // in messages: "the sphere"
  std::string_view usage;  // for numbers too many: "s takes 4 numbers: x y z radius"
  void (*read)(Parser&);   // what follows the keyword
  Leaves leaves = Leaves::objects;
  /// What a word in the place of a number may mean.
  std::string_view if_word = {};  // NOLINT(readability-redundant-member-init)
  Surplus surplus = {};
};

/// In the order in which messages list them.
using Family = std::span<const Entity>;
extern const Family kCameras, kSurroundings, kRounds, kFlats, kAdditions, kMovements, kHints;

/// The keyword that has a part in how the reader recovers from errors.
inline constexpr std::string_view kCameraKeyword = "v";

/// What begins a piece of `v`, in the usual order.
enum class CameraWord { none, from, at, up, angle, hither, resolution, aperture, focal };

/// A word of a dialect that is not read.
struct RefusedWord {
  std::string_view word;
  std::string_view what;  // "a moving sphere of the P3F dialect: ..."
  size_t numbers = 0;     // behind it in its line; 0: any
};

/// Null where the word is no keyword.
const Entity* find_entity(std::string_view word);
CameraWord find_camera_word(std::string_view word);
/// `numbers`: how many are behind it in its line.
const RefusedWord* find_refused(std::string_view word, size_t numbers = 0);

/// The word of `v` meant by a misspelt one (`in_camera`), or the keyword; empty if none is near.
std::string_view nearest_word(std::string_view word, bool in_camera);

/// All keywords, for "expected one of ...".
std::string keyword_list();

}  // namespace raio::nff
