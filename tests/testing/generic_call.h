// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#ifndef CURVEREG_TESTS_TESTING_GENERIC_CALL_H_
#define CURVEREG_TESTS_TESTING_GENERIC_CALL_H_

#include <grpcpp/generic/generic_stub.h>

#include <chrono>
#include <string>

namespace curvereg::testing {

// How a call of `method` (/SERVICE/METHOD), of whatever kind, ends that sends these bytes and nothing else. All of its
// answers are read.
inline grpc::Status Send(grpc::GenericStub& stub, const std::string& method, const std::string& bytes,
                         std::chrono::seconds timeout) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + timeout);
  grpc::CompletionQueue queue;
  const auto next = [&queue] {
    void* tag = nullptr;
    bool ok = false;
    return queue.Next(&tag, &ok) && ok;
  };
  const auto call = stub.PrepareCall(&context, method, &queue);
  call->StartCall(nullptr);
  next();
  const grpc::Slice slice(bytes);
  call->WriteLast(grpc::ByteBuffer(&slice, 1), grpc::WriteOptions(), nullptr);
  next();
  grpc::ByteBuffer answer;
  do {
    call->Read(&answer, nullptr);
  } while (next());
  grpc::Status status;
  call->Finish(&status, nullptr);
  next();
  return status;
}

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_GENERIC_CALL_H_
