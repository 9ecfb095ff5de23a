// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "cli/progress_bar.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

#include "absl/strings/str_format.h"

namespace curvereg::cli {
namespace {
constexpr int kWidth = 30;
constexpr std::chrono::milliseconds kRedrawInterval(100);
}  // namespace

std::string ProgressLine(const std::string& label, double share, const std::string& note) {
  const double clamped = share >= 1.0 ? 1.0 : (share > 0.0 ? share : 0.0);
  const int filled = static_cast<int>(clamped * kWidth);
  return absl::StrFormat("%s [%s%s] %3d %% %s", label, std::string(static_cast<std::size_t>(filled), '#'),
                         std::string(static_cast<std::size_t>(kWidth - filled), ' '), static_cast<int>(clamped * 100.0),
                         note);
}

ProgressBar::ProgressBar(std::string label) : label_(std::move(label)), on_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::Update(double share, const std::string& note) {
  if (!on_terminal_) return;
  const auto now = std::chrono::steady_clock::now();
  if (drawn_ && now - last_draw_ < kRedrawInterval) return;
  drawn_ = true;
  last_draw_ = now;
  std::fprintf(stderr, "\r\033[K%s", ProgressLine(label_, share, note).c_str());
  std::fflush(stderr);
}

}  // namespace curvereg::cli
