// JPEG through libjpeg. Its errors are jumps, like those of libpng: code that may fail is called
// under setjmp() and owns nothing.
#include <fmt/format.h>

#include <csetjmp>
#include <cstdio>
// It needs FILE.
#include <jerror.h>
#include <jpeglib.h>

#include "base/executor.h"
#include "io/image/codecs.h"

namespace raio::core {
namespace {

/// Malicious files repeat scans endlessly, which costs this much at most; ordinary files have a
/// dozen.
constexpr int kMaxScans = 200;

struct Failure {
  jpeg_error_mgr manager;  // first, since libjpeg knows only this part
  std::jmp_buf back;
  char text[JMSG_LENGTH_MAX] = "not enough memory";
};

[[noreturn]] void fail(j_common_ptr jpeg) {
  auto* failure = reinterpret_cast<Failure*>(jpeg->err);
  jpeg->err->format_message(jpeg, failure->text);
  std::longjmp(failure->back, 1);
}

// Messages of level -1 report damage, after which libjpeg would guess; except for some harmless
// quirks of other programs.
void take_message(j_common_ptr jpeg, int level) {
  if (level >= 0) return;
  for (const int harmless : {JWRN_EXTRANEOUS_DATA, JWRN_ADOBE_XFORM, JWRN_NOT_SEQUENTIAL})
    if (jpeg->err->msg_code == harmless) return;
  fail(jpeg);
}

void ignore_message(j_common_ptr) {}

void count_scans(j_common_ptr jpeg) {
  auto* failure = reinterpret_cast<Failure*>(jpeg->err);
  if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMaxScans) return;
  std::snprintf(failure->text, sizeof failure->text, "more than %d scans", kMaxScans);
  std::longjmp(failure->back, 1);
}

struct Decompressor {
  Failure failure;
  jpeg_progress_mgr progress{};
  jpeg_decompress_struct jpeg{};

  Decompressor() {
    jpeg.err = jpeg_std_error(&failure.manager);
    failure.manager.error_exit = fail;
    failure.manager.emit_message = take_message;
    failure.manager.output_message = ignore_message;
    progress.progress_monitor = count_scans;
  }
  Decompressor(const Decompressor&) = delete;
  Decompressor& operator=(const Decompressor&) = delete;
  ~Decompressor() { jpeg_destroy_decompress(&jpeg); }

  /// Runs `step`; false if libjpeg gave up, as described by `failure`.
  template <class Step>
  bool guarded(const Step& step) {
    if (setjmp(failure.back)) return false;
    step();
    return true;
  }
};

}  // namespace

Decoded<PixelRows> jpeg_rows(std::string_view bytes) {
  Decompressor decompressor;
  jpeg_decompress_struct& jpeg = decompressor.jpeg;
  const auto broken = [](std::string_view why) {
    return std::unexpected(fmt::format("broken JPEG: {}", why));
  };
  const bool begun = decompressor.guarded([&] {
    jpeg_create_decompress(&jpeg);
    jpeg.progress = &decompressor.progress;
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()),
                 static_cast<unsigned long>(bytes.size()));
    jpeg_read_header(&jpeg, TRUE);
    jpeg.out_color_space = JCS_RGB;
  });
  if (!begun) return broken(decompressor.failure.text);
  const size_t width = jpeg.image_width, height = jpeg.image_height;
  if (const std::string problem = size_problem(int64_t(width), int64_t(height)); !problem.empty())
    return broken(problem);
  // Huffman codes take at least a bit per block of 8 x 8.
  if (!jpeg.arith_code && width * height / 512 > bytes.size())
    return broken(fmt::format("too short for {} x {} pixels", width, height));

  PixelRows rows{int(width), int(height), 3, 8, {}};
  rows.bytes.resize(3 * width * height);
  const bool done = decompressor.guarded([&] {
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height) {
      check_stop();
      JSAMPROW row = &rows.bytes[3 * width * jpeg.output_scanline];
      jpeg_read_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_decompress(&jpeg);
  });
  if (!done) return broken(decompressor.failure.text);
  return rows;
}

}  // namespace raio::core
