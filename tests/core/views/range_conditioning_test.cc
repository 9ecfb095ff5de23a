// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The stage against a plain implementation of it (image_conditioning.h), byte by byte, and with the instruction sets
// that OpenCV may choose from. Those are fixed when a process starts, hence the child processes.
#include "core/views/range_conditioning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "core/base/hash.h"
#include "core/base/parallel.h"
#include "core/views/image_conditioning.h"
#include "tests/testing/hummocks.h"
#include "tests/testing/run_command.h"
#include "tests/testing/scenes.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

// Returns at random with the given share, 2 m to 80 m away.
RangeImage RandomRange(int rows, int cols, double share, uint64_t seed) {
  testing::Random random(seed);
  RangeImage image{Image<float>(rows, cols), Image<uint8_t>(rows, cols), Image<int32_t>(rows, cols, -1)};
  for (size_t i = 0; i < image.range.size(); ++i) {
    if (random.Uniform() >= share) continue;
    image.range.pixels[i] = static_cast<float>(random.Uniform(2.0, 80.0));
    image.valid.pixels[i] = 1;
  }
  return image;
}

RangeImage Panorama() {
  const RangeImageOptions options = {.full_sphere = true};
  return *ComputeRangeImage(testing::SmallMotion().source.points, options);
}

template <typename T>
Image<T> Continued(const Image<T>& image, int margin) {
  Image<T> wide(image.rows, image.cols + 2 * margin);
  for (int row = 0; row < wide.rows; ++row) {
    for (int col = 0; col < wide.cols; ++col) {
      wide(row, col) = image(row, (col - margin + image.cols) % image.cols);
    }
  }
  return wide;
}

Image<float> PlainConditionRange(const RangeImage& image, double sigma_px) {
  const int margin = image.range.cols / 2;
  Image<float> wide = Continued(image.range, margin);
  FillHoles(Continued(image.valid, margin), wide);
  GaussianBlur3x3(sigma_px, wide);
  Image<float> result(image.range.rows, image.range.cols);
  for (int row = 0; row < result.rows; ++row) std::copy_n(wide.Row(row) + margin, result.cols, result.Row(row));
  const auto [low, high] = std::minmax_element(result.pixels.begin(), result.pixels.end());
  const float offset = *low;
  const float scale = *high > *low ? 1.0F / (*high - *low) : 0.0F;
  for (float& value : result.pixels) value = (value - offset) * scale;
  return result;
}

uint64_t DigestOf(const void* bytes, size_t size) { return HashOf({static_cast<const char*>(bytes), size}); }

uint64_t DigestOf(const Image<float>& image) {
  return DigestOf(image.pixels.data(), image.pixels.size() * sizeof(float));
}

TEST(ConditionRangeTest, SameBytesAsThePlainImplementation) {
  const RangeImage panorama = Panorama();
  EXPECT_EQ(ConditionRange(panorama, 0.5).pixels, PlainConditionRange(panorama, 0.5).pixels);
  uint64_t seed = 1;
  for (const auto& [rows, cols] : {std::pair(1, 1), {1, 7}, {6, 1}, {16, 32}, {37, 50}, {63, 129}, {360, 720}}) {
    for (const double share : {0.02, 0.3, 1.0}) {
      const RangeImage image = RandomRange(rows, cols, share, ++seed);
      for (const double sigma_px : {0.0, 0.5, 1.3}) {
        EXPECT_EQ(ConditionRange(image, sigma_px).pixels, PlainConditionRange(image, sigma_px).pixels)
            << rows << " x " << cols << ", share " << share << ", sigma " << sigma_px;
      }
    }
  }
}

TEST(ConditionRangeTest, HolesAreFilledAcrossTheSeam) {
  RangeImage image{Image<float>(4, 16, 10.0F), Image<uint8_t>(4, 16, 1), Image<int32_t>(4, 16, 0)};
  image.range(1, 8) = 30.0F;  // so that the values span more than 0
  for (const int col : {0, 1, 14, 15}) {
    for (int row = 0; row < 4; ++row) image.valid(row, col) = 0;
  }
  const Image<float> conditioned = ConditionRange(image, 0.5);
  EXPECT_EQ(conditioned(1, 8), 1.0F);
  for (const int col : {0, 1, 14, 15}) EXPECT_NEAR(conditioned(2, col), 0.0, 1e-6);
}

