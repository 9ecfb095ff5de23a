// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What a scan costs on its way into and out of a message, beside a copy of the points; then the sizes.
#include "wire/point_codec.h"

#include <cstdio>

#include "bench/bench_scene.h"
#include "bench/ratio.h"
#include "wire/digest.h"

namespace curvereg::bench {
namespace {

v1::PointCloud Encoded(const Scan& scan, v1::PointEncoding encoding) {
  wire::PointEncodingOptions options;
  options.encoding = encoding;
  return *wire::EncodeScan(scan, options);
}

int Run(int argc, char** argv) {
  const Scan scan{BenchScan(BenchPose(0.0, 0.0, 0.0)), std::nullopt};
  const v1::PointCloud raw = Encoded(scan, v1::POINT_ENCODING_RAW);
  const v1::PointCloud shuffled = Encoded(scan, v1::POINT_ENCODING_SHUFFLED_ZSTD);
  const v1::PointCloud quantized = Encoded(scan, v1::POINT_ENCODING_QUANTIZED_ZSTD);
  for (const v1::PointCloud& cloud : {raw, shuffled, quantized}) {
    std::printf("%s: %.2f bytes per point\n", v1::PointEncoding_Name(cloud.header().encoding()).c_str(),
                static_cast<double>(cloud.data().size()) / static_cast<double>(scan.points.size()));
  }
  const auto encode = [&scan](v1::PointEncoding encoding) {
    return [&scan, encoding] { static_cast<void>(Encoded(scan, encoding)); };
  };
  const auto decode = [](const v1::PointCloud& cloud) {
    return [&cloud] { static_cast<void>(wire::DecodeScan(cloud.header(), cloud.data(), {})); };
  };
  const auto digest = [&raw](v1::DigestAlgorithm algorithm) {
    return [&raw, algorithm] { static_cast<void>(wire::DigestOf(algorithm, raw.data())); };
  };
  return PrintRatios(argc, argv, CopyOf(scan.points),
                     {{"encode RAW", encode(v1::POINT_ENCODING_RAW)},
                      {"decode RAW", decode(raw)},
                      {"encode SHUFFLED_ZSTD", encode(v1::POINT_ENCODING_SHUFFLED_ZSTD)},
                      {"decode SHUFFLED_ZSTD", decode(shuffled)},
                      {"encode QUANTIZED_ZSTD, 1 mm", encode(v1::POINT_ENCODING_QUANTIZED_ZSTD)},
                      {"decode QUANTIZED_ZSTD", decode(quantized)},
                      {"Crc32c of RAW", [&raw] { static_cast<void>(wire::Crc32c(raw.data())); }},
                      {"XXH3_128 of RAW", digest(v1::DIGEST_ALGORITHM_XXH3_128)},
                      {"SHA256 of RAW", digest(v1::DIGEST_ALGORITHM_SHA256)}});
}

}  // namespace
}  // namespace curvereg::bench

int main(int argc, char** argv) { return curvereg::bench::Run(argc, argv); }
