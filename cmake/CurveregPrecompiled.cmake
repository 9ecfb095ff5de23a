# SPDX-FileCopyrightText: 2026 The Curvereg authors
# SPDX-License-Identifier: Apache-2.0
# The precompiled headers of the layers; each holds what most sources of its layer include and is costly to parse.
set(core_headers
    <algorithm> <array> <chrono> <cmath> <cstdint> <functional> <limits> <map> <memory> <mutex> <optional> <set> <span>
    <stop_token> <string> <string_view> <utility> <vector>
    <Eigen/Core> <Eigen/Geometry> <absl/status/statusor.h> <absl/strings/str_cat.h> <absl/strings/str_format.h>)
set(core_libraries Eigen3::Eigen absl::statusor absl::strings absl::str_format)
curvereg_add_precompiled(core LIBRARIES ${core_libraries} HEADERS ${core_headers})

if(CURVEREG_BUILD_SERVER)
  set(rpc_headers
      ${core_headers} <condition_variable> <filesystem>
      <grpcpp/client_context.h> <grpcpp/support/client_callback.h> <grpcpp/support/server_callback.h>
      <curvereg/v1/registration_service.grpc.pb.h> <curvereg/v1/scan_service.grpc.pb.h>
      <curvereg/v1/traverse_service.grpc.pb.h>)
  curvereg_add_precompiled(rpc LIBRARIES ${core_libraries} curvereg::proto HEADERS ${rpc_headers})
endif()

if(CURVEREG_BUILD_TESTS)
  set(test_headers <gmock/gmock.h> <gtest/gtest.h> <fstream> <sstream> <thread>)
  curvereg_add_precompiled(test LIBRARIES ${core_libraries} GTest::gmock HEADERS ${core_headers} ${test_headers})
  if(CURVEREG_BUILD_SERVER)
    curvereg_add_precompiled(rpc_test LIBRARIES ${core_libraries} curvereg::proto GTest::gmock
                             HEADERS ${rpc_headers} ${test_headers})
  endif()
endif()
