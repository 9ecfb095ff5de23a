#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
#
# OpenCV 4.6: linear filters give other bytes on other processors, with one thread and without OpenCL.
#
# The usual guess: the same library, input and parameters give the same bytes on every x86-64 processor; only the speed
# depends on the instruction set.
# Observed: GaussianBlur, sepFilter2D, filter2D and addWeighted of 64-bit floats differ between a processor with AVX2 and
# FMA3 and one without, for sums of products are fused there and rounded once less. add, multiply, divide and resize do
# not differ. OPENCV_CPU_DISABLE lets one processor stand for both.
#
# Why it matters: range images and bird's-eye views are blurred before key points are sought. Extrema near a threshold
# come and go with the machine, so two ground stations can disagree about one pair of scans, and results cannot be
# compared by digest.
# What to do: compose the filter of functions that round once per pixel (multiply, add), or accept results that depend
# on the processor and never compare them by bytes.
set -euo pipefail

name=libopencv-imgproc-dev pinned=4.6.0+dfsg-12
version=$(dpkg-query -W -f '${Version}' $name 2>/dev/null || echo missing)
echo "$name $version (described: $pinned)"
if [ "$version" = missing ] || { [ "$version" != "$pinned" ] && [ -z "${FINDINGS_ANY_VERSION:-}" ]; }; then
  echo "cannot be shown: $name $pinned is needed" && exit 77
fi
if ! grep -qw avx2 /proc/cpuinfo || ! grep -qw fma /proc/cpuinfo; then
  echo 'cannot be shown: this processor has no AVX2 and FMA3' && exit 77
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cat >show.cc <<'C'
#include <cstdint>
#include <cstdio>
#include <functional>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

static cv::Mat Noise(std::uint64_t seed) {  // 64 x 64 values in [0, 1)
  cv::Mat image(64, 64, CV_64F);
  for (double* value = image.ptr<double>(); value != image.ptr<double>() + image.total(); ++value) {
    seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
    *value = static_cast<double>(seed >> 11) / 9007199254740992.0;
  }
  return image;
}

static void Print(const char* name, const std::function<void(const cv::Mat&, const cv::Mat&, cv::Mat&)>& filter) {
  cv::Mat out;
  filter(Noise(1), Noise(2), out);
  std::uint64_t hash = 14695981039346656037ULL;
  for (const std::uint8_t* byte = out.ptr(); byte != out.ptr() + out.total() * out.elemSize(); ++byte) {
    hash = (hash ^ *byte) * 1099511628211ULL;
  }
  std::printf("%s %016llx\n", name, static_cast<unsigned long long>(hash));
}

int main() {
  cv::setNumThreads(1);
  const cv::Mat kernel = cv::getGaussianKernel(3, 0.5, CV_64F);
  Print("GaussianBlur", [](auto& a, auto&, auto& out) { cv::GaussianBlur(a, out, {3, 3}, 0.5); });
  Print("sepFilter2D", [&](auto& a, auto&, auto& out) { cv::sepFilter2D(a, out, CV_64F, kernel, kernel); });
  Print("filter2D", [&](auto& a, auto&, auto& out) { cv::filter2D(a, out, CV_64F, kernel * kernel.t()); });
  Print("addWeighted", [](auto& a, auto& b, auto& out) { cv::addWeighted(a, 0.3, b, 0.7, 0.1, out); });
  Print("add", [](auto& a, auto& b, auto& out) { cv::add(a, b, out); });
  Print("multiply", [](auto& a, auto& b, auto& out) { cv::multiply(a, b, out, 0.3); });
  Print("divide", [](auto& a, auto& b, auto& out) { cv::divide(a, b, out); });
  Print("resize", [](auto& a, auto&, auto& out) { cv::resize(a, out, {33, 33}, 0, 0, cv::INTER_LINEAR); });
}
C
g++ -O2 -std=c++17 -I/usr/include/opencv4 show.cc -o show -lopencv_imgproc -lopencv_core
./show >with
OPENCV_CPU_DISABLE=AVX2,FMA3,AVX512_SKX,AVX512_COMMON ./show >without 2>/dev/null

echo 'expected by guess: the same bytes with and without AVX2 and FMA3; seen:'
differ='' same=''
while read -r filter one other; do
  if [ "$one" = "$other" ]; then same+=" $filter" verdict=same; else differ+=" $filter" verdict=DIFFERENT; fi
  printf '  %-14s %s %s %s\n' "$filter" "$one" "$other" "$verdict"
done < <(join with <(cat without) --nocheck-order)
if [ "$differ" = ' GaussianBlur sepFilter2D filter2D addWeighted' ] && [ "$same" = ' add multiply divide resize' ]; then
  echo 'as described' && exit 0
fi
echo 'not as described' && exit 1
