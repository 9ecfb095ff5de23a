// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "eval/report.h"

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "eval/report_html.h"
#include "eval/report_json.h"
#include "files/cloud_file.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

PairOutcome Outcome(int source, double error_m, bool accepted) {
  PairOutcome outcome;
  outcome.source = std::to_string(source);
  outcome.target = std::to_string(source - 1);
  outcome.true_T_target_source = Eigen::Translation3d(1.0, 0.0, 0.0);
  outcome.result.T_target_source = Eigen::Translation3d(1.0, error_m, 0.0);
  outcome.result.verdict = {.accepted = accepted, .reasons = {}};
  if (!accepted) outcome.result.verdict.reasons = {Reason::kOverlapTooLow};
  outcome.seconds = 0.125;
  return outcome;
}

// Three scans in a row; the first pair is right, the second wrong and rejected; one failed negative pair.
class ReportTest : public ::testing::Test {
 protected:
  ReportTest() {
    dataset_.folder = "yard <1>";
    for (int i = 0; i < 3; ++i) {
      dataset_.scan_names.push_back(std::to_string(i));
      dataset_.scan_paths.push_back(std::to_string(i));
      dataset_.T_world_scan.push_back(RigidTransform(Eigen::Translation3d(i, 0.0, 0.0)));
    }
    evaluation_.dataset = dataset_.folder;
    MethodEvaluation& run = evaluation_.methods.emplace_back();
    run.outcomes = {Outcome(1, 0.001, true), Outcome(2, 3.0, false)};
    PairOutcome& negative = run.outcomes.emplace_back();
    negative.source = "2";
    negative.target = "0";
    negative.error = "cannot <do>";
    run.summary = Summarise(run.outcomes);
    options_.load_scan = [](const std::string&) -> absl::StatusOr<Scan> {
      Scan scan;
      for (int i = 0; i < 400; ++i) {
        scan.points.emplace_back(static_cast<float>(i % 20), static_cast<float>(i / 20), 0.1f * static_cast<float>(i));
      }
      return scan;
    };
  }

  std::string Read(const std::string& name) const {
    std::ostringstream text;
    text << std::ifstream(folder_.File(name), std::ios::binary).rdbuf();
    return text.str();
  }

  std::map<std::string, std::string> AllFiles() const {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      files[entry.path().filename().string()] = Read(entry.path().filename().string());
    }
    return files;
  }

  Dataset dataset_;
  Evaluation evaluation_;
  ReportOptions options_;
  testing::TemporaryFolder folder_;
};

TEST_F(ReportTest, JsonHasTheDocumentedKeys) {
  const auto json = nlohmann::json::parse(EvaluationJson(evaluation_));
  EXPECT_EQ(json["dataset"], "yard <1>");
  const auto& method = json["methods"][0];
  EXPECT_EQ(method["method"], "curvelet");
  EXPECT_EQ(method["pairs"], 2);
  EXPECT_EQ(method["ok"], 1);
  EXPECT_EQ(method["accepted"], 1);
  EXPECT_EQ(method["accepted_wrong"], 0);
  EXPECT_EQ(method["rejected_right"], 0);
  for (const char* key : {"rmse_translation_m", "rmse_rotation_rad", "rmse_ok_translation_m", "rmse_ok_rotation_rad",
                          "median_s", "p95_s"}) {
    EXPECT_TRUE(method[key].is_number()) << key;
  }
  const auto& detail = method["details"][0];
  EXPECT_EQ(detail["source"], "1");
  EXPECT_EQ(detail["target"], "0");
  EXPECT_EQ(detail["accepted"], true);
  EXPECT_EQ(detail["translation_error_m"], PoseError(evaluation_.methods[0].outcomes[0]).translation_m);  // every digit
  EXPECT_EQ(detail["rotation_error_rad"], 0.0);
  EXPECT_EQ(detail["seconds"], 0.125);
  EXPECT_TRUE(method["details"][2]["translation_error_m"].is_null());
  EXPECT_EQ(method["details"][2]["error"], "cannot <do>");
  EXPECT_EQ(method["details"][1]["reasons"][0], "overlap_too_low");
}

