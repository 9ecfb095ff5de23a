// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Bytes that are no request, to every method of a real server: an error of ours each, counted and logged.
#include <chrono>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <google/protobuf/descriptor.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include "curvereg/v1/registration_service.pb.h"
#include "curvereg/v1/scan_service.pb.h"
#include "curvereg/v1/traverse_service.pb.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "tests/testing/generic_call.h"
#include "tests/testing/server_process.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;

constexpr std::chrono::seconds kPatience(30);

// "/curvereg.v1.ScanService/GetScan" and so on.
std::vector<std::string> AllMethods() {
  std::vector<std::string> methods;
  for (const auto* file : {v1::ListMethodsRequest::descriptor()->file(), v1::GetScanRequest::descriptor()->file(),
                           v1::GetTraverseRequest::descriptor()->file()}) {
    const google::protobuf::ServiceDescriptor* const service = file->service(0);
    for (int i = 0; i < service->method_count(); ++i) {
      methods.push_back("/" + service->full_name() + "/" + service->method(i)->name());
    }
  }
  return methods;
}

std::vector<google::rpc::ErrorInfo> ErrorInfosOf(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  std::vector<google::rpc::ErrorInfo> infos;
  for (const google::protobuf::Any& detail : details.details()) {
    if (google::rpc::ErrorInfo info; detail.UnpackTo(&info)) infos.push_back(info);
  }
  return infos;
}

class UnreadableRequestsTest : public ::testing::Test {
 protected:
  void ExpectRefused(const std::string& method, const std::string& bytes, const std::string& reason) {
    SCOPED_TRACE(method);
    const grpc::Status status = testing::Send(stub_, method, bytes, kPatience);
    const std::vector<google::rpc::ErrorInfo> infos = ErrorInfosOf(status);
    ASSERT_EQ(infos.size(), 1U) << status.error_code() << ": " << status.error_message();
    EXPECT_EQ(infos.front().reason(), reason);
    EXPECT_EQ(infos.front().domain(), "curvereg");
    EXPECT_NE(status.error_message(), "");
  }
  std::string Log() const {
    std::ostringstream text;
    text << std::ifstream(folder_.File("server.log")).rdbuf();
    return text.str();
  }

  testing::TemporaryFolder folder_;
  testing::ServerProcess server_{CURVEREG_SERVER_EXECUTABLE, folder_.path(), {"--log-format", "text"}};
  grpc::GenericStub stub_{grpc::CreateChannel(server_.target(), grpc::InsecureChannelCredentials())};
};

TEST_F(UnreadableRequestsTest, EveryMethodRefusesThem) {
  const std::vector<std::string> methods = AllMethods();
  EXPECT_GE(methods.size(), 18U);
  for (const std::string& method : methods) {
    ExpectRefused(method, "\xff\xff\xff", "UNEXPECTED_MESSAGE");
    const std::string name = method.substr(method.rfind('/') + 1);
    EXPECT_THAT(Log(), HasSubstr("method=" + name + " "));
    EXPECT_THAT(server_.Get("/metrics"),
                HasSubstr("grpc_server_handled_total{grpc_code=\"INVALID_ARGUMENT\",grpc_method=\"" + name + "\""));
  }
}

TEST_F(UnreadableRequestsTest, NamesMustBeUtf8) {
  ExpectRefused("/curvereg.v1.ScanService/GetScan", "\x0a\x02\xff\xfe", "UNEXPECTED_MESSAGE");
  ExpectRefused("/curvereg.v1.ScanService/DownloadScan", "\x0a\x02\xff\xfe", "UNEXPECTED_MESSAGE");
}

TEST_F(UnreadableRequestsTest, TheServerGoesOn) {
  ExpectRefused("/curvereg.v1.ScanService/GetScan", "\xff", "UNEXPECTED_MESSAGE");
  EXPECT_TRUE(testing::Send(stub_, "/curvereg.v1.ScanService/ListScans", "", kPatience).ok());
}

}  // namespace
}  // namespace curvereg
