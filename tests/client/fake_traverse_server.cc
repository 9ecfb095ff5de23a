// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/client/fake_traverse_server.h"

#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>

#include "curvereg/v1/traverse_service.grpc.pb.h"
#include "tests/client/scripted_server.h"
#include "wire/digest.h"

namespace curvereg::testing {
namespace {

constexpr uint64_t kMapChunkBytes = 4096;

// One stream of messages that may be cut. Sends false once it is.
template <typename Stream, typename Response>
class CutStream {
 public:
  CutStream(Stream& stream, int cut_after_sent) : stream_(stream), left_(cut_after_sent) {}
  bool Write(const Response& response) {
    if (left_ == 1) is_cut_ = true;
    if (left_ > 1) --left_;
    return !is_cut_ && stream_.Write(response);
  }
  bool is_cut() const { return is_cut_; }

 private:
  Stream& stream_;
  int left_;
  bool is_cut_ = false;
};

const grpc::Status kCut(grpc::UNAVAILABLE, "cut");

}  // namespace

v1::ScanResult PlausibleResult(uint64_t sequence_number) {
  v1::ScanResult result;
  result.set_sequence_number(sequence_number);
  v1::TrajectoryPose& pose = *result.mutable_pose();
  pose.set_sequence_number(sequence_number);
  pose.mutable_t_segment_sensor()->mutable_translation()->set_x(0.5 * static_cast<double>(sequence_number));
  pose.mutable_t_segment_sensor()->mutable_rotation()->set_w(1.0);
  pose.set_origin(sequence_number == 0 ? v1::POSE_ORIGIN_SEGMENT_START : v1::POSE_ORIGIN_REGISTERED);
  return result;
}

class FakeTraverseServer::Service final : public v1::TraverseService::Service {
 public:
  using ScanStream = grpc::ServerReaderWriter<v1::StreamScansResponse, v1::StreamScansRequest>;
  explicit Service(TraverseMemory& memory) : memory_(memory) {}

  grpc::Status StreamScans(grpc::ServerContext*, ScanStream* stream) override {
    v1::StreamScansRequest request;
    if (!stream->Read(&request) || !request.has_start()) return {grpc::INVALID_ARGUMENT, "no start"};
    CutStream<ScanStream, v1::StreamScansResponse> answers(*stream, memory_.cut_after_sent);
    if (const grpc::Status status = Begin(request.start(), answers); !status.ok()) return status;
    v1::StreamedScanHeader header;
    for (int count = 1; stream->Read(&request); ++count) {
      if (count == memory_.cut_after_received) return kCut;
      const std::lock_guard lock(memory_.mutex);
      if (request.has_header()) {
        header = request.header();
        EXPECT_EQ(header.sequence_number(), memory_.scans.size()) << "out of order, or registered twice";
        if (memory_.partial.size() == header.payload_bytes()) Complete(header, answers);
      } else if (const grpc::Status status = Append(request.chunk(), header, answers); !status.ok()) {
        return status;
      }
      if (answers.is_cut()) return kCut;
    }
    return grpc::Status::OK;
  }

  grpc::Status WatchTraverse(grpc::ServerContext* context, const v1::WatchTraverseRequest* request,
                             grpc::ServerWriter<v1::WatchTraverseResponse>* writer) override {
    CutStream<grpc::ServerWriter<v1::WatchTraverseResponse>, v1::WatchTraverseResponse> answers(*writer,
                                                                                                memory_.cut_after_sent);
    for (uint64_t next = request->first_event(); !context->IsCancelled();) {
      v1::WatchTraverseResponse event;
      {
        const std::lock_guard lock(memory_.mutex);
        if (next < memory_.events.size()) event = memory_.events[next];
      }
      if (event.what_case() != v1::WatchTraverseResponse::WHAT_NOT_SET) {
        answers.Write(event);
        ++next;
        if (answers.is_cut()) return kCut;
      } else if (request->existing_only()) {
        return grpc::Status::OK;
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
    }
    return grpc::Status::CANCELLED;
  }

  grpc::Status DownloadMap(grpc::ServerContext*, const v1::DownloadMapRequest* request,
                           grpc::ServerWriter<v1::DownloadMapResponse>* writer) override {
    const std::lock_guard lock(memory_.mutex);
    CutStream<grpc::ServerWriter<v1::DownloadMapResponse>, v1::DownloadMapResponse> answers(*writer,
                                                                                            memory_.cut_after_sent);
    if (request->has_version() && request->version() != memory_.map_version) {
      return Refusal(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE);
    }
    v1::DownloadMapResponse response;
    response.mutable_header()->set_version(memory_.map_version);
    response.mutable_header()->set_payload_bytes(memory_.map.size());
    response.mutable_header()->set_cell_count(memory_.map.size() / 12);
    *response.mutable_header()->mutable_payload_digest() = wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, memory_.map);
    answers.Write(response);
    for (uint64_t offset = request->offset(); offset < memory_.map.size() && !answers.is_cut();) {
      v1::PayloadChunk& chunk = *response.mutable_chunk();
      chunk.set_offset(offset);
      chunk.set_data(memory_.map.substr(offset, kMapChunkBytes));
      chunk.set_crc32c(wire::Crc32c(chunk.data()));
      offset += chunk.data().size();
      answers.Write(response);
    }
    return answers.is_cut() ? kCut : grpc::Status::OK;
  }

