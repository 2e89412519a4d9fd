#include "io/file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>
#include <vector>

#include "temporary_folder.h"

namespace raio::core {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

class FileTest : public TemporaryFolder {};

mode_t permissions(const fs::path& path) {
  struct stat status{};
  EXPECT_EQ(::stat(path.c_str(), &status), 0) << path;
  return status.st_mode & 07777;
}

/// Checks the same before and after the work.
void expect_both_fail(const fs::path& path, std::string_view why) {
  for (const auto& outcome : {check_writable(path), write_file(path, "bytes")}) {
    ASSERT_FALSE(outcome) << path;
    EXPECT_EQ(outcome.error().kind, ErrorKind::cannot_write);
    EXPECT_THAT(outcome.error().text(), HasSubstr(path.string()));
    EXPECT_THAT(outcome.error().text(), HasSubstr(std::string(why)));
    EXPECT_THAT(outcome.error().text(), Not(HasSubstr("\n")));
  }
}

/// Standard output is `replacement` (-1: closed) while `action` runs.
template <class Action>
auto with_standard_output(int replacement, Action action) {
  std::fflush(stdout);
  const int kept = ::dup(STDOUT_FILENO);
  if (replacement < 0) {
    ::close(STDOUT_FILENO);
  } else {
    ::dup2(replacement, STDOUT_FILENO);
  }
  auto result = action();
  ::dup2(kept, STDOUT_FILENO);
  ::close(kept);
  return result;
}

TEST_F(FileTest, CreatesAndReplaces) {
  const std::string bytes("a\0b\n\xff", 5);
  ASSERT_TRUE(write_file(file("f"), "a longer text that was there before"));
  ASSERT_TRUE(write_file(file("f"), bytes));
  EXPECT_EQ(get(file("f")), bytes);
  ASSERT_TRUE(write_file(file("empty"), ""));
  EXPECT_EQ(fs::file_size(file("empty")), 0u);
  EXPECT_EQ(entries(), 2);
}

TEST_F(FileTest, WritesByNameAloneIntoTheCurrentFolder) {
  const fs::path before = fs::current_path();
  fs::current_path(folder());
  const auto checked = check_writable("plain");
  const auto written = write_file("plain", "text");
  fs::current_path(before);
  EXPECT_TRUE(checked);
  EXPECT_TRUE(written);
  EXPECT_EQ(get(file("plain")), "text");
}

TEST_F(FileTest, NewFilesFollowTheUmaskOldOnesKeepTheirPermissions) {
  const mode_t before = ::umask(0027);
  ASSERT_TRUE(write_file(file("new"), "x"));
  put(file("old"), "x");
  fs::permissions(file("old"), fs::perms(0764));
  ASSERT_TRUE(write_file(file("old"), "y"));
  ::umask(before);
  EXPECT_EQ(permissions(file("new")), 0640u);
  EXPECT_EQ(permissions(file("old")), 0764u);
}

TEST_F(FileTest, LinksStayLinks) {
  fs::create_directory(file("there"));
  put(file("there/real"), "old");
  fs::create_symlink("there/real", file("first"));
  fs::create_symlink(file("first"), file("second"));
  ASSERT_TRUE(check_writable(file("second")));
  ASSERT_TRUE(write_file(file("second"), "new"));
  EXPECT_TRUE(fs::is_symlink(file("second")));
  EXPECT_TRUE(fs::is_symlink(file("first")));
  EXPECT_EQ(get(file("there/real")), "new");

  fs::create_symlink("there/not yet", file("dangling"));
  ASSERT_TRUE(check_writable(file("dangling")));
  EXPECT_FALSE(fs::exists(file("there/not yet")));
  ASSERT_TRUE(write_file(file("dangling"), "made"));
  EXPECT_TRUE(fs::is_symlink(file("dangling")));
  EXPECT_EQ(get(file("there/not yet")), "made");

  fs::create_symlink("loop", file("loop"));
  expect_both_fail(file("loop"), "symbolic links");
  fs::create_symlink("no folder/f", file("lost"));
  expect_both_fail(file("lost"), "no folder");
}

TEST_F(FileTest, ImpossibleTargetsAreErrorsInOneLine) {
  put(file("plain"), "kept");
  expect_both_fail(folder(), "Is a directory");
  expect_both_fail(folder() / "", "Is a directory");
  expect_both_fail(file("missing/f"), "does not exist");
  expect_both_fail(file("missing/"), "does not exist");
  expect_both_fail(file("plain/f"), "Not a directory");
  expect_both_fail(file(std::string(300, 'n')), "name too long");
  expect_both_fail("", "No such file");
  expect_both_fail("/proc/raio-test", "in the folder /proc");
  EXPECT_EQ(get(file("plain")), "kept");
  EXPECT_EQ(entries(), 1);

  const auto broken = write_file(file("two\nlines/f"), "x");
  ASSERT_FALSE(broken);
  EXPECT_THAT(broken.error().text(), HasSubstr("two lines/f"));
}

TEST_F(FileTest, LongNamesAreFine) {
  const fs::path longest = file(std::string(255, 'n'));
  ASSERT_TRUE(write_file(longest, "x"));
  EXPECT_EQ(get(longest), "x");
}

TEST_F(FileTest, RefusedPermissions) {
  put(file("read only"), "kept");
  fs::permissions(file("read only"), fs::perms(0444));
  fs::create_directory(file("closed"));
  fs::permissions(file("closed"), fs::perms(0555));
  fs::permissions(folder(), fs::perms(0777));
  // Root is never refused, so the test continues as nobody.
  const bool root = ::geteuid() == 0;
  if (root && ::seteuid(65534) != 0) GTEST_SKIP() << "root here cannot become another user";
  expect_both_fail(file("read only"), "Permission denied");
  expect_both_fail(file("closed/f"), "Permission denied");
  ASSERT_EQ(root ? ::seteuid(0) : 0, 0);
  EXPECT_EQ(get(file("read only")), "kept");
}

TEST_F(FileTest, CheckingLeavesNothingAndTouchesNothing) {
  ASSERT_TRUE(check_writable(file("new")));
  EXPECT_EQ(entries(), 0);
  put(file("old"), "kept");
  ASSERT_TRUE(check_writable(file("old")));
  EXPECT_EQ(get(file("old")), "kept");
  EXPECT_EQ(entries(), 1);
  EXPECT_TRUE(check_writable("/dev/null"));
  EXPECT_TRUE(check_writable("/dev/full"));
}

TEST_F(FileTest, DevicesAreWrittenDirectly) {
  ASSERT_TRUE(write_file("/dev/null", "text"));
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  const auto full = write_file("/dev/full", "text");
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().kind, ErrorKind::cannot_write);
  EXPECT_EQ(full.error().text(), "cannot write /dev/full: No space left on device");
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

TEST_F(FileTest, FilesWithoutANameAreWrittenDirectly) {
  const int id = ::memfd_create("raio-test", 0);
  ASSERT_GE(id, 0);
  ASSERT_EQ(::write(id, "longer than before", 18), 18);
  const fs::path path = "/proc/self/fd/" + std::to_string(id);
  EXPECT_TRUE(check_writable(path));
  EXPECT_TRUE(write_file(path, "text"));
  EXPECT_EQ(get(path), "text");
  ::close(id);
}

TEST_F(FileTest, PipesAreWrittenDirectly) {
  ASSERT_EQ(::mkfifo(file("pipe").c_str(), 0600), 0);
  EXPECT_TRUE(check_writable(file("pipe")));  // and does not wait for a reader
  const std::string bytes(200'000, 'p');
  std::expected<std::string, Error> got;
  std::thread reader([&] { got = read_file(file("pipe"), bytes.size()); });
  EXPECT_TRUE(write_file(file("pipe"), bytes));
  reader.join();
  ASSERT_TRUE(got);
  EXPECT_EQ(*got, bytes);
  EXPECT_TRUE(fs::is_fifo(file("pipe")));
}

TEST_F(FileTest, StandardOutput) {
  const int id = ::open(file("out").c_str(), O_RDWR | O_CREAT | O_APPEND, 0600);
  ASSERT_GE(id, 0);
  const bool done = with_standard_output(id, [] {
    return check_writable("-") && write_file("-", "one ") && write_file("/dev/stdout", "two");
  });
  ::close(id);
  EXPECT_TRUE(done);
  EXPECT_EQ(get(file("out")), "one two");
}

TEST_F(FileTest, AFullClosedOrUnreadStandardOutputIsAnError) {
  const auto write = [] { return write_file("-", std::string(1'000'000, 'x')); };
  const auto check = [] { return check_writable("-"); };

  const auto closed = with_standard_output(-1, write);
  ASSERT_FALSE(closed);
  EXPECT_EQ(closed.error().text(), "cannot write standard output: Bad file descriptor");
  EXPECT_FALSE(with_standard_output(-1, check));

  const int full = ::open("/dev/full", O_WRONLY), input = ::open("/dev/null", O_RDONLY);
  const auto no_space = with_standard_output(full, write);
  ASSERT_FALSE(no_space);
  EXPECT_THAT(no_space.error().text(), HasSubstr("No space left"));
  EXPECT_FALSE(with_standard_output(input, check));
  ::close(full);
  ::close(input);

  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  ::close(ends[0]);
  const auto unread = with_standard_output(ends[1], write);
  ::close(ends[1]);
  ASSERT_FALSE(unread);
  EXPECT_THAT(unread.error().text(), HasSubstr("Broken pipe"));
  sigset_t pending;
  sigpending(&pending);
  EXPECT_FALSE(sigismember(&pending, SIGPIPE));
}

TEST_F(FileTest, APipeThatDoesNotBlockIsWaitedFor) {
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_NONBLOCK), 0);
  std::string got;
  std::thread reader([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    char part[4096];
    for (ssize_t n = 0; got.size() < 300'000;)
      if ((n = ::read(ends[0], part, sizeof part)) > 0) got.append(part, size_t(n));
  });
  const std::string bytes(300'000, 'x');
  const auto written = with_standard_output(ends[1], [&] { return write_file("-", bytes); });
  if (!written) ::close(ends[1]);
  reader.join();
  EXPECT_TRUE(written);
  EXPECT_EQ(got, bytes);
  ::close(ends[0]);
  ::close(ends[1]);
}

TEST_F(FileTest, AFailureHalfwayKeepsTheOldFile) {
  put(file("f"), "old");
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{100'000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  const auto old = write_file(file("f"), std::string(200'000, 'x'));
  const auto fresh = write_file(file("g"), std::string(200'000, 'x'));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ASSERT_FALSE(old);
  EXPECT_THAT(old.error().text(), HasSubstr("File too large"));
  EXPECT_FALSE(fresh);
  EXPECT_EQ(get(file("f")), "old");
  EXPECT_EQ(entries(), 1);
}

TEST_F(FileTest, TheTargetIsWholeWheneverKilled) {
  const std::string first(3'000'000, 'a'), second(2'000'000, 'b');
  ASSERT_TRUE(write_file(file("f"), first));
  for (int round = 0; round < 10; ++round) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0)
      for (;;) {
        if (!write_file(file("f"), second) || !write_file(file("f"), first)) ::_exit(1);
      }
    std::this_thread::sleep_for(std::chrono::microseconds(5000 + 1700 * round));
    ASSERT_EQ(::kill(child, SIGKILL), 0);
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    ASSERT_TRUE(WIFSIGNALED(status));
    const std::string found = get(file("f"));
    EXPECT_TRUE(found == first || found == second) << found.size() << " bytes";
  }
  EXPECT_LE(entries(), 1 + 10);
}

TEST_F(FileTest, WritersAtTheSameTimeDoNotMix) {
  std::vector<std::thread> writers;
  for (int i = 0; i < 4; ++i)
    writers.emplace_back([&, i] {
      for (int n = 0; n < 50; ++n)
        if (!write_file(file("f"), std::string(50'000, char('a' + i)))) ADD_FAILURE();
    });
  for (std::thread& writer : writers) writer.join();
  const std::string found = get(file("f"));
  EXPECT_EQ(found, std::string(50'000, found[0]));
  EXPECT_EQ(entries(), 1);
}

TEST_F(FileTest, ReadsWholeFilesUpToALimit) {
  put(file("f"), std::string(100, 'x'));
  EXPECT_EQ(read_file(file("f"), 100), std::string(100, 'x'));
  EXPECT_THAT(read_file(file("f"), 99).error().text(), HasSubstr("larger than 99 bytes"));
  EXPECT_FALSE(read_file("/proc/self/status", 1'000'000)->empty());
  for (const fs::path& path : {file("missing"), folder(), fs::path("/dev/zero")}) {
    const auto bytes = read_file(path, 100);
    ASSERT_FALSE(bytes) << path;
    EXPECT_EQ(bytes.error().kind, ErrorKind::cannot_read);
    EXPECT_THAT(bytes.error().text(), HasSubstr(path.string()));
  }
}

}  // namespace
}  // namespace raio::core
