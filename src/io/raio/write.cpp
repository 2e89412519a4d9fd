
#include <algorithm>
#include <memory>
#include <new>
#include <type_traits>

#include "base/parallel.h"
#include "io/raio/format.h"
#include "io/raio/raio.h"

namespace raio::core {
namespace {

using namespace scene_file;

struct FileColumn {
  Entry entry;
  std::string_view bytes;
  std::shared_ptr<const void> keep;  // of the bytes
};

std::vector<FileColumn> columns_of(const Settings& settings, const Scene& scene) {
  std::vector<FileColumn> columns;
  for_each_file_column(
      settings, scene, [&](std::string_view name, uint32_t mesh, const auto& array) {
        using T = std::remove_cvref_t<decltype(array)>::value_type;
        static_assert(sizeof(T) == bytes_of(Element<T>::number) * Element<T>::numbers);
        if (array.empty()) return;
        const auto elements = std::make_shared<const Array<T>>(packed(array));
        FileColumn column{{.number = Element<T>::number,
                           .numbers = Element<T>::numbers,
                           .mesh = mesh,
                           .count = array.size()},
                          {reinterpret_cast<const char*>(elements->data()), elements->bytes()},
                          elements};
        name.copy(column.entry.name, sizeof(Entry::name) - 1);
        columns.push_back(column);
      });
  return columns;
}

void copy_in_parallel(std::string_view from, char* to) {
  constexpr size_t kChunk = 1 << 22;
  parallel_for((from.size() + kChunk - 1) / kChunk,
               [&](size_t i) { from.substr(i * kChunk, kChunk).copy(to + i * kChunk, kChunk); });
}

}  // namespace

std::string encode_raio_scene(const Scene& scene) {
  const Settings settings = settings_of(scene);
  std::vector<FileColumn> columns = columns_of(settings, scene);
  size_t size = sizeof(Header) + columns.size() * sizeof(Entry);
  for (FileColumn& c : columns) {
    c.entry.offset = aligned(size);
    c.entry.hash = column_hash(c.bytes);
    size = c.entry.offset + c.bytes.size();
  }
  Header header{.columns = uint32_t(columns.size()), .file_size = size};
  kMagic.copy(header.magic, sizeof header.magic);

  std::string out(size, '\0');
  char* table = out.data() + sizeof header;
  for (const FileColumn& c : columns) {
    std::memcpy(table, &c.entry, sizeof c.entry);
    table += sizeof c.entry;
    copy_in_parallel(c.bytes, out.data() + c.entry.offset);
  }
  header.hash = table_hash(
      header, std::string_view(out).substr(sizeof header, columns.size() * sizeof(Entry)));
  std::memcpy(out.data(), &header, sizeof header);
  return out;
}

std::expected<void, Error> write_raio_scene(const Scene& scene,
                                            const std::filesystem::path& path) try {
  return write_file(path, encode_raio_scene(scene));
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(path));
}

}  // namespace raio::core
