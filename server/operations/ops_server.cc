// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/operations/ops_server.h"

#include <civetweb.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <string_view>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/listen_address.h"

namespace curvereg::server {
namespace {

constexpr std::chrono::milliseconds kWakeInterval{20};
constexpr char kPlainText[] = "text/plain; charset=utf-8";
constexpr char kMetricsText[] = "text/plain; version=0.0.4; charset=utf-8";

struct Answer {
  int status = 200;
  const char* content_type = kPlainText;
  std::string body;
};

const char* StatusText(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    default:
      return "Service Unavailable";
  }
}

Answer AnswerTo(std::string_view path, const OpsSources& sources) {
  if (path == "/livez") return {.body = "ok\n"};
  if (path == "/metrics") return {.content_type = kMetricsText, .body = sources.metrics()};
  if (path == "/readyz") {
    const std::string reason = sources.not_ready();
    if (reason.empty()) return {.body = "ok\n"};
    return {.status = 503, .body = "not ready: " + reason + "\n"};
  }
  return {.status = 404, .body = "there is /metrics, /livez and /readyz\n"};
}

void Send(mg_connection* connection, const Answer& answer, bool with_body) {
  std::string text = absl::StrCat("HTTP/1.1 ", answer.status, " ", StatusText(answer.status),
                                  "\r\nContent-Type: ", answer.content_type, "\r\nContent-Length: ", answer.body.size(),
                                  "\r\nCache-Control: no-store\r\nConnection: close\r\n",
                                  answer.status == 405 ? "Allow: GET, HEAD\r\n" : "", "\r\n");
  if (with_body) text += answer.body;
  mg_write(connection, text.data(), text.size());
}

// civetweb asks here first and, at an answer that is not 0, does nothing more: none of its file serving is reached.
int BeginRequest(mg_connection* connection) {
  const mg_request_info* request = mg_get_request_info(connection);
  const auto& sources = *static_cast<const OpsSources*>(request->user_data);
  const std::string_view method = request->request_method == nullptr ? "" : request->request_method;
  const std::string_view path = request->local_uri == nullptr ? "" : request->local_uri;
  const bool is_head = method == "HEAD";
  const Answer answer =
      is_head || method == "GET" ? AnswerTo(path, sources) : Answer{.status = 405, .body = "only GET and HEAD\n"};
  Send(connection, answer, !is_head);
  return answer.status;
}

// Connects to the port and leaves: civetweb notices that it is to stop only when its poll of up to 2 s ends.
void WakeUp(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* address = nullptr;
  if (getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &address) != 0) return;
  const int fd = socket(address->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (fd >= 0) {
    static_cast<void>(connect(fd, address->ai_addr, address->ai_addrlen));
    close(fd);
  }
  freeaddrinfo(address);
}

int DropLogMessage(const mg_connection* /*connection*/, const char* /*message*/) { return 1; }

}  // namespace

struct OpsServer::State {
  ~State() {
    if (context == nullptr) return;
    const std::jthread waker([this](const std::stop_token& stopped) {
      for (; !stopped.stop_requested(); std::this_thread::sleep_for(kWakeInterval)) WakeUp(host, port);
    });
    mg_stop(context);
  }
  OpsSources sources;
  std::string host;  // numeric; an address that stands for all is also one to connect to
  int port = 0;      // bound
  mg_context* context = nullptr;
};

absl::StatusOr<std::unique_ptr<OpsServer>> OpsServer::Start(const std::string& listen, const OpsSources& sources) {
  const absl::StatusOr<wire::ListenAddress> address = wire::ParseListenAddress(listen);
  if (!address.ok()) return address.status();
  if (address->host.find(':') != std::string::npos && mg_check_feature(MG_FEATURES_IPV6) == 0) {
    return absl::InvalidArgumentError("ops_listen: the HTTP library of this build knows no IPv6: " + listen);
  }
  // civetweb takes addresses, not names.
  const bool is_name = address->host == "localhost";
  const std::string ports = is_name ? absl::StrCat("127.0.0.1:", address->port) : listen;
  const std::array<const char*, 15> options = {"listening_ports",
                                               ports.c_str(),
                                               "num_threads",
                                               "32",  // more than silent clients are likely to hold
                                               "request_timeout_ms",
                                               "2000",  // a silent client holds a thread no longer
                                               "max_request_size",
                                               "8192",
                                               "enable_keep_alive",
                                               "no",
                                               "listen_backlog",
                                               "64",
                                               "connection_queue",
                                               "32",
                                               nullptr};
  auto state = std::make_unique<State>();
  state->sources = sources;
  state->host = is_name ? "127.0.0.1" : address->host;
  mg_callbacks callbacks{};
  callbacks.begin_request = BeginRequest;
  callbacks.log_message = DropLogMessage;
  state->context = mg_start(&callbacks, &state->sources, const_cast<const char**>(options.data()));
  mg_server_port bound{};
  if (state->context == nullptr || mg_get_server_ports(state->context, 1, &bound) != 1) {
    return absl::UnavailableError("ops_listen: cannot listen on " + listen);
  }
  state->port = bound.port;
  return std::unique_ptr<OpsServer>(new OpsServer(std::move(state)));
}

OpsServer::OpsServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

int OpsServer::port() const { return state_->port; }

OpsServer::~OpsServer() = default;

}  // namespace curvereg::server
