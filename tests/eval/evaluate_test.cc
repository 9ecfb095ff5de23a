// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/evaluate.h"

#include <map>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Scans "0", "1", "2" of 10, 11 and 12 points; pair i is (i+1 → i) with a motion of i+1 metres along x.
class EvaluateTest : public ::testing::Test {
 protected:
  EvaluateTest() {
    dataset_.folder = "somewhere";
    for (int i = 0; i < 3; ++i) {
      dataset_.scan_names.push_back(std::to_string(i));
      dataset_.scan_paths.push_back("somewhere/" + std::to_string(i) + ".pcd");
    }
    for (int i = 0; i < 2; ++i) {
      ScanPair pair;
      pair.source = std::to_string(i + 1);
      pair.target = std::to_string(i);
      pair.T_target_source = Eigen::Translation3d(i + 1.0, 0.0, 0.0);
      dataset_.pairs.push_back(pair);
    }
    options_.load_scan = [this](const std::string& path) -> absl::StatusOr<Scan> {
      ++num_loads_[path];
      Scan scan;
      scan.points.resize(static_cast<std::size_t>(10 + path[10] - '0'));
      return scan;
    };
    options_.register_scans = [this](const Scan& source, const Scan& target, const RegistrationOptions& options) {
      return Register(source, target, options);
    };
  }

  // Right about scan 1, wrong about scan 2, and it cannot register onto scan 2 at all.
  absl::StatusOr<RegistrationResult> Register(const Scan& source, const Scan& target,
                                              const RegistrationOptions& options) {
    seen_.push_back(options.method);
    if (target.points.size() == 12) return absl::InvalidArgumentError("flat");
    RegistrationResult result;
    result.T_target_source = Eigen::Translation3d(1.0, 0.0, 0.0);
    result.verdict = {.accepted = source.points.size() == 11, .reasons = {}};
    return result;
  }

  Dataset dataset_;
  EvaluationOptions options_;
  std::map<std::string, int> num_loads_;
  std::vector<Method> seen_;
};

