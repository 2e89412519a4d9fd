// The words of an NFF text: keywords, the parameters of `v`, and words of dialects that Raio
// refuses. For the NFF reader.
//
// Each keyword has a row next to its reader and writer, in the file of its family: camera.cpp,
// surroundings.cpp, rounds.cpp (NFF), flats.cpp (NFF and P3F), additions.cpp (Raio) and
// movements.cpp (P3F and Raio). A new keyword is one row there.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace raio::core::nff {

class Parser;

/// Advice for an entity that is followed by this many extra numbers.
struct Surplus {
  size_t numbers = 0;
  std::string_view advice = {};  // NOLINT(readability-redundant-member-init)
};

/// A keyword and its reader.
struct Entity {
  /// The effect of the entity: it adds a material or objects only, or changes something else, too.
  enum class Leaves { objects, more };

  std::string_view word;   // the keyword
  std::string_view noun;   // in messages: "the sphere"
  std::string_view usage;  // after extra numbers: "s takes 4 numbers: x y z radius"
  void (*read)(Parser&);   // reads the numbers after the keyword
  Leaves leaves = Leaves::objects;
  /// Advice if a word takes the place of a number.
  std::string_view if_word = {};  // NOLINT(readability-redundant-member-init)
  Surplus surplus = {};
};

/// In the order in which messages list them.
using Family = std::span<const Entity>;
extern const Family kCameras, kSurroundings, kRounds, kFlats, kAdditions, kMovements, kHints;

/// The keyword that error recovery treats specially.
inline constexpr std::string_view kCameraKeyword = "v";

/// The parameters of `v`, in the usual order.
enum class CameraWord { none, from, at, up, angle, hither, resolution, aperture, focal };

/// A word of a dialect that Raio refuses.
struct RefusedWord {
  std::string_view word;
  std::string_view what;  // "a moving sphere of the P3F dialect: ..."
  size_t numbers = 0;     // that follow on its line; 0: any
};

/// Null if the word is not a keyword.
const Entity* find_entity(std::string_view word);
CameraWord find_camera_word(std::string_view word);
/// `numbers`: how many follow on its line.
const RefusedWord* find_refused(std::string_view word, size_t numbers = 0);

/// The parameter of `v` (`in_camera`) or the keyword that is closest to a misspelt word; empty if
/// none is close.
std::string_view nearest_word(std::string_view word, bool in_camera);

/// All keywords, for "expected one of ...".
std::string keyword_list();

}  // namespace raio::core::nff
