// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Tells the caller how far a reader is, seldom enough to cost nothing.
#ifndef CURVEREG_FILES_READ_PROGRESS_H_
#define CURVEREG_FILES_READ_PROGRESS_H_

#include <algorithm>
#include <cstddef>
#include <functional>

#include "files/cloud_file.h"

namespace curvereg {

class ReadProgress {
 public:
  // `total`: items (points or bytes) there are. `options` must outlive this.
  ReadProgress(const CloudReadOptions& options, std::size_t total) : report_(options.progress), total_(total) {}

  // Items done so far, never fewer than before.
  void At(std::size_t done) {
    if (done < next_) return;
    next_ = done + kInterval;
    if (report_) report_(std::min(1.0, static_cast<double>(done) / static_cast<double>(total_)));
  }

 private:
  static constexpr std::size_t kInterval = std::size_t{1} << 18;
  const std::function<void(double)>& report_;
  std::size_t total_ = 0;
  std::size_t next_ = kInterval;
};

}  // namespace curvereg

#endif  // CURVEREG_FILES_READ_PROGRESS_H_
