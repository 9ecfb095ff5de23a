// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Any bytes as a stream of scans: a row of messages, each after its length in two bytes. The first byte says whether
// what must fit together is mended.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "curvereg/v1/traverse_service.pb.h"
#include "fuzz/memory_scan_store.h"
#include "fuzz/request_checks.h"
#include "server/operations/metrics.h"
#include "server/scans/upload_session.h"
#include "server/scheduling/memory_budget.h"
#include "server/traverses/scan_stream_session.h"
#include "tests/server/traverses/fake_traverses.h"
#include "wire/digest.h"

namespace curvereg::server {
namespace {

// What fits lets the fuzzer past the checks: numbers, sizes, checksums and digests that fit the chunks after each
// header.
void Mend(std::vector<v1::StreamScansRequest>& requests) {
  uint64_t sequence_number = 0;
  v1::StreamedScanHeader* header = nullptr;
  std::string payload;
  for (v1::StreamScansRequest& request : requests) {
    if (request.has_header()) {
      header = request.mutable_header();
      header->set_sequence_number(sequence_number++);
      payload.clear();
    } else if (request.has_chunk() && header != nullptr) {
      request.mutable_chunk()->set_offset(payload.size());
      request.mutable_chunk()->set_crc32c(wire::Crc32c(request.chunk().data()));
      payload += request.chunk().data();
      header->set_payload_bytes(payload.size());
      *header->mutable_payload_digest() = wire::DigestOf(v1::DIGEST_ALGORITHM_SHA256, payload);
    }
  }
}

void CheckScanStream(std::string_view bytes, bool mended) {
  std::vector<v1::StreamScansRequest> requests;
  if (mended) requests.emplace_back().mutable_start()->set_traverse(testing::FakeTraverses::kName);
  while (const std::optional<std::string> text = NextText(bytes)) {
    if (!requests.emplace_back().ParseFromString(*text)) return;
  }
  if (mended) Mend(requests);
  static Metrics metrics;  // dear to make
  MemoryScanStore store;
  MemoryBudget memory(uint64_t{64} << 20);
  UploadOwners owners;
  testing::FakeTraverses traverses;
  const ScanStreamSession::Environment environment = {{FuzzLimits(), &memory, &store, &metrics, &owners}, &traverses};
  ScanStreamSession session(environment, {.replaced = {}, .wake = [] {}});
  for (v1::StreamScansRequest& request : requests) {
    const ScanStreamSession::Answer answer = session.Handle(request);
    CheckError(answer.status());
    if (!answer.ok()) break;
  }
  if (session.has_started()) Require(session.TakeResults(1000).ok() && session.took_all_results());
  Require(memory.reserved_bytes() == 0);
}

}  // namespace
}  // namespace curvereg::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  curvereg::server::CheckScanStream({reinterpret_cast<const char*>(data) + 1, size - 1}, data[0] % 2 == 1);
  return 0;
}
