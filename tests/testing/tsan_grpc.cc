// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// What gRPC orders, told to ThreadSanitizer, which does not see it: Debian's gRPC and Abseil are not instrumented.
// Linked into every executable of the tsan build, in front of the libraries, whose calls come here as ours do.
// Nothing is ordered but what gRPC promises or its locks order: what precedes the start of an operation comes before
// what follows its end, and a critical section before the next one. So a race between two of our threads stays visible.
#include <absl/synchronization/mutex.h>
#include <dlfcn.h>
#include <grpc/grpc.h>
#include <grpcpp/support/callback_common.h>
#include <grpcpp/support/server_callback.h>
#include <sanitizer/tsan_interface.h>

#include <cstdio>
#include <cstdlib>

// Of gRPC's core, whose headers are not installed.
unsigned char grpc_call_is_client(grpc_call* call);

namespace {

// The library's own function. Ends the process where there is none, e.g. with another version of Abseil.
template <typename Function>
Function* Original(const char* symbol) {
  void* const found = dlsym(RTLD_NEXT, symbol);
  if (found == nullptr) {
    std::fprintf(stderr, "tsan_grpc.cc: no function %s\n", symbol);
    std::abort();
  }
  return reinterpret_cast<Function*>(found);
}

// What a client does before an operation of a call comes before what a server does after one, and the other way round,
// for the tests that hold both. It orders two threads of a server only by way of a client in the same process.
const char kToServer = 0;
const char kToClient = 0;

void BeforeOperation(grpc_call* call) {
  __tsan_release(const_cast<char*>(grpc_call_is_client(call) ? &kToServer : &kToClient));
}
void AfterOperation(grpc_call* call) {
  __tsan_acquire(const_cast<char*>(grpc_call_is_client(call) ? &kToClient : &kToServer));
}

// gRPC's calling of a reaction, with private members, which an explicit instantiation may name.
using grpc::internal::CallbackWithStatusTag;
using grpc::internal::CallbackWithSuccessTag;
void React(CallbackWithSuccessTag& tag, bool ok);
void React(CallbackWithStatusTag& tag, bool ok);
template <typename Tag, grpc_call* Tag::*Call, void (Tag::*Run)(bool)>
struct Reaction {
  friend void React(Tag& tag, bool ok) {
    __tsan_acquire(&tag);
    AfterOperation(tag.*Call);
    (tag.*Run)(ok);
  }
};
template struct Reaction<CallbackWithSuccessTag, &CallbackWithSuccessTag::call_, &CallbackWithSuccessTag::Run>;
template struct Reaction<CallbackWithStatusTag, &CallbackWithStatusTag::call_, &CallbackWithStatusTag::Run>;

// A tag of the synchronous calls, of which only clients and servers of tests are made.
grpc_event AfterEvent(const grpc_event& event) {
  if (event.type == GRPC_OP_COMPLETE) {
    __tsan_acquire(event.tag);
    __tsan_acquire(const_cast<char*>(&kToClient));
    __tsan_acquire(const_cast<char*>(&kToServer));
  }
  return event;
}

}  // namespace

// ---- Abseil's locks, which gRPC uses and its headers inline into our code ----------------------------------------

namespace absl {
ABSL_NAMESPACE_BEGIN

void Mutex::Lock() {
  static auto* const original = Original<void(Mutex*)>("_ZN4absl7debian35Mutex4LockEv");
  original(this);
  __tsan_acquire(this);
}

bool Mutex::TryLock() {
  static auto* const original = Original<bool(Mutex*)>("_ZN4absl7debian35Mutex7TryLockEv");
  const bool locked = original(this);
  if (locked) __tsan_acquire(this);
  return locked;
}

void Mutex::Unlock() {
  static auto* const original = Original<void(Mutex*)>("_ZN4absl7debian35Mutex6UnlockEv");
  __tsan_release(this);
  original(this);
}

void CondVar::Wait(Mutex* mutex) {
  static auto* const original = Original<void(CondVar*, Mutex*)>("_ZN4absl7debian37CondVar4WaitEPNS0_5MutexE");
  __tsan_release(mutex);
  original(this, mutex);
  __tsan_acquire(mutex);
}

bool CondVar::WaitWithTimeout(Mutex* mutex, Duration timeout) {
  static auto* const original = Original<bool(CondVar*, Mutex*, Duration)>(
      "_ZN4absl7debian37CondVar15WaitWithTimeoutEPNS0_5MutexENS0_8DurationE");
  __tsan_release(mutex);
  const bool timed_out = original(this, mutex, timeout);
  __tsan_acquire(mutex);
  return timed_out;
}

bool CondVar::WaitWithDeadline(Mutex* mutex, Time deadline) {
  static auto* const original =
      Original<bool(CondVar*, Mutex*, Time)>("_ZN4absl7debian37CondVar16WaitWithDeadlineEPNS0_5MutexENS0_4TimeE");
  __tsan_release(mutex);
  const bool timed_out = original(this, mutex, deadline);
  __tsan_acquire(mutex);
  return timed_out;
}

ABSL_NAMESPACE_END
}  // namespace absl

