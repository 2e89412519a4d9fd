#include "render/part.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <new>
#include <vector>

#include "base/hash.h"
#include "render/render.h"

namespace raio::core {
namespace {

constexpr std::string_view kMagic = "RAIOPART";
constexpr uint32_t kFormat = 4;
constexpr size_t kHashBytes = 16;

// Numbers are little-endian.
template <class T>
void put(std::string& out, T value) {
  for (size_t i = 0; i < sizeof value; ++i) out += char(uint64_t(value) >> 8 * i & 255);
}

void put_text(std::string& out, std::string_view text) {
  put(out, uint32_t(text.size()));
  out += text;
}

void put_hash(std::string& out, const Hash128& hash) {
  put(out, hash.first);
  put(out, hash.second);
}

constexpr std::array kRayCounts = {
    &RayCounts::eye,    &RayCounts::eye_hits,    &RayCounts::reflection, &RayCounts::refraction,
    &RayCounts::shadow, &RayCounts::shadow_hits, &RayCounts::tests,      &RayCounts::steps};

// All lowest bytes, then all second ones, and so on: the upper bytes are similar, which deflate
// compresses well.
template <class T>
std::string to_planes(std::span<const T> numbers) {
  std::string planes(numbers.size() * sizeof(T), '\0');
  for (size_t plane = 0; plane < sizeof(T); ++plane)
    for (size_t i = 0; i < numbers.size(); ++i)
      planes[plane * numbers.size() + i] = char(numbers[i] >> 8 * plane & 255);
  return planes;
}

template <class T>
std::vector<T> from_planes(std::string_view planes) {
  std::vector<T> numbers(planes.size() / sizeof(T));
  for (size_t plane = sizeof(T); plane-- > 0;)
    for (size_t i = 0; i < numbers.size(); ++i)
      numbers[i] = T(numbers[i] << 8 | T(uint8_t(planes[plane * numbers.size() + i])));
  return numbers;
}

// Data that deflate cannot shrink stays as it is.
template <class T>
void put_numbers(std::string& out, const std::vector<T>& numbers) {
  if (numbers.empty()) return;
  const std::string planes = to_planes(std::span(numbers));
  const auto whole = uLong(planes.size());  // which has 32 bits on Windows, enough for a tile
  std::string packed(compressBound(whole), '\0');
  auto size = uLongf(packed.size());
  const int done = compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                             reinterpret_cast<const Bytef*>(planes.data()), whole, 1);
  packed.resize(size);
  put_text(out, done == Z_OK && size < planes.size() ? packed : planes);
}

// A tile without samples is a single zero.
std::string encode_tile(const TileSamples& tile) {
  std::string out;
  put(out, uint32_t(tile.samples.spans().size()));
  if (tile.samples.empty()) return out;
  for (const SampleSpan& span : tile.samples.spans()) put(out, span.first), put(out, span.end);
  for (const auto count : kRayCounts) put(out, tile.rays.*count);
  for (const CountedSamples& of : {tile.faults.nans, tile.faults.clamped})
    put(out, of.count), put(out, of.x), put(out, of.y);
  put_numbers(out, tile.sums);
  put_numbers(out, tile.last_round);
  put_numbers(out, tile.means);
  put_numbers(out, tile.squares);
  put_numbers(out, tile.firsts);
  return out;
}

/// Reads from the front; after the end everything is zero and `ended` is set.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : left_(bytes) {}

  template <class T>
  T number() {
    const std::string_view bytes = take(sizeof(T));
    uint64_t value = 0;
    for (size_t i = bytes.size(); i-- > 0;) value = value << 8 | uint8_t(bytes[i]);
    return T(value);
  }
  std::string_view text() { return take(number<uint32_t>()); }
  std::string_view take(size_t count) {
    if (count > left_.size()) {
      ended = true;
      left_ = {};
      return {};
    }
    const std::string_view taken = left_.substr(0, count);
    left_.remove_prefix(count);
    return taken;
  }
  size_t left() const { return left_.size(); }
  std::string_view rest() const { return left_; }

  bool ended = false;

 private:
  std::string_view left_;
};

// Reads several numbers; false if there are not enough bytes.
template <class T>
bool take_numbers(ByteReader& bytes, size_t count, std::vector<T>& numbers) {
  if (count == 0) return true;
  const std::string_view text = bytes.text();
  std::string planes;
  if (text.size() != count * sizeof(T)) {
    planes.resize(count * sizeof(T));
    auto size = uLongf(planes.size());
    const int done = uncompress(reinterpret_cast<Bytef*>(planes.data()), &size,
                                reinterpret_cast<const Bytef*>(text.data()), uLong(text.size()));
    if (done != Z_OK || size != planes.size()) return false;
  }
  numbers = from_planes<T>(planes.empty() ? text : planes);
  return true;
}