TEST_F(ReportTest, HtmlEscapesNamesAndListsFailures) {
  HtmlPageContent page = EvaluationPage(evaluation_);
  page.pictures = {{.title = "A & B", .png = "abc"}};
  page.note = "no figures: <why>";
  const std::string html = HtmlPage(page);
  EXPECT_THAT(html, HasSubstr("yard &lt;1&gt;"));
  EXPECT_THAT(html, HasSubstr("A &amp; B"));
  EXPECT_THAT(html, HasSubstr("data:image/png;base64,YWJj"));
  EXPECT_THAT(html, HasSubstr("no figures: &lt;why&gt;"));
  EXPECT_THAT(html, HasSubstr("overlap_too_low"));
  EXPECT_THAT(html, HasSubstr("cannot &lt;do&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("<do>")));
  EXPECT_THAT(html, Not(HasSubstr("http")));  // self-contained
}

TEST_F(ReportTest, WithoutPythonAllButTheFiguresIsWritten) {
  options_.figures.python = folder_.File("no_such_python");
  const auto warning = WriteReport(evaluation_, dataset_, folder_.path(), options_);
  ASSERT_TRUE(warning.ok()) << warning.status();
  EXPECT_THAT(*warning, HasSubstr("no_such_python is missing"));
  EXPECT_THAT(Read("report.html"), HasSubstr("no_such_python is missing"));
  EXPECT_THAT(Read("report.json"), HasSubstr("\"curvelet\""));
  EXPECT_THAT(Read("distributions.csv"), HasSubstr("curvelet,seconds,0.125,1\n"));
  EXPECT_THAT(Read("map_curvelet.ply"), HasSubstr("element vertex"));
  EXPECT_TRUE(std::filesystem::exists(folder_.File("trajectory_truth.tum")));
  EXPECT_TRUE(std::filesystem::exists(folder_.File("trajectory_curvelet.tum")));
}

TEST_F(ReportTest, AFailingScriptIsNamedWithItsLastWords) {
  std::ofstream(folder_.File("broken.py")) << "raise SystemExit('first\\nthe end')\n";
  options_.figures.script = folder_.File("broken.py");
  options_.figures.python = "/usr/bin/python3";
  if (!std::filesystem::exists(options_.figures.python)) GTEST_SKIP() << "no " << options_.figures.python;
  const auto figures = DrawFigures(folder_.path(), Drawing::kPairEvaluation, options_.figures);
  EXPECT_EQ(figures.status().code(), absl::StatusCode::kInternal);
  EXPECT_THAT(std::string(figures.status().message()), HasSubstr("the end"));
}

TEST_F(ReportTest, DrawsThePaperFiguresAndRepeatsItselfToTheByte) {
  const auto warning = WriteReport(evaluation_, dataset_, folder_.path(), options_);
  ASSERT_TRUE(warning.ok()) << warning.status();
  if (!warning->empty()) GTEST_SKIP() << *warning;
  const auto first = AllFiles();
  for (const char* name : {"figure_1_errors.png", "figure_2_run_time.png", "figure_3_trajectory.png",
                           "figure_4_map_curvelet.png", "report.html"}) {
    ASSERT_TRUE(first.contains(name)) << name;
    EXPECT_GT(first.at(name).size(), 2000u) << name;
  }
  std::size_t num_pictures = 0;
  const std::string& html = first.at("report.html");
  for (std::size_t at = html.find("data:image/png"); at != std::string::npos;
       at = html.find("data:image/png", at + 1)) {
    ++num_pictures;
  }
  EXPECT_EQ(num_pictures, 4u);
  ASSERT_TRUE(WriteReport(evaluation_, dataset_, folder_.path(), options_).ok());
  EXPECT_TRUE(AllFiles() == first);
}

TEST_F(ReportTest, NothingAcceptedLeavesNoMap) {
  std::ofstream(folder_.File("map_curvelet.ply")) << "of an earlier run";
  std::ofstream(folder_.File("figure_4_map_curvelet.png")) << "of an earlier run";
  for (PairOutcome& outcome : evaluation_.methods[0].outcomes) outcome.result.verdict = Verdict{};
  const auto warning = WriteReport(evaluation_, dataset_, folder_.path(), options_);
  ASSERT_TRUE(warning.ok()) << warning.status();
  EXPECT_FALSE(std::filesystem::exists(folder_.File("map_curvelet.ply")));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("figure_4_map_curvelet.png")));
}

TEST_F(ReportTest, TheMapIsThinnedToAPointPerCell) {
  options_.map_cell_m = 1.5;
  ASSERT_TRUE(WriteReport(evaluation_, dataset_, folder_.path(), options_).ok());
  EXPECT_THAT(Read("trajectory_curvelet.tum"), HasSubstr("\n1.000000000 1.000000000000 0.001"));
  const auto map = ReadCloudFile(folder_.File("map_curvelet.ply"));
  ASSERT_TRUE(map.ok()) << map.status();
  // The scan is a tilted plane of 400 points, 1 m apart; scan 1 lies 1 m beside scan 0, scan 2 was rejected.
  std::set<std::array<double, 3>> cells;
  for (const Eigen::Vector3f& point : map->points) {
    const Eigen::Vector3d cell = (point.cast<double>() / 1.5).array().floor();
    EXPECT_TRUE(cells.insert({cell.x(), cell.y(), cell.z()}).second) << "one point per cell";
  }
  EXPECT_GT(cells.size(), 200u);
  EXPECT_LT(cells.size(), 800u);
}

TEST_F(ReportTest, AFolderThatIsNotThereIsAnError) {
  const auto warning = WriteReport(evaluation_, dataset_, folder_.File("absent"), options_);
  EXPECT_FALSE(warning.ok());
  EXPECT_THAT(std::string(warning.status().message()), HasSubstr("absent"));
}

}  // namespace
}  // namespace curvereg
