// Buffers of a glTF file, and the numbers in them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/memory.h"
#include "io/mesh/builder.h"
#include "io/mesh/gltf.h"

namespace raio::core::gltf {
namespace {

// Maximum count of a sparse accessor that has no bufferView.
constexpr size_t kFewZeros = 1'000'000;

[[noreturn]] void fail(std::string message) { throw ReadFailure{std::move(message)}; }

int digit_of_base64(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;  // URL-safe variant
  return c == '/' || c == '_' ? 63 : -1;
}

std::string decode_base64(std::string_view text, const std::string& what) {
  while (text.ends_with('=')) text.remove_suffix(1);
  std::string out;
  out.reserve(text.size() / 4 * 3 + 3);
  uint32_t bits = 0;
  int count = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const int digit = digit_of_base64(text[i]);
    if (digit < 0)
      fail(fmt::format("{}: expected a digit of base64, found {} as character {} of them", what,
                       core::quoted(text.substr(i, 1)), i + 1));
    bits = bits << 6 | uint32_t(digit);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    out += char(bits >> count & 255);
  }
  return out;
}

std::string decode_percent(std::string_view text) {
  const auto digit = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%' && i + 2 < text.size() && digit(text[i + 1]) >= 0 &&
        digit(text[i + 2]) >= 0) {
      out += char(digit(text[i + 1]) * 16 + digit(text[i + 2]));
      i += 2;
    } else {
      out += text[i];
    }
  }
  return out;
}

template <class T>
T load(const char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

double number_at(const char* from, Component component, bool normalized) {
  const auto signed_part = [&](double value, double most) {
    return normalized ? std::max(value / most, -1.0) : value;
  };
  switch (component) {
    case Component::i8:
      return signed_part(load<int8_t>(from), 127);
    case Component::u8:
      return signed_part(load<uint8_t>(from), 255);
    case Component::i16:
      return signed_part(load<int16_t>(from), 32767);
    case Component::u16:
      return signed_part(load<uint16_t>(from), 65535);
    case Component::u32:
      return load<uint32_t>(from);
    case Component::f32:
      return double(load<float>(from));
  }
  return 0;
}

uint32_t whole_at(const char* from, Component component) {
  switch (component) {
    case Component::u8:
      return load<uint8_t>(from);
    case Component::u16:
      return load<uint16_t>(from);
    default:
      return load<uint32_t>(from);
  }
}

/// Extracts `count` elements of `size` bytes at intervals of `stride`.
std::string_view elements(std::string_view bytes, size_t offset, size_t count, size_t stride,
                          size_t size, const std::string& what) {
  const bool fits = offset <= bytes.size() && size <= bytes.size() - offset &&
                    count - 1 <= (bytes.size() - offset - size) / stride;
  if (!fits)
    fail(
        fmt::format("{}: {} elements of {} bytes from byte {} do not fit in its bufferView "
                    "of {} bytes",
                    what, count, size, offset, bytes.size()));
  return bytes.substr(offset);
}

}  // namespace

size_t bytes_of(Component component) {
  switch (component) {
    case Component::i8:
    case Component::u8:
      return 1;
    case Component::i16:
    case Component::u16:
      return 2;
    case Component::u32:
    case Component::f32:
      return 4;
  }
  return 4;
}

