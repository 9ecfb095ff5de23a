// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as an upload: a row of messages, each after its length in two bytes. The first byte says whether their
// checksums are mended.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "curvereg/v1/scan_service.pb.h"
#include "fuzz/memory_scan_store.h"
#include "fuzz/request_checks.h"
#include "server/operations/metrics.h"
#include "server/scans/upload_message.h"
#include "server/scans/upload_session.h"
#include "server/scheduling/memory_budget.h"
#include "wire/digest.h"

namespace curvereg::server {
namespace {

// Checksums that fit let the fuzzer past them, to where no mutation would get.
void Mend(v1::UploadScanRequest& request, std::string& payload) {
  if (request.has_chunk()) {
    request.mutable_chunk()->set_offset(payload.size());
    request.mutable_chunk()->set_crc32c(wire::Crc32c(request.chunk().data()));
    payload += request.chunk().data();
  } else if (request.has_finish()) {
    *request.mutable_finish()->mutable_payload_digest() = wire::DigestOf(v1::DIGEST_ALGORITHM_SHA256, payload);
  }
}

void CheckUpload(std::string_view bytes, bool mended) {
  static Metrics metrics;  // dear to make
  MemoryScanStore store;
  MemoryBudget memory(uint64_t{64} << 20);
  UploadOwners owners;
  const UploadEnvironment environment = {FuzzLimits(), &memory, &store, &metrics, &owners};
  UploadSession session(environment, {});
  std::string payload;
  while (std::optional<std::string> text = NextText(bytes)) {
    v1::UploadScanRequest request;
    const bool is_request = request.ParseFromString(*text);
    if (mended && is_request) {
      Mend(request, payload);
      text = request.SerializeAsString();
    }
    // In two slices, as gRPC may cut it.
    const std::array<grpc::Slice, 2> slices = {grpc::Slice(text->substr(0, text->size() / 2)),
                                               grpc::Slice(text->substr(text->size() / 2))};
    UploadMessage message;
    Require(message.Parse(grpc::ByteBuffer(slices.data(), slices.size())) == is_request);
    if (!is_request) return;
    const UploadSession::Answer answer = session.Handle(message);
    CheckError(answer.status());
    if (!answer.ok() || session.is_done()) break;
  }
  Require(memory.reserved_bytes() == 0);
}

}  // namespace
}  // namespace curvereg::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  curvereg::server::CheckUpload({reinterpret_cast<const char*>(data) + 1, size - 1}, data[0] % 2 == 1);
  return 0;
}
