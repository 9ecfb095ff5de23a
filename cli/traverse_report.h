// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Writes a traverse into a folder:
//   report.json                what is known of the traverse, scan by scan
//   trajectory_N.tum           the poses of segment N
//   map.ply                    the map of the segment with the most poses
//   figure_*.png, report.html  trajectory with error ellipses, map, verdicts in time, and everything in one page
#ifndef CURVEREG_CLI_TRAVERSE_REPORT_H_
#define CURVEREG_CLI_TRAVERSE_REPORT_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/traverses.h"

namespace curvereg::cli {

struct TraverseRecord {
  RemoteTraverse traverse;
  RemoteTrajectory trajectory;
  std::vector<ScanResult> results;       // as they were when the scans came
  std::vector<LinkSummary> later_links;  // found afterwards
  std::vector<Eigen::Vector3f> map;      // of the largest segment; empty: none
};

// Precondition: the folder exists. Returns a warning, empty when all went well: the figures may be missing where all
// else was written. Errors are those of writing a file.
absl::StatusOr<std::string> WriteTraverseReport(const TraverseRecord& record, const std::string& folder);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_TRAVERSE_REPORT_H_