// A header of 12 bytes, then chunks, each with length, type and data.
Chunks chunks_of(std::string_view file) {
  constexpr uint32_t kJson = 0x4e4f534a, kBinary = 0x004e4942;
  const auto fail = [](const std::string& message) {
    throw ReadFailure{"broken .glb: " + message};
  };
  if (file.size() < 12) fail("it ends within its header");
  if (const uint32_t version = load<uint32_t>(file.data() + 4); version != 2)
    throw ReadFailure{fmt::format("a binary scene in glTF {}; Raio reads glTF 2.0{}", version,
                                  version == 1 ? "; convert it with gltf-pipeline" : "")};
  const size_t size = load<uint32_t>(file.data() + 8);
  if (size > file.size())
    fail(fmt::format("it has {} bytes, expected {}; it is truncated", file.size(), size));
  file = file.substr(0, size);
  Chunks out;
  for (size_t at = 12, number = 0; at < file.size(); ++number) {
    if (file.size() - at < 8) fail(fmt::format("it ends within the chunk at byte {}", at));
    const size_t length = load<uint32_t>(file.data() + at);
    const uint32_t type = load<uint32_t>(file.data() + at + 4);
    if (length > file.size() - at - 8)
      fail(fmt::format("the chunk at byte {} has {} bytes, but only {} remain", at, length,
                       file.size() - at - 8));
    const std::string_view bytes = file.substr(at + 8, length);
    if (number == 0 && type != kJson) fail("its first chunk, at byte 12, is not JSON");
    if (number == 0) out.json = bytes;
    if (number == 1 && type == kBinary) out.binary = bytes;
    at += 8 + length;
  }
  if (out.json.empty()) fail("it has no JSON");
  return out;
}

std::string decode_data_uri(std::string_view uri, const std::string& what) {
  const size_t comma = uri.find(',');
  if (comma == std::string_view::npos) fail(fmt::format("{}: its data: URI has no comma", what));
  const std::string_view head = uri.substr(0, comma), data = uri.substr(comma + 1);
  return head.ends_with(";base64") ? decode_base64(data, what) : decode_percent(data);
}

std::string file_of_uri(std::string_view uri, const std::string& what) {
  if (uri.find("://") < 10)  // after a scheme
    fail(fmt::format("{}: {} is not a local file; download it and change the uri", what,
                     core::quoted(uri)));
  return decode_percent(uri);
}

Buffers::Buffers(const Document& document, std::optional<std::string_view> chunk,
                 const ReadOptions& options)
    : document_(document) {
  own_.resize(document.buffers.size()), bytes_.resize(document.buffers.size());
  for (size_t i = 0; i < own_.size(); ++i) {
    const Buffer& buffer = document.buffers[i];
    const std::string what = fmt::format("/buffers/{}", i);
    if (!buffer.uri) {
      // A buffer without data, meant for an extension, is an error only if it is used.
      if (i == 0 && chunk) bytes_[0] = *chunk;
    } else if (buffer.uri->starts_with("data:")) {
      bytes_[i] = own_[i] = decode_data_uri(*buffer.uri, what + "/uri");
    } else {
      const std::string name = file_of_uri(*buffer.uri, what + "/uri");
      auto bytes = options.folder ? read_beside(*options.folder, name)
                                  : std::unexpected("the scene has no folder to search");
      if (!bytes) fail(fmt::format("{}/uri: {}: {}", what, core::quoted(name), bytes.error()));
      bytes_[i] = own_[i] = std::move(*bytes);
    }
    const bool empty = !buffer.uri && bytes_[i].data() == nullptr;
    if (!empty && bytes_[i].size() < buffer.length)
      fail(fmt::format("{}: it has {} bytes, expected {}", what, bytes_[i].size(), buffer.length));
    bytes_[i] = bytes_[i].substr(0, buffer.length);
    total_ += bytes_[i].size();
  }
}

std::string_view Buffers::view(uint32_t number, const std::string& user) const {
  const View& view = document_.views[number];
  const std::string_view bytes = bytes_[view.buffer];
  if (bytes.empty())
    fail(fmt::format(
        "{}: {}", user,
        view.compressed
            ? "it uses EXT_meshopt_compression, which is not supported; "
              "export without compression"
            : fmt::format("/buffers/{} has neither a uri nor bytes in the file", view.buffer)));
  return bytes.substr(view.offset, view.length);
}

