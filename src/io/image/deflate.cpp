#include "io/image/deflate.h"

#include <new>

#include "base/parallel.h"

namespace raio::core {

namespace {

/// A raw deflate stream. Level 1 is several times faster than zlib's default on rendered pictures,
/// and the files are hardly larger.
struct Deflater {
  z_stream stream{};

  Deflater() {
    constexpr int kRaw = -MAX_WBITS, kUsualMemory = 8;
    if (deflateInit2(&stream, 1, Z_DEFLATED, kRaw, kUsualMemory, Z_DEFAULT_STRATEGY) != Z_OK)
      throw std::bad_alloc();
  }
  Deflater(const Deflater&) = delete;
  Deflater& operator=(const Deflater&) = delete;
  ~Deflater() { deflateEnd(&stream); }

  /// Compresses `bytes` independently; more can follow, unless these are the last.
  std::string compress(std::vector<uint8_t>& bytes, bool last) {
    deflateReset(&stream);
    constexpr size_t kFlushBytes = 16;
    std::string out(deflateBound(&stream, uLong(bytes.size())) + kFlushBytes, '\0');
    stream.next_in = bytes.data();
    stream.avail_in = uInt(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = uInt(out.size());
    deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
    out.resize(out.size() - stream.avail_out);
    return out;
  }
};

}  // namespace

Deflated deflate_bands(size_t bands, const CheckSum& check_sum,
                       const std::function<std::vector<uint8_t>(size_t band)>& make) {
  Deflated deflated;
  deflated.bands.resize(bands);
  std::vector<uLong> check_sums(bands);
  std::vector<size_t> sizes(bands);
  PerThread<Deflater> deflaters;  // a quarter of a megabyte each
  parallel_for(bands, [&](size_t i) {
    std::vector<uint8_t> bytes = make(i);
    sizes[i] = bytes.size();
    check_sums[i] = check_sum.of(check_sum.of(0, nullptr, 0), bytes.data(), bytes.size());
    deflated.bands[i] = deflaters.local().compress(bytes, i + 1 == bands);
  });
  uLong sum = check_sums[0];
  for (size_t i = 1; i < bands; ++i) sum = check_sum.combine(sum, check_sums[i], z_off_t(sizes[i]));
  deflated.check_sum = uint32_t(sum);
  for (const size_t size : sizes) deflated.bytes += size;
  return deflated;
}

}  // namespace raio::core
