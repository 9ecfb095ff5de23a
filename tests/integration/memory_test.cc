// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Peak memory of a registration: at most 12 times the bytes of the two clouds plus 64 MB. Each is measured in a child
// process of its own, the clouds included.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <malloc.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <fstream>
#include <string>

#include "core/register_scans.h"
#include "tests/testing/simulated.h"

namespace curvereg {
namespace {

using testing::ScanPairWithTruth;

constexpr double kMegabyte = 1024.0 * 1024.0;

// A line of /proc/self/status, e.g. "VmHWM", in bytes; -1 when there is none.
double StatusBytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    if (word != name + ":") continue;
    double kilobytes = -1.0;
    status >> kilobytes;
    return 1024.0 * kilobytes;
  }
  return -1.0;
}

double CloudBytes(const ScanPairWithTruth& pair) {
  return static_cast<double>(sizeof(Eigen::Vector3f) * (pair.source.points.size() + pair.target.points.size()));
}

struct Measured {
  double peak_bytes = -1.0;  // above what the process held before, clouds included
  bool answered = false;
};

// Registers in a child process. Nothing before may have started a thread: a child inherits only the one that forks.
Measured PeakOfRegistration(const ScanPairWithTruth& pair, const RegistrationOptions& options) {
  std::array<int, 2> pipe_ends = {};
  Measured measured;
  if (pipe(pipe_ends.data()) != 0) return measured;
  malloc_trim(0);  // memory that is kept but unused would hide as much of the peak
  const pid_t child = fork();
  if (child == 0) {
    const double before = StatusBytes("VmRSS");
    measured.answered = RegisterScans(pair.source, pair.target, options).ok();
    measured.peak_bytes = StatusBytes("VmHWM") - before + CloudBytes(pair);
    const ssize_t written = write(pipe_ends[1], &measured, sizeof(measured));
    _exit(written == sizeof(measured) ? 0 : 1);
  }
  close(pipe_ends[1]);
  const bool is_read = read(pipe_ends[0], &measured, sizeof(measured)) == sizeof(measured);
  close(pipe_ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(is_read && WIFEXITED(status) && WEXITSTATUS(status) == 0) << "the child ended with " << status;
  return measured;
}

void ExpectWithinLimit(const std::string& name, const ScanPairWithTruth& pair, Method method = Method::kCurvelet) {
  RegistrationOptions options;
  options.method = method;
  options.num_threads = 2;
  const Measured measured = PeakOfRegistration(pair, options);
  const double limit = 12.0 * CloudBytes(pair) + 64.0 * kMegabyte;
  std::printf("%-28s %-10s clouds %6.1f MB, peak %6.1f MB, limit %6.1f MB\n", name.c_str(),
              std::string(MethodName(method)).c_str(), CloudBytes(pair) / kMegabyte, measured.peak_bytes / kMegabyte,
              limit / kMegabyte);
  std::fflush(stdout);
  EXPECT_TRUE(measured.answered);
  EXPECT_GT(measured.peak_bytes, CloudBytes(pair));
  EXPECT_LE(measured.peak_bytes, limit) << name;
}

class MemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
#ifdef CURVEREG_SANITIZED
    GTEST_SKIP() << "sanitizers need memory of their own";
#endif
    if (StatusBytes("VmHWM") < 0.0) GTEST_SKIP() << "this system does not tell the peak memory of a process";
  }
};

TEST_F(MemoryTest, EasyPair) { ExpectWithinLimit("mars-yard-sim 1 -> 0", testing::PairOf("mars-yard-sim", 1, 0)); }

TEST_F(MemoryTest, WholeEscalation) { ExpectWithinLimit("negatives 4 -> 0", testing::PairOf("negatives", 4, 0)); }

TEST_F(MemoryTest, FewPointsManyFalseReturns) {
  ExpectWithinLimit("outliers 8 -> 4", testing::PairOf("outliers", 8, 4));
}

TEST_F(MemoryTest, OtherMethods) {
  const ScanPairWithTruth pair = testing::PairOf("mars-yard-sim", 1, 0);
  ExpectWithinLimit("mars-yard-sim 1 -> 0", pair, Method::kIcp);
  ExpectWithinLimit("mars-yard-sim 1 -> 0", pair, Method::kPaper);
}

TEST_F(MemoryTest, FiveMillionPoints) {
  const ScanPairWithTruth small = testing::PairOf("mars-yard-sim", 1, 0);
  ExpectWithinLimit("mars-yard-sim x 22",
                    {testing::Multiplied(small.source, 5'000'000), testing::Multiplied(small.target, 5'000'000), {}});
}

TEST_F(MemoryTest, FiveMillionPointsWholeEscalation) {
  const ScanPairWithTruth small = testing::PairOf("negatives", 4, 0);
  ExpectWithinLimit("negatives x 22",
                    {testing::Multiplied(small.source, 5'000'000), testing::Multiplied(small.target, 5'000'000), {}});
}

}  // namespace
}  // namespace curvereg
