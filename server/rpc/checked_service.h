// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Services that bytes of any kind may reach. What is no request gRPC would answer by itself, with UNIMPLEMENTED, no
// reason, no line in the log and no count; here it ends a Call, as every error does.
#ifndef CURVEREG_SERVER_RPC_CHECKED_SERVICE_H_
#define CURVEREG_SERVER_RPC_CHECKED_SERVICE_H_

#include <google/protobuf/descriptor.h>
#include <grpcpp/impl/codegen/server_callback_handlers.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/server_callback.h>

#include "absl/strings/str_cat.h"
#include "server/rpc/call.h"
#include "wire/error.h"

namespace curvereg::server {

// What came in for a request, parsed by gRPC in its place.
template <typename Request>
struct Incoming {
  Request request;
  bool is_readable = false;
};

// Ends a stream before its first answer.
template <typename Response>
class RefusedStream final : public grpc::ServerWriteReactor<Response> {
 public:
  explicit RefusedStream(const grpc::Status& status) { this->Finish(status); }
  void OnDone() override { delete this; }

 private:
  ~RefusedStream() override = default;
};

// `Generated`: a CallbackService, or another made of gRPC's callback methods.
template <typename Generated>
class CheckedService : public Generated {
 protected:
  // In the constructor of `Service`, for each method with one request: `handle` gets only what is readable.
  template <typename Service, typename Request, typename Response>
  void Check(const CallEnvironment& calls, const MethodTraits& traits,
             grpc::ServerUnaryReactor* (Service::*handle)(grpc::CallbackServerContext*, const Request*, Response*)) {
    const auto react = [this, calls, traits, handle](grpc::CallbackServerContext* context,
                                                     const Incoming<Request>* incoming, Response* response) {
      if (incoming->is_readable) return (static_cast<Service*>(this)->*handle)(context, &incoming->request, response);
      grpc::ServerUnaryReactor* const refused = context->DefaultReactor();
      refused->Finish(Refuse(calls, traits, *context));
      return refused;
    };
    this->MarkMethodCallback(IndexOf(traits),
                             new grpc::internal::CallbackUnaryHandler<Incoming<Request>, Response>(react));
  }

  // The same for a method that answers with a stream.
  template <typename Service, typename Request, typename Response>
  void Check(const CallEnvironment& calls, const MethodTraits& traits,
             grpc::ServerWriteReactor<Response>* (Service::*handle)(grpc::CallbackServerContext*, const Request*)) {
    const auto react = [this, calls, traits, handle](
                           grpc::CallbackServerContext* context,
                           const Incoming<Request>* incoming) -> grpc::ServerWriteReactor<Response>* {
      if (incoming->is_readable) return (static_cast<Service*>(this)->*handle)(context, &incoming->request);
      return new RefusedStream<Response>(Refuse(calls, traits, *context));
    };
    this->MarkMethodCallback(IndexOf(traits),
                             new grpc::internal::CallbackServerStreamingHandler<Incoming<Request>, Response>(react));
  }

 private:
  static int IndexOf(const MethodTraits& traits) {
    return google::protobuf::DescriptorPool::generated_pool()
        ->FindMethodByName(absl::StrCat(traits.service, ".", traits.method))
        ->index();
  }

  static grpc::Status Refuse(const CallEnvironment& calls, const MethodTraits& traits,
                             grpc::CallbackServerContext& context) {
    Call call(calls, traits, context);
    const absl::Status unreadable =
        wire::MakeError(v1::ERROR_REASON_UNEXPECTED_MESSAGE, "the request was not readable");
    return call.Finish(call.admitted().ok() ? unreadable : call.admitted());
  }
};

}  // namespace curvereg::server

template <typename Request>
class grpc::SerializationTraits<curvereg::server::Incoming<Request>> {
 public:
  static Status Deserialize(ByteBuffer* bytes, curvereg::server::Incoming<Request>* incoming) {
    incoming->is_readable = SerializationTraits<Request>::Deserialize(bytes, &incoming->request).ok();
    return Status::OK;
  }
};

#endif  // CURVEREG_SERVER_RPC_CHECKED_SERVICE_H_
