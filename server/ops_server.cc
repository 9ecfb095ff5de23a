// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/ops_server.h"

#include <civetweb.h>

#include <array>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/listen_address.h"

namespace curvereg::server {
namespace {

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

int DropLogMessage(const mg_connection* /*connection*/, const char* /*message*/) { return 1; }

}  // namespace

struct OpsServer::State {
  ~State() {
    if (context != nullptr) mg_stop(context);
  }
  OpsSources sources;
  mg_context* context = nullptr;
};

absl::StatusOr<std::unique_ptr<OpsServer>> OpsServer::Start(const std::string& listen, const OpsSources& sources) {
  const absl::StatusOr<ListenAddress> address = ParseListenAddress(listen);
  if (!address.ok()) return address.status();
  // civetweb takes addresses, not names.
  const std::string ports = address->host == "localhost" ? absl::StrCat("127.0.0.1:", address->port) : listen;
  const std::array<const char*, 15> options = {"listening_ports",
                                               ports.c_str(),
                                               "num_threads",
                                               "3",
                                               "request_timeout_ms",
                                               "5000",  // a silent client holds a thread no longer
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
  mg_callbacks callbacks{};
  callbacks.begin_request = BeginRequest;
  callbacks.log_message = DropLogMessage;
  state->context = mg_start(&callbacks, &state->sources, const_cast<const char**>(options.data()));
  mg_server_port bound{};
  if (state->context == nullptr || mg_get_server_ports(state->context, 1, &bound) != 1) {
    return absl::UnavailableError("cannot listen on " + listen);
  }
  auto server = std::unique_ptr<OpsServer>(new OpsServer(std::move(state)));
  server->port_ = bound.port;
  return server;
}

OpsServer::OpsServer(std::unique_ptr<State> state) : state_(std::move(state)) {}
OpsServer::~OpsServer() = default;

}  // namespace curvereg::server
