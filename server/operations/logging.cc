// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/logging.h"

#include <spdlog/logger.h>
#include <spdlog/sinks/null_sink.h>
#include <spdlog/sinks/stdout_sinks.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/time.h"
#include "server/operations/line_limiter.h"

namespace curvereg::server {
namespace {

using spdlog::level::level_enum;

std::optional<level_enum> LevelFromName(std::string_view name) {
  if (name == "debug") return spdlog::level::debug;
  if (name == "info") return spdlog::level::info;
  if (name == "warning") return spdlog::level::warn;
  if (name == "error") return spdlog::level::err;
  return std::nullopt;
}

const char* LevelName(level_enum level) {
  switch (level) {
    case spdlog::level::debug:
      return "debug";
    case spdlog::level::warn:
      return "warning";
    case spdlog::level::err:
      return "error";
    default:
      return "info";
  }
}

std::string Now() { return absl::FormatTime("%Y-%m-%dT%H:%M:%E3SZ", absl::Now(), absl::UTCTimeZone()); }

// Escapes quotes, control characters and, as U+FFFD, bytes that are not UTF-8.
std::string Dump(const nlohmann::ordered_json& value) {
  return value.dump(-1, ' ', /*ensure_ascii=*/false, nlohmann::ordered_json::error_handler_t::replace);
}

nlohmann::ordered_json ToJson(const LogField& field) {
  return std::visit([](const auto& value) { return nlohmann::ordered_json(value); }, field.value);
}

std::string JsonLine(level_enum level, const std::string& event, const LogFields& fields) {
  nlohmann::ordered_json line = {{"time", Now()}, {"level", LevelName(level)}, {"event", event}};
  for (const LogField& field : fields) line[field.name] = ToJson(field);
  return Dump(line);
}

// Plain words stay as they are, all else is quoted as in JSON.
std::string TextValue(const LogField& field) {
  const auto* text = std::get_if<std::string>(&field.value);
  if (text == nullptr) return Dump(ToJson(field));
  const bool is_word = !text->empty() && std::all_of(text->begin(), text->end(), [](char c) {
    return c > ' ' && c <= '~' && c != '"' && c != '\\' && c != '=';
  });
  return is_word ? *text : Dump(*text);
}

std::string TextLine(level_enum level, const std::string& event, const LogFields& fields) {
  std::string line = absl::StrCat(Now(), " ", LevelName(level), " ", event);
  for (const LogField& field : fields) absl::StrAppend(&line, " ", field.name, "=", TextValue(field));
  return line;
}

bool IsFaultOfOurs(const CallRecord& record) {
  return record.code == "INTERNAL" || record.code == "UNKNOWN" || record.reason == "STORED_SCAN_DAMAGED";
}

level_enum LevelOf(const CallRecord& record) {
  if (IsFaultOfOurs(record)) return spdlog::level::err;
  const bool is_overload = record.code == "RESOURCE_EXHAUSTED" || record.code == "UNAVAILABLE";
  return is_overload ? spdlog::level::warn : spdlog::level::info;
}

LogFields FieldsOf(const CallRecord& record) {
  LogFields fields = {{"service", record.service},
                      {"method", record.method},
                      {"request_id", record.request_id},
                      {"client", record.client},
                      {"code", record.code}};
  if (!record.reason.empty()) fields.push_back({"reason", record.reason});
  if (!record.message.empty()) fields.push_back({"message", record.message});
  fields.push_back({"ms", record.milliseconds});
  return fields;
}

}  // namespace

struct Logger::State {
  State(spdlog::sink_ptr sink, bool is_json) : logger("curvereg", std::move(sink)), as_json(is_json) {}

  void Write(level_enum level, const std::string& event, const LogFields& fields) {
    if (!logger.should_log(level)) return;
    logger.log(level, as_json ? JsonLine(level, event, fields) : TextLine(level, event, fields));
  }

  void ReportSuppressed(LineLimiter::TimePoint now) {
    std::vector<LineLimiter::Suppressed> suppressed;
    {
      const std::lock_guard lock(mutex);
      suppressed = limiter.TakeSuppressed(now);
    }
    for (const auto& [kind, num_lines] : suppressed) {
      Write(spdlog::level::warn, "suppressed", {{"calls", kind}, {"count", num_lines}});
    }
  }

  bool Allow(const std::string& kind, LineLimiter::TimePoint now) {
    const std::lock_guard lock(mutex);
    return limiter.Allow(kind, now);
  }

  spdlog::logger logger;  // our own: spdlog's registry of loggers is not used
  const bool as_json;
  std::mutex mutex;
  LineLimiter limiter{kCallsPerSecond};
};

absl::StatusOr<std::unique_ptr<Logger>> Logger::Create(const LogConfig& config, std::FILE* file) {
  const std::optional<level_enum> level = LevelFromName(config.level);
  if (!level.has_value()) return absl::InvalidArgumentError("log.level: no level is named \"" + config.level + "\"");
  if (config.format != "text" && config.format != "json") {
    return absl::InvalidArgumentError("log.format: no format is named \"" + config.format + "\"");
  }
  using Sink = spdlog::sinks::stdout_sink_base<spdlog::details::console_mutex>;  // writes and flushes line by line
  auto state = std::make_unique<State>(std::make_shared<Sink>(file), config.format == "json");
  state->logger.set_pattern("%v");  // the line is made whole here
  state->logger.set_level(*level);
  return std::unique_ptr<Logger>(new Logger(std::move(state)));
}

std::unique_ptr<Logger> Logger::Silent() {
  auto state = std::make_unique<State>(std::make_shared<spdlog::sinks::null_sink_mt>(), false);
  state->logger.set_level(spdlog::level::off);
  return std::unique_ptr<Logger>(new Logger(std::move(state)));
}

Logger::Logger(std::unique_ptr<State> state) : state_(std::move(state)) {}

Logger::~Logger() { state_->ReportSuppressed(LineLimiter::TimePoint::max()); }

void Logger::Call(const CallRecord& record) {
  const auto now = std::chrono::steady_clock::now();
  state_->ReportSuppressed(now);
  const bool is_limited = record.code != "OK" && !IsFaultOfOurs(record);
  if (is_limited) {
    const std::string& cause = record.reason.empty() ? record.code : record.reason;
    if (!state_->Allow(absl::StrCat(record.service, "/", record.method, " ", cause), now)) return;
  }
  state_->Write(LevelOf(record), "call", FieldsOf(record));
}

void Logger::WarnOfGrpc(const std::string& source, const std::string& message) {
  const auto now = std::chrono::steady_clock::now();
  state_->ReportSuppressed(now);
  if (!state_->Allow(absl::StrCat("grpc ", source), now)) return;
  state_->Write(spdlog::level::warn, "grpc", {{"source", source}, {"message", message}});
}

void Logger::Debug(const std::string& event, const LogFields& fields) {
  state_->Write(spdlog::level::debug, event, fields);
}
void Logger::Info(const std::string& event, const LogFields& fields) {
  state_->Write(spdlog::level::info, event, fields);
}
void Logger::Warning(const std::string& event, const LogFields& fields) {
  state_->Write(spdlog::level::warn, event, fields);
}
void Logger::Error(const std::string& event, const LogFields& fields) {
  state_->Write(spdlog::level::err, event, fields);
}

}  // namespace curvereg::server
