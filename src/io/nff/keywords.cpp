#include "io/nff/keywords.h"

#include <algorithm>
#include <array>
#include <vector>

#include "base/spelling.h"

namespace raio::core::nff {
namespace {

constexpr std::array kFamilies = {&kCameras,   &kSurroundings, &kRounds, &kFlats,
                                  &kAdditions, &kMovements,    &kHints};

std::vector<std::string_view> keywords() {
  std::vector<std::string_view> words;
  for (const Family* family : kFamilies)
    for (const Entity& entity : *family) words.push_back(entity.word);
  return words;
}

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

constexpr std::string_view kShutter =
    "a shutter of a student dialect: take it out and use `shutter`";
constexpr std::string_view kStudentLens =
    "a lens setting of a student dialect: write P3F's \"aperture\" and \"focal\" after resolution, "
    "or "
    "use `dof` with `aperture` and `focus`";
constexpr std::string_view kAffTransform =
    "a transform or animation of the AFF dialect (BART): export the objects with their positions "
    "in "
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
    "a moving sphere of a student dialect: write \"sm\" with two centres, the radius and two times";

constexpr std::array kRefused = {
    RefusedWord{"ms", kMovingSphere},
    RefusedWord{"time0", kShutter},
    RefusedWord{"time1", kShutter},
    RefusedWord{
        "yon",
        "a far clipping plane of the Graphics Gems V dialect: NFF sees to infinity, take it out"},
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
    RefusedWord{
        "la", "an area light of a student dialect: write \"l\" with x y z width depth n r g b", 12},
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
    RefusedWord{"%", "a comment of the AFF dialect (BART): begin NFF comments with \"#\""},
    RefusedWord{"light", kPrt},
    RefusedWord{"background", kPrt},
    RefusedWord{"surface", kPrt},
};

}  // namespace

const Entity* find_entity(std::string_view word) {
  for (const Family* family : kFamilies)
    for (const Entity& entity : *family)
      if (entity.word == word) return &entity;
  return nullptr;
}

CameraWord find_camera_word(std::string_view word) {
  for (const CameraEntry& entry : kCameraWords)
    if (entry.word == word) return entry.camera_word;
  return CameraWord::none;
}

const RefusedWord* find_refused(std::string_view word, size_t numbers) {
  // "%" begins a comment even without a blank after it.
  if (word.starts_with('%')) word = "%";
  for (const RefusedWord& refused : kRefused)
    if (refused.word == word && (refused.numbers == 0 || refused.numbers == numbers))
      return &refused;
  return nullptr;
}

std::string_view nearest_word(std::string_view word, bool in_camera) {
  if (!in_camera) return core::nearest_word(word, keywords());
  std::array<std::string_view, kCameraWords.size()> words;
  std::ranges::transform(kCameraWords, words.begin(), &CameraEntry::word);
  return core::nearest_word(word, words);
}

std::string keyword_list() {
  std::string out;
  for (const std::string_view word : keywords())
    out += (out.empty() ? "" : " ") + std::string(word);
  return out;
}

}  // namespace raio::core::nff
