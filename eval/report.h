// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes an evaluation into a folder:
//   report.json                what `evaluate --json` prints
//   distributions.csv          empirical distributions of the errors and run times
//   trajectory_truth.tum       where scans stood; trajectory_METHOD.tum: where the accepted answers put them
//   map_METHOD.ply             the scans merged where the accepted answers put them, thinned
//   figure_*.png, report.html  the pictures, and everything in one page
// The same evaluation gives the same bytes (run times are part of an evaluation).
#ifndef CURVEREG_EVAL_REPORT_H_
#define CURVEREG_EVAL_REPORT_H_

#include <string>

#include "absl/status/statusor.h"
#include "eval/dataset.h"
#include "eval/evaluate.h"
#include "eval/figures.h"

namespace curvereg {

struct ReportOptions {
  double map_cell_m = 0.2;
  ScanLoader load_scan;  // required
  FigureOptions figures;
};

// Precondition: the folder exists. Returns a warning, empty when all went well: the figures may be missing where all
// else was written. Errors are those of writing a file, or of reading a scan for the map.
absl::StatusOr<std::string> WriteReport(const Evaluation& evaluation, const Dataset& dataset, const std::string& folder,
                                        const ReportOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_REPORT_H_
