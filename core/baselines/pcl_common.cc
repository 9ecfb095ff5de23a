// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/baselines/pcl_common.h"

#include <pcl/common/transforms.h>
#include <pcl/features/fpfh.h>
#include <pcl/features/normal_3d.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/registration/correspondence_estimation.h>
#include <pcl/registration/default_convergence_criteria.h>
#include <pcl/registration/transformation_estimation_svd.h>

#include <cmath>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"

namespace curvereg::pcl_common {
namespace {

Cloud::Ptr FinitePoints(const Scan& scan) {
  auto cloud = pcl::make_shared<Cloud>();
  cloud->reserve(scan.points.size());
  for (const Eigen::Vector3f& point : scan.points) {
    if (point.allFinite()) cloud->push_back(pcl::PointXYZ(point.x(), point.y(), point.z()));
  }
  return cloud;
}

// PCL numbers the voxels of the bounding box with 32-bit integers, and passes the cloud through unchanged beyond that.
absl::Status ValidateVoxels(const Scan& scan, double voxel_size_m) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& point : scan.points) {
    if (point.allFinite()) box.extend(point.cast<double>());
  }
  const Eigen::Array3d num_voxels = (box.sizes().array() / voxel_size_m).floor() + 2.0;
  if (num_voxels.prod() < std::numeric_limits<int32_t>::max()) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("baseline option voxel_size_m = ", voxel_size_m, " is too small for the extent of the scan"));
}

Normals::Ptr EstimateNormals(const Surface& surface, double radius_m) {
  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;  // turns normals towards (0, 0, 0), the sensor
  estimation.setInputCloud(surface.cloud);
  estimation.setSearchMethod(surface.tree);
  estimation.setRadiusSearch(radius_m);
  auto normals = pcl::make_shared<Normals>();
  estimation.compute(*normals);
  return normals;
}

// Leaves out the points of `surface` whose normal could not be estimated.
void KeepPointsWithNormals(Surface& surface) {
  auto cloud = pcl::make_shared<Cloud>();
  auto normals = pcl::make_shared<Normals>();
  for (size_t i = 0; i < surface.cloud->size(); ++i) {
    if (!(*surface.normals)[i].getNormalVector3fMap().allFinite()) continue;
    cloud->push_back((*surface.cloud)[i]);
    normals->push_back((*surface.normals)[i]);
  }
  surface.normals = normals;
  if (cloud->size() == surface.cloud->size()) return;
  surface.cloud = cloud;
  if (!cloud->empty()) surface.tree->setInputCloud(cloud, nullptr);
}

double RootMeanSquare(const pcl::Correspondences& correspondences) {
  double sum = 0.0;
  for (const pcl::Correspondence& c : correspondences) sum += static_cast<double>(c.distance);  // squared by PCL
  return std::sqrt(sum / static_cast<double>(correspondences.size()));
}

// The numbers of PCL's IterativeClosestPoint for its setTransformationEpsilon(epsilon).
using Criteria = pcl::registration::DefaultConvergenceCriteria<float>;
void Configure(const BaselineOptions& options, Criteria& criteria) {
  criteria.setMaximumIterations(options.max_iterations);
  criteria.setRelativeMSE(-std::numeric_limits<double>::max());
  criteria.setTranslationThreshold(options.epsilon);
  criteria.setRotationThreshold(1.0 - options.epsilon);
}

}  // namespace

void InterruptibleKdTree::setInputCloud(const PointCloudConstPtr& cloud, const pcl::IndicesConstPtr& indices) {
  if (cloud != getInputCloud() || indices != getIndices()) Base::setInputCloud(cloud, indices);
}

int InterruptibleKdTree::nearestKSearch(const pcl::PointXYZ& point, int k, pcl::Indices& indices,
                                        std::vector<float>& squared_distances) const {
  if (!stop_.Requested()) return Base::nearestKSearch(point, k, indices, squared_distances);
  indices.assign(static_cast<size_t>(k), 0);  // PCL reads the entries without looking at the count
  squared_distances.assign(static_cast<size_t>(k), std::numeric_limits<float>::max());
  return 0;
}

int InterruptibleKdTree::radiusSearch(const pcl::PointXYZ& point, double radius, pcl::Indices& indices,
                                      std::vector<float>& squared_distances, unsigned int max_neighbours) const {
  if (!stop_.Requested()) return Base::radiusSearch(point, radius, indices, squared_distances, max_neighbours);
  indices.clear();
  squared_distances.clear();
  return 0;
}

