// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Positions as integers, see v1.Quantization. Frame and unit of points as in core/scan/scan.h. The integers are written
// shuffled: with b bytes per coordinate and n points, byte k of axis a of point i is planes[(a * b + k) * n + i].
#ifndef CURVEREG_WIRE_QUANTIZATION_H_
#define CURVEREG_WIRE_QUANTIZATION_H_

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "curvereg/v1/point_cloud.pb.h"

namespace curvereg::wire {

// The coarsest step whose decoded points, rounded to float32, are not farther than max_error_m from `points`; the
// fewest bytes that hold their extent. INVALID_FIELD "max_error_m": not above 0, or the extent does not fit 4 bytes.
absl::StatusOr<v1::Quantization> ChooseQuantization(const std::vector<Eigen::Vector3f>& points, double max_error_m);

// Precondition: `quantization` was chosen for these points; `planes` has room for 3 b n bytes.
void QuantizePoints(const std::vector<Eigen::Vector3f>& points, const v1::Quantization& quantization, char* planes);

// Fills all of `points`. Points without a return, and coordinates beyond float32, become not-a-number.
// Precondition: the quantisation is valid; `planes` has 3 b points.size() bytes.
void DequantizePoints(std::string_view planes, const v1::Quantization& quantization,
                      std::vector<Eigen::Vector3f>& points);

}  // namespace curvereg::wire

#endif  // CURVEREG_WIRE_QUANTIZATION_H_
