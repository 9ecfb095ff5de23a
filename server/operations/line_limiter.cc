// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/line_limiter.h"

namespace curvereg::server {

bool LineLimiter::Allow(const std::string& kind, TimePoint now) {
  Window& window = windows_.try_emplace(kind, Window{now, 0}).first->second;
  // A window that is over but still here holds lines nobody was told about: it goes on until TakeSuppressed.
  return ++window.num_lines <= lines_per_window_;
}

std::vector<LineLimiter::Suppressed> LineLimiter::TakeSuppressed(TimePoint now) {
  std::vector<Suppressed> suppressed;
  for (auto window = windows_.begin(); window != windows_.end();) {
    if (now - window->second.begin < kWindow) {
      ++window;
      continue;
    }
    const int64_t num_over = window->second.num_lines - lines_per_window_;
    if (num_over > 0) suppressed.push_back({window->first, num_over});
    window = windows_.erase(window);
  }
  return suppressed;
}

}  // namespace curvereg::server