absl::Status ValidateInputs(const Scan& source, const Scan& target, const BaselineOptions& options) {
  if (absl::Status status = Validate(options); !status.ok()) return status;
  for (const Scan* scan : {&source, &target}) {
    if (absl::Status status = ValidateScan(*scan); !status.ok()) return status;
    if (options.voxel_size_m == 0.0) continue;
    if (absl::Status status = ValidateVoxels(*scan, options.voxel_size_m); !status.ok()) return status;
  }
  return absl::OkStatus();
}

Surface PrepareSurface(const Scan& scan, const BaselineOptions& options) {
  Surface surface{FinitePoints(scan), pcl::make_shared<Normals>(), pcl::make_shared<InterruptibleKdTree>(options.stop)};
  if (options.voxel_size_m > 0.0) {
    pcl::VoxelGrid<pcl::PointXYZ> grid;
    const auto leaf = static_cast<float>(options.voxel_size_m);
    grid.setLeafSize(leaf, leaf, leaf);
    grid.setInputCloud(surface.cloud);
    auto thinned = pcl::make_shared<Cloud>();
    grid.filter(*thinned);
    surface.cloud = thinned;
  }
  if (options.stop.Requested()) return surface;
  surface.tree->setInputCloud(surface.cloud, nullptr);
  surface.normals = EstimateNormals(surface, options.normal_radius_m);
  if (!options.stop.Requested()) KeepPointsWithNormals(surface);
  return surface;
}

Features::Ptr DescribePoints(const Cloud::Ptr& points, const Surface& surface, const BaselineOptions& options) {
  pcl::FPFHEstimation<pcl::PointXYZ, pcl::Normal, pcl::FPFHSignature33> estimation;
  estimation.setInputCloud(points);
  estimation.setSearchSurface(surface.cloud);
  estimation.setInputNormals(surface.normals);
  estimation.setSearchMethod(surface.tree);
  estimation.setRadiusSearch(options.feature_radius_m);
  auto features = pcl::make_shared<Features>();
  estimation.compute(*features);
  return features;
}

// Here alone, because PCL's header compiles Eigen's SVD wherever the class is used.
Eigen::Matrix4f FitRigid(const Cloud& source, const pcl::Indices& picked_source, const Cloud& target,
                         const pcl::Indices& picked_target) {
  const pcl::registration::TransformationEstimationSVD<pcl::PointXYZ, pcl::PointXYZ> fit;
  Eigen::Matrix4f T_target_source = Eigen::Matrix4f::Identity();
  fit.estimateRigidTransformation(source, picked_source, target, picked_target, T_target_source);
  return T_target_source;
}

void RefineByIcp(const Surface& source, const Surface& target, const BaselineOptions& options, BaselineResult& result) {
  Eigen::Matrix4f T_target_source = result.T_target_source->matrix().cast<float>();
  auto points_target = pcl::make_shared<Cloud>();  // the source's points under the pose so far
  pcl::transformPointCloud(*source.cloud, *points_target, T_target_source);

  pcl::registration::CorrespondenceEstimation<pcl::PointXYZ, pcl::PointXYZ> estimation;
  estimation.setInputTarget(target.cloud);
  estimation.setSearchMethodTarget(target.tree, /*force_no_recompute=*/true);
  const pcl::registration::TransformationEstimationSVD<pcl::PointXYZ, pcl::PointXYZ> fit;
  pcl::Correspondences partners;
  Eigen::Matrix4f step = Eigen::Matrix4f::Identity();
  int iteration = 0;
  Criteria criteria(iteration, step, partners);
  Configure(options, criteria);

  while (criteria.getConvergenceState() == Criteria::CONVERGENCE_CRITERIA_NOT_CONVERGED) {
    estimation.setInputSource(points_target);
    estimation.determineCorrespondences(partners, options.icp_max_correspondence_m);
    if (options.stop.Requested() || partners.size() < 3) break;
    fit.estimateRigidTransformation(*points_target, *target.cloud, partners, step);
    pcl::transformPointCloud(*points_target, *points_target, step);
    T_target_source = step * T_target_source;
    ++iteration;
    criteria.hasConverged();
    result.num_inliers = static_cast<int>(partners.size());
    result.residual_rmse_m = RootMeanSquare(partners);
  }
  result.num_iterations = iteration;
  result.converged = criteria.getConvergenceState() != Criteria::CONVERGENCE_CRITERIA_NOT_CONVERGED &&
                     criteria.getConvergenceState() != Criteria::CONVERGENCE_CRITERIA_ITERATIONS;
  result.T_target_source->matrix() = T_target_source.cast<double>();
  result.T_target_source = Orthonormalised(*result.T_target_source);
}

absl::StatusOr<BaselineResult> Finish(BaselineResult result, const Stop& stop) {
  if (stop.Cancelled()) return absl::CancelledError("registration cancelled");
  if (stop.PastDeadline()) result.failure = Reason::kDeadline;
  return result;
}

}  // namespace curvereg::pcl_common
