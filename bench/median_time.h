// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Times pieces of work against each other. All are run in turn, round after round, so that a noisy machine disturbs
// them alike and the ratio of their medians means something.
#ifndef CURVEREG_BENCH_MEDIAN_TIME_H_
#define CURVEREG_BENCH_MEDIAN_TIME_H_

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

namespace curvereg::bench {

// Median wall time [s] of each work over `rounds` rounds, after one round that warms caches up.
inline std::vector<double> MedianSeconds(int rounds, const std::vector<std::function<void()>>& works) {
  std::vector<std::vector<double>> seconds(works.size());
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t i = 0; i < works.size(); ++i) {
      const auto start = std::chrono::steady_clock::now();
      works[i]();
      const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
      if (round >= 0) seconds[i].push_back(elapsed.count());
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
