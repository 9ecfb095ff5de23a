// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/views/image_conditioning.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/base/small_matrices.h"

namespace curvereg {
namespace {

struct PyramidLevel {
  Image<float> values;
  Image<float> weights;  // 0 where nothing is known, up to 1
};

PyramidLevel Halved(const PyramidLevel& fine) {
  PyramidLevel coarse;
  const int rows = (fine.values.rows + 1) / 2;
  const int cols = (fine.values.cols + 1) / 2;
  coarse.values = Image<float>(rows, cols);
  coarse.weights = Image<float>(rows, cols);
  for (int row = 0; row < rows; ++row) {
    const int row1 = std::min(2 * row + 1, fine.values.rows - 1);
    for (int col = 0; col < cols; ++col) {
      const int col1 = std::min(2 * col + 1, fine.values.cols - 1);
      const float w00 = fine.weights(2 * row, 2 * col), w01 = fine.weights(2 * row, col1);
      const float w10 = fine.weights(row1, 2 * col), w11 = fine.weights(row1, col1);
      const float weight = w00 + w01 + w10 + w11;
      if (weight <= 0.0F) continue;
      coarse.values(row, col) = (w00 * fine.values(2 * row, 2 * col) + w01 * fine.values(2 * row, col1) +
                                 w10 * fine.values(row1, 2 * col) + w11 * fine.values(row1, col1)) /
                                weight;
      coarse.weights(row, col) = std::min(1.0F, weight);
    }
  }
  return coarse;
}

// Blends the coarser level, bilinearly interpolated, into the pixels of low weight.
void PullInto(const PyramidLevel& coarse, PyramidLevel& fine) {
  const int last_row = coarse.values.rows - 1;
  const int last_col = coarse.values.cols - 1;
  for (int row = 0; row < fine.values.rows; ++row) {
    const int r0 = row / 2;
    const int r1 = std::clamp(r0 + ((row & 1) != 0 ? 1 : -1), 0, last_row);
    for (int col = 0; col < fine.values.cols; ++col) {
      float& weight = fine.weights(row, col);
      if (weight >= 1.0F) continue;
      const int c0 = col / 2;
      const int c1 = std::clamp(c0 + ((col & 1) != 0 ? 1 : -1), 0, last_col);
      const float coarse_value = 0.5625F * coarse.values(r0, c0) +
                                 0.1875F * (coarse.values(r0, c1) + coarse.values(r1, c0)) +
                                 0.0625F * coarse.values(r1, c1);
      fine.values(row, col) = weight * fine.values(row, col) + (1.0F - weight) * coarse_value;
      weight = 1.0F;
    }
  }
}

}  // namespace

void FillHoles(const Image<uint8_t>& valid, Image<float>& image) {
  std::vector<PyramidLevel> levels(1);
  levels[0].weights = Image<float>(image.rows, image.cols);
  std::copy(valid.pixels.begin(), valid.pixels.end(), levels[0].weights.pixels.begin());
  levels[0].values = std::move(image);
  for (size_t i = 0; i < valid.size(); ++i) {
    if (valid.pixels[i] == 0) levels[0].values.pixels[i] = 0.0F;  // may be NaN, which weight 0 would not silence
  }
  while (levels.back().values.size() > 1) levels.push_back(Halved(levels.back()));
  if (levels.back().values.empty() || levels.back().weights.pixels[0] == 0.0F) {
    image = Image<float>(levels[0].values.rows, levels[0].values.cols);
    return;
  }
  for (size_t level = levels.size() - 1; level > 0; --level) PullInto(levels[level], levels[level - 1]);
  image = std::move(levels[0].values);
}

void RemoveSpikes(int radius, float max_deviation, const Image<float>& image, Image<uint8_t>& valid) {
  const Image<uint8_t> before = valid;
  std::vector<float> window;
  for (int row = 0; row < image.rows; ++row) {
    for (int col = 0; col < image.cols; ++col) {
      if (before(row, col) == 0) continue;
      window.clear();
      for (int r = std::max(0, row - radius); r <= std::min(image.rows - 1, row + radius); ++r) {
        for (int c = std::max(0, col - radius); c <= std::min(image.cols - 1, col + radius); ++c) {
          if (before(r, c) != 0) window.push_back(image(r, c));
        }
      }
      const auto middle = window.begin() + static_cast<std::ptrdiff_t>(window.size() / 2);
      std::nth_element(window.begin(), middle, window.end());
      if (window.size() < 3 || std::abs(image(row, col) - *middle) > max_deviation) valid(row, col) = 0;
    }
  }
}

void GaussianBlur3x3(double sigma_px, Image<float>& image) {
  if (sigma_px <= 0.0 || image.empty()) return;
  const double side = std::exp(-0.5 / (sigma_px * sigma_px));
  const auto centre_weight = static_cast<float>(1.0 / (1.0 + 2.0 * side));
  const auto side_weight = static_cast<float>(side / (1.0 + 2.0 * side));
  const auto cols = static_cast<size_t>(image.cols);
  Image<float> horizontal(image.rows, image.cols);
  for (int row = 0; row < image.rows; ++row) {
    const float* in = image.Row(row);
    float* out = horizontal.Row(row);
    for (size_t col = 0; col < cols; ++col) {
      const float left = in[col == 0 ? 0 : col - 1];
      const float right = in[col + 1 == cols ? col : col + 1];
      out[col] = centre_weight * in[col] + side_weight * (left + right);
    }
  }
  for (int row = 0; row < image.rows; ++row) {
    const float* above = horizontal.Row(std::max(row - 1, 0));
    const float* here = horizontal.Row(row);
    const float* below = horizontal.Row(std::min(row + 1, image.rows - 1));
    float* out = image.Row(row);
    for (size_t col = 0; col < cols; ++col)
      out[col] = centre_weight * here[col] + side_weight * (above[col] + below[col]);
  }
}

void Detrend(const Image<uint8_t>& valid, Image<float>& image) {
  // Normal equations about the image centre, one row at a time to keep the sums exact enough.
  Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  for (int row = 0; row < image.rows; ++row) {
    const double v = row - 0.5 * image.rows;
    double n = 0.0, su = 0.0, suu = 0.0, sz = 0.0, suz = 0.0;
    for (int col = 0; col < image.cols; ++col) {
      if (valid(row, col) == 0) continue;
      const double u = col - 0.5 * image.cols;
      const double z = image(row, col);
      n += 1.0;
      su += u;
      suu += u * u;
      sz += z;
      suz += u * z;
    }
    Eigen::Matrix3d row_A;
    row_A << n, v * n, su, v * n, v * v * n, v * su, su, v * su, suu;
    A += row_A;
    b += Eigen::Vector3d(sz, v * sz, suz);
  }
  if (A(0, 0) < 3.0) return;
  A.diagonal().array() += 1e-9 * A.trace();  // a line of valid pixels leaves a slope undetermined: take it as 0
  const Eigen::Vector3d plane = SolveSymmetric(A, b);
  for (int row = 0; row < image.rows; ++row) {
    const double at_row = plane[0] + plane[1] * (row - 0.5 * image.rows);
    for (int col = 0; col < image.cols; ++col) {
      image(row, col) -= static_cast<float>(at_row + plane[2] * (col - 0.5 * image.cols));
    }
  }
}

void Apodize(int width_px, Image<float>& image) {
  const auto window = [width_px](int index, int size) {
    const int distance = std::min(index, size - 1 - index);
    if (distance >= width_px) return 1.0F;
    return static_cast<float>(0.5 - 0.5 * std::cos(std::numbers::pi * distance / width_px));
  };
  std::vector<float> col_window(static_cast<size_t>(image.cols));
  for (int col = 0; col < image.cols; ++col) col_window[static_cast<size_t>(col)] = window(col, image.cols);
  for (int row = 0; row < image.rows; ++row) {
    const float row_weight = window(row, image.rows);
    for (int col = 0; col < image.cols; ++col) image(row, col) *= row_weight * col_window[static_cast<size_t>(col)];
  }
}

Image<float> ValidFraction(const Image<uint8_t>& valid, int radius) {
  Image<int> sums(valid.rows + 1, valid.cols + 1);  // integral image
  for (int row = 0; row < valid.rows; ++row) {
    int row_sum = 0;
    for (int col = 0; col < valid.cols; ++col) {
      row_sum += valid(row, col);
      sums(row + 1, col + 1) = sums(row, col + 1) + row_sum;
    }
  }
  Image<float> share(valid.rows, valid.cols);
  for (int row = 0; row < valid.rows; ++row) {
    const int r0 = std::max(row - radius, 0);
    const int r1 = std::min(row + radius + 1, valid.rows);
    for (int col = 0; col < valid.cols; ++col) {
      const int c0 = std::max(col - radius, 0);
      const int c1 = std::min(col + radius + 1, valid.cols);
      const int count = sums(r1, c1) - sums(r0, c1) - sums(r1, c0) + sums(r0, c0);
      share(row, col) = static_cast<float>(count) / static_cast<float>((r1 - r0) * (c1 - c0));
    }
  }
  return share;
}

}  // namespace curvereg
