// Makes the hashes of a damaged .raio scene right, so that the damage gets past them. For tests and
// the fuzzer of the format.
#pragma once

#include <cstring>
#include <string_view>

#include "io/raio/format.h"

namespace raio::core::tests {

/// Recomputes the hashes of all columns within the bytes and of the table, including those of
/// prototypes.
inline void mend_raio_scene(char* bytes, size_t size, int depth = 0) {
  using namespace scene_file;
  Header header;
  if (size < sizeof header) return;
  std::memcpy(&header, bytes, sizeof header);
  const size_t most = (size - sizeof header) / sizeof(Entry);
  if (header.columns > most) return;
  const std::string_view file(bytes, size);
  for (size_t i = 0; i < header.columns; ++i) {
    char* const at = bytes + sizeof header + i * sizeof(Entry);
    Entry entry;
    std::memcpy(&entry, at, sizeof entry);
    const size_t element = bytes_of(entry.number) * entry.numbers;
    if (entry.offset > size || element == 0 || entry.count > (size - entry.offset) / element)
      continue;
    if (std::string_view(entry.name, 10) == std::string_view("prototype\0", 10) && depth < 20)
      mend_raio_scene(bytes + entry.offset, entry.count * element, depth + 1);
    entry.hash = column_hash(file.substr(entry.offset, entry.count * element));
    std::memcpy(at, &entry, sizeof entry);
  }
  header.hash = table_hash(header, file.substr(sizeof header, header.columns * sizeof(Entry)));
  std::memcpy(bytes, &header, sizeof header);
}

}  // namespace raio::core::tests
