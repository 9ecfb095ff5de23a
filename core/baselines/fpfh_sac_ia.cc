// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/fpfh_sac_ia.h"

#include <pcl/common/distances.h>
#include <pcl/common/transforms.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "core/baselines/pcl_common.h"

namespace curvereg {
namespace {

using pcl_common::Features;
using pcl_common::Surface;

constexpr size_t kSampleSize = 3;

struct DescribedSurface {
  Surface surface;
  Features::Ptr features;  // one per point; empty when the surface is, or after a stop
};

DescribedSurface Describe(const Scan& scan, const BaselineOptions& options) {
  DescribedSurface described{pcl_common::PrepareSurface(scan, options), pcl::make_shared<Features>()};
  if (options.stop.Requested() || described.surface.cloud->empty()) return described;
  described.features = pcl_common::DescribePoints(described.surface.cloud, described.surface, options);
  return described;
}

// Uniform in [0, n); spelt out because the standard leaves its distributions to each library.
int RandomIndex(std::mt19937_64& generator, size_t n) { return static_cast<int>(((generator() >> 32U) * n) >> 32U); }

// Three points of `cloud`, pairwise at least min_distance_m apart. Where none are found, the distance is halved for
// this and all later samples, as PCL does. Precondition: three points at least, not all equal.
pcl::Indices DrawSample(const pcl_common::Cloud& cloud, std::mt19937_64& generator, float& min_distance_m) {
  pcl::Indices sample;
  size_t num_failures = 0;
  while (sample.size() < kSampleSize) {
    const int candidate = RandomIndex(generator, cloud.size());
    const bool is_far = std::ranges::all_of(sample, [&](int other) {
      return candidate != other && pcl::euclideanDistance(cloud[static_cast<size_t>(candidate)],
                                                          cloud[static_cast<size_t>(other)]) >= min_distance_m;
    });
    if (is_far) {
      sample.push_back(candidate);
      num_failures = 0;
    } else if (++num_failures >= 3 * cloud.size()) {
      min_distance_m *= 0.5F;
      num_failures = 0;
    }
  }
  return sample;
}

// For each descriptor of the sample, one of the `randomness` target points with the most similar ones, drawn at random.
// A plain search: in 33 dimensions a tree saves nothing, and building PCL's over 224k points takes 0.2 s unstoppably.
pcl::Indices DrawMatches(const Features& sample, const Features& target, int randomness, std::mt19937_64& generator) {
  using Histogram = Eigen::Map<const Eigen::Matrix<float, 33, 1>>;
  const size_t num_choices = std::min(static_cast<size_t>(randomness), target.size());
  pcl::Indices matches;
  std::vector<std::pair<float, int>> candidates(target.size());  // squared distance, index
  for (const pcl::FPFHSignature33& feature : sample) {
    const Histogram wanted(feature.histogram);
    for (size_t i = 0; i < target.size(); ++i) {
      candidates[i] = {(Histogram(target[i].histogram) - wanted).squaredNorm(), static_cast<int>(i)};
    }
    std::ranges::nth_element(candidates, candidates.begin() + static_cast<std::ptrdiff_t>(num_choices) - 1);
    std::sort(candidates.begin(), candidates.begin() + static_cast<std::ptrdiff_t>(num_choices));
    matches.push_back(candidates[static_cast<size_t>(RandomIndex(generator, num_choices))].second);
  }
  return matches;
}

// Sum over the source's points of min(d^2, d_max^2), d the distance to the nearest target point.
double TruncatedError(const Surface& source, const Surface& target, const Eigen::Matrix4f& T_target_source,
                      double max_distance_m) {
  pcl_common::Cloud points_target;
  pcl::transformPointCloud(*source.cloud, points_target, T_target_source);
  const double limit = max_distance_m * max_distance_m;
  double error = 0.0;
  pcl::Indices nearest(1);
  std::vector<float> squared_distance(1);
  for (const pcl::PointXYZ& point : points_target) {
    target.tree->nearestKSearch(point, 1, nearest, squared_distance);
    error += std::min(static_cast<double>(squared_distance[0]), limit);
  }
  return error;
}

// SAC-IA: of the poses that random samples give, the one with the least error. Leaves result.T_target_source empty when
// stopped before the first.
void AlignBySamples(const DescribedSurface& source, const DescribedSurface& target, const BaselineOptions& options,
                    BaselineResult& result) {
  std::mt19937_64 generator(options.seed);
  auto min_distance_m = static_cast<float>(options.min_sample_distance_m);
  double least_error = std::numeric_limits<double>::infinity();
  for (int i = 0; i < options.max_iterations; ++i) {
    const pcl::Indices sample = DrawSample(*source.surface.cloud, generator, min_distance_m);
    const pcl::Indices matches =
        DrawMatches(Features(*source.features, sample), *target.features, options.correspondence_randomness, generator);
    const Eigen::Matrix4f T_target_source =
        pcl_common::FitRigid(*source.surface.cloud, sample, *target.surface.cloud, matches);
    const double error =
        TruncatedError(source.surface, target.surface, T_target_source, options.icp_max_correspondence_m);
    if (options.stop.Requested()) return;
    ++result.num_matches;
    if (error >= least_error) continue;
    least_error = error;
    result.T_target_source.emplace().matrix() = T_target_source.cast<double>();
  }
}

BaselineResult Run(const Scan& source_scan, const Scan& target_scan, const BaselineOptions& options) {
  BaselineResult result;
  const DescribedSurface source = Describe(source_scan, options);
  const DescribedSurface target = Describe(target_scan, options);
  if (options.stop.Requested()) return result;
  result.num_source_keypoints = static_cast<int>(source.features->size());
  result.num_target_keypoints = static_cast<int>(target.features->size());
  if (source.features->size() < kSampleSize || target.features->size() < kSampleSize) {
    result.failure = Reason::kTooFewFeatures;
    return result;
  }
  AlignBySamples(source, target, options, result);
  if (result.T_target_source.has_value()) pcl_common::RefineByIcp(source.surface, target.surface, options, result);
  return result;
}

}  // namespace

absl::StatusOr<BaselineResult> RegisterFpfhSacIa(const Scan& source, const Scan& target,
                                                 const BaselineOptions& options) {
  if (absl::Status status = pcl_common::ValidateInputs(source, target, options); !status.ok()) return status;
  return pcl_common::Finish(Run(source, target, options), options.stop);
}

}  // namespace curvereg
