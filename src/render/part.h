// Part files (.raio): a film, whole or not, with all that decides its picture, so that it can be
// gone on with elsewhere and later. A checkpoint is one, a shard, a picture to which samples may be
// added. docs/long-renders.md has their layout.
#pragma once

#include <expected>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "integrate/film.h"
#include "io/file.h"
#include "render/provenance.h"

namespace raio {

struct PartHeader {
  Metadata settings;               // settings_of() the picture
  uint32_t shard = 0, shards = 1;  // which tiles are here, as in RenderTask
  SampleSpan samples = {};         // which samples are; empty: all that the settings say
};

struct Part {
  PartHeader header;
  std::unique_ptr<Film> film;
};

/// Whether the name says that the file is one.
bool is_part_path(const std::filesystem::path& path);

/// The film as it is at some moment while others may add to it: each tile is whole.
std::string encode_part(const PartHeader& header, const Film& film);
std::expected<void, Error> write_part(const std::filesystem::path& path, const PartHeader& header,
                                      const Film& film);

/// The file need not be trusted: what comes back is a sound film of the size that its settings say.
/// The error of decode_part has no subject.
std::expected<Part, Error> decode_part(std::string_view file);
std::expected<Part, Error> read_part(const std::filesystem::path& path);

/// How many samples the tiles of a part have, of those that its shard is about.
struct SampleCounts {
  uint32_t fewest = 0, most = 0;
  bool alike = true;  // all have the same samples:
  SampleSet samples;  // of the first of them
};
SampleCounts samples_of(const Part& part);

/// "0:20,50:100", each span from its first sample to before its end.
std::string text_of(const SampleSet& samples);

/// A part with its name, for messages.
struct NamedPart {
  std::string name;
  Part part;
};

/// All of them in the film of the first, to the same bytes as if one render had made them. The
/// error (bad_input) says what does not fit together: settings that differ, samples that two have.
std::expected<Part, Error> merge_parts(std::span<NamedPart> parts);

/// Which tiles and samples a part lacks, tiles in the words of the shards that it was made of;
/// nothing when it has all. `shards`: into how many the picture was split.
std::string missing_samples(const Part& part, uint32_t shards);

}  // namespace raio
