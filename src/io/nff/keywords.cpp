#include "io/nff/keywords.h"

#include <array>
#include <vector>

#include "base/spelling.h"

namespace raio::nff {
namespace {

/// What an entity leaves behind: a material or objects and nothing else, or something else, too.
enum class Leaves { objects, more };

struct KeywordEntry {
  std::string_view word;
  Keyword keyword;
  Leaves leaves;
  std::string_view noun;
  std::string_view usage;
};

constexpr std::array kKeywords = {
    KeywordEntry{"v", Keyword::v, Leaves::more, "the camera",
                 "v takes from, at, up, angle, hither and resolution"},
    KeywordEntry{"b", Keyword::b, Leaves::more, "the background", "b takes 3 numbers: r g b"},
    KeywordEntry{"bclr", Keyword::b, Leaves::more, "the background", "bclr takes 3 numbers: r g b"},
    KeywordEntry{"l", Keyword::l, Leaves::more, "the light",
                 "l takes 3 or 6 numbers on its line: x y z, then r g b"},
    KeywordEntry{"f", Keyword::f, Leaves::objects, "the material",
                 "f takes 8 numbers: r g b Kd Ks Shine T ior"},
    KeywordEntry{"s", Keyword::s, Leaves::objects, "the sphere", "s takes 4 numbers: x y z radius"},
    KeywordEntry{"c", Keyword::c, Leaves::objects, "the cone",
                 "c takes 8 numbers: x y z radius of the base, then of the apex"},
    KeywordEntry{"p", Keyword::p, Leaves::objects, "the polygon",
                 "p takes a count and as many corners of 3 numbers"},
    KeywordEntry{"pp", Keyword::pp, Leaves::objects, "the smooth polygon",
                 "pp takes a count and as many corners of 6 numbers"},
    KeywordEntry{"pl", Keyword::pl, Leaves::objects, "the plane",
                 "pl takes 9 numbers: three points"},
    KeywordEntry{"box", Keyword::box, Leaves::objects, "the box",
                 "box takes 6 numbers: lowest and highest corner"},
    KeywordEntry{
        "mesh", Keyword::mesh, Leaves::objects, "the mesh",
        "mesh takes two counts, as many vertices of 3 numbers, as many faces of 3 indices"},
    KeywordEntry{"ellipsoid", Keyword::ellipsoid, Leaves::objects, "the ellipsoid",
                 "ellipsoid takes 12 numbers: x y z of the centre, then of each semi-axis"},
    KeywordEntry{
        "disc", Keyword::disc, Leaves::objects, "the disc",
        "disc takes 7 or 8 numbers on its line: x y z, the normal's x y z, radius, then the "
        "inner radius of a ring"},
    KeywordEntry{"spp", Keyword::spp, Leaves::more, "spp", "spp takes 1 number"},
    KeywordEntry{"accel", Keyword::accel, Leaves::more, "accel", "accel takes 1 number"},
};

/// By keyword, the first of its words.
constexpr auto kEntries = [] {
  std::array<uint8_t, kKeywords.size() + 1> entries{};
  for (size_t i = kKeywords.size(); i-- > 0;) entries[size_t(kKeywords[i].keyword)] = uint8_t(i);
  return entries;
}();
const KeywordEntry& entry_of(Keyword keyword) { return kKeywords[kEntries[size_t(keyword)]]; }

struct CameraEntry {
  std::string_view word;
  CameraWord camera_word;
};

constexpr std::array kCameraWords = {
    CameraEntry{"from", CameraWord::from},
    CameraEntry{"at", CameraWord::at},
    CameraEntry{"up", CameraWord::up},
    CameraEntry{"angle", CameraWord::angle},
    CameraEntry{"hither", CameraWord::hither},
    CameraEntry{"resolution", CameraWord::resolution},
    CameraEntry{"aperture", CameraWord::aperture},
    CameraEntry{"focal", CameraWord::focal},
};

constexpr std::string_view kMotion =
    "motion blur of the P3F dialect, which Raio does not have: take it out";
constexpr std::string_view kStudentLens =
    "a lens setting of a student dialect: write P3F's \"aperture\" and \"focal\" after resolution, "
    "or "
    "use `dof` with `aperture` and `focus`";
constexpr std::string_view kAffTransform =
    "a transform or animation of the AFF dialect (BART): export the objects where they stand in "
    "one frame";
constexpr std::string_view kAffMesh =
    "a part of a mesh of the AFF dialect (BART): write the triangles as \"p 3\" or \"pp 3\", or as "
    "P3F's "
    "\"mesh\"";
constexpr std::string_view kAffTexture =
    "a textured or animated triangle of the AFF dialect (BART): write it as \"p 3\" or \"pp 3\"";
constexpr std::string_view kAffFile =
    "a file inclusion of the AFF dialect (BART): put the contents of that file in its place";
constexpr std::string_view kPrt =
    "a keyword of the PRT format: NFF writes \"l\" for lights, \"b\" for the background and \"f\" "
    "for "
    "surfaces";
constexpr std::string_view kPatch =
    "a curved patch of the ENFF dialect: cut it into triangles and write them as \"pp 3\"";
constexpr std::string_view kMovingSphere =
    "a moving sphere of the P3F dialect: Raio has no motion blur, write \"s\"";

constexpr std::array kRefused = {
    RefusedWord{"ms", kMovingSphere},
    RefusedWord{"sm", kMovingSphere},
    RefusedWord{
        "env",
        "an environment of images of the P3F dialect: Raio has a plain background, write \"b\""},
    RefusedWord{"time0", kMotion},
    RefusedWord{"time1", kMotion},
    RefusedWord{"yon",
                "a back plane of the Graphics Gems V dialect: NFF sees to infinity, take it out"},
    RefusedWord{"lensRadius", kStudentLens},
    RefusedWord{"apperture", kStudentLens},
    RefusedWord{"focalp", kStudentLens},
    RefusedWord{"viewp", kStudentLens},
    RefusedWord{
        "al",
        "an area light of a student dialect: write \"l\" and use `soft-shadows` with `light-size`"},
    RefusedWord{"obj",
                "a file inclusion of a student dialect: write its triangles as P3F's \"mesh\""},
    RefusedWord{"pb", kPatch},
    RefusedWord{"pn", kPatch},
    RefusedWord{"pn_end", kPatch},
    RefusedWord{"fm", "a material of the AFF dialect (BART): write \"f r g b Kd Ks Shine T ior\""},
    RefusedWord{
        "am",
        "an ambient light of the AFF dialect (BART): Raio sets it from the lights, take it out"},
    RefusedWord{"la", "an animated light of the AFF dialect (BART): write \"l\""},
    RefusedWord{"a", "an animation of the AFF dialect (BART): Raio renders one frame, take it out"},
    RefusedWord{"k", kAffTransform},
    RefusedWord{"x", kAffTransform},
    RefusedWord{"xs", kAffTransform},
    RefusedWord{"{", kAffTransform},
    RefusedWord{"}", kAffTransform},
    RefusedWord{"transl", kAffTransform},
    RefusedWord{"rot", kAffTransform},
    RefusedWord{"scale", kAffTransform},
    RefusedWord{"visibility", kAffTransform},
    RefusedWord{"tt", kAffTexture},
    RefusedWord{"ttp", kAffTexture},
    RefusedWord{"tpa", kAffTexture},
    RefusedWord{"m", kAffMesh},
    RefusedWord{"vertices", kAffMesh},
    RefusedWord{"normals", kAffMesh},
    RefusedWord{"texturecoords", kAffMesh},
    RefusedWord{"triangles", kAffMesh},
    RefusedWord{"i", kAffFile},
    RefusedWord{"d", "a level of detail of the AFF dialect (BART): take it out"},
    RefusedWord{"%", "a comment of the AFF dialect (BART): NFF's begin with \"#\""},
    RefusedWord{"light", kPrt},
    RefusedWord{"background", kPrt},
    RefusedWord{"surface", kPrt},
};

}  // namespace

Keyword find_keyword(std::string_view word) {
  for (const KeywordEntry& entry : kKeywords)
    if (entry.word == word) return entry.keyword;
  return Keyword::none;
}

CameraWord find_camera_word(std::string_view word) {
  for (const CameraEntry& entry : kCameraWords)
    if (entry.word == word) return entry.camera_word;
  return CameraWord::none;
}

const RefusedWord* find_refused(std::string_view word) {
  // "%" is a comment even when the text sticks to it.
  if (word.starts_with('%')) word = "%";
  for (const RefusedWord& refused : kRefused)
    if (refused.word == word) return &refused;
  return nullptr;
}

std::string_view nearest_word(std::string_view word, bool in_camera) {
  std::vector<std::string_view> words;
  if (in_camera)
    for (const CameraEntry& entry : kCameraWords) words.push_back(entry.word);
  else
    for (const KeywordEntry& entry : kKeywords) words.push_back(entry.word);
  return raio::nearest_word(word, words);
}

std::string_view usage(Keyword keyword) {
  return keyword == Keyword::none ? std::string_view() : entry_of(keyword).usage;
}

std::string_view noun_of(Keyword keyword) {
  return keyword == Keyword::none ? std::string_view() : entry_of(keyword).noun;
}

bool leaves_objects(Keyword keyword) {
  return keyword != Keyword::none && entry_of(keyword).leaves == Leaves::objects;
}

std::string keyword_list() {
  std::string out;
  for (const KeywordEntry& entry : kKeywords)
    out += (out.empty() ? "" : " ") + std::string(entry.word);
  return out;
}

}  // namespace raio::nff
