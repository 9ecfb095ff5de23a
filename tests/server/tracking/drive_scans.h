// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Small scans of a drive, as a stream brings them.
#ifndef CURVEREG_TESTS_SERVER_TRACKING_DRIVE_SCANS_H_
#define CURVEREG_TESTS_SERVER_TRACKING_DRIVE_SCANS_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <thread>

#include "core/scan/scan.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "tests/server/store/store_testing.h"
#include "tests/testing/scenes.h"
#include "wire/point_codec.h"

namespace curvereg::server {

// Where the rover of a drive stands for its scan `number`: 0.8 m apart on a bend.
inline RigidTransform DrivePose(int number) {
  return testing::RoverPose(0.8 * number, 0.02 * number * number, 0.05 * number);
}

// Encoded; `drive` tells drives over the same ground apart by their noise.
inline v1::PointCloud DriveCloud(int number, uint64_t drive = 0) {
  const Scan scan =
      testing::BumpyGround(DrivePose(number), {.num_columns = 360,
                                               .num_rows = 40,
                                               .max_range_m = 20.0,
                                               .noise_seed = 1000 * drive + static_cast<uint64_t>(number)});
  return *wire::EncodeScan(scan);
}

inline v1::StreamedScanHeader StreamedHeader(uint64_t sequence_number, const v1::PointCloud& cloud) {
  v1::StreamedScanHeader header;
  header.set_sequence_number(sequence_number);
  *header.mutable_header() = cloud.header();
  header.set_payload_bytes(cloud.data().size());
  *header.mutable_payload_digest() = DigestOf(cloud.data());
  return header;
}

// Asks every few milliseconds; false after a minute.
inline bool BecomesTrue(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return true;
}

}  // namespace curvereg::server

#endif  // CURVEREG_TESTS_SERVER_TRACKING_DRIVE_SCANS_H_
