// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE with PCL (Point Cloud Library, 1.13 or later): conversions of clouds, and the registration as a
// pcl::Registration. Both are header-only and need PCL on the user's side alone; link curvereg::core and PCL.
//
//   curvereg::CurveletRegistration<pcl::PointXYZ, pcl::PointXYZ> registration;
//   registration.setInputSource(source);
//   registration.setInputTarget(target);
//   pcl::PointCloud<pcl::PointXYZ> aligned;
//   registration.align(aligned);
//   if (registration.hasConverged()) use(registration.getFinalTransformation());
//
// By a server instead of in this process, with <curvereg/client.h> and curvereg::client:
//
//   const curvereg::Scan source_scan = curvereg::ScanFromPcl(*source), target_scan = curvereg::ScanFromPcl(*target);
//   absl::StatusOr<curvereg::RegistrationResult> result =
//       client->RegisterScans(std::cref(source_scan), std::cref(target_scan));
#ifndef CURVEREG_CLIENT_PCL_H_
#define CURVEREG_CLIENT_PCL_H_

#include "client/pcl_clouds.h"        // IWYU pragma: export
#include "client/pcl_registration.h"  // IWYU pragma: export

#endif  // CURVEREG_CLIENT_PCL_H_
