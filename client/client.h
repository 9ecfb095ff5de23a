// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// START HERE: the client library. One warm connection to a server; plain structs in and out; every call retries what is
// safe to retry until its deadline.
//
//   absl::StatusOr<std::unique_ptr<Client>> client = Client::Connect("rover-ground:50051");
//   absl::StatusOr<RegistrationResult> result = (*client)->RegisterScans(source, target);
//
// Errors keep the server's code and message; ErrorReasonName (below) gives the reason. A Client is safe to use from
// several threads.
#ifndef CURVEREG_CLIENT_CLIENT_H_
#define CURVEREG_CLIENT_CLIENT_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "core/base/stop.h"
#include "core/methods/registration_names.h"
#include "core/methods/registration_options.h"
#include "core/methods/registration_result.h"
#include "core/scan/scan.h"

namespace grpc {
class Channel;
}

namespace curvereg {

struct TlsOptions {
  bool enabled = false;
  std::string ca_file;           // PEM of the authority that signed the server; empty: the system's
  std::string certificate_file;  // PEM; for mutual TLS
  std::string key_file;
  std::string server_name;  // expected name in the server's certificate; empty: the host connected to
};

struct RetryOptions {
  // Of one call, the first included; a transfer that makes progress starts counting again. Refusals by a server that
  // starts or stops do not count, only call_timeout ends these. 1: nothing is tried again.
  int max_attempts = 5;
  std::chrono::milliseconds initial_backoff{200};  // doubles each time, up to max_backoff; then drawn from 0.8 to 1.2 x
  std::chrono::milliseconds max_backoff{10'000};   // a delay that the server asks for is kept, even a longer one
};

struct ClientOptions {
  TlsOptions tls;
  std::string token;                                     // bearer token; empty: none. Sent over TLS or loopback only
  std::chrono::milliseconds connect_timeout{10'000};     // of Connect
  std::chrono::milliseconds call_timeout{120'000};       // of a call with its retries; transfers: without progress
  std::chrono::milliseconds keepalive_interval{20'000};  // of pings while a call runs; a dead link is noticed after
  std::chrono::milliseconds keepalive_timeout{10'000};   // this long without an answer (TCP_USER_TIMEOUT as well)
  RetryOptions retry;
};

// How clouds are sent.
struct TransferEncoding {
  enum class Kind { kRaw, kLossless, kQuantized };
  Kind kind = Kind::kRaw;
  double max_error_m = 1e-3;  // of kQuantized: no point is farther from its original [m]
};

struct TransferProgress {
  uint64_t bytes_done = 0;  // of the payload, safe on the other side
  uint64_t bytes_total = 0;
  uint64_t bytes_resent = 0;  // sent more than once, because of cuts
  int num_resumes = 0;
};

struct TransferOptions {
  TransferEncoding encoding{TransferEncoding::Kind::kQuantized};
  std::string frame_id;
  std::function<void(const TransferProgress&)> progress;  // called on the calling thread
  std::stop_token cancellation;
  uint32_t chunk_bytes = 512 * 1024;  // on good links; less on slow ones, see max_resend_share
  double max_resend_share = 0.02;     // of the payload that may be under way, and so lost by a cut, on links that are
                                      // slow to acknowledge
};

// A scan that the server keeps.
struct RemoteScan {
  std::string name;  // scans/...
  uint64_t num_points = 0;
  uint64_t num_finite_points = 0;
  uint64_t payload_bytes = 0;
  std::string encoding;        // "raw", "lossless", "quantized"
  double max_error_m = 0.0;    // of the encoding [m]
  std::string content_digest;  // as ScanDigest of the decoded scan
  std::string frame_id;
  std::chrono::system_clock::time_point create_time;
};

struct UploadOutcome {
  RemoteScan scan;
  bool already_stored = false;
  TransferProgress transfer;
};

// A scan of the caller's, or the name of one that the server keeps.
using ScanReference = std::variant<std::reference_wrapper<const Scan>, std::string>;

struct RemotePicture {
  std::string name;  // e.g. "elevation_keypoints"
  std::string png;   // file content
};

struct RemotePictures {
  std::vector<RemotePicture> pictures;
  uint64_t num_points = 0;
  std::vector<std::pair<std::string, int>> num_keypoints;  // by view
};

struct RemoteMethod {
  std::string name;
  std::string description;
  bool available = false;
};

struct ServerStatus {
  bool serving = false;                                // of the whole server
  std::vector<std::pair<std::string, bool>> services;  // name, serving
  std::string build_id;
  std::vector<RemoteMethod> methods;
  std::vector<std::pair<std::string, uint64_t>> limits;  // name as in ServerLimits, value
  std::vector<std::pair<std::string, uint64_t>> load;    // name as in ServerLoad, value
  std::chrono::microseconds round_trip{0};               // median of a few health checks
};

class TraverseClient;

class Client {
 public:
  // `target`: HOST:PORT, or any gRPC name (dns:///..., ipv4:..., unix:...). Plain text unless tls.enabled. UNAVAILABLE
  // when no connection comes about within connect_timeout; INVALID_ARGUMENT: options, or files that they name;
  // CANCELLED.
  static absl::StatusOr<std::unique_ptr<Client>> Connect(const std::string& target, const ClientOptions& options = {},
                                                         std::stop_token cancellation = {});
  // Over a channel that is there already, for example a server's in-process one.
  static std::unique_ptr<Client> OverChannel(std::shared_ptr<grpc::Channel> channel, const ClientOptions& options = {});
  virtual ~Client() = default;

  // options.cancellation ends the call; options.limits stay behind, the server has its own. options.deadline travels as
  // what is left of it at each attempt: it becomes the time budget unless that is less, and so is part of the result's
  // options_digest. A server that has not answered 2 s after it is not waited for: no pose, Reason::kDeadline, and no
  // counts and digests. Inline scans are sent as `encoding` tells. Errors: those of RegisterScans in
  // core/register_scans.h, and of the contract.
  virtual absl::StatusOr<RegistrationResult> RegisterScans(const ScanReference& source, const ScanReference& target,
                                                           const RegistrationOptions& options = {},
                                                           const TransferEncoding& encoding = {}) = 0;
  virtual absl::StatusOr<RemotePictures> RenderScan(const ScanReference& scan, int num_threads = 0,
                                                    std::stop_token cancellation = {}) = 0;

  // Resumes after every cut, as long as there is progress within call_timeout.
  virtual absl::StatusOr<UploadOutcome> UploadScan(const Scan& scan, const TransferOptions& options = {}) = 0;
  virtual absl::StatusOr<Scan> DownloadScan(const std::string& name, const TransferOptions& options = {}) = 0;

  // `until` is when a call ends at the latest: CANCELLED, or the deadline, unless call_timeout is over before it.
  virtual absl::StatusOr<RemoteScan> GetScan(const std::string& name, const Stop& until = {}) = 0;
  virtual absl::StatusOr<std::vector<RemoteScan>> ListScans(const Stop& until = {}) = 0;  // all pages, newest first
  virtual absl::Status DeleteScan(const std::string& name, const Stop& until = {}) = 0;
  virtual absl::StatusOr<ServerStatus> Status(const Stop& until = {}) = 0;

  // The calls about traverses (client/traverses.h), over the same connection. Lives as long as the client.
  virtual TraverseClient& traverses() = 0;
};

// The reason of an error that came from a server, e.g. "QUEUE_FULL"; empty when it has none.
std::string ErrorReasonName(const absl::Status& status);

}  // namespace curvereg

#endif  // CURVEREG_CLIENT_CLIENT_H_
