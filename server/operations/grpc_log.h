// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What gRPC itself has to say, in our log and not past it.
#ifndef CURVEREG_SERVER_OPERATIONS_GRPC_LOG_H_
#define CURVEREG_SERVER_OPERATIONS_GRPC_LOG_H_

#include "server/operations/logging.h"

namespace curvereg::server {

// While it exists, lines of gRPC's go to `logger` as events "grpc". One at a time in a process, for gRPC has one hook
// without a context.
class GrpcLog {
 public:
  explicit GrpcLog(Logger& logger);
  ~GrpcLog();
  GrpcLog(const GrpcLog&) = delete;
  GrpcLog& operator=(const GrpcLog&) = delete;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_GRPC_LOG_H_
