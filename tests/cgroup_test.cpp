// Limits of containers, read from trees of files as Linux has them.
#include "base/platform/cgroup.h"

#include <gtest/gtest.h>

#include "temporary_folder.h"

namespace raio::core {
namespace {

class ControlGroupsTest : public TemporaryFolder {
 protected:
  void write(const std::string& path, std::string_view text) {
    std::filesystem::create_directories(file(path).parent_path());
    put(file(path), text);
  }
  void write_v2(std::string_view group, std::string_view root = "/") {
    write("proc/self/cgroup", "0::" + std::string(group) + "\n");
    write("proc/self/mountinfo",
          "22 1 8:1 / / rw,relatime shared:1 - ext4 /dev/sda1 rw\n"
          "30 22 0:26 " +
              std::string(root) +
              " /sys/fs/cgroup rw,nosuid shared:4 master:1 - cgroup2 cgroup2 rw,nsdelegate\n");
  }
  ControlGroups groups() const { return ControlGroups(folder().string()); }
  std::string group_file(const std::string& path) const { return folder().string() + path; }
};

TEST_F(ControlGroupsTest, NoneLimitNothing) {
  EXPECT_FALSE(groups().cores());
  EXPECT_FALSE(groups().memory());
  write_v2("/");
  EXPECT_FALSE(groups().cores());
  EXPECT_FALSE(groups().memory());
  write_v2("/user.slice");
  write("sys/fs/cgroup/user.slice/cpu.max", "max 100000\n");
  write("sys/fs/cgroup/user.slice/memory.max", "max\n");
  EXPECT_FALSE(groups().cores());
  EXPECT_FALSE(groups().memory());
}

TEST_F(ControlGroupsTest, OfVersion2TheTightestOnTheWayCounts) {
  write_v2("/a.slice/b c.scope");
  const std::string top = "sys/fs/cgroup/";
  write(top + "a.slice/cpu.max", "150000 100000\n");
  write(top + "a.slice/b c.scope/cpu.max", "300000 100000\n");
  EXPECT_EQ(groups().cores(), 1.5);
  write(top + "a.slice/b c.scope/cpu.max", "25000 50000\n");
  EXPECT_EQ(groups().cores(), 0.5);

  write(top + "a.slice/memory.max", "4000000000\n");
  write(top + "a.slice/memory.current", "3000000000\n");
  write(top + "a.slice/memory.stat", "anon 5\nfile 900000000\ninactive_file 500000000\n");
  write(top + "a.slice/b c.scope/memory.max", "2000000000\n");
  write(top + "a.slice/b c.scope/memory.current", "100000000\n");
  const auto memory = groups().memory();
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->available, 1'500'000'000u);
  EXPECT_EQ(memory->file, group_file("/sys/fs/cgroup/a.slice/memory.max"));
  // More than allowed is used up, no more.
  write(top + "a.slice/memory.current", "9000000000\n");
  EXPECT_EQ(groups().memory()->available, 0u);
}

TEST_F(ControlGroupsTest, AContainerSeesItsGroupAsTheRoot) {
  write_v2("/");
  write("sys/fs/cgroup/cpu.max", "200000 100000\n");
  write("sys/fs/cgroup/memory.max", "1000\n");
  write("sys/fs/cgroup/memory.current", "400\n");
  EXPECT_EQ(groups().cores(), 2);
  EXPECT_EQ(groups().memory()->available, 600u);
  // The same with the names of the machine outside, and with a group beyond the root.
  write_v2("/docker/0a1b", "/docker/0a1b");
  EXPECT_EQ(groups().cores(), 2);
  write_v2("/../other");
  EXPECT_EQ(groups().cores(), 2);
  // Below the mounted group.
  write_v2("/docker/0a1b/init", "/docker/0a1b");
  write("sys/fs/cgroup/init/cpu.max", "100000 100000\n");
  EXPECT_EQ(groups().cores(), 1);
  // A name that only begins alike is another group.
  write_v2("/docker/0a1bc", "/docker/0a1b");
  EXPECT_EQ(groups().cores(), 2);
}

TEST_F(ControlGroupsTest, Version1HasAHierarchyForEachController) {
  write("proc/self/cgroup",
        "12:pids:/x\n5:cpu,cpuacct:/docker/7\n4:memory:/docker/7/job\n1:name=systemd:/x\n0::/y\n");
  write("proc/self/mountinfo",
        "31 30 0:27 / /sys/fs/cgroup/unified rw - cgroup2 cgroup2 rw\n"
        "32 30 0:28 / /sys/fs/cgroup/cpuset rw shared:9 - cgroup cgroup rw,cpuset\n"
        "33 30 0:29 / /sys/fs/cgroup/cpu,cpuacct rw shared:10 - cgroup cgroup rw,cpu,cpuacct\n"
        "34 30 0:30 /docker/7 /sys/fs/cgroup/the\\040memory rw - cgroup cgroup rw,memory\n");
  write("sys/fs/cgroup/unified/y/cpu.max", "100000 100000\n");  // has no controllers
  const std::string cpu = "sys/fs/cgroup/cpu,cpuacct/docker/7/";
  write(cpu + "cpu.cfs_quota_us", "-1\n");
  write(cpu + "cpu.cfs_period_us", "100000\n");
  EXPECT_FALSE(groups().cores());
  write(cpu + "cpu.cfs_quota_us", "250000\n");
  EXPECT_EQ(groups().cores(), 2.5);

  const std::string memory = "sys/fs/cgroup/the memory/";
  write(memory + "job/memory.limit_in_bytes", "9223372036854771712\n");  // none
  write(memory + "memory.limit_in_bytes", "1000000\n");
  write(memory + "memory.usage_in_bytes", "900000\n");
  write(memory + "memory.stat", "inactive_file 1\ntotal_inactive_file 300000\n");
  const auto found = groups().memory();
  ASSERT_TRUE(found);
  EXPECT_EQ(found->available, 400000u);
  EXPECT_EQ(found->file, group_file("/sys/fs/cgroup/the memory/memory.limit_in_bytes"));
}

TEST_F(ControlGroupsTest, DamagedFilesLimitNothing) {
  for (const char* text : {"", "\n", "x", "1", "1 x", "-1 100000", "0 0", "100000 0", "1e5 1e5"}) {
    write_v2("/");
    write("sys/fs/cgroup/cpu.max", text);
    EXPECT_FALSE(groups().cores()) << text;
    write("sys/fs/cgroup/memory.max", text[0] == '1' ? "12 34" : text);
    EXPECT_FALSE(groups().memory()) << text;
  }
  for (const char* text : {"", "0:", "0::", "x", "0::/\n0", ":::"}) {
    write("proc/self/cgroup", text);
    EXPECT_FALSE(groups().cores()) << text;
  }
  write_v2("/");
  for (const char* text : {"", "1 2 3", "1 2 3 / / - ", "1 2 3 \\1 \\ x - cgroup2", "- - - - -"}) {
    write("proc/self/mountinfo", text);
    (void)groups().memory();
    EXPECT_FALSE(groups().cores()) << text;
  }
}

}  // namespace
}  // namespace raio::core
