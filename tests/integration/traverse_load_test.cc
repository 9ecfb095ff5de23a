// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// A real server that follows a long drive, and many rovers at once. CURVEREG_LONG_TESTS=1 drives 1,000 scans and holds
// the times to the limits of an idle machine of 2 cores; CURVEREG_TEST_STREAMED_SCANS and CURVEREG_TEST_PAUSE_MS change
// the drive's length and how long the rover waits between an answer and its next scan.
#include <algorithm>
#include <barrier>
#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <numeric>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/traverses.h"
#include "core/base/parallel.h"
#include "core/methods/prepared_scan.h"
#include "core/register_scans.h"
#include "sim/presets.h"
#include "sim/simulation.h"
#include "tests/testing/matchers.h"
#include "tests/testing/server_process.h"
#include "tests/testing/test_data.h"
#include "tests/testing/traverses.h"

namespace curvereg {
namespace {

using testing::IsOk;
using Clock = std::chrono::steady_clock;

bool IsLong() { return std::getenv("CURVEREG_LONG_TESTS") != nullptr; }

uint64_t FromEnvironment(const char* name, uint64_t otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

double SecondsSince(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

StreamedScan NumberedScan(uint64_t sequence_number, Scan scan) {
  StreamedScan streamed;
  streamed.sequence_number = sequence_number;
  streamed.scan = std::move(scan);
  return streamed;
}

// A yard driven through to and fro, as often as one likes. Scans of 720 x 400 beams, about 224,000 returns each.
class Shuttle {
 public:
  Shuttle() {
    sim::SimulationOptions options = *sim::PresetOptions("mars-yard-sim");
    options.scanner.pattern.rows = 400;
    const auto simulation = sim::Simulation::Create(options);
    for (int i = 0; i < simulation->num_scans(); ++i) scans_.push_back(simulation->ScanAt(i));
  }

  // No two are the same, or the server would find some of them prepared: of each passage one point less is kept.
  Scan Number(uint64_t number) const {
    const uint64_t way = scans_.size() - 1;
    const uint64_t along = number % (2 * way);
    Scan scan = scans_[along <= way ? along : 2 * way - along];
    scan.points.resize(scan.points.size() - (number + way) / way);
    return scan;
  }

  // Seconds in which the server answers for a new stored scan and its prepared predecessor; the median. `round` tells
  // one measurement's scans from another's.
  double ServedPairSeconds(Client& client, size_t round) const {
    std::vector<double> seconds;
    std::string predecessor;
    for (size_t i = 0; i <= scans_.size() / 2; ++i) {
      Scan scan = scans_[i];
      scan.points.resize(scan.points.size() - 1000 * round);
      const auto uploaded = client.UploadScan(scan, {});
      EXPECT_THAT(uploaded, IsOk());
      const Clock::time_point start = Clock::now();
      if (i > 0) {
        const auto result = client.RegisterScans(uploaded->scan.name, predecessor);
        EXPECT_THAT(result, IsOk());
        seconds.push_back(SecondsSince(start));
      }
      predecessor = uploaded->scan.name;
    }
    return Median(std::move(seconds));
  }

  // Seconds in which the core alone prepares a scan and registers it on its prepared predecessor; the median.
  double PairSeconds() const {
    std::vector<double> seconds;
    for (size_t i = 1; i < scans_.size(); i += 2) {
      const std::unique_ptr<const PreparedScan> target = *PreparedScan::Create(Shared(i - 1));
      static_cast<void>(target->View(BirdsEyeView::kElevation, 0));
      const std::shared_ptr<const Scan> scan = Shared(i);
      const Clock::time_point start = Clock::now();
      const std::unique_ptr<const PreparedScan> source = *PreparedScan::Create(scan);
      EXPECT_TRUE(RegisterPreparedScans(*source, *target)->verdict.accepted) << i;
      seconds.push_back(SecondsSince(start));
    }
    return Median(std::move(seconds));
  }

 private:
  std::shared_ptr<const Scan> Shared(size_t i) const { return std::make_shared<const Scan>(scans_[i]); }

  std::vector<Scan> scans_;
};

struct AnswerTimes {
  double server_s = 0.0;  // from the scan's acknowledgement to its result, as the server tells
  double client_s = 0.0;  // the same, as the rover sees it
  double send_s = 0.0;    // from Send to the result: encoding and transfer too
};

// Streams one scan at a time and waits for its result.
class Rover {
 public:
  Rover(Client& client, const std::string& name) {
    StreamOptions options;
    options.on_acknowledged = [this](uint64_t, const std::string&) {
      const std::lock_guard lock(mutex_);
      acknowledged_ = Clock::now();
    };
    options.on_result = [this](const ScanResult& result) {
      const std::lock_guard lock(mutex_);
      answered_ = Clock::now();
      results.push_back(result);
      arrived_.notify_all();
    };
    auto streamer = client.traverses().Stream(name, options);
    EXPECT_THAT(streamer, IsOk());
    streamer_ = *std::move(streamer);
  }

  AnswerTimes Ask(Scan scan) {
    const Clock::time_point start = Clock::now();
    const size_t number = results.size();
    EXPECT_THAT(streamer_->Send(NumberedScan(number, std::move(scan))), IsOk());
    std::unique_lock lock(mutex_);
    EXPECT_TRUE(arrived_.wait_for(lock, std::chrono::seconds(60), [&] { return results.size() > number; }));
    const auto seconds_since = [&](Clock::time_point from) {
      return std::chrono::duration<double>(answered_ - from).count();
    };
    return {results.back().latency_s, seconds_since(acknowledged_), seconds_since(start)};
  }

  absl::Status Finish() { return streamer_->Finish(); }

  std::vector<ScanResult> results;

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  Clock::time_point acknowledged_;
  Clock::time_point answered_;
  std::unique_ptr<ScanStreamer> streamer_;
};

AnswerTimes MedianOf(const std::vector<AnswerTimes>& times, uint64_t first, uint64_t end) {
  std::vector<double> server, client, send;
  for (uint64_t i = first; i < end; ++i) {
    server.push_back(times[i].server_s);
    client.push_back(times[i].client_s);
    send.push_back(times[i].send_s);
  }
  return {Median(server), Median(client), Median(send)};
}

// Of a new scan and its prepared predecessor.
struct PairTimes {
  double core_s = 0.0;
  double served_s = 0.0;
};

void Print(const char* when, const AnswerTimes& times, const PairTimes& pair) {
  std::printf("%s: answered in %.1f ms (the rover sees %.1f, from Send %.1f)\n", when, 1e3 * times.server_s,
              1e3 * times.client_s, 1e3 * times.send_s);
  std::printf(
      "  a prepared pair: %.1f ms by the core alone, ratio %.2f; %.1f ms as the server's client sees it, ratio %.2f\n",
      1e3 * pair.core_s, times.server_s / pair.core_s, 1e3 * pair.served_s, times.client_s / pair.served_s);
}

TEST(TraverseLoadTest, ALateScanIsAnsweredAsSoonAsAnEarlyOne) {
  const uint64_t num_scans = FromEnvironment("CURVEREG_TEST_STREAMED_SCANS", IsLong() ? 1000 : 200);
  const std::chrono::milliseconds pause(FromEnvironment("CURVEREG_TEST_PAUSE_MS", 60));
  constexpr uint64_t kWindow = 30;
  constexpr uint64_t kFirstMeasured = 10;  // then as many scans as the cache keeps have come
  const Shuttle shuttle;
  const testing::TemporaryFolder folder;
  testing::ServerProcess server(CURVEREG_SERVER_EXECUTABLE, folder.path(),
                                {"--log-level", "error", "--limits-cache-bytes", std::to_string(uint64_t{96} << 20)});
  auto client = Client::Connect(server.target());
  ASSERT_THAT(client, IsOk());
  TraverseSettings settings;
  settings.optimize_on_the_fly = true;
  ASSERT_THAT((*client)->traverses().Create("drive", settings), IsOk());
  Rover rover(**client, "traverses/drive");
  std::vector<AnswerTimes> times;
  uint64_t memory_before = 0;
  PairTimes early_pair;
  for (uint64_t i = 0; i < num_scans; ++i) {
    times.push_back(rover.Ask(shuttle.Number(i)));
    if (i + 1 == 100) memory_before = server.ResidentBytes();
    if (i + 1 == kFirstMeasured + kWindow) early_pair = {shuttle.PairSeconds(), shuttle.ServedPairSeconds(**client, 1)};
    std::this_thread::sleep_for(pause);
  }
  const uint64_t memory_after = server.ResidentBytes();
  const PairTimes late_pair = {shuttle.PairSeconds(), shuttle.ServedPairSeconds(**client, 2)};
  const auto trajectory = (*client)->traverses().GetTrajectory("traverses/drive");
  ASSERT_THAT(trajectory, IsOk());
  ASSERT_EQ(trajectory->poses.size(), num_scans);
  for (const TrajectoryPose& pose : trajectory->poses) EXPECT_EQ(pose.segment, 0) << pose.sequence_number;
  const AnswerTimes early = MedianOf(times, kFirstMeasured, kFirstMeasured + kWindow);
  const AnswerTimes late = MedianOf(times, num_scans - kWindow, num_scans);
  const double bytes_per_scan =
      (static_cast<double>(memory_after) - static_cast<double>(memory_before)) / static_cast<double>(num_scans - 100);
  Print("scans 10 to 39", early, early_pair);
  Print("the last 30 scans", late, late_pair);
  std::printf("%llu scans, version %llu; server memory %.0f MB after 100 scans, %.0f MB at the end: %.3f MB per scan\n",
              static_cast<unsigned long long>(num_scans), static_cast<unsigned long long>(trajectory->version),
              static_cast<double>(memory_before) * 1e-6, static_cast<double>(memory_after) * 1e-6,
              bytes_per_scan * 1e-6);
  // The heap takes some hundreds of scans to settle; a short drive allows for that.
  const double settling_bytes = IsLong() ? 0.0 : 64e6 / static_cast<double>(num_scans - 100);
  EXPECT_LE(bytes_per_scan, 1e6 + settling_bytes);
  // The machine itself may have become slower, which the pair by the core alone tells.
  const double slowdown = std::max(1.0, late_pair.core_s / early_pair.core_s);
  EXPECT_LE(late.server_s, 1.5 * slowdown * early.server_s);
  EXPECT_LE(late.client_s, 1.5 * slowdown * early.client_s);
  if (!IsLong()) return;
  EXPECT_LE(early.server_s, 0.040);
  EXPECT_LE(late.server_s, 0.040);
  EXPECT_LE(early.client_s, 1.2 * early_pair.served_s);
  EXPECT_LE(late.client_s, 1.2 * late_pair.served_s);
}

// A small drive of its own for each rover.
std::vector<Scan> DriveOf(int rover, int num_scans) {
  sim::SimulationOptions options = testing::SmallDrive(num_scans);
  options.seed = 100 + static_cast<uint64_t>(rover);
  const auto simulation = sim::Simulation::Create(options);
  std::vector<Scan> scans;
  for (int i = 0; i < num_scans; ++i) scans.push_back(simulation->ScanAt(i));
  return scans;
}

struct Stream {
  std::vector<TrajectoryPose> poses;
  std::vector<Clock::time_point> answered;  // by scan
};

// Sends all the scans at once, by a client of its own, when all that wait at `start` are ready.
Stream StreamDrive(const std::string& target, const std::string& id, const std::vector<Scan>& scans,
                   std::barrier<>& start) {
  auto client = Client::Connect(target);
  EXPECT_THAT(client, IsOk());
  TraverseSettings settings;
  settings.registration.num_threads = 1;
  EXPECT_THAT((*client)->traverses().Create(id, settings), IsOk());
  Stream stream;
  StreamOptions options;
  options.on_result = [&](const ScanResult& result) {
    stream.poses.push_back(result.pose);
    stream.answered.push_back(Clock::now());
  };
  auto streamer = (*client)->traverses().Stream("traverses/" + id, options);
  EXPECT_THAT(streamer, IsOk());
  start.arrive_and_wait();
  for (uint64_t i = 0; i < scans.size(); ++i) {
    EXPECT_THAT((*streamer)->Send(NumberedScan(i, scans[i])), IsOk());
  }
  EXPECT_THAT((*streamer)->Finish(), IsOk());
  return stream;
}

void ExpectSamePoses(const Stream& together, const Stream& alone) {
  ASSERT_EQ(together.poses.size(), alone.poses.size());
  for (size_t i = 0; i < alone.poses.size(); ++i) {
    const TrajectoryPose& pose = together.poses[i];
    EXPECT_EQ(pose.sequence_number, i);
    EXPECT_EQ(pose.segment, alone.poses[i].segment);
    EXPECT_EQ(pose.origin, alone.poses[i].origin);
    EXPECT_EQ(pose.T_segment_scan.matrix(), alone.poses[i].T_segment_scan.matrix()) << i;
    EXPECT_EQ(pose.covariance, alone.poses[i].covariance) << i;
  }
}

struct Shares {
  double slowest_rate = 0.0;  // of the mean rate over each rover's whole drive
  double fewest_scans = 0.0;  // of the mean number of scans answered while all rovers were waiting for more
  double scans_per_s = 0.0;
};

Shares SharesOf(const std::vector<Stream>& streams, Clock::time_point start) {
  std::vector<double> rates;
  std::vector<double> counts;
  Clock::time_point first_end = Clock::time_point::max();
  for (const Stream& stream : streams) first_end = std::min(first_end, stream.answered.back());
  Shares shares;
  for (const Stream& stream : streams) {
    const double seconds = std::chrono::duration<double>(stream.answered.back() - start).count();
    rates.push_back(static_cast<double>(stream.answered.size()) / seconds);
    counts.push_back(
        static_cast<double>(std::count_if(stream.answered.begin(), stream.answered.end(),
                                          [&](Clock::time_point answered) { return answered <= first_end; })));
  }
  const auto least_of_mean = [](const std::vector<double>& values) {
    const double sum = std::accumulate(values.begin(), values.end(), 0.0);
    return *std::min_element(values.begin(), values.end()) * static_cast<double>(values.size()) / sum;
  };
  shares.slowest_rate = least_of_mean(rates);
  shares.fewest_scans = least_of_mean(counts);
  shares.scans_per_s =
      std::accumulate(counts.begin(), counts.end(), 0.0) / std::chrono::duration<double>(first_end - start).count();
  return shares;
}

TEST(TraverseLoadTest, SixteenRoversAtOnceAreServedAlike) {
  constexpr int kNumRovers = 16;
  constexpr int kNumScans = 12;
  std::vector<std::vector<Scan>> drives;
  for (int i = 0; i < kNumRovers; ++i) drives.push_back(DriveOf(i, kNumScans));
  const testing::TemporaryFolder folder;
  testing::ServerProcess server(CURVEREG_SERVER_EXECUTABLE, folder.path(), {"--log-level", "error"});
  std::vector<Stream> together(kNumRovers);
  Clock::time_point start;
  {
    std::barrier<> ready(kNumRovers + 1);
    std::vector<std::jthread> rovers;
    for (int i = 0; i < kNumRovers; ++i) {
      rovers.emplace_back([&, i] {
        const auto number = static_cast<size_t>(i);
        together[number] = StreamDrive(server.target(), "rover-" + std::to_string(i), drives[number], ready);
      });
    }
    ready.arrive_and_wait();
    start = Clock::now();
  }
  for (const Stream& stream : together) ASSERT_EQ(stream.answered.size(), size_t{kNumScans});
  const Shares shares = SharesOf(together, start);
  std::printf(
      "%.1f scans/s of all %d rovers; the slowest rover's rate %.2f of the mean, fewest scans %.2f of the mean\n",
      shares.scans_per_s, kNumRovers, shares.slowest_rate, shares.fewest_scans);
  EXPECT_GE(shares.slowest_rate, 0.7);
  const testing::TemporaryFolder quiet_folder;
  testing::ServerProcess quiet(CURVEREG_SERVER_EXECUTABLE, quiet_folder.path(), {"--log-level", "error"});
  for (int i = 0; i < kNumRovers; ++i) {
    std::barrier<> nobody_else(1);
    const auto number = static_cast<size_t>(i);
    const Stream alone = StreamDrive(quiet.target(), "rover-" + std::to_string(i), drives[number], nobody_else);
    SCOPED_TRACE(i);
    ExpectSamePoses(together[number], alone);
  }
}

}  // namespace
}  // namespace curvereg
