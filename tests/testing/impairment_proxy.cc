// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/testing/impairment_proxy.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <list>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

#include "tests/testing/relayed_flow.h"

namespace curvereg::testing {
namespace {

constexpr std::chrono::milliseconds kLongestWait(1000);

sockaddr_in LoopbackAddress(int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  address.sin_port = htons(static_cast<uint16_t>(port));
  return address;
}

// Small buffers, so that a slow link is felt by the sender and not swallowed by the kernel.
void SetOptions(int fd, bool small_buffers) {
  const int one = 1;
  setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &one, sizeof one);
  const int bytes = 16 * 1024;
  if (!small_buffers) return;
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
  setsockopt(fd, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
}

void CloseWithReset(int fd) {
  const linger at_once{.l_onoff = 1, .l_linger = 0};
  setsockopt(fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(fd);
}

struct Relay {
  int client;
  int server;
  RelayedFlow up;
  RelayedFlow down;
  bool abandoned = false;
};

class PollingProxy final : public ImpairmentProxy {
 public:
  PollingProxy(int listener, int server_port, const LinkOptions& options)
      : listener_(listener), wake_(eventfd(0, EFD_NONBLOCK)), server_port_(server_port), options_(options) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size);
    port_ = ntohs(address.sin_port);
    up_.delay = down_.delay = options.one_way_delay;
    up_.bytes_per_second = down_.bytes_per_second = options.bytes_per_second;
    if (options.cut_every.count() > 0) next_cut_ = LinkClock::now() + options.cut_every;
    thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
  }
  ~PollingProxy() override {
    thread_.request_stop();
    Wake();
    thread_.join();
    DropAll();
    close(listener_);
    close(wake_);
  }

  int port() const override { return port_; }
  void Cut(std::chrono::milliseconds outage) override {
    Change([&] { CutNow(LinkClock::now(), outage); });
  }
  void Stall() override {
    Change([&] { stalled_ = true; });
  }
  void Resume() override {
    Change([&] { stalled_ = false; });
  }
  void Abandon() override {
    Change([&] { std::for_each(relays_.begin(), relays_.end(), [](Relay& relay) { relay.abandoned = true; }); });
  }
  void CorruptByte(Direction direction, uint64_t offset) override {
    Change([&] { (direction == Direction::kToServer ? up_ : down_).corrupt_at = offset; });
  }
  LinkStatistics statistics() const override {
    const std::lock_guard lock(mutex_);
    return {up_.num_bytes, down_.num_bytes, num_connections_, num_cuts_};
  }

 private:
  template <typename Function>
  void Change(const Function& function) {
    {
      const std::lock_guard lock(mutex_);
      function();
    }
    Wake();
  }
  void Wake() {
    const uint64_t one = 1;
    [[maybe_unused]] const ssize_t count = write(wake_, &one, sizeof one);
  }
  void DropAll() {
    for (const Relay& relay : relays_) {
      CloseWithReset(relay.client);
      CloseWithReset(relay.server);
    }
    relays_.clear();
  }
  void CutNow(LinkClock::time_point now, std::chrono::milliseconds outage) {
    DropAll();
    refuse_until_ = now + outage;
    ++num_cuts_;
  }

  void Run(const std::stop_token& stop) {
    std::vector<pollfd> polled;
    while (!stop.stop_requested()) {
      int timeout_ms = 0;
      {
        const std::lock_guard lock(mutex_);
        timeout_ms = Work(LinkClock::now(), polled);
      }
      poll(polled.data(), polled.size(), timeout_ms);
      uint64_t count = 0;
      [[maybe_unused]] const ssize_t read_count = read(wake_, &count, sizeof count);
    }
  }

  // Does what can be done now; tells what to wait for and how long at most [ms].
  int Work(LinkClock::time_point now, std::vector<pollfd>& polled) {
    if (next_cut_ && now >= *next_cut_) {
      CutNow(now, options_.outage);
      *next_cut_ += options_.cut_every;
    }
    polled.assign({{wake_, POLLIN, 0}});
    LinkClock::time_point next = now + kLongestWait;
    if (next_cut_) next = std::min(next, *next_cut_);
    if (!stalled_) {
      AcceptAll(now);
      polled.push_back({listener_, POLLIN, 0});
      std::erase_if(relays_, [&](Relay& relay) { return Advance(relay, now); });
      for (const Relay& relay : relays_) {
        if (!relay.abandoned) next = std::min(next, AddPolled(relay, polled));
      }
    }
    const auto wait = std::chrono::ceil<std::chrono::milliseconds>(next - LinkClock::now());
    return static_cast<int>(std::max<int64_t>(wait.count(), 0));
  }

  void AcceptAll(LinkClock::time_point now) {
    while (true) {
      const int client = accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
      if (client < 0) return;
      const int server = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
      const sockaddr_in address = LoopbackAddress(server_port_);
      if (now < refuse_until_ || connect(server, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
        CloseWithReset(client);
        CloseWithReset(server);
        continue;
      }
      SetOptions(client, options_.bytes_per_second > 0);
      SetOptions(server, options_.bytes_per_second > 0);
      const LinkClock::time_point open_at = now + 2 * options_.one_way_delay;
      relays_.push_back({client, server, RelayedFlow(client, server, open_at), RelayedFlow(server, client, open_at)});
      ++num_connections_;
    }
  }

  // True: the relay has come to its end and is closed.
  bool Advance(Relay& relay, LinkClock::time_point now) {
    if (relay.abandoned) return false;
    relay.up.Step(up_, now);
    relay.down.Step(down_, now);
    const bool failed = relay.up.failed() || relay.down.failed();
    if (!failed && !(relay.up.done() && relay.down.done())) return false;
    for (const int fd : {relay.client, relay.server}) {
      if (failed) {
        CloseWithReset(fd);
      } else {
        close(fd);
      }
    }
    return true;
  }

  LinkClock::time_point AddPolled(const Relay& relay, std::vector<pollfd>& polled) const {
    const LinkClock::time_point now = LinkClock::now();
    polled.push_back({relay.up.ReadFd(up_, now), POLLIN, 0});
    polled.push_back({relay.up.WriteFd(now), POLLOUT, 0});
    polled.push_back({relay.down.ReadFd(down_, now), POLLIN, 0});
    polled.push_back({relay.down.WriteFd(now), POLLOUT, 0});
    return std::min(relay.up.NextTime(up_, now), relay.down.NextTime(down_, now));
  }

  const int listener_;
  const int wake_;
  const int server_port_;
  const LinkOptions options_;
  int port_ = 0;
  mutable std::mutex mutex_;  // guards what follows
  LinkLane up_;
  LinkLane down_;
  std::list<Relay> relays_;
  bool stalled_ = false;
  LinkClock::time_point refuse_until_{};
  std::optional<LinkClock::time_point> next_cut_;
  int num_connections_ = 0;
  int num_cuts_ = 0;
  std::jthread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<ImpairmentProxy>> ImpairmentProxy::Start(int server_port, const LinkOptions& options) {
  const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const sockaddr_in address = LoopbackAddress(0);
  SetOptions(listener, options.bytes_per_second > 0);  // accepted sockets inherit them
  if (bind(listener, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 || listen(listener, 64) != 0) {
    close(listener);
    return absl::UnavailableError(std::string("impairment proxy: ") + std::strerror(errno));
  }
  return std::make_unique<PollingProxy>(listener, server_port, options);
}

}  // namespace curvereg::testing
