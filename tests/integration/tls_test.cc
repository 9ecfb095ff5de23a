// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// The built server with TLS and tokens against the client library and the built command line.
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "client/client.h"
#include "tests/testing/certificates.h"
#include "tests/testing/matchers.h"
#include "tests/testing/run_command.h"
#include "tests/testing/server_process.h"
#include "tests/testing/simulated.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using testing::Finished;
using ::testing::HasSubstr;
using testing::IsNear;
using testing::IsOk;
using ::testing::Not;
using testing::ReadFile;
using testing::ServerProcess;

class TlsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!testing::HasOpenssl()) GTEST_SKIP() << "the openssl command is missing";
    certificates_.MakeAuthority("ca");
    certificates_.MakeAuthority("other");
    certificates_.MakeLeaf("server", "ca", "DNS:localhost,IP:127.0.0.1,IP:::1");
    certificates_.MakeLeaf("rover", "ca", "DNS:rover");
    certificates_.MakeLeaf("stranger", "other", "DNS:rover");
  }

  // With TLS; `more`: further arguments.
  void Serve(std::vector<std::string> more = {}) {
    more.insert(more.end(),
                {"--tls-certificate-file", certificates_.Pem("server"), "--tls-key-file", certificates_.Key("server")});
    server_ = std::make_unique<ServerProcess>(CURVEREG_SERVER_EXECUTABLE, folder_.path(), more);
    ASSERT_NE(server_->port(), 0) << Log();
  }
  std::vector<std::string> Mutually() const { return {"--tls-client-ca-file", certificates_.Pem("ca")}; }
  std::string Log() const { return ReadFile(folder_.File("server.log")); }

  // Adds a token of this scope to the token file and returns it.
  std::string MakeToken(const std::string& scope) const {
    const Finished made = Run("'" CURVEREG_SERVER_EXECUTABLE "' make-token " + scope + "-user --scope " + scope +
                              " --append-to '" + TokenFile() + "'");
    EXPECT_EQ(made.status, 0) << made.err;
    return made.out.substr(0, made.out.find('\n'));
  }
  std::string TokenFile() const { return folder_.File("tokens.toml"); }

  // Trusts `authority`; shows the certificate `leaf`, none when empty. Gives up soon.
  ClientOptions Options(const std::string& authority, const std::string& leaf = "") const {
    ClientOptions options;
    options.tls.enabled = true;
    options.tls.ca_file = certificates_.Pem(authority);
    if (!leaf.empty()) {
      options.tls.certificate_file = certificates_.Pem(leaf);
      options.tls.key_file = certificates_.Key(leaf);
    }
    options.connect_timeout = std::chrono::seconds(2);
    options.retry.max_attempts = 2;
    return options;
  }
  ClientOptions WithToken(const std::string& token) const {
    ClientOptions options = Options("ca");
    options.token = token;
    return options;
  }
  // Of a call over a new connection.
  absl::Status Try(const ClientOptions& options) const {
    const auto client = Client::Connect(server_->target(), options);
    return client.ok() ? (*client)->ListScans().status() : client.status();
  }

  // A command in the folder.
  Finished Run(const std::string& command) const { return testing::RunIn(folder_.path(), command); }
  Finished Ask(const std::string& arguments, const std::string& environment = "") const {
    return Run(environment + " '" CURVEREG_EXECUTABLE "' " + arguments + " --timeout 5 --server " + server_->target());
  }

  const testing::TemporaryFolder folder_;
  const testing::Certificates certificates_{folder_.path()};
  std::unique_ptr<ServerProcess> server_;
};

TEST_F(TlsTest, RegistersUploadsAndDownloads) {
  Serve();
  const testing::ScanPairWithTruth pair = testing::PairOf("sparse", 1, 0);
  const auto client = Client::Connect(server_->target(), Options("ca"));
  ASSERT_THAT(client, IsOk());
  TransferOptions lossless;
  lossless.encoding.kind = TransferEncoding::Kind::kLossless;
  const auto source = (*client)->UploadScan(pair.source, lossless);
  ASSERT_THAT(source, IsOk());
  const auto back = (*client)->DownloadScan(source->scan.name);
  ASSERT_THAT(back, IsOk());
  EXPECT_EQ(back->points.size(), pair.source.points.size());
  const auto result = (*client)->RegisterScans(source->scan.name, std::cref(pair.target));
  ASSERT_THAT(result, IsOk());
  EXPECT_THAT(result->T_target_source, IsNear(pair.T_target_source, 0.05, 0.005));
  const auto status = (*client)->Status();
  ASSERT_THAT(status, IsOk());
  EXPECT_TRUE(status->serving);
}

TEST_F(TlsTest, OnlyTheRightAuthorityIsTrusted) {
  Serve();
  EXPECT_THAT(Try(Options("ca")), IsOk());
  EXPECT_EQ(Try(Options("other")).code(), absl::StatusCode::kUnavailable);
  ClientOptions plain;
  plain.connect_timeout = std::chrono::seconds(2);
  plain.retry.max_attempts = 2;
  EXPECT_EQ(Try(plain).code(), absl::StatusCode::kUnavailable);
}

TEST_F(TlsTest, TheNameInTheCertificateMustBeTheServers) {
  certificates_.MakeLeaf("server", "ca", "DNS:rover-ground");
  Serve();
  EXPECT_EQ(Try(Options("ca")).code(), absl::StatusCode::kUnavailable);
  ClientOptions named = Options("ca");
  named.tls.server_name = "rover-ground";
  EXPECT_THAT(Try(named), IsOk());
  named.tls.server_name = "other-ground";
  EXPECT_EQ(Try(named).code(), absl::StatusCode::kUnavailable);
}

