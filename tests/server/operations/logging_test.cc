// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/logging.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "server/operations/line_limiter.h"

namespace curvereg::server {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

// A log in a temporary file, given back line by line.
class LoggingTest : public ::testing::Test {
 protected:
  LoggingTest() : file_(std::tmpfile()) {}
  ~LoggingTest() override { std::fclose(file_); }

  std::unique_ptr<Logger> Make(const std::string& format, const std::string& level = "info") {
    return *Logger::Create({.format = format, .level = level}, file_);
  }
  std::vector<std::string> Lines() {
    std::string text(1 << 20, '\0');
    std::rewind(file_);
    text.resize(std::fread(text.data(), 1, text.size(), file_));
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
  }

  std::FILE* file_;
};

CallRecord Refusal() {
  return {.service = "curvereg.v1.RegistrationService",
          .method = "RegisterScans",
          .request_id = "abc",
          .client = "ipv4:127.0.0.1:5",
          .code = "RESOURCE_EXHAUSTED",
          .reason = "QUEUE_FULL",
          .message = "the queue is full",
          .milliseconds = 1.5};
}

TEST_F(LoggingTest, TextLinesHaveAllFields) {
  Make("text")->Call(Refusal());
  ASSERT_EQ(Lines().size(), 1u);
  EXPECT_THAT(Lines()[0], MatchesRegex("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}\\.[0-9]{3}Z warning call "
                                       "service=curvereg.v1.RegistrationService method=RegisterScans request_id=abc "
                                       "client=ipv4:127.0.0.1:5 code=RESOURCE_EXHAUSTED reason=QUEUE_FULL "
                                       "message=\"the queue is full\" ms=1.5"));
}

TEST_F(LoggingTest, JsonLinesParse) {
  const std::unique_ptr<Logger> logger = Make("json");
  logger->Call(Refusal());
  logger->Info("listening", {{"grpc_port", int64_t{50051}}, {"tls", true}, {"share", 0.5}, {"name", "x"}});
  ASSERT_EQ(Lines().size(), 2u);
  const nlohmann::json call = nlohmann::json::parse(Lines()[0]);
  EXPECT_EQ(call["level"], "warning");
  EXPECT_EQ(call["event"], "call");
  EXPECT_EQ(call["request_id"], "abc");
  EXPECT_EQ(call["reason"], "QUEUE_FULL");
  EXPECT_EQ(call["ms"], 1.5);
  const nlohmann::json listening = nlohmann::json::parse(Lines()[1]);
  EXPECT_EQ(listening["grpc_port"], 50051);
  EXPECT_EQ(listening["tls"], true);
  EXPECT_EQ(listening["share"], 0.5);
  EXPECT_EQ(listening["name"], "x");
}

TEST_F(LoggingTest, NothingThatACallerSendsForgesALine) {
  CallRecord record = Refusal();
  record.client = "evil\n2026-01-01T00:00:00.000Z info call code=OK";
  record.message = "a\"b\\c\x01\xFF\r\nd";
  Make("text")->Call(record);
  ASSERT_EQ(Lines().size(), 1u);
  EXPECT_THAT(Lines()[0], HasSubstr("client=\"evil\\n2026"));
  Make("json")->Call(record);
  ASSERT_EQ(Lines().size(), 2u);
  const nlohmann::json line = nlohmann::json::parse(Lines()[1]);
  EXPECT_EQ(line["client"], record.client);
  EXPECT_EQ(line["message"], "a\"b\\c\x01\xEF\xBF\xBD\r\nd");
}

TEST_F(LoggingTest, LevelsFollowTheCodeAndTheSetting) {
  const std::unique_ptr<Logger> logger = Make("text", "warning");
  CallRecord record = Refusal();
  for (const char* code : {"OK", "INVALID_ARGUMENT", "RESOURCE_EXHAUSTED", "INTERNAL"}) {
    record.code = code;
    logger->Call(record);
  }
  logger->Debug("d");
  logger->Info("i");
  logger->Warning("w");
  logger->Error("e");
  const std::vector<std::string> lines = Lines();
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_THAT(lines[0], HasSubstr("warning call"));
  EXPECT_THAT(lines[1], HasSubstr("error call"));
  EXPECT_THAT(lines[2], EndsWith("warning w"));
  EXPECT_THAT(lines[3], EndsWith("error e"));
}

TEST_F(LoggingTest, RefusalsOfOneKindAreCountedWhenTheyAreMany) {
  std::unique_ptr<Logger> logger = Make("json");
  for (int i = 0; i < 100; ++i) logger->Call(Refusal());
  CallRecord other = Refusal();
  other.reason = "CLIENT_QUOTA";
  logger->Call(other);
  logger.reset();  // tells what was held back
  int num_calls = 0;
  int num_suppressed = 0;
  for (const std::string& text : Lines()) {
    const nlohmann::json line = nlohmann::json::parse(text);
    if (line["event"] == "call") ++num_calls;
    if (line["event"] == "suppressed") num_suppressed += line["count"].get<int>();
  }
  EXPECT_EQ(num_calls + num_suppressed, 101);
  EXPECT_LE(num_calls, 3 * Logger::kCallsPerSecond + 1);  // the loop may run into a second second
  EXPECT_GE(num_calls, Logger::kCallsPerSecond + 1);
}

TEST_F(LoggingTest, SuccessesAndFaultsOfOursAreNeverHeldBack) {
  const std::unique_ptr<Logger> logger = Make("text");
  CallRecord record = Refusal();
  for (const char* code : {"OK", "INTERNAL", "DATA_LOSS"}) {
    record.code = code;
    record.reason = record.code == "DATA_LOSS" ? "STORED_SCAN_DAMAGED" : "";
    for (int i = 0; i < 50; ++i) logger->Call(record);
  }
  EXPECT_EQ(Lines().size(), 150u);
}

TEST_F(LoggingTest, LinesOfGrpcAreLimitedBySource) {
  {
    const std::unique_ptr<Logger> logger = Make("text");
    for (int i = 0; i < 30; ++i) logger->WarnOfGrpc("ssl.cc:1", "the handshake failed");
    logger->WarnOfGrpc("ssl.cc:2", "another");
  }
  ASSERT_EQ(Lines().size(), Logger::kCallsPerSecond + 2u);
  EXPECT_THAT(Lines()[0], HasSubstr("warning grpc source=ssl.cc:1 message=\"the handshake failed\""));
  EXPECT_THAT(Lines().back(), HasSubstr("suppressed calls=\"grpc ssl.cc:1\" count=20"));
}

TEST_F(LoggingTest, LinesOfSeveralThreadsStayWhole) {
  const std::unique_ptr<Logger> logger = Make("json");
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&logger] {
      for (int i = 0; i < 200; ++i) logger->Info("tick", {{"text", std::string(100, 'x')}});
    });
  }
  threads.clear();
  ASSERT_EQ(Lines().size(), 800u);
  for (const std::string& line : Lines()) EXPECT_TRUE(nlohmann::json::accept(line)) << line;
}

