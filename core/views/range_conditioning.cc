// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/views/range_conditioning.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace curvereg {
namespace {

// Every function of OpenCV called here copies, compares, or rounds one sum, product or quotient per pixel. Those that
// combine two of them (addWeighted, filters, matrix expressions of several terms) fuse them where the processor can.

struct PyramidLevel {
  cv::Mat values;   // CV_32F
  cv::Mat weights;  // CV_32F: 0 where nothing is known, up to 1
};

// Sum over each block of 2 x 2 pixels: ((upper left + upper right) + lower left) + lower right. Precondition: even
// sides.
cv::Mat BlockSums(const cv::Mat& image) {
  const cv::Mat columns_as_channels = image.reshape(2);
  cv::Mat left, right;
  cv::extractChannel(columns_as_channels, left, 0);
  cv::extractChannel(columns_as_channels, right, 1);
  const auto every_second_row = [](const cv::Mat& of, int first) {
    return cv::Mat(of.rows / 2, of.cols, of.type(), const_cast<uchar*>(of.ptr(first)), 2 * of.step);
  };
  cv::Mat sums;
  cv::add(every_second_row(left, 0), every_second_row(right, 0), sums);
  cv::add(sums, every_second_row(left, 1), sums);
  cv::add(sums, every_second_row(right, 1), sums);
  return sums;
}

// Half the size: the weighted mean of each block. At an odd border the last row or column counts twice.
PyramidLevel Halved(const PyramidLevel& fine) {
  const int more_rows = fine.values.rows % 2;
  const int more_cols = fine.values.cols % 2;
  PyramidLevel even;
  cv::copyMakeBorder(fine.values, even.values, 0, more_rows, 0, more_cols, cv::BORDER_REPLICATE);
  cv::copyMakeBorder(fine.weights, even.weights, 0, more_rows, 0, more_cols, cv::BORDER_REPLICATE);
  cv::multiply(even.values, even.weights, even.values);
  PyramidLevel coarse;
  coarse.weights = BlockSums(even.weights);
  cv::divide(BlockSums(even.values), coarse.weights, coarse.values);
  coarse.values.setTo(0.0F, coarse.weights <= 0.0F);  // 0 / 0
  cv::min(coarse.weights, 1.0F, coarse.weights);
  return coarse;
}

// At twice the size, bilinear between pixel centres: 9/16 of the pixel that is halved, 3/16 of its two neighbours on
// the side of the new pixel, 1/16 of the diagonal one. Borders replicated.
cv::Mat Doubled(const cv::Mat& coarse) {
  cv::Mat bordered;
  cv::copyMakeBorder(coarse, bordered, 1, 1, 1, 1, cv::BORDER_REPLICATE);
  const auto shifted = [&](int down, int right) {
    return bordered(cv::Rect(1 + right, 1 + down, coarse.cols, coarse.rows));
  };
  cv::Mat fine(2 * coarse.rows, 2 * coarse.cols, CV_32F);
  cv::Mat sides, diagonal;
  for (const int down : {-1, 1}) {
    std::vector<cv::Mat> columns(2);
    for (const int right : {-1, 1}) {
      cv::Mat& sum = columns[right < 0 ? 0 : 1];
      cv::add(shifted(0, right), shifted(down, 0), sides);
      cv::multiply(sides, 0.1875F, sides);
      cv::multiply(shifted(down, right), 0.0625F, diagonal);
      cv::multiply(coarse, 0.5625F, sum);
      cv::add(sum, sides, sum);
      cv::add(sum, diagonal, sum);
    }
    cv::Mat interleaved;
    cv::merge(columns, interleaved);
    cv::Mat rows(coarse.rows, fine.cols, CV_32F, fine.ptr(down < 0 ? 0 : 1), 2 * fine.step);
    interleaved.reshape(1).copyTo(rows);
  }
  return fine;
}

// Blends the coarser image into the pixels of weight below 1.
void PullInto(const cv::Mat& coarse, PyramidLevel& fine) {
  cv::Mat blended, rest;
  cv::subtract(1.0F, fine.weights, rest);
  cv::multiply(rest, Doubled(coarse)(cv::Rect(0, 0, fine.values.cols, fine.values.rows)), rest);
  cv::multiply(fine.weights, fine.values, blended);
  cv::add(blended, rest, blended);
  blended.copyTo(fine.values, fine.weights < 1.0F);
}

// Precondition: values are 0 where `weights` is 0.
cv::Mat WithHolesFilled(cv::Mat values, cv::Mat weights) {
  std::vector<PyramidLevel> levels = {{std::move(values), std::move(weights)}};
  while (levels.back().values.total() > 1) levels.push_back(Halved(levels.back()));
  for (size_t level = levels.size() - 1; level > 0; --level) PullInto(levels[level].values, levels[level - 1]);
  return levels.front().values;
}

// side * (before + after) + centre * pixel, along columns or along rows.
cv::Mat Smoothed(const cv::Mat& image, bool along_columns, float centre_weight, float side_weight) {
  const int down = along_columns ? 1 : 0;
  const int right = 1 - down;
  cv::Mat bordered, sides, centre;
  cv::copyMakeBorder(image, bordered, down, down, right, right, cv::BORDER_REPLICATE);
  cv::add(bordered(cv::Rect(0, 0, image.cols, image.rows)),
          bordered(cv::Rect(2 * right, 2 * down, image.cols, image.rows)), sides);
  cv::multiply(sides, side_weight, sides);
  cv::multiply(image, centre_weight, centre);
  cv::add(centre, sides, centre);
  return centre;
}

cv::Mat Gaussian3x3(const cv::Mat& image, double sigma_px) {
  if (sigma_px <= 0.0) return image;
  const cv::Mat kernel = cv::getGaussianKernel(3, sigma_px, CV_64F);
  const auto centre = static_cast<float>(kernel.at<double>(1));
  const auto side = static_cast<float>(kernel.at<double>(0));
  return Smoothed(Smoothed(image, false, centre, side), true, centre, side);
}

// Maps the least value to 0 and the greatest to 1.
void Normalise(const cv::Mat& image, cv::Mat& normalised) {
  double low = 0.0, high = 0.0;
  cv::minMaxLoc(image, &low, &high);
  const auto offset = static_cast<float>(low);
  const auto top = static_cast<float>(high);
  cv::subtract(image, offset, normalised);
  cv::multiply(normalised, top > offset ? 1.0F / (top - offset) : 0.0F, normalised);
}

}  // namespace

Image<float> ConditionRange(const RangeImage& image, double sigma_px) {
  const int rows = image.range.rows;
  const int cols = image.range.cols;
  const int margin = cols / 2;  // as wide as the holes are: half the sky
  const cv::Mat range(rows, cols, CV_32F, const_cast<float*>(image.range.pixels.data()));
  const cv::Mat valid(rows, cols, CV_8U, const_cast<uint8_t*>(image.valid.pixels.data()));
  cv::Mat values, weights;
  cv::copyMakeBorder(range, values, 0, 0, margin, margin, cv::BORDER_WRAP);
  cv::copyMakeBorder(valid, weights, 0, 0, margin, margin, cv::BORDER_WRAP);
  values.setTo(0.0F, weights == 0);
  weights.convertTo(weights, CV_32F);
  const cv::Mat smooth = Gaussian3x3(WithHolesFilled(values, weights), sigma_px);
  Image<float> conditioned(rows, cols);
  cv::Mat out(rows, cols, CV_32F, conditioned.pixels.data());
  Normalise(smooth(cv::Rect(margin, 0, cols, rows)), out);
  return conditioned;
}

}  // namespace curvereg
