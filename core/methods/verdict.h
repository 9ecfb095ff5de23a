// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Is the pose to be believed? What decides does not depend on the sensor's scale: whether either scan claims surface
// where the other saw through, how well the band-passed views correlate, how much of the common surface fits within its
// own roughness, how far behind the next best pose is, and whether every direction of the pose is observed.
// Nothing is compared with a length in metres.
#ifndef CURVEREG_CORE_METHODS_VERDICT_H_
#define CURVEREG_CORE_METHODS_VERDICT_H_

#include <vector>

#include "core/methods/prepared_scan.h"
#include "core/methods/registration_result.h"
#include "core/pose/refinement.h"

namespace curvereg {

// What the two scans say about one pose.
struct PoseCheck {
  double free_space_agreement = 0.0;  // the smaller of both ways, [0, 1]
  double overlap_source = 0.0;        // share of the source that the target saw, [0, 1]
  double overlap_target = 0.0;
};
PoseCheck CheckPose(const PreparedScan& source, const PreparedScan& target, const RigidTransform& T_target_source);

// Correlation of two band-passed views of one kind under a pose, over the pixels where both saw ground.
struct ViewCorrelation {
  double ncc = 0.0;    // [-1, 1]
  int num_pixels = 0;  // compared
};
ViewCorrelation CorrelateViews(const ViewFeatures& source, const ViewFeatures& target,
                               const RigidTransform& T_target_source);

// All that the verdict looks at.
struct PoseEvidence {
  PoseCheck check;
  SurfaceFit fit;
  double image_correlation = 0.0;  // the best of the views computed, [-1, 1]
  int num_matches = 0;             // of the view that proposed the pose
  int num_inliers = 0;
  double runner_up_ratio = 0.0;  // confidence of the surest different pose over this one's
};

// Ranks poses of one pair of scans; larger is better, no unit.
double PoseScore(const PoseEvidence& evidence);

// How sure a pose is, comparable between different pairs and between the rungs of the ladder, [0, 1.1].
double PoseConfidence(const PoseEvidence& evidence);

// Agreement of free space and of surfaces in one number, fs^20 * inliers^10, [0, 1].
double SurfaceConsistency(const PoseEvidence& evidence);

struct VerdictOptions {
  double min_consistency = 0.15;        // SurfaceConsistency; wrong poses of look-alike places reach 0.12
  double min_overlap = 0.15;            // of either scan
  double min_image_correlation = 0.35;  // unrelated ground correlates up to 0.3
  // Of image correlation + 0.05 per agreeing match, ten at most: two nearly flat places can fit and correlate up to
  // 0.57 by chance, but then hardly any match agrees.
  double min_appearance = 0.75;
  double max_runner_up_ratio = 0.8;
  // By how many standard deviations of noise, as if elements were independent, a direction's information must exceed
  // it. They are not (each pair counts both ways, coarse cells hold the points of fine ones): on perfect planes 2 to 4
  // such deviations are one, and the largest of 864 was 16 (both scans from one place, 3 cm noise; else 9). Real pairs
  // have at least 41, simulated ones of sparse scans full of outliers at 21 m at least 18.
  double min_information_z = 14.0;
};

// Directions that the common surface does not determine (target frame): their information, taken with one normal from
// each scan so that noise cancels, is not significantly above what noise alone would give.
std::vector<DegenerateDirection> FindDegenerateDirections(const SurfaceFit& fit, double min_information_z);

Verdict DecideVerdict(const PoseEvidence& evidence, const std::vector<DegenerateDirection>& degenerate,
                      const VerdictOptions& options = {});

// Judges `T_target_source` and writes it down: pose, verdict, covariance, degenerate directions and the measures.
void FillResult(const RigidTransform& T_target_source, const PoseEvidence& evidence, RegistrationResult& result);

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_VERDICT_H_
