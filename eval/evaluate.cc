// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/evaluate.h"

#include <chrono>
#include <map>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"

namespace curvereg {
namespace {

// What is to be answered for: the names and the truth of each pair, still without a result.
std::vector<PairOutcome> PairsOf(const Dataset& dataset, const std::vector<NegativePair>& negatives) {
  std::vector<PairOutcome> pairs;
  for (const ScanPair& pair : dataset.pairs) {
    PairOutcome outcome;
    outcome.source = pair.source;
    outcome.target = pair.target;
    outcome.true_T_target_source = pair.T_target_source;
    outcome.overlap = pair.overlap;
    pairs.push_back(std::move(outcome));
  }
  for (const NegativePair& pair : negatives) {
    PairOutcome outcome;
    outcome.source = pair.source;
    outcome.target = pair.target;
    pairs.push_back(std::move(outcome));
  }
  return pairs;
}

// The scans of a data set by name.
class ScanShelf {
 public:
  ScanShelf(const Dataset& dataset, ScanLoader load) : folder_(dataset.folder), cache_(std::move(load)) {
    for (std::size_t i = 0; i < dataset.scan_names.size(); ++i) {
      path_of_[dataset.scan_names[i]] = dataset.scan_paths[i];
    }
  }

  absl::StatusOr<std::shared_ptr<const Scan>> Get(const std::string& name) {
    const auto found = path_of_.find(name);
    if (found == path_of_.end()) return absl::InvalidArgumentError(absl::StrCat(folder_, ": no scan is named ", name));
    return cache_.Get(found->second);
  }

 private:
  std::string folder_;
  std::map<std::string, std::string> path_of_;
  ScanCache cache_;
};

// The caller gave up, the server is gone, or it will refuse every other call as well.
bool EndsEvaluation(const absl::Status& error) {
  return absl::IsCancelled(error) || absl::IsUnavailable(error) || absl::IsUnauthenticated(error) ||
         absl::IsPermissionDenied(error);
}

// The error of the call goes into `failure`, unless it ends the evaluation.
absl::Status RegisterPair(const EvaluationOptions& options, const RegistrationOptions& registration, ScanShelf& shelf,
                          PairOutcome& outcome, absl::Status& failure) {
  const auto source = shelf.Get(outcome.source);
  if (!source.ok()) return source.status();
  const auto target = shelf.Get(outcome.target);
  if (!target.ok()) return target.status();

  const auto start = std::chrono::steady_clock::now();
  absl::StatusOr<RegistrationResult> result = options.register_scans(**source, **target, registration);
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (EndsEvaluation(result.status())) return result.status();
  if (result.ok()) {
    outcome.seconds = result->total_seconds;
    outcome.result = *std::move(result);
  } else {
    failure = result.status();
    outcome.error = std::string(failure.message());
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Evaluation> Evaluate(const Dataset& dataset, const std::vector<NegativePair>& negatives,
                                    const EvaluationOptions& options) {
  const std::vector<PairOutcome> pairs = PairsOf(dataset, negatives);
  if (pairs.empty()) return absl::InvalidArgumentError(absl::StrCat(dataset.folder, ": no pair to register"));

  ScanShelf shelf(dataset, options.load_scan);
  EvaluationProgress progress;
  progress.num_total = static_cast<int>(pairs.size() * options.methods.size());
  Evaluation evaluation{.dataset = dataset.folder, .methods = {}};
  absl::Status failure;
  int num_failures = 0;
  for (const Method method : options.methods) {
    RegistrationOptions registration = options.registration;
    registration.method = method;
    MethodEvaluation& run = evaluation.methods.emplace_back();
    run.method = method;
    run.outcomes = pairs;
    for (PairOutcome& outcome : run.outcomes) {
      // Asked here, too: pairs whose registrations are over in no time would never notice.
      if (registration.cancellation.stop_requested()) return absl::CancelledError("interrupted");
      const absl::Status status = RegisterPair(options, registration, shelf, outcome, failure);
      if (!status.ok()) return status;
      num_failures += !outcome.error.empty();
      ++progress.num_done;
      progress.last = &outcome;
      if (options.progress) options.progress(progress);
    }
    run.summary = Summarise(run.outcomes);
  }
  if (num_failures == progress.num_total) return failure;
  return evaluation;
}

}  // namespace curvereg
