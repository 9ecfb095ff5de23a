// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// pcl_registration SOURCE TARGET
//
// Registers two cloud files with a pcl::Registration and prints the transform that maps the source onto the target as
// "x y z qx qy qz qw" [m; unit quaternion], then PCL's fitness score [m^2]. Exit status: 0 accepted, 3 rejected,
// 2 usage, 1 anything else.
#include <curvereg/files/cloud_file.h>
#include <curvereg/pcl.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <string>

namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

// Null, and a message on stderr, if the file cannot be read.
Cloud::Ptr ReadCloud(const std::string& path) {
  const absl::StatusOr<curvereg::Scan> scan = curvereg::ReadCloudFile(path);
  if (!scan.ok()) {
    std::fprintf(stderr, "%s\n", scan.status().ToString().c_str());
    return nullptr;
  }
  return pcl::make_shared<Cloud>(curvereg::PclCloudFromScan(*scan));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: pcl_registration SOURCE TARGET\n");
    return 2;
  }
  const Cloud::Ptr source = ReadCloud(argv[1]);
  const Cloud::Ptr target = ReadCloud(argv[2]);
  if (source == nullptr || target == nullptr) return 1;

  curvereg::CurveletRegistration<pcl::PointXYZ, pcl::PointXYZ> registration;
  registration.setInputSource(source);
  registration.setInputTarget(target);
  Cloud aligned;
  registration.align(aligned);

  if (!registration.status().ok()) return 1;  // PCL has printed why
  if (!registration.hasConverged()) {
    for (const curvereg::Reason reason : registration.result().verdict.reasons) {
      std::printf("rejected: %s\n", std::string(curvereg::ReasonName(reason)).c_str());
    }
    return 3;
  }
  const Eigen::Isometry3f T_target_source(registration.getFinalTransformation());
  const Eigen::Vector3f translation = T_target_source.translation();
  const Eigen::Quaternionf rotation(T_target_source.rotation());
  std::printf("%.6f %.6f %.6f %.7f %.7f %.7f %.7f\n", translation.x(), translation.y(), translation.z(), rotation.x(),
              rotation.y(), rotation.z(), rotation.w());
  std::printf("fitness score: %g\n", registration.getFitnessScore(/*max_range=*/1.0));
  return 0;
}
