// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Runs methods over the pairs of a data set and measures each answer against the truth [paper, section 5].
#ifndef CURVEREG_EVAL_EVALUATE_H_
#define CURVEREG_EVAL_EVALUATE_H_

#include <functional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/methods/registration_options.h"
#include "eval/dataset.h"
#include "eval/metrics.h"
#include "eval/negative_pairs.h"
#include "eval/scan_cache.h"

namespace curvereg {

// The signature of RegisterScans.
using Registrar =
    std::function<absl::StatusOr<RegistrationResult>(const Scan&, const Scan&, const RegistrationOptions&)>;

struct EvaluationProgress {
  int num_done = 0;  // registrations, all methods together
  int num_total = 0;
  const PairOutcome* last = nullptr;  // null before the first
};

struct EvaluationOptions {
  std::vector<Method> methods = {Method::kCurvelet};
  RegistrationOptions registration;                         // its method is overwritten by each of `methods`
  ScanLoader load_scan;                                     // required
  Registrar register_scans;                                 // required
  std::function<void(const EvaluationProgress&)> progress;  // called on the calling thread; may be empty
};

struct MethodEvaluation {
  Method method = Method::kCurvelet;
  std::vector<PairOutcome> outcomes;  // the data set's pairs in order, then its negative pairs
  MethodSummary summary;
};

struct Evaluation {
  std::string dataset;  // folder
  std::vector<MethodEvaluation> methods;
};

// Scans are read before the clock starts. A registration that cannot be done is an outcome with an `error`; a scan
// that cannot be read, and CANCELLED, UNAVAILABLE, UNAUTHENTICATED or PERMISSION_DENIED, end the evaluation with that
// error. When no registration at all could be done, the error of the last. INVALID_ARGUMENT: nothing to evaluate, or a
// pair names a scan that the data set does not have.
absl::StatusOr<Evaluation> Evaluate(const Dataset& dataset, const std::vector<NegativePair>& negatives,
                                    const EvaluationOptions& options);

}  // namespace curvereg

#endif  // CURVEREG_EVAL_EVALUATE_H_
