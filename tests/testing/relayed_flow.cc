// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "tests/testing/relayed_flow.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace curvereg::testing {
namespace {

constexpr double kQueueSeconds = 0.1;
constexpr double kQuantumSeconds = 0.005;
constexpr uint64_t kUnboundedCapacity = uint64_t{64} << 20;

}  // namespace

uint64_t LinkLane::Capacity() const {
  if (bytes_per_second <= 0) return kUnboundedCapacity;
  const double seconds = std::chrono::duration<double>(delay).count() + kQueueSeconds;
  return static_cast<uint64_t>(bytes_per_second * seconds) + Quantum();
}

uint64_t LinkLane::Quantum() const {
  if (bytes_per_second <= 0) return 64 * 1024;
  return std::clamp<uint64_t>(static_cast<uint64_t>(bytes_per_second * kQuantumSeconds), 256, 64 * 1024);
}

LinkClock::time_point LinkLane::Pass(std::string& bytes, LinkClock::time_point now) {
  if (corrupt_at && *corrupt_at >= num_bytes && *corrupt_at < num_bytes + bytes.size()) {
    char& byte = bytes[*corrupt_at - num_bytes];
    byte = static_cast<char>(static_cast<unsigned char>(byte) ^ 1U);
    corrupt_at.reset();
  }
  num_bytes += bytes.size();
  free_at = std::max(free_at, now);
  if (bytes_per_second > 0) {
    const std::chrono::duration<double> time(static_cast<double>(bytes.size()) / bytes_per_second);
    free_at += std::chrono::duration_cast<LinkClock::duration>(time);
  }
  return free_at + delay;
}

bool RelayedFlow::Readable(const LinkLane& lane, LinkClock::time_point now) const {
  return !ended_ && now >= open_at_ && now >= lane.free_at && num_queued_ < lane.Capacity();
}

int RelayedFlow::ReadFd(const LinkLane& lane, LinkClock::time_point now) const {
  return Readable(lane, now) ? from_ : -1;
}

int RelayedFlow::WriteFd(LinkClock::time_point now) const {
  return !queue_.empty() && queue_.front().due <= now ? to_ : -1;
}

LinkClock::time_point RelayedFlow::NextTime(const LinkLane& lane, LinkClock::time_point now) const {
  LinkClock::time_point next = LinkClock::time_point::max();
  if (!queue_.empty() && queue_.front().due > now) next = queue_.front().due;
  // A full queue is emptied first; that is a time of its own.
  if (!ended_ && num_queued_ < lane.Capacity() && !Readable(lane, now)) {
    next = std::min(next, std::max(open_at_, lane.free_at));
  }
  return next;
}

void RelayedFlow::Step(LinkLane& lane, LinkClock::time_point now) {
  if (Readable(lane, now)) Read(lane, now);
  Write(now);
}

void RelayedFlow::Read(LinkLane& lane, LinkClock::time_point now) {
  std::string bytes(lane.Quantum(), '\0');
  const ssize_t count = recv(from_, bytes.data(), bytes.size(), MSG_DONTWAIT);
  if (count < 0) {
    failed_ = failed_ || (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR);
    return;
  }
  bytes.resize(static_cast<size_t>(count));
  ended_ = count == 0;
  num_queued_ += bytes.size();
  const LinkClock::time_point due = lane.Pass(bytes, now);
  queue_.push_back({due, std::move(bytes)});  // an empty one passes the end on
}

void RelayedFlow::Write(LinkClock::time_point now) {
  while (!failed_ && !queue_.empty() && queue_.front().due <= now) {
    Segment& segment = queue_.front();
    if (segment.bytes.empty()) {
      shutdown(to_, SHUT_WR);
    } else {
      const ssize_t count = send(to_, segment.bytes.data() + segment.num_sent, segment.bytes.size() - segment.num_sent,
                                 MSG_DONTWAIT | MSG_NOSIGNAL);
      if (count < 0) {
        failed_ = errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR;
        return;
      }
      segment.num_sent += static_cast<size_t>(count);
      num_queued_ -= static_cast<uint64_t>(count);
      if (segment.num_sent < segment.bytes.size()) return;
    }
    queue_.pop_front();
  }
}

}  // namespace curvereg::testing
