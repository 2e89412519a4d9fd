// Part files: whatever the bytes, a reason in one line, or a film that survives the way through a
// file.
#include "render/part.h"

#include "base/hash.h"
#include "require.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

/// Makes the hash at the end right, so that a change gets past it.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  constexpr size_t kHashBytes = 16;
  const size_t mutated = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 == 0 || mutated < kHashBytes) return mutated;
  const size_t end = mutated - kHashBytes;
  const auto hash = raio::core::hash128({reinterpret_cast<const char*>(data), end});
  for (size_t i = 0; i < 8; ++i) {
    data[end + i] = uint8_t(hash.first >> 8 * i);
    data[end + 8 + i] = uint8_t(hash.second >> 8 * i);
  }
  return mutated;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace raio::core;
  const auto part = decode_part({reinterpret_cast<const char*>(data), size});
  if (!part) return fuzz::require(!part.error().text().empty(), "an error has a reason"), 0;
  const Film& film = *part->film;
  if (film.width() * int64_t(film.height()) > 100'000) return 0;
  const auto again = decode_part(encode_part(part->header, film));
  fuzz::require(again && again->header.settings == part->header.settings &&
                    again->film->tiles() == film.tiles(),
                "a part survives a file");
  for (size_t t = 0; t < film.tiles(); ++t)
    fuzz::require(again->film->copy(t) == film.copy(t), "a tile survives a file");
  (void)film.resolve();
  return 0;
}