// Reads a tile's samples; returns the error, or nothing.
std::string take_samples(ByteReader& bytes, SampleSpan within, SampleSet& samples) {
  const auto count = bytes.number<uint32_t>();
  uint32_t end = 0;  // of the previous span
  for (uint32_t i = 0; i < count; ++i) {
    const auto first = bytes.number<uint32_t>();
    const SampleSpan span{first, bytes.number<uint32_t>()};
    if (bytes.ended) return "its samples end early";
    if (span.empty() || span.first < within.first || span.end > within.end ||
        (i > 0 && span.first <= end))
      return fmt::format("samples {}:{}, after {} and of {}:{}", span.first, span.end, end,
                         within.first, within.end);
    end = span.end;
    samples.append(span);
  }
  return {};
}

bool are_sound(const RayCounts& rays, uint64_t eye, size_t tiles) {
  // The film's sum must not overflow.
  const uint64_t most = std::numeric_limits<uint64_t>::max() / kRayCounts.size() / tiles;
  return rays.eye == eye && rays.eye_hits <= rays.eye && rays.shadow_hits <= rays.shadow &&
         std::ranges::all_of(kRayCounts, [&](auto count) { return rays.*count <= most; });
}

bool are_sound(const CountedSamples& some, uint64_t samples, const Tile& tile) {
  if (some.count == 0) return some == CountedSamples();
  return some.count <= samples && some.x >= uint32_t(tile.x0) && some.x < uint32_t(tile.x1) &&
         some.y >= uint32_t(tile.y0) && some.y < uint32_t(tile.y1);
}

// Returns the tile's error, or nothing. `within`: samples that it may have.
std::string take_tile(ByteReader& bytes, size_t index, const PartHeader& header, SampleSpan within,
                      Film& film) {
  TileSamples tile;
  if (std::string wrong = take_samples(bytes, within, tile.samples); !wrong.empty()) return wrong;
  if (tile.samples.empty()) return {};
  if (index % header.shards != header.shard) return "not part of the shard";
  const Tile place = film.tile(index);
  const size_t pixels = size_t(place.x1 - place.x0) * size_t(place.y1 - place.y0);
  const uint64_t all = uint64_t(tile.samples.count()) * pixels;
  for (const auto count : kRayCounts) tile.rays.*count = bytes.number<uint64_t>();
  if (!are_sound(tile.rays, all, film.tiles())) return "counts of rays are out of range";
  for (CountedSamples* of : {&tile.faults.nans, &tile.faults.clamped}) {
    of->count = bytes.number<uint64_t>();
    of->x = bytes.number<uint32_t>(), of->y = bytes.number<uint32_t>();
    if (!are_sound(*of, all, place)) return "the count of NaN or clamped samples is out of range";
  }
  const FilmLayout& layout = film.layout();
  const size_t in_last_round = film.rounds().first > 0 ? 4 * pixels : 0;
  if (!take_numbers(bytes, 4 * pixels, tile.sums) ||
      !take_numbers(bytes, in_last_round, tile.last_round) ||
      !take_numbers(bytes, size_t(layout.means()) * pixels, tile.means) ||
      !take_numbers(bytes, size_t(layout.squares()) * pixels, tile.squares) ||
      !take_numbers(bytes, size_t(layout.firsts()) * pixels, tile.firsts))
    return "the number of values differs from the number of pixels";
  if (!film.can_hold(tile)) return "a sum exceeds the bound of its samples";
  film.replace(index, tile);
  return {};
}

// The bytes of the next tile, unchecked.
std::string_view skip_tile(ByteReader& bytes, const Film& film) {
  const std::string_view begin = bytes.rest();
  const auto spans = bytes.number<uint32_t>();
  bytes.take(size_t(spans) * 2 * sizeof(uint32_t));
  if (spans > 0) {
    bytes.take((kRayCounts.size() + 4) * sizeof(uint64_t));  // rays and SampleFaults
    bytes.text();
    if (film.rounds().first > 0) bytes.text();
    const FilmLayout& layout = film.layout();
    for (const int planes : {layout.means(), layout.squares(), layout.firsts()})
      if (planes > 0) bytes.text();
  }
  return begin.substr(0, begin.size() - bytes.left());
}

}  // namespace

std::string text_of(const SampleSet& samples) {
  std::string text;
  for (const SampleSpan& s : samples.spans())
    text += fmt::format("{}{}:{}", text.empty() ? "" : ",", s.first, s.end);
  return text;
}

bool is_part_path(const std::filesystem::path& path) { return path.extension() == ".raio"; }

std::string encode_part(const PartHeader& header, const Film& film) {
  std::string out(kMagic);
  put(out, kFormat);
  for (const int side : {film.width(), film.height(), film.tile_side()}) put(out, uint32_t(side));
  put(out, std::bit_cast<uint64_t>(film.bound()));
  put(out, header.shard);
  put(out, header.shards);
  put(out, header.samples.first), put(out, header.samples.end);
  put(out, uint32_t(header.settings.size()));
  for (const auto& [key, value] : header.settings) put_text(out, key), put_text(out, value);

  std::vector<std::string> tiles(film.tiles());
  parallel_for(tiles.size(), [&](size_t t) { tiles[t] = encode_tile(film.copy(t)); });
  size_t bytes = out.size() + kHashBytes;
  for (const std::string& tile : tiles) bytes += tile.size();
  out.reserve(bytes);
  for (std::string& tile : tiles) out += std::exchange(tile, {});
  put_hash(out, hash128(out));
  return out;
}

