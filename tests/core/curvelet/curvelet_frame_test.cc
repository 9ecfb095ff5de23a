// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/curvelet/curvelet_frame.h"

#include <gtest/gtest.h>

#include <map>
#include <mutex>

namespace curvereg {
namespace {

using Complex = std::complex<double>;

Image<double> Noise(int rows, int cols) {
  Image<double> image(rows, cols);
  uint32_t state = 12345;
  for (double& pixel : image.pixels) {
    state = state * 1664525U + 1013904223U;
    pixel = state / 4294967296.0 - 0.5;
  }
  return image;
}

size_t Area(const CurveletWedge& wedge) { return static_cast<size_t>(wedge.rows) * static_cast<size_t>(wedge.cols); }

// All that a frame says of an image.
struct Recording {
  std::mutex mutex;
  std::map<int, Image<double>> wavelets;
  std::map<std::pair<int, int>, std::vector<Complex>> wedges;

  CurveletFrame::Sink Sink() {
    return {.wavelet =
                [this](int scale, Image<double> array) {
                  const std::lock_guard<std::mutex> lock(mutex);
                  wavelets[scale] = std::move(array);
                },
            .wedge =
                [this](const CurveletWedge& wedge, const Complex* array) {
                  const std::lock_guard<std::mutex> lock(mutex);
                  wedges[{wedge.scale, wedge.angle}].assign(array, array + Area(wedge));
                }};
  }
  CurveletFrame::Source Source() {
    return {.wavelet = [this](int scale) { return wavelets.at(scale); },
            .wedge =
                [this](const CurveletWedge& wedge, Complex* array) {
                  const std::vector<Complex>& values = wedges.at({wedge.scale, wedge.angle});
                  std::copy(values.begin(), values.end(), array);
                }};
  }
};

TEST(CurveletFrameTest, GivesEachArrayOnce) {
  const CurveletFrame frame(64, 70, {.num_scales = 3});
  Recording recording;
  frame.Analyse(Noise(64, 70), recording.Sink());
  EXPECT_EQ(recording.wavelets.size(), 2U);  // coarsest and finest
  EXPECT_EQ(recording.wedges.size(), 8U);    // north and east of 16
  EXPECT_EQ(frame.WedgeAt(2, 8).angle, 8);
  EXPECT_TRUE(frame.HasWavelet(1));
  EXPECT_FALSE(frame.HasWavelet(2));
  EXPECT_TRUE(frame.HasWavelet(3));
}

// <analysis of f, c> = <f, synthesis of c> for unrelated f and c, where a wedge counts for its opposite too.
TEST(CurveletFrameTest, SynthesisIsTheAdjointOfAnalysis) {
  for (const FinestScale finest : {FinestScale::kWavelets, FinestScale::kCurvelets}) {
    const CurveletFrame frame(61, 48, {.num_scales = 3, .finest = finest});
    const Image<double> f = Noise(61, 48);
    Recording analysed;
    frame.Analyse(f, analysed.Sink());
    Recording other;
    uint32_t state = 99;
    const auto next = [&state] { return (state = state * 1664525U + 1013904223U) / 4294967296.0 - 0.5; };
    double left = 0.0;
    for (const auto& [scale, array] : analysed.wavelets) {
      Image<double>& c = other.wavelets[scale] = Image<double>(array.rows, array.cols);
      for (size_t i = 0; i < c.size(); ++i) left += (c.pixels[i] = next()) * array.pixels[i];
    }
    for (const auto& [key, array] : analysed.wedges) {
      std::vector<Complex>& c = other.wedges[key];
      for (const Complex& value : array) {
        c.emplace_back(next(), next());
        left += 2.0 * (std::conj(c.back()) * value).real();
      }
    }
    const Image<double> g = frame.Synthesise(other.Source(), 1, 3);
    double right = 0.0;
    for (size_t i = 0; i < f.size(); ++i) right += f.pixels[i] * g.pixels[i];
    EXPECT_NEAR(left, right, 1e-12);
    EXPECT_GT(std::abs(left), 1e-3);
  }
}

}  // namespace
}  // namespace curvereg
