// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/harris3d_fpfh.h"

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/keypoints/harris_3d.h>
#include <pcl/sample_consensus/ransac.h>
#include <pcl/sample_consensus/sac_model_registration.h>

#include <algorithm>
#include <vector>

#include "core/baselines/pcl_common.h"

// PCL's library has it compiled; its header would have it compiled here once more.
extern template class pcl::SampleConsensusModelRegistration<pcl::PointXYZ>;

namespace curvereg {
namespace {

using pcl_common::Cloud;
using pcl_common::Features;
using pcl_common::Surface;

constexpr size_t kSampleSize = 3;

struct DescribedKeypoints {
  Surface surface;
  Cloud::Ptr points = pcl::make_shared<Cloud>();
  Features::Ptr features = pcl::make_shared<Features>();  // one per point
};

// PCL's defaults: response det - 0.04 trace^2 of the normals' covariance, maxima within the radius, corners refined.
Cloud::Ptr DetectKeypoints(const Surface& surface, double radius_m) {
  pcl::HarrisKeypoint3D<pcl::PointXYZ, pcl::PointXYZI, pcl::Normal> detector;
  detector.setInputCloud(surface.cloud);
  detector.setNormals(surface.normals);
  detector.setSearchMethod(surface.tree);
  detector.setRadius(static_cast<float>(radius_m));
  detector.setNumberOfThreads(1);  // with more, the order of the key points would depend on timing
  pcl::PointCloud<pcl::PointXYZI> responses;
  detector.compute(responses);
  auto points = pcl::make_shared<Cloud>();
  for (const pcl::PointXYZI& response : responses) {
    const pcl::PointXYZ point(response.x, response.y, response.z);
    if (pcl::isFinite(point)) points->push_back(point);
  }
  return points;
}

DescribedKeypoints Describe(const Scan& scan, const BaselineOptions& options) {
  DescribedKeypoints described{pcl_common::PrepareSurface(scan, options)};
  if (options.stop.Requested() || described.surface.cloud->empty()) return described;
  const Cloud::Ptr points = DetectKeypoints(described.surface, options.feature_radius_m);
  if (options.stop.Requested() || points->empty()) return described;
  const Features::Ptr features = pcl_common::DescribePoints(points, described.surface, options);
  for (size_t i = 0; i < features->size(); ++i) {  // a refined corner may lie away from every point
    if (!std::ranges::all_of((*features)[i].histogram, [](float value) { return std::isfinite(value); })) continue;
    described.points->push_back((*points)[i]);
    described.features->push_back((*features)[i]);
  }
  return described;
}

// Index of the target key point with the most similar descriptor, per source key point.
pcl::Indices MatchFeatures(const Features& source, const Features::Ptr& target) {
  pcl::KdTreeFLANN<pcl::FPFHSignature33> tree(/*sorted=*/true);
  tree.setInputCloud(target);
  pcl::Indices matches;
  pcl::Indices nearest(1);
  std::vector<float> squared_distance(1);
  for (const pcl::FPFHSignature33& feature : source) {
    tree.nearestKSearch(feature, 1, nearest, squared_distance);
    matches.push_back(nearest[0]);
  }
  return matches;
}

// PCL's model of a rigid transform between matched points, with a seed: PCL's own is a constant or the time.
class SeededModel : public pcl::SampleConsensusModelRegistration<pcl::PointXYZ> {
 public:
  SeededModel(const Cloud::Ptr& source, const pcl::Indices& indices, uint64_t seed)
      : pcl::SampleConsensusModelRegistration<pcl::PointXYZ>(source, indices) {
    rng_alg_.seed(static_cast<unsigned>(seed ^ (seed >> 32U)));
  }
};

// RANSAC over the matches, what PCL's CorrespondenceRejectorSampleConsensus does; fills in pose and inliers.
void RejectMatches(const DescribedKeypoints& source, const DescribedKeypoints& target, const BaselineOptions& options,
                   BaselineResult& result) {
  const pcl::Indices matches = MatchFeatures(*source.features, target.features);
  result.num_matches = static_cast<int>(matches.size());
  pcl::Indices all(matches.size());
  for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  auto model = pcl::make_shared<SeededModel>(source.points, all, options.seed);
  model->setInputTarget(target.points, matches);
  pcl::RandomSampleConsensus<pcl::PointXYZ> ransac(model, options.ransac_threshold_m);
  ransac.setMaxIterations(options.max_iterations);
  pcl::Indices inliers;
  if (ransac.computeModel()) ransac.getInliers(inliers);
  result.num_inliers = static_cast<int>(inliers.size());
  if (inliers.size() < kSampleSize) {
    result.failure = Reason::kNoConsensus;
    return;
  }
  Eigen::VectorXf coefficients;
  ransac.getModelCoefficients(coefficients);
  const Eigen::Matrix4f T_target_source =
      Eigen::Map<const Eigen::Matrix<float, 4, 4, Eigen::RowMajor>>(coefficients.data());
  result.T_target_source.emplace().matrix() = T_target_source.cast<double>();
}

BaselineResult Run(const Scan& source_scan, const Scan& target_scan, const BaselineOptions& options) {
  BaselineResult result;
  const DescribedKeypoints source = Describe(source_scan, options);
  const DescribedKeypoints target = Describe(target_scan, options);
  if (options.stop.Requested()) return result;
  result.num_source_keypoints = static_cast<int>(source.points->size());
  result.num_target_keypoints = static_cast<int>(target.points->size());
  if (source.points->size() < kSampleSize || target.points->size() < kSampleSize) {
    result.failure = Reason::kTooFewFeatures;
    return result;
  }
  RejectMatches(source, target, options, result);
  if (result.T_target_source.has_value()) pcl_common::RefineByIcp(source.surface, target.surface, options, result);
  return result;
}

}  // namespace

absl::StatusOr<BaselineResult> RegisterHarris3dFpfh(const Scan& source, const Scan& target,
                                                    const BaselineOptions& options) {
  if (absl::Status status = pcl_common::ValidateInputs(source, target, options); !status.ok()) return status;
  return pcl_common::Finish(Run(source, target, options), options.stop);
}

}  // namespace curvereg
