// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Results as text for people.
#ifndef CURVEREG_CLI_RESULT_TEXT_H_
#define CURVEREG_CLI_RESULT_TEXT_H_

#include <string>

#include "core/methods/registration_result.h"
#include "eval/evaluate.h"

namespace curvereg::cli {

// Verdict, transform, standard deviations, degenerate directions, evidence and times of a registration.
std::string RegistrationText(const RegistrationResult& result);

// A table, one line per method.
std::string EvaluationText(const Evaluation& evaluation);

}  // namespace curvereg::cli

#endif  // CURVEREG_CLI_RESULT_TEXT_H_
