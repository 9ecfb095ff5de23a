// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "core/register_scans.h"

#include <array>
#include <chrono>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "core/base/hash.h"
#include "core/base/parallel.h"
#include "core/baselines/register_baseline.h"
#include "core/methods/register_curvelet.h"
#include "core/methods/register_icp.h"
#include "core/methods/register_paper.h"
#include "core/methods/registration_names.h"

namespace curvereg {
namespace {

using Clock = std::chrono::steady_clock;

absl::Status ValidateOptions(const RegistrationOptions& options) {
  if (options.num_threads < 0) return absl::InvalidArgumentError("num_threads must not be negative");
  if (options.time_budget_s.has_value() && !(*options.time_budget_s > 0.0)) {
    return absl::InvalidArgumentError("time_budget_s must be positive");
  }
  if (!options.prior.has_value()) return absl::OkStatus();
  if (!IsRigid(options.prior->T_target_source)) {
    return absl::InvalidArgumentError("the prior is not a rigid transform (rotation not orthonormal, or not finite)");
  }
  if (options.prior->covariance.has_value()) {
    const Matrix6d& covariance = *options.prior->covariance;
    const Eigen::LLT<Matrix6d> cholesky(covariance);  // of the lower triangle
    const bool is_symmetric = covariance.isApprox(covariance.transpose(), 1e-6);
    if (!covariance.allFinite() || !is_symmetric || cholesky.info() != Eigen::Success) {
      return absl::InvalidArgumentError("the prior's covariance is not symmetric positive definite");
    }
  }
  return absl::OkStatus();
}

// Everything that changes the answer, as text, hashed; threads do not.
std::string OptionsDigest(const RegistrationOptions& options) {
  std::string text = absl::StrCat(std::string(MethodName(options.method)), ";seed=", options.seed);
  const auto append_matrix = [&text](const Eigen::MatrixXd& matrix) {
    for (Eigen::Index i = 0; i < matrix.size(); ++i) absl::StrAppendFormat(&text, ",%.17g", matrix.data()[i]);
  };
  if (options.prior.has_value()) {
    append_matrix(options.prior->T_target_source.matrix());
    if (options.prior->covariance.has_value()) append_matrix(*options.prior->covariance);
  }
  if (options.time_budget_s.has_value()) absl::StrAppendFormat(&text, ";budget=%.17g", *options.time_budget_s);
  absl::StrAppendFormat(&text, ";limits=%d,%d,%.17g", options.limits.min_points, options.limits.max_points,
                        options.limits.max_coordinate_m);
  return absl::StrFormat("%016x", HashOf(text));
}

bool IsPrepared(Method method) { return method == Method::kCurvelet || method == Method::kIcp; }

absl::StatusOr<RegistrationResult> RunPreparedMethod(const PreparedScan& source, const PreparedScan& target,
                                                     const RegistrationOptions& options, const Stop& stop) {
  if (options.method == Method::kIcp) return RegisterIcp(source, target, options, stop);
  return RegisterCurvelet(source, target, options, stop);
}

// Unless it was done.
void DescribeScans(const Scan& source, const Scan& target, RegistrationResult& result) {
  if (!result.source_digest.empty()) return;
  result.source_digest = ScanDigest(source);
  result.target_digest = ScanDigest(target);
  result.evidence.num_source_points = CountFinitePoints(source);
  result.evidence.num_target_points = CountFinitePoints(target);
}

absl::StatusOr<RegistrationResult> PrepareAndRun(const ScanPreparation& source, const ScanPreparation& target,
                                                 const RegistrationOptions& options, const Stop& stop) {
  const Clock::time_point start = Clock::now();
  std::array<absl::StatusOr<std::shared_ptr<const PreparedScan>>, 2> prepared = {nullptr, nullptr};
  ParallelFor(2, [&](int i) { prepared[static_cast<size_t>(i)] = (i == 0 ? source : target)(stop); });
  for (const auto& scan : prepared) {
    if (scan.ok()) continue;
    if (!absl::IsDeadlineExceeded(scan.status())) return scan.status();
    RegistrationResult result;
    result.verdict.reasons = {Reason::kDeadline};
    return result;
  }
  const double preparation_s = std::chrono::duration<double>(Clock::now() - start).count();
  absl::StatusOr<RegistrationResult> result = RunPreparedMethod(**prepared[0], **prepared[1], options, stop);
  if (!result.ok()) return result;
  result->stage_times.insert(result->stage_times.begin(), StageTime{"preparation", preparation_s});
  DescribeScans((*prepared[0])->scan(), (*prepared[1])->scan(), *result);
  return result;
}

// `scan` outlives what comes back.
ScanPreparation PreparationOf(const Scan& scan, const RegistrationOptions& options) {
  PreparationOptions preparation;
  preparation.limits = options.limits;
  return [&scan, preparation](const Stop& stop) {
    return PreparedScan::Create(std::shared_ptr<const Scan>(std::shared_ptr<void>(), &scan), preparation, stop);
  };
}

absl::StatusOr<RegistrationResult> RunMethod(const Scan& source, const Scan& target, const RegistrationOptions& options,
                                             const Stop& stop) {
  switch (options.method) {
    case Method::kCurvelet:
    case Method::kIcp:
      return PrepareAndRun(PreparationOf(source, options), PreparationOf(target, options), options, stop);
    case Method::kPaper:
    case Method::kFpfhSacIa:
    case Method::kHarris3dFpfh:
      for (const Scan* scan : {&source, &target}) {
        if (absl::Status status = ValidateScan(*scan, options.limits, stop); !status.ok()) return status;
      }
      if (options.method == Method::kPaper) return RegisterPaper(source, target, options, stop);
      return RegisterBaseline(source, target, options, stop);
  }
  return absl::InvalidArgumentError("unknown method");
}

// Runs `method` within the thread limit and adds what every result carries.
template <typename Run>
absl::StatusOr<RegistrationResult> RunWithin(const RegistrationOptions& options, const Run& run) {
  if (absl::Status status = ValidateOptions(options); !status.ok()) return status;
  const Clock::time_point start = Clock::now();
  const Stop stop = StopOf(options, start);
  absl::StatusOr<RegistrationResult> result = absl::UnknownError("not run");
  WithThreadLimit(options.num_threads, [&] { result = run(stop); });
  if (!result.ok()) return result;
  result->seed = options.seed;
  result->options_digest = OptionsDigest(options);
  result->build_id = BuildId();
  result->total_seconds = std::chrono::duration<double>(Clock::now() - start).count();
  return result;
}

}  // namespace

Stop StopOf(const RegistrationOptions& options, Clock::time_point start) {
  Stop stop{options.cancellation, options.deadline};
  if (options.time_budget_s.has_value()) {
    const Clock::time_point end = start + std::chrono::duration_cast<Clock::duration>(
                                              std::chrono::duration<double>(std::min(*options.time_budget_s, 1e6)));
    stop.deadline = std::min(end, options.deadline.value_or(end));
  }
  return stop;
}

bool IsAvailable(Method method) {
  return (method != Method::kFpfhSacIa && method != Method::kHarris3dFpfh) || HasBaselines();
}

std::string BuildId() { return absl::StrCat("curvereg ", CURVEREG_VERSION, " (", __VERSION__, ")"); }

absl::StatusOr<RegistrationResult> RegisterScans(const Scan& source, const Scan& target,
                                                 const RegistrationOptions& options) {
  return RunWithin(options, [&](const Stop& stop) {
    absl::StatusOr<RegistrationResult> result = RunMethod(source, target, options, stop);
    if (result.ok()) DescribeScans(source, target, *result);
    return result;
  });
}

absl::StatusOr<RegistrationResult> PrepareAndRegister(const ScanPreparation& source, const ScanPreparation& target,
                                                      const RegistrationOptions& options) {
  if (!IsPrepared(options.method)) return absl::InvalidArgumentError("the method prepares nothing");
  return RunWithin(options, [&](const Stop& stop) { return PrepareAndRun(source, target, options, stop); });
}

absl::StatusOr<RegistrationResult> RegisterPreparedScans(const PreparedScan& source, const PreparedScan& target,
                                                         const RegistrationOptions& options) {
  if (!IsPrepared(options.method)) {
    return RegisterScans(source.scan(), target.scan(), options);  // methods without a preparation
  }
  return RunWithin(options, [&](const Stop& stop) {
    absl::StatusOr<RegistrationResult> result = RunPreparedMethod(source, target, options, stop);
    if (result.ok()) DescribeScans(source.scan(), target.scan(), *result);
    return result;
  });
}

}  // namespace curvereg
