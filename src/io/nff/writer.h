// Shared by the writers of entities. Internal to this folder: write.cpp goes through the scene, and
// each kind of primitive is written next to its reader.
#pragma once

#include <string>
#include <string_view>
#include <utility>

#include "scene/scene.h"

namespace raio::core::nff {

/// A text under construction, with a blank between the words of a line. A number gets the fewest
/// digits that read back to it.
class Text {
 public:
  Text& word(std::string_view word) {
    if (!out_.empty() && out_.back() != '\n') out_ += ' ';
    out_ += word;
    return *this;
  }

  Text& number(int x) { return word(std::to_string(x)); }
  Text& number(uint32_t x) { return word(std::to_string(x)); }
  Text& number(double x);
  Text& number(float x);

  template <class T>
  Text& vector(Vec3<T> v) {
    return number(v.x).number(v.y).number(v.z);
  }

  void end_line() { out_ += '\n'; }

  std::string take() { return std::move(out_); }

 private:
  std::string out_;
};

/// The double that a reader gets from the digits of a float, which may differ from the float.
double as_read(float x);

class Writer {
 public:
  explicit Writer(const Scene& scene) : scene_(scene) {}

  std::string write(std::string_view comment);

  const Scene& scene() const { return scene_; }
  Text& text() { return text_; }
  /// A point in the file's coordinates, in double if the scene has an origin.
  Text& position(std::string_view keyword, Vec3f p) {
    if (!keyword.empty()) text_.word(keyword);
    return scene_.origin == Vec3d() ? text_.vector(p) : text_.vector(scene_.origin + Vec3d(p));
  }

 private:
  void use(MaterialId id);
  void material(MaterialId id);

  const Scene& scene_;
  Text text_;
  MaterialId next_material_ = 0, current_ = 0xffffffffu;
};

void write_camera(Writer& w);
void write_camera_movement(Writer& w);
/// Background, sky, requests, lights.
void write_surroundings(Writer& w);
void write_material(Writer& w, MaterialId id);

/// Writes element `i` of a pool. Defined for each pool next to its reader; if one is missing, the
/// linker names it.
template <class Shape>
void write_shape(Writer&, const Shape&, size_t);

}  // namespace raio::core::nff
