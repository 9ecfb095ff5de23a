// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Lets the first lines of each kind through in every second and counts the others. Not safe for several threads.
#ifndef CURVEREG_SERVER_OPERATIONS_LINE_LIMITER_H_
#define CURVEREG_SERVER_OPERATIONS_LINE_LIMITER_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace curvereg::server {

class LineLimiter {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;
  static constexpr std::chrono::seconds kWindow{1};

  struct Suppressed {
    std::string kind;
    int64_t num_lines = 0;
  };

  explicit LineLimiter(int lines_per_window) : lines_per_window_(lines_per_window) {}

  // Whether a line of this kind may be written. There should be few kinds: each is remembered until its window is over.
  bool Allow(const std::string& kind, TimePoint now);

  // The kinds of which lines were held back in windows that are over by now, each told once; forgets those windows.
  std::vector<Suppressed> TakeSuppressed(TimePoint now);

 private:
  struct Window {
    TimePoint begin;
    int64_t num_lines = 0;
  };
  const int lines_per_window_;
  std::map<std::string, Window> windows_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_LINE_LIMITER_H_
