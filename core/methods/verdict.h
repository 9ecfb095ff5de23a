// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The verdict on a pose: whether either scan has surface in the other's free space, how well the band-passed views
// correlate, how much of the common surface fits within its own roughness, how far behind the next best pose is, and
// whether every direction of the pose is observed. The thresholds of VerdictOptions are ratios, without a unit. Lengths
// enter elsewhere: PoseScore adds 0.02 m to the residual, the runner-up is another pose only beyond 1 m or 0.1 rad
// (register_curvelet.cc), and free space and surfels have margins and cells in metres. The rules are the project's own;
// docs/method.md says on which data each number was chosen.
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
  double runner_up_ratio = 0.0;  // confidence of the most confident different pose over this one's
};

// Ranks poses of one pair of scans; larger is better. PoseConfidence * sqrt(4 + inlier matches) / (residual + 0.02 m),
// so the unit is 1/m.
double PoseScore(const PoseEvidence& evidence);

// Confidence in a pose, comparable between different pairs and between escalation steps, [0, 1.1]: SurfaceConsistency *
// the lesser overlap * (0.1 + image correlation)^0.2, a negative correlation counted as 0.
double PoseConfidence(const PoseEvidence& evidence);

// Agreement of free space and of surfaces in one number, [0, 1]: free_space_agreement^20 * inlier_fraction^10. The
// exponents here and above were fitted by conditional logit to the hypotheses of 128 real and simulated pairs and
// rounded, see docs/method.md.
double SurfaceConsistency(const PoseEvidence& evidence);

struct VerdictOptions {
  double min_consistency = 0.15;        // SurfaceConsistency; wrong poses of look-alike places reach 0.12
  double min_overlap = 0.15;            // of either scan
  double min_image_correlation = 0.35;  // unrelated ground correlates up to 0.3
  // Of image correlation + 0.05 per agreeing match, ten at most: two nearly flat places can fit and correlate up to
  // 0.57 by chance, but then hardly any match agrees.
  double min_appearance = 0.75;
  double max_runner_up_ratio = 0.8;
  // By how many standard deviations of noise, as if surfels were independent, a direction's information must exceed
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

// Decides the verdict on `T_target_source` and fills in pose, verdict, covariance, degenerate directions and measures.
void FillResult(const RigidTransform& T_target_source, const PoseEvidence& evidence, RegistrationResult& result);

}  // namespace curvereg

#endif  // CURVEREG_CORE_METHODS_VERDICT_H_
