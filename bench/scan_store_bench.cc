// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Storing scans beside writing the same bytes to a bare file and forcing them to disk, in turn. Works in the folder
// given as the only argument, or the system's temporary one: what it lies on decides.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/scan_store.h"
#include "wire/digest.h"

namespace curvereg::server {
namespace {

constexpr std::size_t kChunkBytes = std::size_t{1} << 20;
constexpr int kRounds = 15;

// One scan's times [ms].
struct Times {
  double append = 0.0;  // per 1 MiB
  double commit = 0.0;
  double total = 0.0;
};

double MillisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void Require(bool is_done, const char* what) {
  if (is_done) return;
  std::fprintf(stderr, "%s failed\n", what);
  std::exit(1);
}

// Calls append(offset, chunk) for all of the payload, then commit().
template <typename Append, typename Commit>
Times Measure(std::string_view payload, const Append& append, const Commit& commit) {
  Times times;
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t offset = 0; offset < payload.size(); offset += kChunkBytes) {
    append(offset, payload.substr(offset, kChunkBytes));
  }
  times.append = MillisecondsSince(start) * static_cast<double>(kChunkBytes) / static_cast<double>(payload.size());
  const auto committing = std::chrono::steady_clock::now();
  commit();
  times.commit = MillisecondsSince(committing);
  times.total = MillisecondsSince(start);
  return times;
}

Times MeasureBare(const std::string& path, std::string_view payload) {
  const int fd = open(path.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const Times times = Measure(
      payload,
      [&](std::size_t offset, std::string_view chunk) {
        Require(pwrite(fd, chunk.data(), chunk.size(), static_cast<off_t>(offset)) > 0, "pwrite");
      },
      [&] { Require(fdatasync(fd) == 0, "fdatasync"); });
  close(fd);
  unlink(path.c_str());
  return times;
}

Times MeasureStore(ScanStore& store, std::string_view payload) {
  UploadDescription description;
  description.id = "bench";
  description.payload_bytes = payload.size();
  const std::unique_ptr<UploadWriter> writer = store.BeginUpload(description).value();
  std::string id;
  const Times times = Measure(
      payload,
      [&](std::size_t offset, std::string_view chunk) { Require(writer->Append(offset, chunk).ok(), "Append"); },
      [&] { id = writer->Commit(0, "").value().scan.id; });
  Require(store.DeleteScan(id).ok(), "DeleteScan");
  return times;
}

double Median(std::vector<Times> times, double Times::*part) {
  std::sort(times.begin(), times.end(), [part](const Times& a, const Times& b) { return a.*part < b.*part; });
  return times[times.size() / 2].*part;
}

void Compare(ScanStore& store, const std::string& folder, std::size_t size) {
  std::mt19937_64 generator(size);
  std::string payload(size, '\0');
  std::vector<Times> bare;
  std::vector<Times> stored;
  for (int i = 0; i < kRounds; ++i) {
    // New bytes each time, or the payload would be known.
    for (std::size_t j = 0; j < size; j += 512) payload[j] = static_cast<char>(generator());
    bare.push_back(MeasureBare(folder + "/bare", payload));
    stored.push_back(MeasureStore(store, payload));
  }
  for (const auto& [name, part] :
       {std::pair{"append 1 MiB", &Times::append}, {"commit", &Times::commit}, {"all", &Times::total}}) {
    const double bare_ms = Median(bare, part);
    const double stored_ms = Median(stored, part);
    std::printf("%8.1f MB %-14s %10.3f ms %10.3f ms %8.2f\n", static_cast<double>(size) * 1e-6, name, stored_ms,
                bare_ms, stored_ms / bare_ms);
  }
}

}  // namespace

int RunScanStoreBench(const std::string& parent) {
  std::string folder = parent + "/scan_store_bench_XXXXXX";
  if (mkdtemp(folder.data()) == nullptr) {
    std::fprintf(stderr, "%s: cannot make a folder there\n", parent.c_str());
    return 1;
  }
  {
    const std::unique_ptr<ScanStore> store = ScanStore::Open(folder + "/store", {}).value();
    std::printf("%8s    %-14s %13s %13s %8s\n", "scan", "", "store", "bare file", "ratio");
    for (const std::size_t size : {std::size_t{2'700'000}, std::size_t{64'000'000}}) Compare(*store, folder, size);
  }
  std::filesystem::remove_all(folder);
  return 0;
}

}  // namespace curvereg::server

int main(int argc, char** argv) {
  return curvereg::server::RunScanStoreBench(argc > 1 ? argv[1] : std::filesystem::temp_directory_path().string());
}
