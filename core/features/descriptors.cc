// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/features/descriptors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/base/simd.h"

namespace curvereg {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kWindow = 16;     // samples per side
constexpr int kCells = 4;       // histogram cells per side
constexpr int kDirections = 8;  // bins per cell
constexpr int kOrientationBins = 36;
constexpr float kClamp = 0.2F;  // limits the weight of single strong edges [Lowe 2004, section 6.1]

// Gradient of one image in polar form: direction as a fraction of the full turn in [0, 1).
struct GradientImage {
  Image<float> magnitude;
  Image<float> turn;
};

// atan2 / (2 pi) mapped to [0, 1); polynomial, largest error 1e-5 turns, far below a bin. Vectorises.
inline float TurnOf(float y, float x) {
  const float ax = std::abs(x);
  const float ay = std::abs(y);
  const float high = std::max(ax, ay);
  const float q = std::min(ax, ay) / (high > 0.0F ? high : 1.0F);
  const float q2 = q * q;
  const float octant =
      q * (0.15915494F +
           q2 * (-0.05297858F + q2 * (0.03103654F + q2 * (-0.01868925F + q2 * (0.00833650F - q2 * 0.00186006F)))));
  const float quadrant = ay > ax ? 0.25F - octant : octant;
  const float half = x < 0.0F ? 0.5F - quadrant : quadrant;
  const float turn = y < 0.0F ? 1.0F - half : half;
  return turn >= 1.0F ? 0.0F : turn;
}

CURVEREG_DISPATCH void GradientRow(const float* above, const float* here, const float* below, int cols,
                                   float* magnitude, float* turn) {
  for (int col = 1; col < cols - 1; ++col) {
    const float dx = here[col + 1] - here[col - 1];
    const float dy = below[col] - above[col];
    magnitude[col] = std::sqrt(dx * dx + dy * dy);
    turn[col] = TurnOf(dy, dx);
  }
}

GradientImage ComputeGradient(const Image<float>& image) {
  GradientImage gradient{Image<float>(image.rows, image.cols), Image<float>(image.rows, image.cols)};
  for (int row = 1; row < image.rows - 1; ++row) {
    GradientRow(image.Row(row - 1), image.Row(row), image.Row(row + 1), image.cols, gradient.magnitude.Row(row),
                gradient.turn.Row(row));
  }
  return gradient;
}

// Where each sample of the window lies before turning, and how much it adds to each of up to four histogram cells.
struct WindowSample {
  float u, v;  // [steps] from the key point, along col and row
  std::array<int, 4> cells;
  std::array<float, 4> weights;
};

std::array<WindowSample, kWindow * kWindow> MakeWindow() {
  std::array<WindowSample, kWindow * kWindow> window{};
  for (int i = 0; i < kWindow; ++i) {
    for (int j = 0; j < kWindow; ++j) {
      WindowSample& sample = window[static_cast<size_t>(i * kWindow + j)];
      sample.u = static_cast<float>(j) - 7.5F;
      sample.v = static_cast<float>(i) - 7.5F;
      const float gauss = std::exp(-(sample.u * sample.u + sample.v * sample.v) / (2.0F * 8.0F * 8.0F));
      const float x = (sample.u + 8.0F) / 4.0F - 0.5F;  // position among cell centres
      const float y = (sample.v + 8.0F) / 4.0F - 0.5F;
      const int x0 = static_cast<int>(std::floor(x));
      const int y0 = static_cast<int>(std::floor(y));
      for (int k = 0; k < 4; ++k) {
        const int cx = x0 + (k & 1);
        const int cy = y0 + (k >> 1);
        const float wx = 1.0F - std::abs(x - static_cast<float>(cx));
        const float wy = 1.0F - std::abs(y - static_cast<float>(cy));
        const bool inside = cx >= 0 && cx < kCells && cy >= 0 && cy < kCells;
        sample.cells[static_cast<size_t>(k)] = inside ? cy * kCells + cx : 0;
        sample.weights[static_cast<size_t>(k)] = inside ? gauss * wx * wy : 0.0F;
      }
    }
  }
  return window;
}

using Window = std::array<WindowSample, kWindow * kWindow>;

using OrientationHistogram = std::array<float, kOrientationBins>;

// Gradient directions about the key point, weighted by magnitude and a Gaussian of half the window's radius
// [Lowe 2004, section 5].
OrientationHistogram HistogramAbout(const GradientImage& gradient, const Keypoint& keypoint,
                                    const DescriptorOptions& options) {
  constexpr float kRadius = 8.0F;  // in steps, as the descriptor's window
  const auto step = static_cast<float>(options.step_px);
  const int radius = static_cast<int>(std::ceil(kRadius * step));
  const float sigma = 0.5F * kRadius * step;
  const float falloff = -1.0F / (2.0F * sigma * sigma);
  const int row0 = static_cast<int>(std::lround(keypoint.row));
  const int col0 = static_cast<int>(std::lround(keypoint.col));
  OrientationHistogram histogram{};
  for (int row = std::max(0, row0 - radius); row <= std::min(gradient.turn.rows - 1, row0 + radius); ++row) {
    const auto dy = static_cast<float>(row) - keypoint.row;
    const float row_weight = std::exp(falloff * dy * dy);
    const float* magnitude = gradient.magnitude.Row(row);
    const float* turn = gradient.turn.Row(row);
    for (int col = std::max(0, col0 - radius); col <= std::min(gradient.turn.cols - 1, col0 + radius); ++col) {
      const auto dx = static_cast<float>(col) - keypoint.col;
      const float squared = falloff * dx * dx;
      if (squared + falloff * dy * dy < -2.0F) continue;  // outside the circle of two sigma
      // exp(x) near enough for a weight: (1 + x/16)^16 by squaring.
      float weight = 1.0F + squared * (1.0F / 16.0F);
      weight *= weight;
      weight *= weight;
      weight *= weight;
      weight *= weight;
      const int bin = std::min(static_cast<int>(turn[col] * kOrientationBins), kOrientationBins - 1);
      histogram[static_cast<size_t>(bin)] += row_weight * weight * magnitude[col];
    }
  }
  return histogram;
}

// Binomial smoothing around the circle, twice.
void Smooth(OrientationHistogram& histogram) {
  for (int pass = 0; pass < 2; ++pass) {
    OrientationHistogram smooth{};
    for (size_t i = 0; i < kOrientationBins; ++i) {
      smooth[i] = 0.25F * histogram[(i + kOrientationBins - 1) % kOrientationBins] + 0.5F * histogram[i] +
                  0.25F * histogram[(i + 1) % kOrientationBins];
    }
    histogram = smooth;
  }
}

struct OrientationPeak {
  float value, turn;
};

// Local maxima, highest first, refined by a parabola through each and its neighbours. Empty when all bins are zero.
std::vector<OrientationPeak> PeaksOf(const OrientationHistogram& histogram, double second_peak_share) {
  const float strongest = *std::max_element(histogram.begin(), histogram.end());
  if (!(strongest > 0.0F)) return {};
  std::vector<OrientationPeak> peaks;
  for (size_t i = 0; i < kOrientationBins; ++i) {
    const float before = histogram[(i + kOrientationBins - 1) % kOrientationBins];
    const float after = histogram[(i + 1) % kOrientationBins];
    const float value = histogram[i];
    if (value <= before || value < after || value < second_peak_share * strongest) continue;
    const float offset = 0.5F * (before - after) / (before - 2.0F * value + after);
    const float turn = (static_cast<float>(i) + 0.5F + offset) / kOrientationBins;
    peaks.push_back({value, turn - std::floor(turn)});
  }
  std::stable_sort(peaks.begin(), peaks.end(),
                   [](const OrientationPeak& a, const OrientationPeak& b) { return a.value > b.value; });
  return peaks;
}

// Dominant gradient directions, in turns.
std::vector<float> DominantTurns(const GradientImage& gradient, const Keypoint& keypoint,
                                 const DescriptorOptions& options) {
  OrientationHistogram histogram = HistogramAbout(gradient, keypoint, options);
  Smooth(histogram);
  const std::vector<OrientationPeak> peaks = PeaksOf(histogram, options.second_peak_share);
  std::vector<float> turns;
  for (size_t i = 0; i < std::min(peaks.size(), static_cast<size_t>(options.max_orientations)); ++i) {
    turns.push_back(peaks[i].turn);
  }
  return turns;
}

void NormaliseDescriptor(float* descriptor) {
  for (int pass = 0; pass < 2; ++pass) {
    float squared = 0.0F;
    for (int i = 0; i < kDescriptorSize; ++i) squared += descriptor[i] * descriptor[i];
    const float scale = 1.0F / std::sqrt(std::max(squared, 1e-30F));
    for (int i = 0; i < kDescriptorSize; ++i) {
      descriptor[i] *= scale;
      if (pass == 0) descriptor[i] = std::min(descriptor[i], kClamp);
    }
  }
}

void Describe(const GradientImage& gradient, const Keypoint& keypoint, float turn, float step, const Window& window,
              float* descriptor) {
  std::fill_n(descriptor, kDescriptorSize, 0.0F);
  const float cosine = step * std::cos(2.0F * kPi * turn);
  const float sine = step * std::sin(2.0F * kPi * turn);
  const int rows = gradient.turn.rows;
  const int cols = gradient.turn.cols;
  for (const WindowSample& sample : window) {
    const int col = static_cast<int>(std::floor(keypoint.col + cosine * sample.u - sine * sample.v + 0.5F));
    const int row = static_cast<int>(std::floor(keypoint.row + sine * sample.u + cosine * sample.v + 0.5F));
    if (col < 0 || col >= cols || row < 0 || row >= rows) continue;
    const size_t pixel = gradient.turn.Index(row, col);
    float direction = (gradient.turn.pixels[pixel] - turn) * kDirections;
    if (direction < 0.0F) direction += kDirections;
    const int whole = static_cast<int>(direction);
    const float share = direction - static_cast<float>(whole);
    const int bin0 = whole & (kDirections - 1);
    const int bin1 = (whole + 1) & (kDirections - 1);
    const float magnitude = gradient.magnitude.pixels[pixel];
    const float value0 = magnitude * (1.0F - share);
    const float value1 = magnitude * share;
    for (size_t k = 0; k < 4; ++k) {
      float* cell = descriptor + sample.cells[k] * kDirections;
      cell[bin0] += sample.weights[k] * value0;
      cell[bin1] += sample.weights[k] * value1;
    }
  }
  NormaliseDescriptor(descriptor);
}

}  // namespace

