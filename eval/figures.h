// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The paper's figures as pictures, drawn by eval/draw_report.py (matplotlib) from the files of a report folder.
#ifndef CURVEREG_EVAL_FIGURES_H_
#define CURVEREG_EVAL_FIGURES_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace curvereg {

struct FigureOptions {
  std::string python = "/usr/bin/python3";  // Debian's, which finds python3-matplotlib
  std::string script;                       // draw_report.py; empty: DefaultDrawScript()
};

// draw_report.py: in share/curvereg beside the installed executable's bin folder, else in the source tree.
std::string DefaultDrawScript();

// Draws into `folder` and returns the pictures' file names in name order. Pictures of an earlier run are removed first.
// FAILED_PRECONDITION, with the cause and the package to install: Python, matplotlib or the script is missing.
// INTERNAL, with what the script said last: it failed.
absl::StatusOr<std::vector<std::string>> DrawFigures(const std::string& folder, const FigureOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_EVAL_FIGURES_H_