TEST_F(TlsTest, MutualTlsAsksTheClientForItsCertificate) {
  Serve(Mutually());
  EXPECT_THAT(Try(Options("ca", "rover")), IsOk());
  EXPECT_EQ(Try(Options("ca")).code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(Try(Options("ca", "stranger")).code(), absl::StatusCode::kUnavailable);
  // Who it was is in the log, and who was turned away; in lines of ours alone.
  server_->Terminate();
  EXPECT_THAT(Log(), HasSubstr("tls:rover"));
  EXPECT_THAT(Log(), HasSubstr("warning grpc source="));
  std::istringstream lines(Log());
  for (std::string line; std::getline(lines, line);) EXPECT_EQ(line.substr(0, 2), "20") << line;
}

TEST_F(TlsTest, TokensGiveTheirScopes) {
  const std::string read = MakeToken("read"), write = MakeToken("write");
  Serve({"--token-file", TokenFile()});
  const testing::ScanPairWithTruth pair = testing::PairOf("sparse", 1, 0);
  const auto writer = Client::Connect(server_->target(), WithToken(write));
  const auto reader = Client::Connect(server_->target(), WithToken(read));
  ASSERT_THAT(writer, IsOk());
  ASSERT_THAT(reader, IsOk());
  const auto uploaded = (*writer)->UploadScan(pair.source);
  ASSERT_THAT(uploaded, IsOk());
  const std::string& name = uploaded->scan.name;

  EXPECT_THAT((*reader)->DownloadScan(name), IsOk());
  EXPECT_THAT((*reader)->RegisterScans(name, std::cref(pair.target)), IsOk());
  const absl::Status upload_refused = (*reader)->UploadScan(pair.target).status();
  EXPECT_EQ(upload_refused.code(), absl::StatusCode::kPermissionDenied);
  EXPECT_EQ(ErrorReasonName(upload_refused), "SCOPE_MISSING");
  EXPECT_EQ(ErrorReasonName((*reader)->DeleteScan(name)), "SCOPE_MISSING");
  EXPECT_THAT((*reader)->GetScan(name), IsOk());
  EXPECT_THAT((*writer)->DeleteScan(name), IsOk());

  server_->Terminate();
  EXPECT_THAT(Log(), HasSubstr("token:read-user"));
  EXPECT_THAT(Log(), Not(HasSubstr(read)));
  EXPECT_THAT(Log(), Not(HasSubstr(write)));
}

TEST_F(TlsTest, NoMethodOfOursWorksWithoutAToken) {
  MakeToken("read");
  Serve({"--token-file", TokenFile()});
  const Scan scan = testing::PairOf("sparse", 1, 0).source;
  const std::string name = "scans/" + std::string(32, '0');
  for (const char* token : {"", "cvr_guessed"}) {
    const auto client = Client::Connect(server_->target(), WithToken(token));
    ASSERT_THAT(client, IsOk());
    const absl::Status statuses[] = {(*client)->RegisterScans(std::cref(scan), std::cref(scan)).status(),
                                     (*client)->RenderScan(std::cref(scan)).status(),
                                     (*client)->UploadScan(scan).status(),
                                     (*client)->DownloadScan(name).status(),
                                     (*client)->GetScan(name).status(),
                                     (*client)->ListScans().status(),
                                     (*client)->DeleteScan(name),
                                     (*client)->Status().status()};
    for (const absl::Status& status : statuses) {
      EXPECT_EQ(status.code(), absl::StatusCode::kUnauthenticated) << status;
      EXPECT_EQ(ErrorReasonName(status), "UNAUTHENTICATED");
    }
  }
}

TEST_F(TlsTest, TheCommandLineTakesItsTokenFromAFileOrTheEnvironment) {
  const std::string write = MakeToken("write");
  std::vector<std::string> arguments = Mutually();
  arguments.insert(arguments.end(), {"--token-file", TokenFile()});
  Serve(arguments);
  std::ofstream(folder_.File("token")) << write << "\n";
  const std::string tls = " --tls-ca ca.pem --tls-cert rover.pem --tls-key rover.key ";
  const Finished with_file = Ask("status" + tls + "--token-file token");
  EXPECT_EQ(with_file.status, 0) << with_file.err;
  EXPECT_EQ(Ask("scans list" + tls, "CURVEREG_TOKEN=" + write).status, 0);

  const Finished without = Ask("scans list" + tls);
  EXPECT_EQ(without.status, 4) << without.err;
  EXPECT_THAT(without.err, HasSubstr("token"));
  const Finished wrong_authority = Ask("status --tls-ca other.pem --tls-cert rover.pem --tls-key rover.key");
  EXPECT_EQ(wrong_authority.status, 4) << wrong_authority.err;
  EXPECT_EQ(Ask("status --tls-ca ca.pem").status, 4) << "there is no certificate of the client";
  EXPECT_EQ(Ask("status" + tls + "--token-file nowhere").status, 2);
}

TEST_F(TlsTest, InlineScansAreCounted) {
  Serve();
  const Scan scan = testing::PairOf("sparse", 1, 0).source;
  const auto client = Client::Connect(server_->target(), Options("ca"));
  ASSERT_THAT(client, IsOk());
  ASSERT_THAT((*client)->RegisterScans(std::cref(scan), std::cref(scan)), IsOk());
  EXPECT_THAT(server_->Get("/metrics"), HasSubstr("curvereg_received_scans_total 2\n"));
}

TEST_F(TlsTest, WorksOverIpv6) {
  Serve({"--listen", "[::1]:0"});
  const auto client = Client::Connect("[::1]:" + std::to_string(server_->port()), Options("ca"));
  ASSERT_THAT(client, IsOk());
  EXPECT_THAT((*client)->ListScans(), IsOk());
}

}  // namespace
}  // namespace curvereg
