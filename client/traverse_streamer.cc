// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/traverse_streamer.h"

#include <mutex>
#include <stop_token>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/retry.h"
#include "client/traverse_send_queue.h"
#include "client/traverse_stream.h"

namespace curvereg::internal {
namespace {

class Streamer final : public ScanStreamer {
 public:
  Streamer(Connection& connection, std::string name, const StreamOptions& options)
      : connection_(connection),
        name_(std::move(name)),
        options_(options),
        queue_(options),
        cancel_(options_.cancellation, RequestStop{&stop_}),
        thread_([this] { Work(); }) {}

  ~Streamer() override { stop_.request_stop(); }

  absl::Status Send(StreamedScan scan) override {
    if (const absl::Status open = MayGive(scan.sequence_number); !open.ok()) return open;
    absl::StatusOr<EncodedScan> encoded = Encode(scan, options_.encoding);
    if (!encoded.ok()) return encoded.status();
    std::unique_lock lock(queue_.mutex);
    queue_.changed.wait(lock, [this] { return queue_.ended || queue_.waiting_bytes <= options_.max_waiting_bytes; });
    if (queue_.ended) return *queue_.ended;
    queue_.Push(*std::move(encoded));
    is_first_ = false;
    queue_.changed.notify_all();
    return absl::OkStatus();
  }

  absl::Status Finish() override {
    std::unique_lock lock(queue_.mutex);
    queue_.closed = true;
    queue_.changed.notify_all();
    queue_.changed.wait(lock, [this] { return queue_.ended.has_value(); });
    return *queue_.ended;
  }

  std::stop_token ended() const override { return ended_.get_token(); }

  StreamProgress progress() const override {
    const std::lock_guard lock(queue_.mutex);
    return queue_.progress;
  }

 private:
  struct RequestStop {
    std::stop_source* stop;
    void operator()() const { stop->request_stop(); }
  };

  absl::Status MayGive(uint64_t sequence_number) {
    const std::lock_guard lock(queue_.mutex);
    if (queue_.ended) return queue_.ended->ok() ? absl::FailedPreconditionError("finished") : *queue_.ended;
    if (queue_.closed) return absl::FailedPreconditionError("no scans may come after Finish");
    if (is_first_ || sequence_number == queue_.end) return absl::OkStatus();
    return absl::InvalidArgumentError(absl::StrCat("scan ", sequence_number, " follows scan ", queue_.end - 1));
  }

  void Work() {
    const ClientOptions& settings = connection_.options();
    Retrier retrier(connection_, {stop_.get_token(), settings.call_timeout, IsResumable, /*until_timeout=*/true});
    const absl::Status status = retrier.Run([&](const std::shared_ptr<grpc::Channel>& channel) {
      const TraverseStream::Limits limits{settings.keepalive_interval + settings.keepalive_timeout, stop_.get_token()};
      return TraverseStream(name_, queue_)
          .Run(
              connection_, channel, limits, [this] { Tell(); }, [&] { retrier.NoteProgress(); });
    });
    ended_.request_stop();
    const std::lock_guard lock(queue_.mutex);
    queue_.ended = status;
    queue_.changed.notify_all();
  }

  void Tell() {
    std::deque<curvereg::ScanResult> results;
    std::deque<std::pair<uint64_t, std::string>> acknowledged;
    StreamProgress progress;
    {
      const std::lock_guard lock(queue_.mutex);
      results.swap(queue_.results);
      acknowledged.swap(queue_.acknowledged);
      queue_.progress.num_results += results.size();
      progress = queue_.progress;
      queue_.changed.notify_all();  // Send may wait for what was acknowledged
    }
    for (const auto& [number, scan_name] : acknowledged) {
      if (options_.on_acknowledged) options_.on_acknowledged(number, scan_name);
    }
    for (const curvereg::ScanResult& result : results) {
      if (options_.on_result) options_.on_result(result);
    }
    if (options_.on_progress) options_.on_progress(progress);
  }

  Connection& connection_;
  const std::string name_;
  const StreamOptions options_;
  mutable TraverseSendQueue queue_;
  bool is_first_ = true;  // guarded by the queue's mutex
  std::stop_source stop_;
  std::stop_source ended_;
  std::stop_callback<RequestStop> cancel_;
  std::jthread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ScanStreamer>> StreamScans(Connection& connection, const std::string& name,
                                                          const StreamOptions& options) {
  if (options.chunk_bytes == 0) return absl::InvalidArgumentError("chunk_bytes must be above 0");
  if (name.empty()) return absl::InvalidArgumentError("the name of a traverse is empty");
  return std::make_unique<Streamer>(connection, name, options);
}

}  // namespace curvereg::internal
