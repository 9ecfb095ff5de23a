// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Results as JSON. Numbers are written with as many digits as bring the same double back; what is unknown (NaN,
// infinite, not computed by the method) is null. Keys keep the order of the structs.
#ifndef CURVEREG_FILES_RESULT_JSON_H_
#define CURVEREG_FILES_RESULT_JSON_H_

#include <Eigen/Core>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/methods/registration_result.h"

namespace curvereg {

// One text, without line breaks when `indent` is negative. Bytes that are no UTF-8 (file names) become U+FFFD.
std::string JsonText(const nlohmann::ordered_json& json, int indent = -1);

// The matrix as an array of rows.
nlohmann::ordered_json MatrixJson(const Eigen::MatrixXd& matrix);

nlohmann::ordered_json ReasonsJson(const std::vector<Reason>& reasons);
nlohmann::ordered_json EvidenceJson(const Evidence& evidence);

// Everything in the result. The transform is null without a pose, the covariance without one.
nlohmann::ordered_json ResultJson(const RegistrationResult& result);

}  // namespace curvereg

#endif  // CURVEREG_FILES_RESULT_JSON_H_