 private:
  template <typename Answers>
  grpc::Status Begin(const v1::StreamScansStart& start, Answers& answers) {
    const std::lock_guard lock(memory_.mutex);
    ++memory_.num_streams;
    if (memory_.on_start) {
      if (const grpc::Status status = memory_.on_start(memory_.num_streams); !status.ok()) return status;
    }
    v1::StreamScansResponse response;
    response.mutable_ready()->set_next_sequence_number(memory_.scans.size());
    response.mutable_ready()->set_committed_offset(memory_.partial.size());
    response.mutable_ready()->set_fencing_number(++memory_.fencing_number);
    response.mutable_ready()->set_max_chunk_bytes(1 << 20);
    answers.Write(response);
    const uint64_t first = start.has_last_result_sequence_number() ? start.last_result_sequence_number() + 1 : 0;
    for (uint64_t i = first; i < memory_.results.size(); ++i) {
      *response.mutable_result() = memory_.results[i];
      answers.Write(response);
    }
    return answers.is_cut() ? kCut : grpc::Status::OK;
  }

  template <typename Answers>
  grpc::Status Append(const v1::PayloadChunk& chunk, const v1::StreamedScanHeader& header, Answers& answers) {
    memory_.bytes_received += chunk.data().size();
    EXPECT_EQ(chunk.crc32c(), wire::Crc32c(chunk.data()));
    if (chunk.offset() != memory_.partial.size()) {
      ADD_FAILURE() << "a chunk at " << chunk.offset() << ", expected at " << memory_.partial.size();
      return Refusal(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE);
    }
    memory_.partial += chunk.data();
    if (memory_.partial.size() == header.payload_bytes()) {
      Complete(header, answers);
      return grpc::Status::OK;
    }
    v1::StreamScansResponse response;
    response.mutable_ack()->set_sequence_number(header.sequence_number());
    response.mutable_ack()->set_committed_offset(memory_.partial.size());
    answers.Write(response);
    return grpc::Status::OK;
  }

  template <typename Answers>
  void Complete(const v1::StreamedScanHeader& header, Answers& answers) {
    EXPECT_TRUE(
        wire::SameDigest(header.payload_digest(), wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, memory_.partial)));
    memory_.partial.clear();
    memory_.scans.push_back(header);
    memory_.results.push_back(PlausibleResult(header.sequence_number()));
    v1::StreamScansResponse response;
    response.mutable_ack()->set_sequence_number(header.sequence_number());
    response.mutable_ack()->set_committed_offset(header.payload_bytes());
    response.mutable_ack()->set_complete(true);
    response.mutable_ack()->set_scan("scans/" + std::to_string(header.sequence_number()));
    answers.Write(response);
    *response.mutable_result() = memory_.results.back();
    answers.Write(response);
  }

  TraverseMemory& memory_;
};

FakeTraverseServer::FakeTraverseServer(TraverseMemory& memory, int port) : service_(std::make_unique<Service>(memory)) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:" + std::to_string(port), grpc::InsecureServerCredentials(), &port_);
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 100);
  builder.RegisterService(service_.get());
  server_ = builder.BuildAndStart();
  EXPECT_NE(server_, nullptr);
}

FakeTraverseServer::~FakeTraverseServer() {
  if (server_ != nullptr) server_->Shutdown(std::chrono::system_clock::now());
}

}  // namespace curvereg::testing
