// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "client/channel_setup.h"

#include <grpc/grpc.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <sstream>

#include "absl/status/status.h"
#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"

namespace curvereg::internal {
namespace {

// Read ahead this much before the receiver's window has been probed; a long link's first transfer gains by it.
constexpr int kLookaheadBytes = 8 << 20;
// Pictures and results are far smaller; chunks are bounded by the server.
constexpr int kMaxReceiveBytes = 256 << 20;

// The address without a port: "[::1]:80" -> "::1", "localhost:80" -> "localhost", "::1" -> "::1".
std::string HostOf(const std::string& address) {
  if (!address.empty() && address.front() == '[') return address.substr(1, address.find(']') - 1);
  const size_t colon = address.rfind(':');
  const bool has_port = colon != std::string::npos && address.find(':') == colon;
  return has_port ? address.substr(0, colon) : address;
}

bool IsLoopbackHost(const std::string& host) {
  if (absl::AsciiStrToLower(host) == "localhost" || host == "::1") return true;
  const std::vector<std::string> parts = absl::StrSplit(host, '.');
  uint32_t number = 0;
  const auto is_octet = [&](const std::string& part) { return absl::SimpleAtoi(part, &number) && number <= 255; };
  return parts.size() == 4 && parts.front() == "127" && std::all_of(parts.begin(), parts.end(), is_octet);
}

absl::Status OptionError(const std::string& text) { return absl::InvalidArgumentError("client option " + text); }

absl::Status ValidateTls(const TlsOptions& tls) {
  const bool any =
      !tls.ca_file.empty() || !tls.certificate_file.empty() || !tls.key_file.empty() || !tls.server_name.empty();
  if (any && !tls.enabled) return OptionError("tls: files or a server name are given, but TLS is not enabled");
  if (tls.certificate_file.empty() != tls.key_file.empty()) {
    return OptionError("tls: certificate_file and key_file go together");
  }
  return absl::OkStatus();
}

absl::Status ValidateToken(std::string_view target, const ClientOptions& options) {
  if (options.token.empty()) return absl::OkStatus();
  const auto printable = [](char c) { return c > ' ' && c <= '~'; };
  if (!std::all_of(options.token.begin(), options.token.end(), printable)) {
    return OptionError("token: must be printable ASCII without spaces");
  }
  if (!options.tls.enabled && !IsLoopbackTarget(target)) {
    return OptionError(absl::StrCat("token: is not sent in plain text to ", std::string(target), "; enable TLS"));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> ReadPem(const std::string& option, const std::string& path) {
  if (path.empty()) return std::string();
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  if (text.str().empty()) return OptionError(absl::StrCat("tls.", option, ": cannot read ", path, ", or it is empty"));
  return text.str();
}

int Milliseconds(std::chrono::milliseconds time) {
  return static_cast<int>(std::min<int64_t>(time.count(), std::numeric_limits<int>::max()));
}

}  // namespace

bool IsLoopbackTarget(std::string_view target) {
  std::string addresses(target);
  if (addresses.rfind("unix:", 0) == 0 || addresses.rfind("unix-abstract:", 0) == 0) return true;
  for (const char* scheme : {"dns:", "ipv4:", "ipv6:"}) {
    if (addresses.rfind(scheme, 0) == 0) addresses.erase(0, std::string(scheme).size());
  }
  // "//AUTHORITY/NAME": only the empty authority, for another one is a name server that could say anything.
  if (addresses.rfind("///", 0) == 0) addresses.erase(0, 3);
  const std::vector<std::string> all = absl::StrSplit(addresses, ',');
  return std::all_of(all.begin(), all.end(), [](const std::string& one) { return IsLoopbackHost(HostOf(one)); });
}

absl::Status ValidateOptions(std::string_view target, const ClientOptions& options) {
  if (target.empty()) return absl::InvalidArgumentError("the server's address is empty");
  const std::pair<const char*, std::chrono::milliseconds> times[] = {
      {"connect_timeout", options.connect_timeout},
      {"call_timeout", options.call_timeout},
      {"keepalive_interval", options.keepalive_interval},
      {"keepalive_timeout", options.keepalive_timeout},
      {"retry.initial_backoff", options.retry.initial_backoff},
      {"retry.max_backoff", options.retry.max_backoff},
  };
  for (const auto& [name, time] : times) {
    if (time.count() <= 0) return OptionError(absl::StrCat(name, ": must be above 0"));
  }
  if (options.retry.max_attempts < 1) return OptionError("retry.max_attempts: must be at least 1");
  if (absl::Status status = ValidateTls(options.tls); !status.ok()) return status;
  return ValidateToken(target, options);
}

absl::StatusOr<std::shared_ptr<grpc::ChannelCredentials>> MakeCredentials(const TlsOptions& tls) {
  if (!tls.enabled) return grpc::InsecureChannelCredentials();
  const absl::StatusOr<std::string> roots = ReadPem("ca_file", tls.ca_file);
  if (!roots.ok()) return roots.status();
  const absl::StatusOr<std::string> certificate = ReadPem("certificate_file", tls.certificate_file);
  if (!certificate.ok()) return certificate.status();
  const absl::StatusOr<std::string> key = ReadPem("key_file", tls.key_file);
  if (!key.ok()) return key.status();
  return grpc::SslCredentials({*roots, *key, *certificate});
}

grpc::ChannelArguments MakeChannelArguments(std::string_view target, const ClientOptions& options) {
  grpc::ChannelArguments arguments;
  // gRPC sets TCP_USER_TIMEOUT to the keep-alive timeout as soon as there is a keep-alive time.
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, Milliseconds(options.keepalive_interval));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, Milliseconds(options.keepalive_timeout));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  arguments.SetInt(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, kLookaheadBytes);
  arguments.SetMaxReceiveMessageSize(kMaxReceiveBytes);
  arguments.SetMaxSendMessageSize(-1);
  // Retrying is ours: gRPC's stops once a stream's buffer is full, and knows nothing of uploads.
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, 0);
  // "Minimum" is how long one attempt to connect may take. Several round trips of a long link must fit.
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, Milliseconds(options.connect_timeout));
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, Milliseconds(options.retry.initial_backoff));
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, Milliseconds(options.retry.max_backoff));
  // A rebuilt channel shall not find the broken connection of the old one.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  // Nothing for this machine goes out to a proxy, a token least of all.
  if (IsLoopbackTarget(target)) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  if (!options.tls.server_name.empty()) arguments.SetSslTargetNameOverride(options.tls.server_name);
  return arguments;
}

}  // namespace curvereg::internal
