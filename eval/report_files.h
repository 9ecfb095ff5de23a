// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The files that reports of pairs and of traverses have in common.
#ifndef CURVEREG_EVAL_REPORT_FILES_H_
#define CURVEREG_EVAL_REPORT_FILES_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "core/base/rigid_transform.h"
#include "eval/dataset.h"
#include "eval/report.h"

namespace curvereg {

// A TUM trajectory of the scans that have a pose, with their numbers in place of times. Errors of WriteTrajectoryFile.
absl::Status WriteScanPoses(const std::string& path, const std::vector<std::optional<RigidTransform>>& T_world_scan);

// One cloud of the scans that have a pose, thinned to a point per cell. Errors are those of reading a scan, of
// BuildPointMap and of WriteCloudFile.
absl::Status WriteMergedMap(const std::string& path, const Dataset& dataset,
                            const std::vector<std::optional<RigidTransform>>& T_world_scan,
                            const ReportOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_REPORT_FILES_H_