// ---- Operations of a call: the tag is theirs alone from start to end ---------------------------------------------

extern "C" {

grpc_call_error grpc_call_start_batch(grpc_call* call, const grpc_op* ops, size_t num_ops, void* tag, void* reserved) {
  static auto* const original = Original<decltype(grpc_call_start_batch)>("grpc_call_start_batch");
  __tsan_release(tag);
  BeforeOperation(call);
  return original(call, ops, num_ops, tag, reserved);
}

// Every handler begins with it.
void* grpc_call_arena_alloc(grpc_call* call, size_t size) {
  static auto* const original = Original<decltype(grpc_call_arena_alloc)>("grpc_call_arena_alloc");
  AfterOperation(call);
  return original(call, size);
}

grpc_event grpc_completion_queue_next(grpc_completion_queue* queue, gpr_timespec deadline, void* reserved) {
  static auto* const original = Original<decltype(grpc_completion_queue_next)>("grpc_completion_queue_next");
  return AfterEvent(original(queue, deadline, reserved));
}

grpc_event grpc_completion_queue_pluck(grpc_completion_queue* queue, void* tag, gpr_timespec deadline, void* reserved) {
  static auto* const original = Original<decltype(grpc_completion_queue_pluck)>("grpc_completion_queue_pluck");
  return AfterEvent(original(queue, tag, deadline, reserved));
}

// In place of the inline StaticRun of the tags through which gRPC calls our reactors.
void CurveregRunSuccessTag(grpc_completion_queue_functor* functor, int ok) __asm__(
    "_ZN4grpc8internal22CallbackWithSuccessTag9StaticRunEP29grpc_completion_queue_functori");
void CurveregRunSuccessTag(grpc_completion_queue_functor* functor, int ok) {
  React(*static_cast<CallbackWithSuccessTag*>(functor), ok != 0);
}

void CurveregRunStatusTag(grpc_completion_queue_functor* functor, int ok) __asm__(
    "_ZN4grpc8internal21CallbackWithStatusTag9StaticRunEP29grpc_completion_queue_functori");
void CurveregRunStatusTag(grpc_completion_queue_functor* functor, int ok) {
  React(*static_cast<CallbackWithStatusTag*>(functor), ok != 0);
}

}  // extern "C"

// ---- OnCancel and OnDone of the server's reactors: gRPC counts what they wait for, partly where nobody sees it ----

namespace grpc::internal {
namespace {

// Passes OnCancel on and tells when it is over. gRPC calls it once.
class CancelledReactor final : public ServerReactor {
 public:
  CancelledReactor(ServerReactor* reactor, void* conditions, void* outstanding)
      : reactor_(reactor), conditions_(conditions), outstanding_(outstanding) {}

  void OnCancel() override {
    __tsan_acquire(conditions_);
    reactor_->OnCancel();
    __tsan_release(outstanding_);
    delete this;
  }
  void OnDone() override {}

 private:
  ServerReactor* const reactor_;
  void* const conditions_;
  void* const outstanding_;
};

}  // namespace

void ServerCallbackCall::CallOnCancel(ServerReactor* reactor) {
  static auto* const original = Original<void(ServerCallbackCall*, ServerReactor*)>(
      "_ZN4grpc8internal18ServerCallbackCall12CallOnCancelEPNS0_13ServerReactorE");
  original(this, new CancelledReactor(reactor, &on_cancel_conditions_remaining_, &callbacks_outstanding_));
}

void ServerCallbackCall::ScheduleOnDone(bool inline_ondone) {
  static auto* const original =
      Original<void(ServerCallbackCall*, bool)>("_ZN4grpc8internal18ServerCallbackCall14ScheduleOnDoneEb");
  __tsan_acquire(&callbacks_outstanding_);
  original(this, inline_ondone);
}

}  // namespace grpc::internal
