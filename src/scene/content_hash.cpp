#include <bit>
#include <cstring>

#include "base/hash.h"
#include "scene/columns.h"

namespace raio::core {
namespace {

static_assert(std::endian::native == std::endian::little,
              "pools are hashed as stored in memory, which must be the same on all machines");

/// Collects plain values without padding.
class Gatherer {
 public:
  template <class... T>
  void add(const T&... values) {
    (bytes_.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  }
  // Elements are four-byte numbers, without padding in between.
  void add_column(ColumnName column, const auto& array) {
    using T = std::remove_cvref_t<decltype(array)>::value_type;
    static_assert(alignof(T) == 4);
    if (column.counted == Counted::where_used) {
      if (array.empty()) return;
      bytes_.append(column.name);
    }
    const Array<T> elements = packed(array);
    add(uint64_t(elements.size()),
        hash128({reinterpret_cast<const char*>(elements.data()), elements.bytes()}));
  }
  template <class T>
  void add_optional(const std::optional<T>& value) {
    add(uint32_t(value.has_value()), value.value_or(T()));
  }

  // Defaults add nothing, so older scenes keep their hashes.
  void add_word(std::string_view word) { bytes_.append(word); }

  std::string name() const { return hex(hash128(bytes_)); }

 private:
  std::string bytes_;
};

}  // namespace

std::string content_hash(const Scene& s) {
  Gatherer all;
  const Camera& camera = s.camera;
  all.add(s.origin, camera.from, camera.at, camera.up, camera.fov_deg);
  all.add(camera.width, camera.height, s.requests.samples_per_pixel, s.background);
  all.add_optional(camera.lens_radius);
  all.add_optional(camera.focus_distance);
  for (const Light& light : s.lights) {
    all.add(light.position);
    all.add_optional(light.color);
  }
  all.add(uint64_t(s.lights.size()));
  const auto add = [&](ColumnName name, const auto& array) { all.add_column(name, array); };
  for_each_own_column(s, add);
  for (const Mesh& mesh : s.meshes) {
    all.add('m');  // so that columns of successive meshes cannot be confused
    for_each_mesh_column(mesh, add);
  }
  if (s.dialect == Dialect::p3f) all.add_word("dialect p3f");
  if (s.dialect == Dialect::data) all.add_word("dialect data");
  if (camera.horizontal_fov_deg > 0) {
    all.add_word("camera across");
    all.add(camera.horizontal_fov_deg);
  }
  if (camera.is_parallel()) all.add_word("camera orthographic");
  if (camera.is_omnidirectional()) all.add_word("camera omnidirectional");
  for (size_t i = 0; i < s.lights.size(); ++i)
    if (const auto& extent = s.lights[i].extent) {
      all.add_word("light extent");
      all.add(uint32_t(i), extent->width, extent->depth);
    }
  if (!s.requests.sky_folder.empty()) all.add_word("sky " + s.requests.sky_folder);
  if (const auto& m = camera.movement) {
    all.add_word("camera movement");
    all.add(m->from, m->at, m->begin, m->end);
  }
  for (const Object& object : s.prototypes)
    all.add_word("object " + content_hash(standalone(s, object)));
  return all.name();
}

}  // namespace raio::core
