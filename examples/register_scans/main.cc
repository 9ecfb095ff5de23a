// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// register_scans HOST:PORT SOURCE TARGET
//
// Asks a server for the transform that aligns the scan in file SOURCE to the one in TARGET, and prints it as
// "x y z qx qy qz qw" [m; unit quaternion]. Exit status: 0 accepted, 3 rejected, 2 usage, 1 anything else.
#include <curvereg/client.h>
#include <curvereg/files/cloud_file.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <functional>

namespace {

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fprintf(stderr, "usage: register_scans HOST:PORT SOURCE TARGET\n");
    return 2;
  }
  const auto source = curvereg::ReadCloudFile(argv[2]);
  if (!source.ok()) return Fail(source.status());
  const auto target = curvereg::ReadCloudFile(argv[3]);
  if (!target.ok()) return Fail(target.status());
  const auto client = curvereg::Client::Connect(argv[1]);
  if (!client.ok()) return Fail(client.status());

  const auto result = (*client)->RegisterScans(std::cref(*source), std::cref(*target));
  if (!result.ok()) return Fail(result.status());
  if (!result->T_target_source.has_value()) {
    std::printf("no pose\n");
    return 3;
  }
  const Eigen::Vector3d translation = result->T_target_source->translation();
  const Eigen::Quaterniond rotation(result->T_target_source->rotation());
  std::printf("%.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", translation.x(), translation.y(), translation.z(), rotation.x(),
              rotation.y(), rotation.z(), rotation.w());
  return result->verdict.accepted ? 0 : 3;
}
