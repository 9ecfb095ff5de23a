// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Tables of a stage's time beside plain work on the same data, measured in turn in the same run: a ratio means
// something on a noisy machine, milliseconds alone do not.
#ifndef CURVEREG_BENCH_RATIO_H_
#define CURVEREG_BENCH_RATIO_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace curvereg::bench {

struct Work {
  // `run` works under the thread limit of its caller; `run_with` sets the limit given itself.
  Work(std::string work_name, std::function<void()> run);
  Work(std::string work_name, std::function<void(int num_threads)> run_with);

  std::string name;
  std::function<void(int num_threads)> run_with;
};

// A copy of all points into memory that is there already. `points` must outlive it.
Work CopyOf(const std::vector<Eigen::Vector3f>& points);

// One real FFT of a size x size image in single precision and its inverse, by FFTW directly, one thread.
Work FftRoundTrip(int size);

// Measures each work under a limit of one and of two threads in turn with `plain` (one thread) and prints a line for
// each: medians [ms] and ratios. argv may hold --benchmark_out=FILE, which gets the same as JSON; other arguments are
// ignored. Returns what main should: 1 when FILE cannot be written.
int PrintRatios(int argc, char** argv, const Work& plain, const std::vector<Work>& works);

}  // namespace curvereg::bench

#endif  // CURVEREG_BENCH_RATIO_H_