std::expected<void, Error> write_part(const std::filesystem::path& path, const PartHeader& header,
                                      const Film& film) try {
  return write_file(path, encode_part(header, film), Until::on_disk);
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(path));
}

std::expected<Part, Error> decode_part(std::string_view file) {
  const auto refused = [](std::string why) {
    return std::unexpected(Error{ErrorKind::bad_input, "", std::move(why)});
  };
  const auto broken = [&](const std::string& why) { return refused("broken part file: " + why); };
  if (!file.starts_with(kMagic)) return refused("it is not a Raio part file");
  ByteReader bytes(file);
  bytes.take(kMagic.size());
  if (const auto format = bytes.number<uint32_t>(); format != kFormat)
    return refused(
        fmt::format("the part file has format {}, which this version cannot read (it reads {}); "
                    "finish it with the version of Raio that wrote it, or render again",
                    format, kFormat));
  if (bytes.left() < kHashBytes) return broken("the file is truncated");
  std::string hash;
  put_hash(hash, hash128(file.substr(0, file.size() - kHashBytes)));
  if (!file.ends_with(hash)) return broken("its checksum is wrong");
  bytes = ByteReader(file.substr(0, file.size() - kHashBytes));
  bytes.take(kMagic.size() + sizeof kFormat);

  Part part;
  PartHeader& header = part.header;
  const auto width = bytes.number<uint32_t>(), height = bytes.number<uint32_t>();
  const auto tile_side = bytes.number<uint32_t>();
  const auto bound = std::bit_cast<double>(bytes.number<uint64_t>());
  header.shard = bytes.number<uint32_t>(), header.shards = bytes.number<uint32_t>();
  header.samples.first = bytes.number<uint32_t>();
  header.samples.end = bytes.number<uint32_t>();
  for (auto count = bytes.number<uint32_t>(); count > 0 && !bytes.ended; --count) {
    const std::string_view key = bytes.text();
    header.settings.emplace_back(key, bytes.text());
  }
  if (bytes.ended) return broken("the file is truncated");
  const auto options = options_from(header.settings, false);
  if (!options) return broken(options.error().message);
  const Crop frame = options->crop.value_or(Crop{0, 0, options->width, options->height});
  if (width != uint32_t(frame.width()) || height != uint32_t(frame.height()) || width == 0 ||
      options->width == 0)
    return broken("its size differs from its settings");
  if (tile_side == 0 || tile_side % 8 != 0 || tile_side > uint32_t(kMaxTileSide))
    return broken(fmt::format("tiles of {} pixels", tile_side));
  if (!(bound >= Film::kMinBound && bound <= Film::kMaxBound))
    return broken("invalid bound of samples");
  if (header.shard >= header.shards) return broken("invalid shard");
  SampleSpan within{0, uint32_t(options->samples_per_pixel())};
  if (header.samples != SampleSpan()) {
    if (header.samples.empty() || header.samples.end > within.end)
      return broken(
          fmt::format("samples {}:{} of {}", header.samples.first, header.samples.end, within.end));
    within = header.samples;
  }
  // Each tile takes at least four bytes, so a short file cannot request the memory of a large film.
  const uint64_t tiles = uint64_t((width - 1) / tile_side + 1) * ((height - 1) / tile_side + 1);
  if (tiles > bytes.left() / 4) return broken("the file is truncated");
  if (auto why = picture_problem(int(width), int(height), *options, header.shards))
    return std::unexpected(std::move(*why));

  part.film =
      std::make_unique<Film>(int(width), int(height), bound, int(tile_side),
                             options->film_channels(), header.shards > 1, options->rounds());
  // A part may have few of many tiles.
  std::vector<std::pair<size_t, std::string_view>> texts;
  for (size_t t = 0; t < tiles; ++t)
    if (const auto text = skip_tile(bytes, *part.film); text.size() > sizeof(uint32_t))
      texts.emplace_back(t, text);
  if (bytes.ended || bytes.left() > 0) return broken("bytes follow its last tile");
  std::vector<std::string> wrong(texts.size());
  parallel_for(texts.size(), [&](size_t i) {
    const auto [t, text] = texts[i];
    ByteReader tile(text);
    wrong[i] = take_tile(tile, t, header, within, *part.film);
    if (wrong[i].empty() && (tile.ended || tile.left() > 0)) wrong[i] = "it ends early";
  });
  for (size_t i = 0; i < texts.size(); ++i)
    if (!wrong[i].empty()) return broken(fmt::format("tile {}: {}", texts[i].first, wrong[i]));
  return part;
}

std::expected<Part, Error> read_part(const std::filesystem::path& path) try {
  const auto bytes = read_file(path, uint64_t(1) << 38);
  if (!bytes) return std::unexpected(bytes.error());
  auto part = decode_part(*bytes);
  if (!part) part.error().subject = path.string();
  return part;
} catch (const std::bad_alloc&) {
  return std::unexpected(memory_error(path));
}

}  // namespace raio::core
