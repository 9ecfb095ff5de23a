// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Traverses as text and as JSON. Keys and units as in client/traverse_types.h; what is unknown is null, or "-".
#ifndef CURVEREG_CLI_TRAVERSE_TEXT_H_
#define CURVEREG_CLI_TRAVERSE_TEXT_H_

#include <Eigen/Core>
#include <optional>
#include <string>

#include "client/traverse_types.h"
#include "files/json.h"

namespace curvereg::cli {

// "segment_start", "registered", "prior".
std::string OriginName(PoseOrigin origin);

Json PoseJson(const TrajectoryPose& pose);
Json LinkJson(const LinkSummary& link);
Json ScanResultJson(const ScanResult& result);
Json TraverseJson(const RemoteTraverse& traverse);
Json EventJson(const TraverseEvent& event);

Json OptimizationJson(const OptimizationOutcome& outcome);
std::string OptimizationText(const OptimizationOutcome& outcome);

// Of the sensor's place in the segment's frame [m^2], to first order; nullopt without a covariance. A perturbation D of
// the left moves the place p to R_D p + t_D, so the rotation counts with its lever.
std::optional<Eigen::Matrix3d> PositionCovariance(const TrajectoryPose& pose);
// Greatest standard deviation of the place over all directions [m].
std::optional<double> PositionSigma(const TrajectoryPose& pose);

// A table with one row per scan, with line breaks.
std::string ScanResultHeader();
std::string ScanResultRow(const ScanResult& result);
// A row, or what else happened in words.
std::string EventText(const TraverseEvent& event);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_TRAVERSE_TEXT_H_
