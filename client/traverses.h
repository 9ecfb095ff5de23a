// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Traverses on a server: a rover streams its scans, a ground station watches poses come and fetches trajectory and map.
//
//   absl::StatusOr<std::unique_ptr<ScanStreamer>> streamer = client->traverses().Stream("traverses/sol-12", options);
//   while (...) status = (*streamer)->Send({.sequence_number = i, .scan = ...});
//   status = (*streamer)->Finish();
//
// Whatever is cut goes on where it was: scans that were acknowledged are not sent again, results and events come once
// and in order. Names are `traverses/{id}`. Safe to use from several threads, but for one streamer's Send and Finish.
#ifndef CURVEREG_CLIENT_TRAVERSES_H_
#define CURVEREG_CLIENT_TRAVERSES_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/client.h"
#include "client/traverse_types.h"
#include "core/base/stop.h"
#include "core/methods/registration_options.h"
#include "core/scan/scan.h"

namespace curvereg {

struct StreamedScan {
  uint64_t sequence_number = 0;  // 0 for the first of the traverse, then one more for each
  Scan scan;
  std::string frame_id;
  std::optional<int64_t> time_ns;  // since 1970-01-01 UTC
  std::optional<Prior> prior;      // motion since the scan before, which is the target
};

struct StreamProgress {
  uint64_t num_acknowledged = 0;  // scans of this streamer that are durable on the server
  uint64_t num_results = 0;       // delivered by this streamer
  uint64_t bytes_acknowledged = 0;
  uint64_t bytes_sent = 0;    // of payloads, bytes_resent among them
  uint64_t bytes_resent = 0;  // sent more than once, because of cuts
  int num_resumes = 0;
};

// The callbacks come one at a time from a thread of the streamer's and must not call it.
struct StreamOptions {
  TransferEncoding encoding{TransferEncoding::Kind::kQuantized};
  std::optional<uint64_t> last_result;  // greatest sequence number whose result the caller has
  std::function<void(const ScanResult&)> on_result;
  std::function<void(uint64_t sequence_number, const std::string& scan_name)> on_acknowledged;
  std::function<void(const StreamProgress&)> on_progress;
  std::stop_token cancellation;
  uint32_t chunk_bytes = 512 * 1024;                // at most; less on slow links
  uint64_t max_waiting_bytes = uint64_t{64} << 20;  // Send waits while more than this is not acknowledged
};

// Sends scans as a rover does. What is under way is paced to the link: a cut costs little more than the bytes that are
// on the wire.
class ScanStreamer {
 public:
  virtual ~ScanStreamer() = default;  // gives up what is not acknowledged

  // Takes the scan over; waits while too many wait. The first scan may have any number, later ones one more each.
  // Scans that the server has already are passed over. The error that ended the streamer: ABORTED when a newer stream
  // of the same traverse has taken over; INVALID_ARGUMENT: a scan that cannot be encoded, or a gap.
  virtual absl::Status Send(StreamedScan scan) = 0;
  // Waits until all scans are acknowledged and the results of all scans of the traverse up to the last are delivered.
  virtual absl::Status Finish() = 0;
  // Requested when the streamer ends, by an error above all: who waits for the next scan need not. Finish tells why.
  virtual std::stop_token ended() const = 0;
  virtual StreamProgress progress() const = 0;
};

struct WatchOptions {
  uint64_t first_event = 0;
  bool existing_only = false;  // end after the last event that is there now
  std::stop_token cancellation;
};

struct MapOptions {
  enum class Kind { kPoints, kElevationAscii };
  Kind kind = Kind::kPoints;
  double cell_m = 0.1;  // edge of a cell [m], 0.01 to 10
  int segment = 0;
  bool remove_dynamic = false;  // leave out points in the free space of other scans
  std::function<void(const TransferProgress&)> progress;
  std::stop_token cancellation;
};

struct RemoteMap {
  uint64_t version = 0;  // of the trajectory
  uint64_t num_cells = 0;
  std::vector<Eigen::Vector3f> points;  // of kPoints, in the segment's frame [m]
  std::string text;                     // of kElevationAscii: an ESRI ASCII grid
};

// Errors are those of the contract's methods. All calls retry what is safe to retry, until `until` as in Client.
class TraverseClient {
 public:
  virtual ~TraverseClient() = default;

  virtual absl::StatusOr<RemoteTraverse> Create(const std::string& id, const TraverseSettings& settings,
                                                const Stop& until = {}) = 0;
  virtual absl::StatusOr<RemoteTraverse> Get(const std::string& name, const Stop& until = {}) = 0;
  virtual absl::StatusOr<std::vector<RemoteTraverse>> List(const Stop& until = {}) = 0;  // all pages, newest first
  virtual absl::Status Delete(const std::string& name, const Stop& until = {}) = 0;
  // All pages, of one version.
  virtual absl::StatusOr<RemoteTrajectory> GetTrajectory(const std::string& name, const Stop& until = {}) = 0;
  virtual absl::StatusOr<OptimizationOutcome> Optimize(const std::string& name, bool find_loop_closures,
                                                       std::stop_token cancellation = {}) = 0;

  // Begins at once and takes the traverse over from other streams. INVALID_ARGUMENT: options.
  virtual absl::StatusOr<std::unique_ptr<ScanStreamer>> Stream(const std::string& name,
                                                               const StreamOptions& options) = 0;
  // Calls back for each event, from the calling thread, until there are no more of those wanted. CANCELLED.
  virtual absl::Status Watch(const std::string& name, const WatchOptions& options,
                             const std::function<void(const TraverseEvent&)>& on_event) = 0;
  virtual absl::StatusOr<RemoteMap> DownloadMap(const std::string& name, const MapOptions& options) = 0;
};

}  // namespace curvereg

#endif  // CURVEREG_CLIENT_TRAVERSES_H_
