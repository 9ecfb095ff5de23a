// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/grpc_log.h"

#include <grpc/support/log.h>

#include <mutex>
#include <string>

#include "absl/strings/str_cat.h"

namespace curvereg::server {
namespace {

struct Destination {
  std::mutex mutex;
  Logger* logger = nullptr;
};

// The one mutable static here: gRPC's hook is a plain function. Never destroyed, for gRPC's threads may outlive main.
Destination& TheDestination() {
  static auto* const destination = new Destination;
  return *destination;
}

void Forward(gpr_log_func_args* line) {
  const std::string path(line->file);
  const std::string source = absl::StrCat(path.substr(path.find_last_of('/') + 1), ":", line->line);
  Destination& destination = TheDestination();
  const std::lock_guard lock(destination.mutex);
  if (destination.logger == nullptr) return;
  destination.logger->WarnOfGrpc(source, line->message);
}

}  // namespace

GrpcLog::GrpcLog(Logger& logger) {
  Destination& destination = TheDestination();
  const std::lock_guard lock(destination.mutex);
  destination.logger = &logger;
  gpr_set_log_function(Forward);
}

GrpcLog::~GrpcLog() {
  Destination& destination = TheDestination();
  const std::lock_guard lock(destination.mutex);
  destination.logger = nullptr;
  gpr_set_log_function(nullptr);
}

}  // namespace curvereg::server