TEST_F(EvaluateTest, MeasuresEachPairForEachMethod) {
  options_.methods = {Method::kPaper, Method::kIcp};
  std::vector<int> done;
  options_.progress = [&](const EvaluationProgress& progress) {
    EXPECT_EQ(progress.num_total, 4);
    done.push_back(progress.num_done);
  };
  const auto evaluation = Evaluate(dataset_, {}, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  ASSERT_EQ(evaluation->methods.size(), 2u);
  const MethodEvaluation& run = evaluation->methods[0];
  EXPECT_EQ(run.method, Method::kPaper);
  EXPECT_EQ(run.summary.pairs, 2);
  EXPECT_EQ(run.summary.ok, 1);
  EXPECT_EQ(run.summary.accepted, 1);
  EXPECT_EQ(run.summary.accepted_wrong, 0);
  EXPECT_DOUBLE_EQ(PoseError(run.outcomes[1]).translation_m, 1.0);
  EXPECT_GE(run.outcomes[0].seconds, 0.0);
  EXPECT_THAT(done, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(seen_, ElementsAre(Method::kPaper, Method::kPaper, Method::kIcp, Method::kIcp));
}

TEST_F(EvaluateTest, ReadsEachScanOnce) {
  ASSERT_TRUE(Evaluate(dataset_, {}, options_).ok());
  EXPECT_EQ(num_loads_.size(), 3u);
  for (const auto& [path, count] : num_loads_) EXPECT_EQ(count, 1) << path;
}

TEST_F(EvaluateTest, FailedCallsAndNegativePairsAreOutcomes) {
  const auto evaluation = Evaluate(dataset_, {{"0", "2"}, {"1", "0"}}, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  const MethodEvaluation& run = evaluation->methods[0];
  ASSERT_EQ(run.outcomes.size(), 4u);
  EXPECT_EQ(run.outcomes[2].error, "flat");
  EXPECT_FALSE(run.outcomes[2].result.verdict.accepted);
  EXPECT_EQ(run.summary.negatives, 2);
  EXPECT_EQ(run.summary.negatives_accepted, 1);
  EXPECT_EQ(run.summary.accepted_wrong, 1);
  EXPECT_EQ(run.summary.failed_calls, 1);
}

TEST_F(EvaluateTest, CancellationAndUnreadableScansEndIt) {
  options_.register_scans = [](const Scan&, const Scan&, const RegistrationOptions&) {
    return absl::StatusOr<RegistrationResult>(absl::CancelledError("interrupted"));
  };
  EXPECT_TRUE(absl::IsCancelled(Evaluate(dataset_, {}, options_).status()));
  options_.load_scan = [](const std::string& path) { return absl::StatusOr<Scan>(absl::DataLossError(path)); };
  EXPECT_EQ(Evaluate(dataset_, {}, options_).status().message(), "somewhere/1.pcd");
}

TEST_F(EvaluateTest, ARefusalOfEveryCallEndsItAtOnce) {
  int num_calls = 0;
  absl::Status refusal;
  options_.register_scans = [&](const Scan&, const Scan&, const RegistrationOptions&) {
    ++num_calls;
    return absl::StatusOr<RegistrationResult>(refusal);
  };
  for (const absl::Status& status : {absl::UnavailableError("gone"), absl::UnauthenticatedError("no token"),
                                     absl::PermissionDeniedError("read only")}) {
    refusal = status;
    num_calls = 0;
    EXPECT_EQ(Evaluate(dataset_, {}, options_).status(), status);
    EXPECT_EQ(num_calls, 1) << status;
  }
}

TEST_F(EvaluateTest, NoFiguresComeOfCallsThatAllFailed) {
  options_.register_scans = [](const Scan&, const Scan&, const RegistrationOptions&) {
    return absl::StatusOr<RegistrationResult>(absl::ResourceExhaustedError("too large"));
  };
  options_.methods = {Method::kPaper, Method::kIcp};
  EXPECT_EQ(Evaluate(dataset_, {}, options_).status(), absl::ResourceExhaustedError("too large"));
}

TEST_F(EvaluateTest, StopsBetweenPairsWhenCancelled) {
  std::stop_source stop;
  options_.registration.cancellation = stop.get_token();
  options_.progress = [&](const EvaluationProgress&) { stop.request_stop(); };
  EXPECT_TRUE(absl::IsCancelled(Evaluate(dataset_, {}, options_).status()));
  EXPECT_EQ(seen_.size(), 1u);
}

TEST_F(EvaluateTest, NothingToDoIsAnError) {
  EXPECT_EQ(Evaluate(Dataset{}, {}, options_).status().code(), absl::StatusCode::kInvalidArgument);
  const auto unknown = Evaluate(dataset_, {{"0", "9"}}, options_);
  EXPECT_THAT(std::string(unknown.status().message()), HasSubstr("no scan is named 9"));
}

TEST(ScanCache, ForgetsTheLongestUnusedWhenFull) {
  std::vector<std::string> loads;
  ScanCache cache(
      [&](const std::string& path) -> absl::StatusOr<Scan> {
        loads.push_back(path);
        Scan scan;
        scan.points.resize(4);
        return scan;
      },
      8);
  const auto a = cache.Get("a");
  ASSERT_TRUE(a.ok());
  for (const char* path : {"b", "a", "c", "a", "b"}) ASSERT_TRUE(cache.Get(path).ok());
  EXPECT_THAT(loads, ElementsAre("a", "b", "c", "b"));
  EXPECT_EQ((*a)->points.size(), 4u);  // still held by us
}

TEST(ScanCache, KeepsAScanLargerThanItself) {
  ScanCache cache(
      [](const std::string&) {
        return absl::StatusOr<Scan>(Scan{std::vector<Eigen::Vector3f>(9), {}});
      },
      1);
  const auto scan = cache.Get("a");
  ASSERT_TRUE(scan.ok());
  EXPECT_EQ((*scan)->points.size(), 9u);
}

}  // namespace
}  // namespace curvereg