TEST_F(LoggingTest, RefusesUnknownFormatsAndLevels) {
  EXPECT_FALSE(Logger::Create({.format = "xml"}, file_).ok());
  EXPECT_FALSE(Logger::Create({.level = "loud"}, file_).ok());
}

TEST_F(LoggingTest, TheSilentOneIsSilent) {
  const std::unique_ptr<Logger> logger = Logger::Silent();
  logger->Error("e");
  logger->Call(Refusal());
  EXPECT_TRUE(Lines().empty());
}

TEST(LineLimiterTest, CountsByKindAndWindow) {
  LineLimiter limiter(2);
  const LineLimiter::TimePoint start{};
  EXPECT_TRUE(limiter.Allow("a", start));
  EXPECT_TRUE(limiter.Allow("a", start));
  EXPECT_FALSE(limiter.Allow("a", start));
  EXPECT_FALSE(limiter.Allow("a", start));
  EXPECT_TRUE(limiter.Allow("b", start));
  EXPECT_TRUE(limiter.TakeSuppressed(start).empty());
  const LineLimiter::TimePoint later = start + LineLimiter::kWindow;
  const std::vector<LineLimiter::Suppressed> suppressed = limiter.TakeSuppressed(later);
  ASSERT_EQ(suppressed.size(), 1u);
  EXPECT_EQ(suppressed[0].kind, "a");
  EXPECT_EQ(suppressed[0].num_lines, 2);
  EXPECT_TRUE(limiter.TakeSuppressed(later).empty());
  EXPECT_TRUE(limiter.Allow("a", later));
}

}  // namespace
}  // namespace curvereg::server
