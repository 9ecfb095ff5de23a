// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/access/credentials.h"

#include <gmock/gmock.h>
#include <grpcpp/grpcpp.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "server/operations/health_service.h"
#include "tests/testing/test_data.h"

namespace curvereg::server {
namespace {

using grpc::health::v1::Health;
using ::testing::AllOf;
using ::testing::HasSubstr;

std::string ReadAll(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// Certificates made by the openssl command: authorities that sign leaves for localhost.
class CredentialsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v openssl >/dev/null 2>&1") != 0) GTEST_SKIP() << "the openssl command is missing";
  }

  void Run(const std::string& arguments) {
    const std::string log = folder_.File("openssl.log");
    ASSERT_EQ(std::system(("cd " + folder_.path() + " && openssl " + arguments + " >" + log + " 2>&1").c_str()), 0)
        << arguments << "\n"
        << ReadAll(log);
  }
  // NAME.pem and NAME.key of an authority.
  void MakeAuthority(const std::string& name) {
    Run("req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=" + name + " -keyout " +
        name + ".key -out " + name + ".pem");
  }
  // NAME.pem and NAME.key signed by the authority.
  void MakeLeaf(const std::string& name, const std::string& authority) {
    std::ofstream(folder_.File("extensions")) << "subjectAltName=DNS:localhost,IP:127.0.0.1\n";
    Run("req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=" + name + " -keyout " + name +
        ".key -out " + name + ".csr");
    Run("x509 -req -days 2 -in " + name + ".csr -CA " + authority + ".pem -CAkey " + authority +
        ".key -CAcreateserial -extfile extensions -out " + name + ".pem");
  }
  TlsConfig Tls(const std::string& leaf) const {
    TlsConfig tls;
    tls.certificate_file = folder_.File(leaf + ".pem");
    tls.key_file = folder_.File(leaf + ".key");
    return tls;
  }

  void Listen(const TlsConfig& tls) {
    const auto credentials = MakeServerCredentials(tls);
    ASSERT_TRUE(credentials.ok()) << credentials.status();
    health_.SetServing("", true);
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", *credentials, &port_);
    builder.RegisterService(&health_);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
  }

  // Whether a call over a new connection arrives; `leaf` empty: no certificate is shown.
  bool CanCall(const std::shared_ptr<grpc::ChannelCredentials>& credentials) const {
    grpc::ChannelArguments arguments;
    arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own
    const auto channel = grpc::CreateCustomChannel("localhost:" + std::to_string(port_), credentials, arguments);
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
    grpc::health::v1::HealthCheckResponse response;
    const grpc::Status status = Health::NewStub(channel)->Check(&context, {}, &response);
    return status.ok() && response.status() == grpc::health::v1::HealthCheckResponse::SERVING;
  }
  std::shared_ptr<grpc::ChannelCredentials> Client(const std::string& authority, const std::string& leaf = "") const {
    grpc::SslCredentialsOptions options;
    options.pem_root_certs = ReadAll(folder_.File(authority + ".pem"));
    if (!leaf.empty()) {
      options.pem_cert_chain = ReadAll(folder_.File(leaf + ".pem"));
      options.pem_private_key = ReadAll(folder_.File(leaf + ".key"));
    }
    return grpc::SslCredentials(options);
  }

  const testing::TemporaryFolder folder_;
  HealthService health_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

TEST_F(CredentialsTest, WithoutACertificateTheTextIsPlain) {
  Listen({});
  EXPECT_TRUE(CanCall(grpc::InsecureChannelCredentials()));
}

TEST_F(CredentialsTest, TlsIsSpokenToThoseWhoTrustTheAuthority) {
  MakeAuthority("ca");
  MakeAuthority("other");
  MakeLeaf("server", "ca");
  Listen(Tls("server"));
  EXPECT_TRUE(CanCall(Client("ca")));
  EXPECT_FALSE(CanCall(Client("other")));
  EXPECT_FALSE(CanCall(grpc::InsecureChannelCredentials()));
}

TEST_F(CredentialsTest, MutualTlsAsksForACertificateOfTheAuthority) {
  MakeAuthority("ca");
  MakeAuthority("other");
  MakeLeaf("server", "ca");
  MakeLeaf("rover", "ca");
  MakeLeaf("stranger", "other");
  TlsConfig tls = Tls("server");
  tls.client_ca_file = folder_.File("ca.pem");
  Listen(tls);
  EXPECT_TRUE(CanCall(Client("ca", "rover")));
  EXPECT_FALSE(CanCall(Client("ca", "stranger")));
  EXPECT_FALSE(CanCall(Client("ca")));
}

TEST_F(CredentialsTest, NewFilesAreTakenUp) {
  MakeAuthority("old_ca");
  MakeAuthority("new_ca");
  MakeLeaf("old", "old_ca");
  MakeLeaf("new", "new_ca");
  namespace fs = std::filesystem;
  const auto publish = [this](const std::string& name) {  // a link to a folder, replaced in one step
    fs::create_directory(folder_.File(name + ".d"));
    fs::copy_file(folder_.File(name + ".pem"), folder_.File(name + ".d/tls.pem"));
    fs::copy_file(folder_.File(name + ".key"), folder_.File(name + ".d/tls.key"));
    fs::create_directory_symlink(name + ".d", folder_.File("next"));
    fs::rename(folder_.File("next"), folder_.File("current"));
  };
  publish("old");
  TlsConfig tls = Tls("current/tls");
  tls.reload_seconds = 1;
  Listen(tls);
  EXPECT_TRUE(CanCall(Client("old_ca")));
  EXPECT_FALSE(CanCall(Client("new_ca")));
  publish("new");
  bool is_new = false;
  for (int i = 0; i < 50 && !is_new; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    is_new = CanCall(Client("new_ca"));
  }
  EXPECT_TRUE(is_new);
  EXPECT_FALSE(CanCall(Client("old_ca")));
}

TEST_F(CredentialsTest, UnusableFilesAreNamed) {
  MakeAuthority("ca");
  MakeLeaf("server", "ca");
  MakeLeaf("rover", "ca");
  Run("pkey -in server.key -aes256 -passout pass:x -out locked.key");
  std::ofstream(folder_.File("empty.pem")) << "\n";
  const auto failure = [](const TlsConfig& tls) {
    const absl::Status status = MakeServerCredentials(tls).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return std::string(status.message());
  };
  TlsConfig tls = Tls("server");
  tls.certificate_file = folder_.File("none.pem");
  EXPECT_THAT(failure(tls), AllOf(HasSubstr("tls.certificate_file"), HasSubstr("none.pem")));
  tls.certificate_file = folder_.File("empty.pem");
  EXPECT_THAT(failure(tls), AllOf(HasSubstr("tls.certificate_file"), HasSubstr("no PEM certificate")));
  tls = Tls("server");
  tls.key_file = folder_.File("rover.key");
  EXPECT_THAT(failure(tls), AllOf(HasSubstr("tls.key_file"), HasSubstr("is not the key of")));
  tls.key_file = folder_.File("locked.key");
  EXPECT_THAT(failure(tls), AllOf(HasSubstr("tls.key_file"), HasSubstr("password")));
  tls = Tls("server");
  tls.client_ca_file = folder_.File("empty.pem");
  EXPECT_THAT(failure(tls), HasSubstr("tls.client_ca_file"));
}

}  // namespace
}  // namespace curvereg::server
