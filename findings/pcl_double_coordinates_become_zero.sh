#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# PCL 1.13.0: a cloud whose x, y and z are doubles becomes points at the origin, and ICP accepts them.
#
# The usual guess: pcl::fromPCLPointCloud2 (on which ROS's pcl_conversions relies) converts FLOAT64 coordinates to the floats of
# pcl::PointXYZ, or fails.
# Observed: fields match only if their type is the same. The cloud gets the right number of points, is_dense stays true,
# and all coordinates are 0. The function returns nothing; the only sign is a warning on standard error. ICP of two such
# clouds reports hasConverged() == true and a fitness score of 0, the best possible.
#
# Why it matters: doubles are valid in PointCloud2 and PCD, and common for georeferenced scans. A registration that checks
# hasConverged() and getFitnessScore() accepts the identity for any two such scans.
# What to do: check the datatype of x, y and z in the message's fields, and convert doubles (minus a local origin) yourself.
set -euo pipefail

name=libpcl-dev pinned=1.13.0+dfsg-3
version=$(dpkg-query -W -f '${Version}' $name 2>/dev/null || echo missing)
echo "$name $version (described: $pinned)"
if [ "$version" = missing ] || { [ "$version" != "$pinned" ] && [ -z "${FINDINGS_ANY_VERSION:-}" ]; }; then
  echo "cannot be shown: $name $pinned is needed" && exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cat >show.cc <<'C'
#include <cstdio>
#include <cstring>
#include <string>

#include <pcl/conversions.h>
#include <pcl/point_types.h>
#include <pcl/registration/icp.h>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

constexpr int kNumPoints = 1000;

// 1000 points in a cube of 10 m, moved by `shift_x`, as a message with coordinates of type Number.
template <typename Number>
pcl::PCLPointCloud2 Message(double shift_x) {
  pcl::PCLPointCloud2 message;
  message.height = 1;
  message.width = kNumPoints;
  message.point_step = 3 * sizeof(Number);
  message.row_step = message.point_step * kNumPoints;
  message.is_dense = true;
  message.data.resize(message.row_step);
  for (int axis = 0; axis < 3; ++axis) {
    pcl::PCLPointField field;
    field.name = std::string(1, "xyz"[axis]);
    field.offset = axis * sizeof(Number);
    field.datatype = sizeof(Number) == 8 ? pcl::PCLPointField::FLOAT64 : pcl::PCLPointField::FLOAT32;
    field.count = 1;
    message.fields.push_back(field);
  }
  unsigned state = 1;
  for (int i = 0; i < 3 * kNumPoints; ++i) {
    state = state * 1664525u + 1013904223u;
    const Number value = static_cast<Number>(10.0 * (state >> 8) / 16777216.0 + (i % 3 == 0 ? shift_x : 0.0));
    std::memcpy(&message.data[i * sizeof(Number)], &value, sizeof(Number));
  }
  return message;
}

struct Outcome {
  int num_points, num_zero;
  bool converged;
  double fitness, shift_x;
};

template <typename Number>
Outcome Register() {
  const Cloud::Ptr source(new Cloud), target(new Cloud);
  pcl::fromPCLPointCloud2(Message<Number>(0.0), *source);
  pcl::fromPCLPointCloud2(Message<Number>(0.3), *target);
  Outcome outcome{};
  outcome.num_points = static_cast<int>(source->size());
  for (const pcl::PointXYZ& p : *source) outcome.num_zero += p.x == 0.0f && p.y == 0.0f && p.z == 0.0f;
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(source);
  icp.setInputTarget(target);
  icp.setMaximumIterations(100);
  Cloud aligned;
  icp.align(aligned);
  outcome.converged = icp.hasConverged();
  outcome.fitness = icp.getFitnessScore();
  outcome.shift_x = icp.getFinalTransformation()(0, 3);
  std::printf("%s: %d points, %d of them at the origin; ICP: converged %d, fitness score %.2g, shift %.3f m (true: 0.300)\n",
              sizeof(Number) == 8 ? "FLOAT64" : "FLOAT32", outcome.num_points, outcome.num_zero, outcome.converged,
              outcome.fitness, outcome.shift_x);
  return outcome;
}

int main() {
  const Outcome floats = Register<float>();
  const Outcome doubles = Register<double>();
  const bool floats_are_right = floats.num_zero == 0 && floats.converged && floats.shift_x > 0.29 && floats.shift_x < 0.31;
  return floats_are_right && doubles.num_points == kNumPoints && doubles.num_zero == kNumPoints && doubles.converged &&
                 doubles.fitness == 0.0
             ? 0
             : 1;
}
C
g++ -std=c++17 -O1 show.cc -isystem /usr/include/eigen3 -isystem /usr/include/pcl-1.13 \
  -lpcl_registration -lpcl_search -lpcl_kdtree -lpcl_common -llz4 -o show
if ./show 2>warnings; then
  echo "standard error: $(sort warnings | uniq -c | tr -s ' \n' ' ')"
  echo 'as described'
else
  echo 'NOT as described' && exit 1
fi
