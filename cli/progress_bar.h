// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A progress bar on standard error, drawn only when that is a terminal.
#ifndef CURVEREG_CLI_PROGRESS_BAR_H_
#define CURVEREG_CLI_PROGRESS_BAR_H_

#include <chrono>
#include <string>

namespace curvereg::cli {

// The line that is drawn for `share` in [0, 1] (clamped; NaN counts as 0): "label [####      ]  40 % note".
std::string ProgressLine(const std::string& label, double share, const std::string& note);

// Not for use by several threads at once. The line is wiped at destruction.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  // Draws at most ten times a second, so it may be called often.
  void Update(double share, const std::string& note = "");

 private:
  std::string label_;
  bool on_terminal_ = false;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point last_draw_;
};

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_PROGRESS_BAR_H_
