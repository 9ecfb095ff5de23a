// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Results as JSON. Numbers are written with as many digits as bring the same double back; what is unknown (NaN,
// infinite, not computed by the method) is null. Keys keep the order of the structs.
#ifndef CURVEREG_FILES_RESULT_JSON_H_
#define CURVEREG_FILES_RESULT_JSON_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/methods/registration_result.h"
#include "files/json.h"

namespace curvereg {

// The matrix as an array of rows.
Json MatrixJson(const Eigen::MatrixXd& matrix);

Json ReasonsJson(const std::vector<Reason>& reasons);
Json EvidenceJson(const Evidence& evidence);

// Everything in the result. The transform is null without a pose, the covariance without one.
Json ResultJson(const RegistrationResult& result);

}  // namespace curvereg

#endif  // CURVEREG_FILES_RESULT_JSON_H_
