// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "server/operations/process_statistics.h"
#include "tests/testing/test_data.h"

namespace curvereg::server {
namespace {

using std::chrono::milliseconds;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr char kService[] = "curvereg.v1.RegistrationService";

// The value of the sample with exactly this name and these labels; NaN when there is none.
double Value(const std::string& text, const std::string& sample) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with(sample + " ")) return std::stod(line.substr(sample.size() + 1));
  }
  return std::nan("");
}

RegistrationResult GoodResult() {
  RegistrationResult result;
  result.verdict = {.accepted = true, .reasons = {}};
  result.evidence.num_source_points = 900;
  result.evidence.num_target_points = 800;
  result.evidence.num_hypotheses = 12;
  result.evidence.num_inliers = 40;
  result.evidence.num_attempts = 3;
  result.evidence.overlap_source = 0.75;
  result.evidence.overlap_target = 0.55;
  result.evidence.residual_rmse_m = 0.04;
  result.stage_times = {{"refinement", 0.02}, {"matching", 0.003}};
  result.total_seconds = 0.03;
  return result;
}

// Everything that can be counted, once.
void CountAll(Metrics& metrics) {
  metrics.RpcStarted(kService, "RegisterScans");
  metrics.MessageReceived(kService, "RegisterScans");
  metrics.MessageSent(kService, "RegisterScans");
  metrics.RpcHandled(kService, "RegisterScans", "OK", milliseconds(30));
  metrics.Rejected("QUEUE_FULL");
  metrics.QueueWaited(milliseconds(4));
  metrics.Registered(GoodResult());
  metrics.ScanReceived(1000);
  metrics.UploadResumed();
  metrics.UploadCompleted(5000);
  metrics.ChecksumFailed();
  metrics.SetGauge("curvereg_queue_length", "Registrations that wait", [] { return 3.0; });
  metrics.SetCounter("curvereg_cache_hits_total", "Scans found prepared", [] { return 7.0; });
}

TEST(MetricsTest, CountsCallsByMethodAndCode) {
  Metrics metrics;
  const std::string labels = "{grpc_method=\"GetScan\",grpc_service=\"s\"}";
  for (int i = 0; i < 3; ++i) metrics.RpcStarted("s", "GetScan");
  metrics.RpcHandled("s", "GetScan", "OK", milliseconds(1));
  metrics.RpcHandled("s", "GetScan", "NOT_FOUND", milliseconds(40));
  metrics.RpcHandled("s", "GetScan", "NOT_FOUND", milliseconds(2000));
  metrics.MessageReceived("s", "GetScan");
  metrics.RpcStarted("s", "ListScans");
  const std::string text = metrics.Text();
  EXPECT_EQ(Value(text, "grpc_server_started_total" + labels), 3.0);
  EXPECT_EQ(Value(text, "grpc_server_started_total{grpc_method=\"ListScans\",grpc_service=\"s\"}"), 1.0);
  EXPECT_EQ(Value(text, "grpc_server_msg_received_total" + labels), 1.0);
  EXPECT_EQ(Value(text, "grpc_server_msg_sent_total" + labels), 0.0);
  EXPECT_EQ(
      Value(text, "grpc_server_handled_total{grpc_code=\"NOT_FOUND\",grpc_method=\"GetScan\",grpc_service=\"s\"}"),
      2.0);
  const std::string not_found = "grpc_code=\"NOT_FOUND\",grpc_method=\"GetScan\",grpc_service=\"s\"";
  EXPECT_EQ(Value(text, "grpc_server_handling_seconds_count{" + not_found + "}"), 2.0);
  EXPECT_NEAR(Value(text, "grpc_server_handling_seconds_sum{" + not_found + "}"), 2.04, 1e-9);
  EXPECT_EQ(Value(text, "grpc_server_handling_seconds_bucket{" + not_found + ",le=\"0.05\"}"), 1.0);
  EXPECT_THAT(text, Not(HasSubstr("grpc_code=\"INTERNAL\""))) << "what never came has no series";
  EXPECT_EQ(Value(text, "curvereg_open_calls{grpc_method=\"ListScans\",grpc_service=\"s\"}"), 1.0);
  EXPECT_EQ(Value(text, "curvereg_open_calls" + labels), 0.0);
}

