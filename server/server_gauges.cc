// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/server_gauges.h"

#include <filesystem>
#include <system_error>

namespace curvereg::server {
namespace {

double FreeBytes(const std::string& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  return error ? 0.0 : static_cast<double>(space.available);
}

double DiskBytes(const std::string& folder) {
  std::error_code error;
  const std::filesystem::space_info space = std::filesystem::space(folder, error);
  return error ? 0.0 : static_cast<double>(space.capacity);
}

// Names in a folder; 0 when there is no such folder.
double NumFiles(const std::string& folder) {
  std::error_code error;
  double count = 0.0;
  for (std::filesystem::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    ++count;
  }
  return count;
}

}  // namespace

void AddServerGauges(Metrics& metrics, const GaugeSources& sources) {
  const WorkerPool* pool = sources.pool;
  const MemoryBudget* memory = sources.memory;
  const PreparedScanCache* cache = sources.cache;
  const auto gauge = [&](const char* name, const char* help, std::function<double()> read) {
    metrics.SetGauge(name, help, std::move(read));
  };
  const auto counter = [&](const char* name, const char* help, std::function<double()> read) {
    metrics.SetCounter(name, help, std::move(read));
  };
  gauge("curvereg_queue_length", "Registrations that wait",
        [pool] { return static_cast<double>(pool->Statistics().num_waiting); });
  gauge("curvereg_registrations_running", "Registrations that run",
        [pool] { return static_cast<double>(pool->Statistics().num_running); });
  gauge("curvereg_workers", "Registrations that can run at once",
        [pool] { return static_cast<double>(pool->Statistics().num_workers); });
  gauge("curvereg_memory_reserved_bytes", "Memory reserved for accepted work",
        [memory] { return static_cast<double>(memory->reserved_bytes()); });
  gauge("curvereg_memory_budget_bytes", "Memory that may be reserved",
        [memory] { return static_cast<double>(memory->total_bytes()); });
  gauge("curvereg_cache_bytes", "Memory of prepared scans that are kept",
        [cache] { return static_cast<double>(cache->GetStatistics().bytes); });
  gauge("curvereg_cache_scans", "Prepared scans that are kept",
        [cache] { return static_cast<double>(cache->GetStatistics().num_entries); });
  counter("curvereg_cache_hits_total", "Stored scans found prepared",
          [cache] { return static_cast<double>(cache->GetStatistics().num_hits); });
  counter("curvereg_cache_misses_total", "Stored scans that had to be prepared",
          [cache] { return static_cast<double>(cache->GetStatistics().num_misses); });
  counter("curvereg_cache_evictions_total", "Prepared scans given up for others",
          [cache] { return static_cast<double>(cache->GetStatistics().num_evictions); });
}

void AddStoreGauges(Metrics& metrics, ScanStore& store, uint64_t max_stored_bytes, const std::string& folder) {
  ScanStore* scans = &store;
  metrics.SetGauge("curvereg_store_scans", "Scans stored",
                   [scans] { return static_cast<double>(scans->Statistics().num_scans); });
  metrics.SetGauge("curvereg_store_uploads", "Uploads not finished",
                   [scans] { return static_cast<double>(scans->Statistics().num_uploads); });
  metrics.SetGauge("curvereg_store_bytes", "Bytes of scans and unfinished uploads",
                   [scans] { return static_cast<double>(scans->Statistics().stored_bytes); });
  metrics.SetGauge("curvereg_store_limit_bytes", "Bytes that may be stored",
                   [max_stored_bytes] { return static_cast<double>(max_stored_bytes); });
  metrics.SetGauge("curvereg_store_damaged_scans", "Stored scans found damaged",
                   [scans] { return static_cast<double>(scans->DamagedScans().size()); });
  metrics.SetGauge("curvereg_store_lost_files", "Files set aside because no record names them",
                   [orphans = ScanStore::OrphanFolder(folder)] { return NumFiles(orphans); });
  metrics.SetGauge("curvereg_store_disk_free_bytes", "Free bytes of the disk that holds the store",
                   [folder] { return FreeBytes(folder); });
  metrics.SetGauge("curvereg_store_disk_bytes", "Bytes of the disk that holds the store",
                   [folder] { return DiskBytes(folder); });
}

}  // namespace curvereg::server