Elements::Elements(const Document& document, const Buffers& buffers, uint32_t accessor,
                   uint32_t least, uint32_t most)
    : accessor_(document.accessors[accessor]), number_(accessor) {
  const std::string what = fmt::format("/accessors/{}", accessor);
  if (accessor_.components < least || accessor_.components > most)
    fail(fmt::format("{}/type: expected {}, found {}", what,
                     least == 1      ? "SCALAR"
                     : least == 16   ? "MAT4"
                     : least == most ? fmt::format("VEC{}", least)
                                     : fmt::format("VEC{} or VEC{}", least, most),
                     accessor_.components == 0   ? "a small matrix"
                     : accessor_.components > 4  ? "MAT4"
                     : accessor_.components == 1 ? "SCALAR"
                                                 : fmt::format("VEC{}", accessor_.components)));
  size_ = bytes_of(accessor_.component) * accessor_.components;
  if (accessor_.view) {
    const size_t stride = document.views[*accessor_.view].stride;
    stride_ = stride > 0 ? stride : size_;
    if (stride_ < size_)
      fail(fmt::format("/bufferViews/{}/byteStride: it is smaller than an element of {}, {} bytes",
                       *accessor_.view, what, size_));
    bytes_ = elements(buffers.view(*accessor_.view, what), accessor_.offset, accessor_.count,
                      stride_, size_, what);
  } else if (accessor_.count > std::max(buffers.total_bytes(), accessor_.sparse ? kFewZeros : 0)) {
    fail(fmt::format("{}/count: {} elements without a bufferView exceed the size of all buffers",
                     what, accessor_.count));
  }
  if (accessor_.sparse) take_sparse(buffers);
}

void Elements::take_sparse(const Buffers& buffers) {
  const Sparse& sparse = *accessor_.sparse;
  const std::string what = fmt::format("/accessors/{}/sparse", number_);
  const size_t step = bytes_of(sparse.indices);
  const std::string_view indices =
      elements(buffers.view(sparse.indices_view, what), sparse.indices_offset, sparse.count, step,
               step, what + "/indices");
  replacements_ = elements(buffers.view(sparse.values_view, what), sparse.values_offset,
                           sparse.count, size_, size_, what + "/values");
  replaced_.resize(sparse.count);
  for (size_t i = 0; i < sparse.count; ++i) {
    replaced_[i] = whole_at(indices.data() + i * step, sparse.indices);
    if (replaced_[i] >= accessor_.count || (i > 0 && replaced_[i] <= replaced_[i - 1]))
      fail(fmt::format("{}/indices: number {} is {}; expected ascending numbers below {}", what, i,
                       replaced_[i], accessor_.count));
  }
}

const char* Elements::element(size_t i) const {
  if (!replaced_.empty()) {
    const auto at = std::ranges::lower_bound(replaced_, uint32_t(i));
    if (at != replaced_.end() && *at == i)
      return replacements_.data() + size_t(at - replaced_.begin()) * size_;
  }
  static constexpr char kZeros[64] = {};
  return bytes_.empty() ? kZeros : bytes_.data() + i * stride_;
}

std::array<double, 4> Elements::numbers(size_t i) const {
  std::array<double, 4> out{};
  const char* const from = element(i);
  const size_t step = bytes_of(accessor_.component);
  for (size_t k = 0; k < std::min<size_t>(accessor_.components, 4); ++k)
    out[k] = number_at(from + k * step, accessor_.component, accessor_.normalized);
  return out;
}

std::array<double, 12> Elements::matrix(size_t i) const {
  std::array<double, 12> out{};
  const char* const from = element(i);
  const size_t step = bytes_of(accessor_.component);
  for (size_t row = 0; row < 3; ++row)
    for (size_t column = 0; column < 4; ++column)
      out[4 * row + column] =
          number_at(from + (4 * column + row) * step, accessor_.component, accessor_.normalized);
  return out;
}

uint32_t Elements::whole(size_t i) const {
  if (accessor_.component != Component::u8 && accessor_.component != Component::u16 &&
      accessor_.component != Component::u32)
    fail(
        fmt::format("/accessors/{}/componentType: expected 5121, 5123 or 5125 for indices, found "
                    "{}",
                    number_, uint32_t(accessor_.component)));
  return whole_at(element(i), accessor_.component);
}

std::string Elements::place(size_t i) const {
  return fmt::format("/accessors/{}, element {} (byte {})", number_, i,
                     accessor_.offset + i * stride_);
}

void MemoryCount::take(double bytes) {
  bytes_ += bytes;
  if (bytes_ > double(available_memory_bytes()) / 2) throw ReadFailure{std::string(kNoMemory)};
}

}  // namespace raio::core::gltf
