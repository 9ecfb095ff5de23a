// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Figures as pictures, drawn by the scripts beside this file (matplotlib) from the files of a report folder.
#ifndef CURVEREG_EVAL_FIGURES_H_
#define CURVEREG_EVAL_FIGURES_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace curvereg {

// What the folder is the report of. Told and not guessed: it may hold files of another kind of report, too.
enum class Drawing {
  kPairEvaluation,      // draw_evaluation.py pairs
  kTraverseEvaluation,  // draw_evaluation.py traverse
  kTraverse,            // draw_traverse_report.py
};

struct FigureOptions {
  std::string python = "/usr/bin/python3";  // Debian's, which finds python3-matplotlib
  std::string script;  // empty: the drawing's, in share/curvereg beside the installed executable's bin folder, else in
                       // the source tree
};

// Draws into `folder` and returns the pictures' file names in name order. Pictures of an earlier run are removed first.
// FAILED_PRECONDITION, with the cause and the package to install: Python, matplotlib or the script is missing.
// INTERNAL, with what the script said last: it failed.
absl::StatusOr<std::vector<std::string>> DrawFigures(const std::string& folder, Drawing drawing,
                                                     const FigureOptions& options = {});

}  // namespace curvereg

#endif  // CURVEREG_EVAL_FIGURES_H_
