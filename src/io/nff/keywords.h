// The words of NFF and of its dialects, each written once. For the NFF reader.
#pragma once

#include <string>
#include <string_view>

namespace raio::nff {

/// What begins an entity.
enum class Keyword { none, v, b, l, f, s, c, p, pp, pl, box, mesh, ellipsoid, disc, spp, accel };

/// What begins a piece of `v`, in the usual order.
enum class CameraWord { none, from, at, up, angle, hither, resolution, aperture, focal };

/// A word of a dialect that is not read.
struct RefusedWord {
  std::string_view word;
  std::string_view what;  // "a moving sphere of the P3F dialect: ..."
};

Keyword find_keyword(std::string_view word);
CameraWord find_camera_word(std::string_view word);
const RefusedWord* find_refused(std::string_view word);

/// The word of `v` meant by a misspelt one (`in_camera`), or the keyword; empty if none is near.
std::string_view nearest_word(std::string_view word, bool in_camera);

/// What an entity takes, for "number too many": "s takes 4 numbers: x y z radius".
std::string_view usage(Keyword keyword);

/// What an entity is called in messages: "the sphere".
std::string_view noun_of(Keyword keyword);

/// Does an entity leave nothing behind but a material or objects?
bool leaves_objects(Keyword keyword);

/// All keywords, for "expected one of ...".
std::string keyword_list();

}  // namespace raio::nff
