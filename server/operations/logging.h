// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The server's log: one event a line, as text (key=value) or as JSON. What clients send is escaped, so that no call can
// forge a line. Safe to use from several threads.
#ifndef CURVEREG_SERVER_OPERATIONS_LOGGING_H_
#define CURVEREG_SERVER_OPERATIONS_LOGGING_H_

#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "absl/status/statusor.h"
#include "server/settings/server_config.h"

namespace curvereg::server {

// One call, as it ended.
struct CallRecord {
  std::string service;     // "curvereg.v1.RegistrationService"
  std::string method;      // "RegisterScans"
  std::string request_id;  // as echoed to the caller
  std::string client;      // token name, TLS identity, else address
  std::string code;        // "OK", "RESOURCE_EXHAUSTED"
  std::string reason;      // "QUEUE_FULL"; empty: none
  std::string message;     // of the error; empty: none
  double milliseconds = 0.0;
};

struct LogField {
  std::string name;
  std::variant<std::string, int64_t, double, bool> value;
};
using LogFields = std::vector<LogField>;

class Logger {
 public:
  // INVALID_ARGUMENT: unknown format or level. `file` (stderr) must outlive the logger.
  static absl::StatusOr<std::unique_ptr<Logger>> Create(const LogConfig& config, std::FILE* file);
  // Writes nothing; for tests and for servers inside another program.
  static std::unique_ptr<Logger> Silent();
  ~Logger();
  Logger(const Logger&) = delete;
  Logger& operator=(const Logger&) = delete;

  // Event "call": info when it went well or the caller is at fault, warning for overload, error for faults of ours. At
  // most kCallsPerSecond failed calls of one method and reason are written in a second; then a line with event
  // "suppressed" counts the rest. INTERNAL, UNKNOWN and DATA_LOSS are always written.
  static constexpr int kCallsPerSecond = 10;
  void Call(const CallRecord& record);

  // A warning of gRPC itself, limited like calls, by `source`: strangers cause many, handshakes that fail above
  // all.
  void WarnOfGrpc(const std::string& source, const std::string& message);

  void Debug(const std::string& event, const LogFields& fields = {});
  void Info(const std::string& event, const LogFields& fields = {});
  void Warning(const std::string& event, const LogFields& fields = {});
  void Error(const std::string& event, const LogFields& fields = {});

 private:
  struct State;
  explicit Logger(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace curvereg::server

#endif  // CURVEREG_SERVER_OPERATIONS_LOGGING_H_
