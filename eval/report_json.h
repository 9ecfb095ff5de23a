// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// An evaluation as JSON: {"dataset", "methods": [{"method", "pairs", "ok", ..., "details": [...]}]}. NaN is null.
#ifndef CURVEREG_EVAL_REPORT_JSON_H_
#define CURVEREG_EVAL_REPORT_JSON_H_

#include <string>

#include "eval/evaluate.h"

namespace curvereg {

// One object in UTF-8; on one line when `indent` is negative. The same evaluation gives the same text.
std::string EvaluationJson(const Evaluation& evaluation, int indent = -1);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_REPORT_JSON_H_
