// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Times pieces of single-threaded work against each other by the processor time of this thread: on a busy machine wall
// time would count the pauses, which fall on long work more than on short. All are run in turn, round after round, so
// that what noise is left disturbs them alike and the ratio of their medians means something.
#ifndef CURVEREG_BENCH_MEDIAN_TIME_H_
#define CURVEREG_BENCH_MEDIAN_TIME_H_

#include <algorithm>
#include <ctime>
#include <functional>
#include <vector>

namespace curvereg::bench {

// Processor time of this thread so far [s].
inline double ThreadSeconds() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Median processor time [s] of each work over `rounds` rounds, after one round that warms caches up.
inline std::vector<double> MedianSeconds(int rounds, const std::vector<std::function<void()>>& works) {
  std::vector<std::vector<double>> seconds(works.size());
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t i = 0; i < works.size(); ++i) {
      const double start = ThreadSeconds();
      works[i]();
      const double elapsed = ThreadSeconds() - start;
      if (round >= 0) seconds[i].push_back(elapsed);
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& series : seconds) {
    const auto middle = series.begin() + static_cast<std::ptrdiff_t>(series.size() / 2);
    std::nth_element(series.begin(), middle, series.end());
    medians.push_back(*middle);
  }
  return medians;
}

}  // namespace curvereg::bench

#endif  // CURVEREG_BENCH_MEDIAN_TIME_H_