TEST(MetricsTest, TellsWhatRegistrationsGave) {
  Metrics metrics;
  metrics.Registered(GoodResult());
  RegistrationResult rejected;  // no evidence: -1 everywhere
  rejected.verdict.reasons = {Reason::kOverlapTooLow, Reason::kAmbiguous};
  metrics.Registered(rejected);
  const std::string text = metrics.Text();
  EXPECT_EQ(Value(text, "curvereg_verdict_total{reason=\"\",verdict=\"accepted\"}"), 1.0);
  EXPECT_EQ(Value(text, "curvereg_verdict_total{reason=\"overlap_too_low\",verdict=\"rejected\"}"), 1.0);
  EXPECT_EQ(Value(text, "curvereg_registration_seconds_count"), 2.0);
  EXPECT_EQ(Value(text, "curvereg_stage_seconds_count{stage=\"refinement\"}"), 1.0);
  EXPECT_NEAR(Value(text, "curvereg_stage_seconds_sum{stage=\"matching\"}"), 0.003, 1e-12);
  EXPECT_EQ(Value(text, "curvereg_registration_attempts_count"), 2.0);
  EXPECT_EQ(Value(text, "curvereg_registration_attempts_bucket{le=\"2\"}"), 1.0);
  EXPECT_EQ(Value(text, "curvereg_registration_hypotheses_sum"), 12.0);
  EXPECT_EQ(Value(text, "curvereg_registration_inliers_count"), 2.0);
  EXPECT_EQ(Value(text, "curvereg_registration_inliers_sum"), 40.0);
  EXPECT_EQ(Value(text, "curvereg_registration_points_total"), 1700.0);
  EXPECT_EQ(Value(text, "curvereg_residual_meters_count"), 1.0);
  EXPECT_EQ(Value(text, "curvereg_overlap_ratio_count"), 1.0);
  EXPECT_NEAR(Value(text, "curvereg_overlap_ratio_sum"), 0.55, 1e-12);
}

TEST(MetricsTest, AsksForReadingsAtEachScrape) {
  Metrics metrics;
  int calls = 0;
  metrics.SetGauge("curvereg_x", "x", [&calls] { return ++calls; });
  EXPECT_EQ(Value(metrics.Text(), "curvereg_x"), 1.0);
  EXPECT_EQ(Value(metrics.Text(), "curvereg_x"), 2.0);
  metrics.SetGauge("curvereg_x", "x", [] { return 9.0; });  // takes the place of the first
  EXPECT_EQ(Value(metrics.Text(), "curvereg_x"), 9.0);
  EXPECT_THAT(metrics.Text(), HasSubstr("# TYPE curvereg_x gauge"));
}

TEST(MetricsTest, StartsAtZero) {
  const std::string text = Metrics().Text();
  EXPECT_EQ(Value(text, "curvereg_uploads_resumed_total"), 0.0);
  EXPECT_EQ(Value(text, "curvereg_checksum_failures_total"), 0.0);
  EXPECT_EQ(Value(text, "curvereg_queue_wait_seconds_count"), 0.0);
  EXPECT_THAT(text, HasSubstr("curvereg_build_info{build=\"curvereg"));
  EXPECT_THAT(text, Not(HasSubstr("curvereg_rejected_total{")));
}

TEST(MetricsTest, KnowsTheProcess) {
  const std::string text = Metrics().Text();
  EXPECT_GT(Value(text, "process_resident_memory_bytes"), 1e6);
  EXPECT_GT(Value(text, "process_virtual_memory_bytes"), Value(text, "process_resident_memory_bytes"));
  EXPECT_GT(Value(text, "process_cpu_seconds_total"), 0.0);
  EXPECT_GE(Value(text, "process_max_fds"), Value(text, "process_open_fds"));
  EXPECT_GE(Value(text, "process_threads"), 1.0);
  const double now = static_cast<double>(std::time(nullptr));
  EXPECT_NEAR(Value(text, "process_start_time_seconds"), now, 120.0);
}

TEST(ProcessStatisticsTest, CountsOpenFiles) {
  const double before = ReadProcessStatistics().num_open_files;
  std::FILE* file = std::fopen("/dev/null", "r");
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(ReadProcessStatistics().num_open_files, before + 1.0);
  std::fclose(file);
}

TEST(MetricsTest, LosesNothingOnSeveralThreads) {
  Metrics metrics;
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&metrics] {
      for (int i = 0; i < 1000; ++i) {
        CountAll(metrics);
        if (i % 250 == 0) static_cast<void>(metrics.Text());
      }
    });
  }
  threads.clear();
  const std::string text = metrics.Text();
  EXPECT_EQ(Value(text, "curvereg_rejected_total{reason=\"QUEUE_FULL\"}"), 4000.0);
  EXPECT_EQ(Value(text, "curvereg_received_points_total"), 4'000'000.0);
  EXPECT_EQ(
      Value(text, "grpc_server_handling_seconds_count{grpc_code=\"OK\",grpc_method=\"RegisterScans\",grpc_service=\"" +
                      std::string(kService) + "\"}"),
      4000.0);
}

TEST(MetricsTest, PrometheusFindsNoFault) {
  if (std::system("command -v promtool >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "promtool (Debian: prometheus) is missing";
  Metrics metrics;
  CountAll(metrics);
  const testing::TemporaryFolder folder;
  std::ofstream(folder.File("metrics")) << metrics.Text();
  const std::string command =
      "promtool check metrics <" + folder.File("metrics") + " >" + folder.File("faults") + " 2>&1";
  const int status = std::system(command.c_str());
  std::ostringstream faults;
  faults << std::ifstream(folder.File("faults")).rdbuf();
  EXPECT_EQ(status, 0) << faults.str();
}

}  // namespace
}  // namespace curvereg::server
