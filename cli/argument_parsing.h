// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Argument values that are more than one number. Errors are INVALID_ARGUMENT and name the value and what is expected.
#ifndef CURVEREG_CLI_ARGUMENT_PARSING_H_
#define CURVEREG_CLI_ARGUMENT_PARSING_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/rigid_transform.h"
#include "core/methods/registration_options.h"

namespace curvereg::cli {

// A transform given as numbers, or the name of a file that holds them ('#' starts a comment): 16 (row-major 4x4),
// 12 (row-major 3x4), 7 (x y z qx qy qz qw) or 8 (a line of a TUM file, its time ignored). Separated by blanks or
// commas. Rotations are accepted when rigid to 1e-3, as printed with few digits, and made exactly rigid. NOT_FOUND:
// neither numbers nor a file that is there.
absl::StatusOr<RigidTransform> ParseTransform(const std::string& text_or_path);

// "X,Y,Z", finite, not zero.
absl::StatusOr<Eigen::Vector3d> ParseDirection(const std::string& text);

// "ROTATION_RAD,TRANSLATION_M", both positive: the covariance of a prior with these standard deviations on each axis.
absl::StatusOr<Matrix6d> ParsePriorSigma(const std::string& text);

// One method's name.
absl::StatusOr<Method> ParseMethod(const std::string& name);

// "A,B,...", at least one, none twice.
absl::StatusOr<std::vector<Method>> ParseMethods(const std::string& names);

// Checks of an option's text, for OptionSyntax::Check: empty when it may pass, else what is wrong.
std::string CheckPositive(const std::string& text);     // a finite number above 0
std::string CheckSeconds(const std::string& text);      // the same, and at most 10^9
std::string CheckNotNegative(const std::string& text);  // a whole number from 0 to 2^64 - 1

// "curvelet, paper, ...", for messages and help.
std::string MethodNames();

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_ARGUMENT_PARSING_H_
