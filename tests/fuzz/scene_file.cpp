// Scene files of all kinds: whatever the bytes, errors of one line each, or a sound scene that
// survives the way through a .raio file to the last bit.
#include "io/scene_file.h"

#include "../raio_mend.h"
#include "io/raio/raio.h"
#include "require.h"

extern "C" size_t LLVMFuzzerMutate(uint8_t* data, size_t size, size_t most);

/// Makes the hashes right, so that a change gets past them.
extern "C" size_t LLVMFuzzerCustomMutator(uint8_t* data, size_t size, size_t most, unsigned seed) {
  const size_t mutated = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 != 0) raio::core::tests::mend_raio_scene(reinterpret_cast<char*>(data), mutated);
  return mutated;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace raio::core;
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  // GRO is the only format detected by suffix alone; this title stands for it.
  const auto read = parse_scene(bytes, bytes.starts_with("gro\n") ? "fuzz.gro" : "fuzz",
                                {.instances = size % 2 == 0});
  if (!read) {
    fuzz::require(!read.error().empty(), "there is an error");
    for (const Diagnostic& d : read.error())
      for (const char c : d.text())
        fuzz::require(c >= 32 && c < 127, "an error is one line of ASCII");
    return 0;
  }
  const Scene& scene = read->scene;
  fuzz::require(validate(scene).empty(), "what is read is sound");
  const std::string written = encode_raio_scene(scene);
  const auto again = decode_raio_scene(written, nullptr);
  fuzz::require(again.has_value(), "what is written can be read");
  fuzz::require(content_hash(*again) == content_hash(scene), "it is the same scene");
  fuzz::require(encode_raio_scene(*again) == written, "there is one file for a scene");
  return 0;
}
