// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/evaluate_traverse.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "absl/strings/str_cat.h"
#include "eval/traverse_evaluation_report.h"
#include "files/trajectory_file.h"
#include "sim/presets.h"
#include "sim/simulation.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::TemporaryFolder;

constexpr int kNumScans = 5;

// A short drive with a small scanner, its scans made when asked for.
class EvaluateTraverseTest : public ::testing::Test {
 protected:
  EvaluateTraverseTest() {
    sim::SimulationOptions options = *sim::PresetOptions("mars-yard-sim");
    options.num_scans = kNumScans;
    options.scanner.pattern.columns = 360;
    options.scanner.pattern.rows = 90;
    simulation_ = sim::Simulation::Create(options);
    dataset_.folder = "yard";
    for (int i = 0; i < kNumScans; ++i) {
      dataset_.scan_names.push_back(std::to_string(i));
      dataset_.scan_paths.push_back(std::to_string(i));
      dataset_.T_world_scan.push_back(simulation_->T_world_scan(i));
    }
    options_.load_scan = [this](const std::string& path) -> absl::StatusOr<Scan> {
      return simulation_->ScanAt(std::stoi(path));
    };
  }

  absl::StatusOr<sim::Simulation> simulation_ = absl::UnknownError("not made");
  Dataset dataset_;
  TraverseEvaluationOptions options_;
};

