#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# FLANN 1.9.2: randomised kd-trees cannot be seeded.
#
# The usual guess: flann::seed_random(seed) before building the index makes the approximate neighbours reproducible.
# Observed: the index shuffles its points with a generator that it seeds from std::random_device. The same program on the
# same data returns other neighbours in every run, whatever the seed.
#
# Why it matters: descriptor matches of two scans, and everything computed from them (RANSAC inliers, the pose), change from
# run to run although every random generator of the program is seeded. A failure on one pair of scans cannot be reproduced.
# What to do: use KDTreeSingleIndexParams, which draws no random numbers, or exhaustive search (33 or 128 dimensions are
# too many for a tree to save much).
set -euo pipefail

name=libflann-dev pinned=1.9.2+dfsg-1+deb12u1
version=$(dpkg-query -W -f '${Version}' $name 2>/dev/null || echo missing)
echo "$name $version (described: $pinned)"
if [ "$version" = missing ] || { [ "$version" != "$pinned" ] && [ -z "${FINDINGS_ANY_VERSION:-}" ]; }; then
  echo "cannot be shown: $name $pinned is needed" && exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cat >show.cc <<'C'
// show INDEX: prints the nearest neighbour found for each of 500 descriptors among 2000, all of fixed values.
#include <cstdio>
#include <cstring>
#include <flann/flann.hpp>
#include <vector>

int main(int, char** argv) {
  constexpr int kDimensions = 33;  // of FPFH
  constexpr int kTrained = 2000, kAsked = 500;
  std::vector<float> trained(kTrained * kDimensions), asked(kAsked * kDimensions);
  unsigned state = 7;
  for (std::vector<float>* values : {&trained, &asked}) {
    for (float& value : *values) value = static_cast<float>((state = state * 1664525u + 1013904223u) >> 8) / 16777216.0f;
  }
  flann::seed_random(42);
  const flann::Matrix<float> data(trained.data(), kTrained, kDimensions);
  const flann::IndexParams params = std::strcmp(argv[1], "randomised") == 0
                                        ? flann::IndexParams(flann::KDTreeIndexParams(4))
                                        : flann::IndexParams(flann::KDTreeSingleIndexParams());
  flann::Index<flann::L2<float>> index(data, params);
  index.buildIndex();
  std::vector<int> found(kAsked);
  std::vector<float> distances(kAsked);
  flann::Matrix<int> indices(found.data(), kAsked, 1);
  flann::Matrix<float> squared(distances.data(), kAsked, 1);
  flann::SearchParams search(32);  // FLANN's default number of leaves to check
  search.cores = 1;
  index.knnSearch(flann::Matrix<float>(asked.data(), kAsked, kDimensions), indices, squared, 1, search);
  for (const int neighbour : found) std::printf("%d\n", neighbour);
}
C
g++ -std=c++17 -O1 show.cc -llz4 -o show
for index in randomised single; do
  for run in 1 2 3; do ./show $index >"$index.$run"; done
done
different() { paste "$1.$2" "$1.$3" | awk '$1 != $2 { n++ } END { print n + 0 }'; }
echo "flann::seed_random(42), same data, neighbours of 500 descriptors that differ between runs of the same program:"
echo "  KDTreeIndex (randomised): runs 1 and 2: $(different randomised 1 2), runs 1 and 3: $(different randomised 1 3)"
echo "  KDTreeSingleIndex:        runs 1 and 2: $(different single 1 2), runs 1 and 3: $(different single 1 3)"
if [ "$(different randomised 1 2)" -gt 0 ] && [ "$(different randomised 1 3)" -gt 0 ] &&
  [ "$(different single 1 2)$(different single 1 3)" = 00 ]; then
  echo 'as described'
else
  echo 'NOT as described' && exit 1
fi