TEST(ConditionRangeTest, NoReturnAndOneRangeGiveZero) {
  const RangeImage none = RandomRange(8, 12, 0.0, 1);
  EXPECT_EQ(ConditionRange(none, 0.5).pixels, std::vector<float>(96, 0.0F));
  RangeImage one = none;
  one.range(3, 4) = 5.0F;
  one.valid(3, 4) = 1;
  for (const float value : ConditionRange(one, 0.0).pixels) EXPECT_EQ(value, 0.0F);
}

TEST(ConditionRangeTest, SameBytesAtAnyThreadCount) {
  const RangeImage panorama = Panorama();
  const uint64_t expected = DigestOf(PlainConditionRange(panorama, 0.5));
  const int num_threads_before = cv::getNumThreads();
  for (const int num_threads : {1, 2, 4}) {
    cv::setNumThreads(num_threads);
    WithThreadLimit(num_threads, [&] { EXPECT_EQ(DigestOf(ConditionRange(panorama, 0.5)), expected) << num_threads; });
  }
  cv::setNumThreads(num_threads_before);
}

TEST(ConditionRangeTest, LeavesTheSettingsOfOpenCvAlone) {
  const int num_threads = cv::getNumThreads();
  const bool is_optimized = cv::useOptimized();
  ConditionRange(RandomRange(16, 32, 0.5, 7), 0.5);
  EXPECT_EQ(cv::getNumThreads(), num_threads);
  EXPECT_EQ(cv::useOptimized(), is_optimized);
}

struct Digests {
  uint64_t conditioned = 0;
  uint64_t gaussian = 0;  // of cv::GaussianBlur, whose bytes depend on the instruction set
};

Digests ComputeDigests() {
  const RangeImage image = RandomRange(360, 720, 0.3, 99);
  cv::Mat range(360, 720, CV_32F);
  std::copy(image.range.pixels.begin(), image.range.pixels.end(), range.ptr<float>());
  cv::Mat blurred;
  cv::GaussianBlur(range, blurred, {3, 3}, 0.5, 0.5, cv::BORDER_REPLICATE);
  return {DigestOf(ConditionRange(image, 0.5)), DigestOf(blurred.data, blurred.total() * sizeof(float))};
}

// Set in the child processes of the test below, which print their digests and compare nothing.
constexpr char kPrintDigests[] = "CURVEREG_TEST_PRINT_DIGESTS";

Digests DigestsWithout(const std::string& instruction_sets) {
  const testing::TemporaryFolder folder;
  const std::string program = std::filesystem::read_symlink("/proc/self/exe");
  const testing::Finished child =
      testing::RunIn(folder.path(), std::string(kPrintDigests) + "=1 OPENCV_CPU_DISABLE=" + instruction_sets + " '" +
                                        program + "' --gtest_filter=ConditionRangeTest.SameBytesWithAnyInstructionSet");
  EXPECT_EQ(child.status, 0) << child.err;
  const size_t at = child.out.find("digests ");
  Digests digests;
  if (at == std::string::npos) {
    ADD_FAILURE() << child.out << child.err;
    return digests;
  }
  std::istringstream(child.out.substr(at + 8)) >> digests.conditioned >> digests.gaussian;
  return digests;
}

TEST(ConditionRangeTest, SameBytesWithAnyInstructionSet) {
  const Digests here = ComputeDigests();
  if (std::getenv(kPrintDigests) != nullptr) {
    std::cout << "digests " << here.conditioned << " " << here.gaussian << std::endl;
    return;
  }
  std::vector<std::string> sets;
#if defined(__x86_64__)
  sets = {"AVX512-SKX", "AVX512-SKX,AVX2,FMA3", "AVX512-SKX,AVX2,FMA3,FP16,AVX",
          "AVX512-SKX,AVX2,FMA3,FP16,AVX,POPCNT,SSE4.2,SSE4.1,SSSE3"};
#endif
  for (const std::string& without : sets) {
    const Digests digests = DigestsWithout(without);
    EXPECT_EQ(digests.conditioned, here.conditioned) << without;
    // The restriction works: what depends on the instruction set differs.
    if (without.find("FMA3") != std::string::npos && cv::checkHardwareSupport(CV_CPU_AVX2)) {
      EXPECT_NE(digests.gaussian, here.gaussian) << without;
    }
  }
}

}  // namespace
}  // namespace curvereg