TEST_F(EvaluateTraverseTest, MeasuresTheDriveAgainstTheTruth) {
  std::vector<std::string> told;
  options_.progress = [&](int num_done, const std::string& name) { told.push_back(absl::StrCat(num_done, name)); };
  const absl::StatusOr<TraverseEvaluation> evaluation = EvaluateTraverse(dataset_, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  EXPECT_THAT(told, ElementsAre("10", "21", "32", "43", "54"));
  EXPECT_EQ(evaluation->num_scans, kNumScans);
  EXPECT_EQ(evaluation->track_seconds.size(), kNumScans);
  EXPECT_GE(evaluation->num_accepted_links, kNumScans - 1);
  EXPECT_EQ(evaluation->num_accepted_wrong_links, 0);
  for (const MeasuredTrajectory* trajectory : {&evaluation->tracked, &evaluation->optimised}) {
    EXPECT_EQ(trajectory->num_segments, 1);
    EXPECT_EQ(trajectory->num_measured, kNumScans);
    ASSERT_TRUE(trajectory->errors.has_value());
    EXPECT_GT(trajectory->errors->drift_m.rmse, 0.0);
    EXPECT_LT(trajectory->errors->drift_m.rmse, 0.05);
    EXPECT_GT(trajectory->errors->path_length_m, 15.0);
    EXPECT_GT(trajectory->thickness.num_cells, 0);
  }
  ASSERT_TRUE(evaluation->true_thickness.has_value());
  EXPECT_GT(evaluation->true_thickness->median_m, 0.0);
}

TEST_F(EvaluateTraverseTest, MeasuresTheLargestSegmentWhenThePathBreaks) {
  // Between scans 1 and 2 the rover is carried to another world.
  options_.load_scan = [this](const std::string& path) -> absl::StatusOr<Scan> {
    const int index = std::stoi(path);
    if (index >= 2) return simulation_->ScanAt(index);
    sim::SimulationOptions other = simulation_->options();
    other.seed += 1;
    return sim::Simulation::Create(other)->ScanAt(index);
  };
  const absl::StatusOr<TraverseEvaluation> evaluation = EvaluateTraverse(dataset_, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  EXPECT_EQ(evaluation->tracked.num_segments, 2);
  EXPECT_EQ(evaluation->tracked.measured_segment, 1);
  EXPECT_EQ(evaluation->tracked.num_measured, 3);
  EXPECT_LT(evaluation->tracked.errors->drift_m.rmse, 0.05);
}

TEST_F(EvaluateTraverseTest, WithoutTruthThereAreNoErrors) {
  dataset_.T_world_scan.assign(kNumScans, std::nullopt);
  const absl::StatusOr<TraverseEvaluation> evaluation = EvaluateTraverse(dataset_, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  EXPECT_FALSE(evaluation->tracked.errors.has_value());
  EXPECT_FALSE(evaluation->true_thickness.has_value());
  EXPECT_GT(evaluation->optimised.thickness.num_cells, 0);
}

TEST_F(EvaluateTraverseTest, SaysWhetherTheOptimisationConverged) {
  absl::StatusOr<TraverseEvaluation> evaluation = EvaluateTraverse(dataset_, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  EXPECT_TRUE(evaluation->converged);
  EXPECT_THAT(TraverseEvaluationText(*evaluation), Not(HasSubstr("did not converge")));
  options_.tracking.pose_graph.max_iterations = 1;
  evaluation = EvaluateTraverse(dataset_, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  EXPECT_FALSE(evaluation->converged);
  EXPECT_THAT(TraverseEvaluationText(*evaluation), HasSubstr("did not converge"));
  EXPECT_EQ(nlohmann::json::parse(TraverseEvaluationJson(*evaluation))["converged"], false);
}

TEST_F(EvaluateTraverseTest, WritesAReport) {
  const absl::StatusOr<TraverseEvaluation> evaluation = EvaluateTraverse(dataset_, options_);
  ASSERT_TRUE(evaluation.ok()) << evaluation.status();
  const TemporaryFolder folder;
  // Of an evaluation of pairs in the same folder.
  std::ofstream(folder.File("report.json")) << "{\"methods\":[]}";
  std::ofstream(folder.File("distributions.csv")) << "method,quantity,value,share\n";
  ReportOptions report;
  report.load_scan = options_.load_scan;
  const absl::StatusOr<std::string> warning =
      WriteTraverseEvaluationReport(*evaluation, dataset_, folder.path(), report);
  ASSERT_TRUE(warning.ok()) << warning.status();
  for (const char* name : {"truth", "tracked", "optimised"}) {
    const auto poses = ReadTrajectoryFile(folder.File(absl::StrCat("trajectory_", name, ".tum")));
    ASSERT_TRUE(poses.ok()) << poses.status();
    ASSERT_EQ(poses->size(), kNumScans);
    EXPECT_LT(Difference(poses->front().T_world_scan, simulation_->T_world_scan(0)).translation_m, 1e-9) << name;
    EXPECT_LT(Difference(poses->back().T_world_scan, simulation_->T_world_scan(kNumScans - 1)).translation_m, 0.1);
  }
  EXPECT_TRUE(std::filesystem::exists(folder.File("map_optimised.ply")));
  EXPECT_TRUE(std::filesystem::exists(folder.File("report.html")));
  EXPECT_EQ(warning->empty(), std::filesystem::exists(folder.File("figure_5_drift.png"))) << *warning;
  EXPECT_FALSE(std::filesystem::exists(folder.File("figure_1_errors.png"))) << "of pairs";
  const nlohmann::json json = nlohmann::json::parse(TraverseEvaluationJson(*evaluation));
  EXPECT_EQ(json["scans"], kNumScans);
  EXPECT_EQ(json["tracked"]["drift_m"]["rmse"], evaluation->tracked.errors->drift_m.rmse);
  EXPECT_THAT(TraverseEvaluationText(*evaluation), HasSubstr("APE RMSE [mm]"));
}

TEST_F(EvaluateTraverseTest, RefusesASingleScanAndEndsAtARequest) {
  Dataset single;
  single.folder = "one";
  single.scan_names = {"0"};
  single.scan_paths = {"0"};
  single.T_world_scan = {std::nullopt};
  EXPECT_TRUE(absl::IsInvalidArgument(EvaluateTraverse(single, options_).status()));

  std::stop_source stop;
  options_.tracking.registration.cancellation = stop.get_token();
  options_.progress = [&](int num_done, const std::string&) {
    if (num_done == 2) stop.request_stop();
  };
  EXPECT_TRUE(absl::IsCancelled(EvaluateTraverse(dataset_, options_).status()));
}

}  // namespace
}  // namespace curvereg
