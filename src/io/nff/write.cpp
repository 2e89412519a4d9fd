#include <algorithm>
#include <charconv>

#include "io/nff/nff.h"
#include "io/nff/text_cursor.h"
#include "io/nff/writer.h"
#include "io/plain_scene.h"

namespace raio::core {
namespace nff {
namespace {

/// The shortest decimal that reads back as the number.
class Digits {
 public:
  template <class Number>
  explicit Digits(Number x) : size_(std::to_chars(text_, text_ + 40, x).ptr - text_) {}

  std::string_view view() const { return {text_, size_t(size_)}; }

  /// The double that a reader gets from the digits of a float, which may differ from the float.
  double read() const {
    double value = 0;
    parse_number(text_, value);
    return value;
  }

 private:
  char text_[40 + TextBuffer::kPadding] = {};
  ptrdiff_t size_;
};

/// Readers round twice, to a double and then to a float. That is wrong for one float only,
/// 7.038531e-26, which needs a double's digits.
Digits digits_of(float x) {
  const Digits digits(x);
  return float(digits.read()) == x ? digits : Digits(double(x));
}

}  // namespace

Text& Text::number(double x) { return word(Digits(x).view()); }
Text& Text::number(float x) { return word(digits_of(x).view()); }

double as_read(float x) { return digits_of(x).read(); }

std::string Writer::write(std::string_view comment) {
  while (!comment.empty()) {
    const size_t end = std::min(comment.find_first_of("\r\n"), comment.size());
    text_.word("#").word(comment.substr(0, end)).end_line();
    comment.remove_prefix(std::min(end + 1, comment.size()));
  }
  write_camera(*this);
  write_camera_movement(*this);
  write_surroundings(*this);
  for_each_pool([&](auto pool) {
    const auto& shapes = scene_.*pool.shapes;
    for (size_t i = 0; i < shapes.size(); ++i) {
      use((scene_.*pool.materials)[i]);
      write_shape(*this, shapes[i], i);
    }
  });
  while (next_material_ < scene_.materials.size()) material(next_material_++);
  return text_.take();
}

/// Makes material `id` the current one. The reader numbers materials in order, so earlier ones that
/// nothing has used yet are written first.
void Writer::use(MaterialId id) {
  if (id == current_) return;
  while (next_material_ <= id) material(next_material_++);
  if (current_ != id) material(id);
}

void Writer::material(MaterialId id) {
  write_material(*this, id);
  current_ = id;
}

}  // namespace nff

std::string write_nff(const Scene& scene, std::string_view comment) {
  if (!is_plain(scene)) return write_nff(plain_scene(scene), comment);
  return nff::Writer(scene).write(comment);
}

}  // namespace raio::core
