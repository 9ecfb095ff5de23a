// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What the service adds to the core's time, through a real server on loopback: the same pairs by the core alone and
// through the server, in turn; then two clients at once against one, with one thread each.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bench/service_fixture.h"
#include "core/register_scans.h"
#include "sim/presets.h"
#include "sim/simulation.h"

namespace curvereg {
namespace {

constexpr int kNumScans = 8;
constexpr int kRounds = 41;
constexpr int kThroughputCalls = 30;

double SecondsOf(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double Median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Drive {
  std::vector<std::shared_ptr<const Scan>> scans;
  std::vector<std::unique_ptr<const PreparedScan>> prepared;
};

// 720 x 400 beams, about 224 000 returns.
Drive MakeDrive() {
  sim::SimulationOptions options = *sim::PresetOptions("mars-yard-sim");
  options.scanner.pattern.rows = 400;
  const auto simulation = sim::Simulation::Create(options);
  Drive drive;
  for (int i = 0; i < kNumScans; ++i) {
    drive.scans.push_back(std::make_shared<Scan>(simulation->ScanAt(i)));
    drive.prepared.push_back(*PreparedScan::Create(drive.scans.back()));
  }
  return drive;
}

std::vector<std::string> UploadAll(Client& client, const Drive& drive) {
  std::vector<std::string> names;
  for (const auto& scan : drive.scans) {
    TransferOptions options;
    options.encoding.kind = TransferEncoding::Kind::kRaw;
    names.push_back(client.UploadScan(*scan, options)->scan.name);
  }
  return names;
}

using PairWork = std::function<bool(std::size_t source, std::size_t target)>;

// Medians of both [ms], measured in turn over the drive's consecutive pairs.
void PrintAdded(const char* title, double allowed_ms, const PairWork& core, const PairWork& service) {
  std::vector<double> core_seconds, service_seconds;
  bool accepted = true;
  for (int round = -kNumScans; round < kRounds; ++round) {
    const auto source = static_cast<std::size_t>(1 + (round + kNumScans) % (kNumScans - 1));
    const double of_core = SecondsOf([&] { accepted = core(source, source - 1) && accepted; });
    const double of_service = SecondsOf([&] { accepted = service(source, source - 1) && accepted; });
    if (round < 0) continue;
    core_seconds.push_back(of_core);
    service_seconds.push_back(of_service);
  }
  const double core_ms = 1e3 * Median(core_seconds), service_ms = 1e3 * Median(service_seconds);
  std::printf("%-44s %8.2f %10.2f %8.2f   (at most %.0f)%s\n", title, core_ms, service_ms, service_ms - core_ms,
              allowed_ms, accepted ? "" : "  NOT ALL ACCEPTED");
}

void PrintLatencies(const Drive& drive) {
  const bench::LoopbackService service;
  server::LimitsConfig no_cache;
  no_cache.cache_bytes = 1;
  const bench::LoopbackService forgetful(no_cache);
  const std::unique_ptr<Client> client = service.Connect();
  const std::unique_ptr<Client> forgetful_client = forgetful.Connect();
  const std::vector<std::string> names = UploadAll(*client, drive);
  UploadAll(*forgetful_client, drive);

  const auto core = [&](std::size_t source, std::size_t target) {
    return RegisterScans(*drive.scans[source], *drive.scans[target])->verdict.accepted;
  };
  const auto core_prepared = [&](std::size_t source, std::size_t target) {
    return RegisterPreparedScans(*drive.prepared[source], *drive.prepared[target])->verdict.accepted;
  };
  const auto by_name = [&](std::size_t source, std::size_t target) {
    return client->RegisterScans(names[source], names[target])->verdict.accepted;
  };
  const auto by_name_anew = [&](std::size_t source, std::size_t target) {
    return forgetful_client->RegisterScans(names[source], names[target])->verdict.accepted;
  };
  const auto inline_scans = [&](std::size_t source, std::size_t target) {
    return client->RegisterScans(std::cref(*drive.scans[source]), std::cref(*drive.scans[target]))->verdict.accepted;
  };
  std::printf("scans of %zu points; medians of %d rounds [ms]\n", drive.scans.front()->points.size(), kRounds);
  std::printf("%-44s %8s %10s %8s\n", "", "core", "service", "added");
  PrintAdded("two stored scans, prepared before", 3.0, core_prepared, by_name);
  PrintAdded("two stored scans, prepared for each call", 3.0, core, by_name_anew);
  PrintAdded("two scans sent along", 15.0, core, inline_scans);
}

// Registrations a second of `num_clients` at once, each with one thread, scans prepared before.
double Throughput(const bench::LoopbackService& service, const std::vector<std::string>& names, int num_clients) {
  std::vector<std::unique_ptr<Client>> clients;
  for (int i = 0; i < num_clients; ++i) clients.push_back(service.Connect());
  RegistrationOptions options;
  options.num_threads = 1;
  const double seconds = SecondsOf([&] {
    std::vector<std::jthread> threads;
    for (const auto& client : clients) {
      threads.emplace_back([&] {
        for (int i = 0; i < kThroughputCalls; ++i) {
          const auto source = static_cast<std::size_t>(1 + i % (kNumScans - 1));
          static_cast<void>(client->RegisterScans(names[source], names[source - 1], options));
        }
      });
    }
  });
  return num_clients * kThroughputCalls / seconds;
}

void PrintThroughput(const Drive& drive) {
  const bench::LoopbackService service;
  const std::unique_ptr<Client> client = service.Connect();
  const std::vector<std::string> names = UploadAll(*client, drive);
  Throughput(service, names, 1);
  std::vector<double> one, ratio;
  for (int round = 0; round < 5; ++round) {
    one.push_back(Throughput(service, names, 1));
    ratio.push_back(Throughput(service, names, 2) / one.back());
  }
  std::printf("one client, one thread: %.1f registrations/s; two clients: %.2f x (at least 1.8)\n", Median(one),
              Median(ratio));
}

}  // namespace
}  // namespace curvereg

int main() {
  const curvereg::Drive drive = curvereg::MakeDrive();
  curvereg::PrintLatencies(drive);
  curvereg::PrintThroughput(drive);
  return 0;
}
