// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Steps of PCL that both baselines use. Included by the sources of this folder only, so that PCL's headers stay there.
#ifndef CURVEREG_CORE_BASELINES_PCL_COMMON_H_
#define CURVEREG_CORE_BASELINES_PCL_COMMON_H_

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>

#include "absl/status/statusor.h"
#include "core/baselines/baseline.h"
#include "core/scan/scan.h"

namespace curvereg::pcl_common {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;
using Features = pcl::PointCloud<pcl::FPFHSignature33>;

// PCL's kd-tree, which finds nothing once a stop was requested: so PCL's loops over points, which know no stop, run
// out. Their results are then worthless; the caller asks `stop` after every stage and drops them.
class InterruptibleKdTree : public pcl::search::KdTree<pcl::PointXYZ> {
 public:
  using Base = pcl::search::KdTree<pcl::PointXYZ>;
  using Base::nearestKSearch;
  using Base::radiusSearch;

  explicit InterruptibleKdTree(const Stop& stop) : Base(/*sorted=*/false), stop_(stop) {}

  // Builds the tree, unless it holds this cloud already.
  void setInputCloud(const PointCloudConstPtr& cloud, const pcl::IndicesConstPtr& indices) override;
  int nearestKSearch(const pcl::PointXYZ& point, int k, pcl::Indices& indices,
                     std::vector<float>& squared_distances) const override;
  int radiusSearch(const pcl::PointXYZ& point, double radius, pcl::Indices& indices,
                   std::vector<float>& squared_distances, unsigned int max_neighbours) const override;

 private:
  Stop stop_;
};

// A scan's points that have a normal, their normals (towards the sensor), and a search tree of the points.
struct Surface {
  Cloud::Ptr cloud;
  Normals::Ptr normals;
  pcl::shared_ptr<InterruptibleKdTree> tree;
};

// Everything that makes a call impossible: INVALID_ARGUMENT for options (Validate), scans (ValidateScan), and voxels
// that are too many for PCL's 32-bit indices.
absl::Status ValidateInputs(const Scan& source, const Scan& target, const BaselineOptions& options);

// The finite points, one per voxel if asked for, with normals from the points within normal_radius_m (3 at least).
// Precondition: ValidateInputs.
Surface PrepareSurface(const Scan& scan, const BaselineOptions& options);

// FPFH of `points` (which need not be points of the surface) on `surface`; NaN where nothing is within the radius.
// Precondition: neither is empty.
Features::Ptr DescribePoints(const Cloud::Ptr& points, const Surface& surface, const BaselineOptions& options);

// The rigid transform of least squares that takes the points of `source` in `picked_source`, one by one, to those of
// `target` in `picked_target`. Precondition: as many, at least 3.
Eigen::Matrix4f FitRigid(const Cloud& source, const pcl::Indices& picked_source, const Cloud& target,
                         const pcl::Indices& picked_target);

// Point-to-point ICP (PCL's parts and convergence rules) from result.T_target_source; fills in pose and counts.
void RefineByIcp(const Surface& source, const Surface& target, const BaselineOptions& options, BaselineResult& result);

// The answer of a run that may have been cut short: CANCELLED, or the result, marked when out of time.
absl::StatusOr<BaselineResult> Finish(BaselineResult result, const Stop& stop);

}  // namespace curvereg::pcl_common

#endif  // CURVEREG_CORE_BASELINES_PCL_COMMON_H_
