// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The registry of error reasons, proto/curvereg/v1/error_reason.proto, against the code: complete, consistent, and
// nothing in it that no one sends.
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "curvereg/v1/error_reason.pb.h"
#include "tests/testing/matchers.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

std::string ReadSource(const std::filesystem::path& path) {
  std::ifstream file(path);
  EXPECT_TRUE(file.is_open()) << path;
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The enum's values with the comment above each, on one line.
std::map<std::string, std::string> RegisteredComments() {
  std::istringstream lines(
      ReadSource(std::filesystem::path(CURVEREG_SOURCE_DIR) / "proto/curvereg/v1/error_reason.proto"));
  const std::regex comment_line(R"(^  // (.*)$)");
  const std::regex value_line(R"(^  (ERROR_REASON_\w+) = \d+;$)");
  std::map<std::string, std::string> comments;
  std::string comment;
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, match, comment_line)) {
      comment += (comment.empty() ? "" : " ") + match[1].str();
    } else if (std::regex_match(line, match, value_line)) {
      comments[match[1].str()] = std::exchange(comment, "");
    }
  }
  return comments;
}

std::vector<v1::ErrorReason> SentReasons() {
  std::vector<v1::ErrorReason> reasons;
  for (int i = v1::ErrorReason_MIN + 1; i <= v1::ErrorReason_MAX; ++i) {
    reasons.push_back(static_cast<v1::ErrorReason>(i));
  }
  return reasons;
}

TEST(ErrorRegistryTest, CommentsBeginWithTheCodeThatIsSent) {
  const auto comments = RegisteredComments();
  EXPECT_EQ(comments.size(), static_cast<size_t>(v1::ErrorReason_ARRAYSIZE));
  for (const v1::ErrorReason reason : SentReasons()) {
    const auto found = comments.find(v1::ErrorReason_Name(reason));
    ASSERT_NE(found, comments.end()) << v1::ErrorReason_Name(reason);
    const std::string code = found->second.substr(0, found->second.find(':'));
    EXPECT_EQ(code, absl::StatusCodeToString(ReasonCode(reason))) << found->first;
  }
  EXPECT_EQ(comments.at("ERROR_REASON_UNSPECIFIED"), "Never sent.");
}

// AIP-193: at most 63 of A-Z, 0-9 and '_', beginning with a letter, not ending with '_'.
TEST(ErrorRegistryTest, NamesAreAsErrorInfoDemands) {
  const std::regex demanded("[A-Z][A-Z0-9_]*[A-Z0-9]");
  for (const v1::ErrorReason reason : SentReasons()) {
    EXPECT_LE(ReasonName(reason).size(), 63U);
    EXPECT_TRUE(std::regex_match(ReasonName(reason), demanded)) << ReasonName(reason);
  }
}

TEST(ErrorRegistryTest, EveryReasonIsSentBySomeone) {
  std::string sources;
  for (const char* folder : {"server", "wire"}) {
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(std::filesystem::path(CURVEREG_SOURCE_DIR) / folder)) {
      if (entry.path().extension() == ".cc") sources += ReadSource(entry.path());
    }
  }
  // The labels of a switch send nothing.
  sources = std::regex_replace(sources, std::regex(R"(case v1::ERROR_REASON_\w+:)"), "");
  for (const v1::ErrorReason reason : SentReasons()) {
    const std::regex word(v1::ErrorReason_Name(reason) + "\\b");
    EXPECT_TRUE(std::regex_search(sources, word)) << v1::ErrorReason_Name(reason);
  }
}

}  // namespace
}  // namespace curvereg::wire
