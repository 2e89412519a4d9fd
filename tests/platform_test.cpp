// The interfaces of src/base/platform on every system: files, memory, libraries, the processor.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/platform/files.h"
#include "base/platform/library.h"
#include "base/platform/processor.h"
#include "io/file.h"
#include "temporary_folder.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Platform : public TemporaryFolder {
 protected:
  static std::string noise(size_t bytes) {
    std::mt19937 random(1);
    std::string out(bytes, '\0');
    std::ranges::generate(out, [&] { return char(random()); });
    return out;
  }
};

TEST_F(Platform, ReplacesWholeFilesAndKeepsLinksAndPermissions) {
  const std::string bytes = noise(100'000);
  ASSERT_TRUE(write_file(file("f"), "a text that was there before"));
  fs::permissions(file("f"), fs::perms(0640));
  fs::create_symlink("f", file("link"));
  ASSERT_TRUE(check_writable(file("link")));
  EXPECT_EQ(get(file("f")), "a text that was there before");
  ASSERT_TRUE(write_file(file("link"), bytes, Until::on_disk));
  EXPECT_EQ(get(file("f")), bytes);
  EXPECT_TRUE(fs::is_symlink(file("link")));
  EXPECT_EQ(fs::status(file("f")).permissions(), fs::perms(0640));
  ASSERT_TRUE(write_file(file("f"), ""));
  EXPECT_EQ(fs::file_size(file("f")), 0u);
  EXPECT_EQ(entries(), 2);
}

TEST_F(Platform, FailedWritesLeaveNothing) {
  for (const fs::path& path : {folder(), file("missing/f"), fs::path()}) {
    const auto checked = check_writable(path), written = write_file(path, "bytes");
    ASSERT_FALSE(checked) << path;
    ASSERT_FALSE(written) << path;
    EXPECT_EQ(checked.error(), written.error());
    EXPECT_THAT(written.error().text(), HasSubstr(path.string()));
  }
  EXPECT_THAT(write_file(file("missing/f"), "").error().message, HasSubstr("does not exist"));
  EXPECT_EQ(entries(), 0);
}

TEST_F(Platform, ReadsToTheEnd) {
  // Large enough for several threads, and not a multiple of their read size.
  const std::string bytes = noise((size_t(5) << 20) + 12345);
  put(file("f"), bytes);
  EXPECT_TRUE(read_file(file("f"), bytes.size()) == bytes);
  auto input = InputFile::open(file("f"));
  ASSERT_TRUE(input);
  EXPECT_EQ(input->kind(), InputFile::Kind::regular);
  EXPECT_EQ(input->rest(), bytes.size());
  std::string found(bytes.size() + 100, '\0');
  size_t size = 0;
  // In pieces of all sizes, some of them large.
  for (size_t piece = 1;; piece = piece * 7 % 4'999'999 + 1) {
    const auto got = input->read(found.data() + size, std::min(piece, found.size() - size));
    ASSERT_TRUE(got);
    if (*got == 0) break;
    size += *got;
  }
  EXPECT_EQ(size, bytes.size());
  EXPECT_TRUE(std::string_view(found).substr(0, size) == bytes);
}

TEST_F(Platform, AFileTruncatedDuringReadingEndsThere) {
  const std::string bytes = noise(size_t(6) << 20);
  put(file("f"), bytes);
  auto input = InputFile::open(file("f"));
  ASSERT_TRUE(input);
  const size_t left = (size_t(3) << 20) + 77;
  fs::resize_file(file("f"), left);
  std::string found(bytes.size() + 1, '\0');
  size_t size = 0;
  for (;;) {
    const auto got = input->read(found.data() + size, found.size() - size);
    ASSERT_TRUE(got);
    if (*got == 0) break;
    size += *got;
  }
  EXPECT_EQ(size, left);
  EXPECT_TRUE(std::string_view(found).substr(0, size) == std::string_view(bytes).substr(0, left));
}

TEST_F(Platform, ReadsFilesWhole) {
  for (const size_t size : {size_t(0), size_t(1), size_t(4096), (size_t(5) << 20) + 3}) {
    const std::string bytes = noise(size);
    put(file("f"), bytes);
    const auto read = read_bytes(file("f"));
    ASSERT_TRUE(read) << read.error();
    ASSERT_EQ(read->size(), size);
    EXPECT_TRUE(std::ranges::equal(*read, std::as_bytes(std::span(bytes))));
    EXPECT_EQ(reinterpret_cast<uintptr_t>(read->data()) % 64, 0u);
  }
}

TEST_F(Platform, ReadingErrorsAreOneLine) {
  const auto missing = read_bytes(file("missing")), no_file = read_bytes(folder());
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error(), "cannot open the file: No such file or directory");
  ASSERT_FALSE(no_file);
  EXPECT_EQ(no_file.error(), "found a folder, expected a file");
}

TEST(PlatformMemory, IsZeroAndAligned) {
  for (const size_t bytes : {size_t(1), size_t(100'000), size_t(5) << 20}) {
    auto* const zeroes = static_cast<unsigned char*>(map_zeroes(bytes));
    EXPECT_TRUE(std::all_of(zeroes, zeroes + bytes, [](unsigned char c) { return c == 0; }));
    EXPECT_EQ(reinterpret_cast<uintptr_t>(zeroes) % 64, 0u);
    zeroes[bytes - 1] = 1;
    unmap_zeroes(zeroes, bytes);
    void* const lines = allocate_lines(bytes);
    EXPECT_EQ(reinterpret_cast<uintptr_t>(lines) % 64, 0u);
    free_lines(lines, bytes);
  }
  EXPECT_GT(available_memory_bytes(), size_t(1) << 20);
}

TEST(PlatformProcessor, HasAName) {
  EXPECT_FALSE(processor_name().empty());
  EXPECT_EQ(processor_name().find('\n'), std::string::npos);
}

#if defined(__x86_64__) && defined(__GLIBC__)
TEST(PlatformProcessor, HasTheInstructionSetsKnownToTheCompiler) {
  const auto expect = [](int64_t target, bool has) {
    EXPECT_EQ((hwy::SupportedTargets() & target) != 0, has || HWY_STATIC_TARGET == target);
  };
  expect(HWY_SSE4, __builtin_cpu_supports("x86-64-v2"));
  expect(HWY_AVX2, __builtin_cpu_supports("x86-64-v3"));
  expect(HWY_AVX3, __builtin_cpu_supports("x86-64-v4"));
}
#endif

}  // namespace
}  // namespace raio::core
