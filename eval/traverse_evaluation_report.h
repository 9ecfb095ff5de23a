// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes the evaluation of a traverse into a folder:
//   traverse.json                                          what `evaluate --mode traverse --json` prints
//   trajectory_truth.tum, _tracked.tum, _optimised.tum     estimates aligned to the truth by their first poses
//   map_optimised.ply                                      the scans merged at the optimised poses, thinned
//   figure_*.png, report.html                              the pictures, and everything in one page
// Estimates are those of the segment that was measured.
#ifndef CURVEREG_EVAL_TRAVERSE_EVALUATION_REPORT_H_
#define CURVEREG_EVAL_TRAVERSE_EVALUATION_REPORT_H_

#include <string>

#include "absl/status/statusor.h"
#include "eval/dataset.h"
#include "eval/evaluate_traverse.h"
#include "eval/report.h"

namespace curvereg {

std::string TraverseEvaluationJson(const TraverseEvaluation& evaluation, int indent = -1);

// A table for people.
std::string TraverseEvaluationText(const TraverseEvaluation& evaluation);

// As WriteReport of report.h.
absl::StatusOr<std::string> WriteTraverseEvaluationReport(const TraverseEvaluation& evaluation, const Dataset& dataset,
                                                          const std::string& folder, const ReportOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_TRAVERSE_EVALUATION_REPORT_H_