Features DescribeKeypoints(const std::vector<Image<float>>& images, const std::vector<Keypoint>& keypoints,
                           const DescriptorOptions& options) {
  std::vector<bool> used(images.size(), false);
  for (const Keypoint& keypoint : keypoints) used[static_cast<size_t>(keypoint.level)] = true;
  std::vector<GradientImage> gradients(images.size());
  ParallelFor(static_cast<int>(images.size()), [&](int level) {
    const auto i = static_cast<size_t>(level);
    if (used[i]) gradients[i] = ComputeGradient(images[i]);
  });
  const Window window = MakeWindow();
  constexpr size_t kBlock = 64;
  std::vector<Features> blocks((keypoints.size() + kBlock - 1) / kBlock);
  ParallelFor(static_cast<int>(blocks.size()), [&](int block) {
    Features& features = blocks[static_cast<size_t>(block)];
    const size_t begin = static_cast<size_t>(block) * kBlock;
    for (size_t i = begin; i < std::min(keypoints.size(), begin + kBlock); ++i) {
      const Keypoint& keypoint = keypoints[i];
      const GradientImage& gradient = gradients[static_cast<size_t>(keypoint.level)];
      std::vector<float> turns = DominantTurns(gradient, keypoint, options);  // none where the image is flat
      if (!options.oriented && !turns.empty()) turns = {0.0F};
      for (const float turn : turns) {
        features.keypoints.push_back(keypoint);
        const float angle = 2.0F * kPi * turn;
        features.orientations_rad.push_back(angle >= kPi ? angle - 2.0F * kPi : angle);
        features.descriptors.resize(features.descriptors.size() + kDescriptorSize);
        Describe(gradient, keypoint, turn, static_cast<float>(options.step_px), window,
                 features.descriptors.data() + features.descriptors.size() - kDescriptorSize);
      }
    }
  });
  Features all;
  for (const Features& features : blocks) {
    all.keypoints.insert(all.keypoints.end(), features.keypoints.begin(), features.keypoints.end());
    all.orientations_rad.insert(all.orientations_rad.end(), features.orientations_rad.begin(),
                                features.orientations_rad.end());
    all.descriptors.insert(all.descriptors.end(), features.descriptors.begin(), features.descriptors.end());
  }
  return all;
}

}  // namespace curvereg
