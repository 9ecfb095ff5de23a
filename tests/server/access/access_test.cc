// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/access/access.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "files/atomic_file.h"
#include "server/access/token_file.h"
#include "tests/testing/test_data.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

// SHA-256 of "secret", as `printf secret | sha256sum` tells.
constexpr char kSecretDigest[] = "2bb80d537b1da3e38bd30361aa855686bde0eacd7162fef6a25fe97bf527a25b";

std::string Table(const std::string& name, const std::string& scope, const std::string& sha256) {
  return "[[token]]\nname = '" + name + "'\nscope = '" + scope + "'\nsha256 = '" + sha256 + "'\n";
}

class AccessTest : public ::testing::Test {
 protected:
  std::string Write(const std::string& text) {
    const std::string path = folder_.File("tokens.toml");
    EXPECT_TRUE(WriteFileAtomically(path, text).ok());
    return path;
  }
  std::unique_ptr<Access> Make(const std::string& text) { return *Access::FromFile(Write(text), 1, *logger_); }

  const testing::TemporaryFolder folder_;
  const std::unique_ptr<Logger> logger_ = Logger::Silent();
};

TEST_F(AccessTest, KnowsATokenByItsDigest) {
  const std::unique_ptr<Access> access = Make(Table("rover", "write", kSecretDigest));
  EXPECT_EQ(*access->Check("Bearer secret", Scope::kRead), "rover");
  EXPECT_EQ(*access->Check("bearer secret", Scope::kWrite), "rover");
  const absl::Status admin = access->Check("Bearer secret", Scope::kAdmin).status();
  EXPECT_EQ(admin.code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(wire::ReasonOf(admin), v1::ERROR_REASON_SCOPE_MISSING);
  EXPECT_EQ(wire::ErrorInfoOf(admin)->metadata().at("scope"), "admin");
}

TEST_F(AccessTest, RefusesEverythingElse) {
  const std::unique_ptr<Access> access = Make(Table("rover", "admin", kSecretDigest));
  for (const char* authorization :
       {"", "secret", "Bearer", "Bearer ", "Bearer  secret", "Bearer secret ", "Basic secret", "Bearer Secret",
        kSecretDigest, "Bearer 2bb80d537b1da3e38bd30361aa855686bde0eacd71"}) {
    const absl::Status status = access->Check(authorization, Scope::kRead).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kUnauthenticated) << authorization;
    EXPECT_EQ(wire::ReasonOf(status), v1::ERROR_REASON_UNAUTHENTICATED);
    EXPECT_EQ(status.message().find("secret"), absl::string_view::npos);
  }
}

TEST_F(AccessTest, AFileWithoutTokensLetsNobodyIn) {
  EXPECT_FALSE(Make("")->Check("Bearer ", Scope::kRead).ok());
  EXPECT_FALSE(Make("# none\n")->Check("Bearer secret", Scope::kRead).ok());
}

TEST_F(AccessTest, OpenLetsEveryoneIn) {
  EXPECT_EQ(*Access::Open()->Check("", Scope::kAdmin), "");
  EXPECT_EQ(*Access::Open()->Check("Bearer x", Scope::kAdmin), "");
}

TEST_F(AccessTest, MadeTokensAreAccepted) {
  const absl::StatusOr<NewToken> read = MakeToken("ground-1", Scope::kRead);
  const absl::StatusOr<NewToken> admin = MakeToken("ops@site", Scope::kAdmin);
  ASSERT_TRUE(read.ok() && admin.ok());
  EXPECT_NE(read->token, admin->token);
  EXPECT_EQ(read->toml.find(read->token), std::string::npos);
  const std::unique_ptr<Access> access = Make(read->toml + "\n" + admin->toml);
  EXPECT_EQ(*access->Check("Bearer " + read->token, Scope::kRead), "ground-1");
  EXPECT_FALSE(access->Check("Bearer " + read->token, Scope::kWrite).ok());
  EXPECT_EQ(*access->Check("Bearer " + admin->token, Scope::kAdmin), "ops@site");
}

TEST_F(AccessTest, NamesAreWords) {
  for (const char* name : {"", "two words", "line\n", "quote\"", "\xC3\xA4"})
    EXPECT_FALSE(MakeToken(name, Scope::kRead).ok());
  EXPECT_FALSE(MakeToken(std::string(65, 'a'), Scope::kRead).ok());
  EXPECT_TRUE(MakeToken(std::string(64, 'a'), Scope::kRead).ok());
}

TEST_F(AccessTest, ErrorsNameFileAndLine) {
  const auto failure = [](const std::string& text) {
    const absl::Status status = ParseTokenFile(text, "tokens.toml").status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << text;
    return std::string(status.message());
  };
  EXPECT_THAT(failure("\n[[token]\n"), StartsWith("tokens.toml:2: "));
  EXPECT_THAT(failure("[token]\n"), HasSubstr("[[token]]"));
  EXPECT_THAT(failure("[[tokens]]\n"), HasSubstr("[[token]]"));
  EXPECT_THAT(failure("[[token]]\nname = 'a'\nscope = 'read'\n"),
              AllOf(StartsWith("tokens.toml:1: "), HasSubstr("sha256")));
  EXPECT_THAT(failure(Table("a", "root", kSecretDigest)), AllOf(StartsWith("tokens.toml:3: "), HasSubstr("scope")));
  EXPECT_THAT(failure(Table("a", "read", "secret")), AllOf(StartsWith("tokens.toml:4: "), HasSubstr("64")));
  EXPECT_THAT(failure(Table("a b", "read", kSecretDigest)), StartsWith("tokens.toml:2: "));
  EXPECT_THAT(failure("[[token]]\nname = 5\n"), HasSubstr("string"));
  EXPECT_THAT(failure("[[token]]\nsecret = 'x'\n"), HasSubstr("\"secret\""));
  EXPECT_THAT(failure(Table("a", "read", kSecretDigest) + Table("b", "admin", kSecretDigest)),
              AllOf(StartsWith("tokens.toml:5: "), HasSubstr("twice")));
}

TEST_F(AccessTest, AFileThatCannotBeReadIsAnError) {
  for (const std::string& path : {folder_.File("none"), folder_.path(), Write("nonsense")}) {
    const absl::Status status = Access::FromFile(path, 1, *logger_).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << path;
    EXPECT_EQ(std::string(status.message()).rfind("token_file: " + path + ":", 0), 0u) << status;
  }
}

// Whether the answer to this token becomes `expected` within ten seconds.
bool Becomes(const Access& access, const std::string& token, bool expected) {
  for (int i = 0; i < 200; ++i) {
    if (access.Check("Bearer " + token, Scope::kRead).ok() == expected) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

TEST_F(AccessTest, FollowsTheFileAndKeepsTheOldOneWhenItIsBroken) {
  const std::unique_ptr<Access> access = Make(Table("rover", "read", kSecretDigest));
  const absl::StatusOr<NewToken> added = MakeToken("added", Scope::kRead);
  Write(Table("rover", "read", kSecretDigest) + added->toml);
  EXPECT_TRUE(Becomes(*access, added->token, true));
  Write("broken [");
  std::this_thread::sleep_for(std::chrono::milliseconds(1500));  // longer than the interval
  EXPECT_TRUE(access->Check("Bearer secret", Scope::kRead).ok());
  Write(added->toml);  // the first is withdrawn
  EXPECT_TRUE(Becomes(*access, "secret", false));
  EXPECT_TRUE(access->Check("Bearer " + added->token, Scope::kRead).ok());
}

}  // namespace
}  // namespace curvereg::server
