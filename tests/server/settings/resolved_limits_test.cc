// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/settings/resolved_limits.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/testing/test_data.h"

namespace curvereg::server {
namespace {

// A root folder with the files of a machine of 8 GiB.
class ResolvedLimitsTest : public ::testing::Test {
 protected:
  ResolvedLimitsTest() { Write("/proc/meminfo", "MemFree: 12 kB\nMemTotal:       8388608 kB\nSwapTotal: 1 kB\n"); }
  void Write(const std::string& path, const std::string& text) {
    const std::filesystem::path file = folder_.path() + path;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file) << text;
  }
  MachineResources Read() const { return ReadMachineResources(folder_.path()); }

  testing::TemporaryFolder folder_;
};

TEST_F(ResolvedLimitsTest, WithoutGroupsTheMachineCounts) {
  EXPECT_EQ(Read().memory_bytes, uint64_t{8} << 30);
  EXPECT_EQ(ReadMachineResources(folder_.File("empty")).memory_bytes, 0u);
}

TEST_F(ResolvedLimitsTest, Version2TakesTheLeastOfAllGroupsAbove) {
  Write("/proc/self/cgroup", "0::/pod/container\n");
  Write("/sys/fs/cgroup/pod/memory.max", "2147483648\n");
  Write("/sys/fs/cgroup/pod/container/memory.max", "max\n");
  Write("/sys/fs/cgroup/pod/container/cpu.max", "50000 100000\n");
  EXPECT_EQ(Read().memory_bytes, uint64_t{2} << 30);
  EXPECT_EQ(Read().num_processors, 1);
  Write("/sys/fs/cgroup/memory.max", "1073741824\n");
  EXPECT_EQ(Read().memory_bytes, uint64_t{1} << 30);
}

TEST_F(ResolvedLimitsTest, Version2InsideAContainerLooksAtItsRoot) {
  Write("/proc/self/cgroup", "0::/\n");
  Write("/sys/fs/cgroup/memory.max", "536870912\n");
  Write("/sys/fs/cgroup/cpu.max", "max 100000\n");
  EXPECT_EQ(Read().memory_bytes, uint64_t{512} << 20);
  EXPECT_EQ(Read().num_processors, ReadMachineResources().num_processors);
}

TEST_F(ResolvedLimitsTest, Version1HasItsOwnFiles) {
  Write("/proc/self/cgroup", "5:memory:/docker/x\n3:cpu,cpuacct:/docker/x\n1:name=systemd:/\n");
  Write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "1073741824\n");  // a container sees its own group as the root
  Write("/sys/fs/cgroup/cpu,cpuacct/docker/x/cpu.cfs_quota_us", "-1\n");
  Write("/sys/fs/cgroup/cpu,cpuacct/docker/x/cpu.cfs_period_us", "100000\n");
  EXPECT_EQ(Read().memory_bytes, uint64_t{1} << 30);
  Write("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712\n");  // none
  EXPECT_EQ(Read().memory_bytes, uint64_t{8} << 30);
}

TEST_F(ResolvedLimitsTest, GarbageIsNoLimit) {
  Write("/proc/self/cgroup", "nonsense\n::\n0::\n");
  Write("/sys/fs/cgroup/memory.max", "much\n");
  Write("/sys/fs/cgroup/cpu.max", "100000 0\n");
  EXPECT_EQ(Read().memory_bytes, uint64_t{8} << 30);
  EXPECT_GE(Read().num_processors, 1);
}

TEST_F(ResolvedLimitsTest, FillsOnlyTheZeros) {
  const LimitsConfig resolved = ResolveLimits({}, {.num_processors = 6, .memory_bytes = uint64_t{8} << 30});
  EXPECT_EQ(resolved.max_concurrent_registrations, 6);
  EXPECT_EQ(resolved.max_threads_per_registration, 6);
  EXPECT_EQ(resolved.memory_bytes, uint64_t{4} << 30);
  EXPECT_EQ(resolved.cache_bytes, uint64_t{1} << 30);
  LimitsConfig given;
  given.max_concurrent_registrations = 1;
  given.max_threads_per_registration = 2;
  given.memory_bytes = 4000;
  const LimitsConfig kept = ResolveLimits(given, {.num_processors = 6, .memory_bytes = uint64_t{8} << 30});
  EXPECT_EQ(kept.max_concurrent_registrations, 1);
  EXPECT_EQ(kept.max_threads_per_registration, 2);
  EXPECT_EQ(kept.memory_bytes, 4000u);
  EXPECT_EQ(kept.cache_bytes, 1000u);
}

TEST_F(ResolvedLimitsTest, ThisMachineHasSomething) {
  const LimitsConfig resolved = ResolveLimits(LimitsConfig());
  EXPECT_GE(resolved.max_concurrent_registrations, 1);
  EXPECT_GE(resolved.memory_bytes, uint64_t{16} << 20);
}

}  // namespace
}  // namespace curvereg::server
