// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Killed at any moment, while several threads upload, a store keeps every byte and every scan that it acknowledged.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <map>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "server/store/scan_store.h"
#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::IsEmpty;
using testing::IsOk;

constexpr int kNumKills = 50;
constexpr int kNumThreads = 4;
constexpr char kChildFlag[] = "--store-child";

// What an upload of this number sends. Every third has the payload of the one before, so that known content comes
// again, mostly at the same time from two threads.
std::string PayloadOf(uint64_t number) {
  const uint64_t content = number % 3 == 2 ? number - 1 : number;
  return RandomBytes(1'000 + content * 7'919 % 300'000, content);
}

UploadDescription DescriptionOf(uint64_t number) { return Describe("u" + std::to_string(number), PayloadOf(number)); }

// One acknowledgement; smaller than PIPE_BUF, so it arrives whole or not at all.
struct Acknowledgement {
  uint64_t number = 0;
  uint64_t offset = 0;
  uint64_t is_scan = 0;
  char scan_id[32] = {};
};

void Report(const Acknowledgement& acknowledgement) {
  // A pipe that is gone means that the parent is: nothing to report to.
  if (write(STDOUT_FILENO, &acknowledgement, sizeof(acknowledgement)) != sizeof(acknowledgement)) _exit(3);
}

void Check(const absl::Status& status, const char* what) {
  if (status.ok()) return;
  const std::string text = std::string(what) + ": " + status.ToString() + "\n";
  if (write(STDERR_FILENO, text.data(), text.size()) < 0) _exit(3);
  _exit(2);
}

// Goes on with an upload from wherever it is, and reports each step when the store has answered.
void UploadOne(ScanStore& store, uint64_t number) {
  const std::string payload = PayloadOf(number);
  absl::StatusOr<std::unique_ptr<UploadWriter>> writer = store.BeginUpload(DescriptionOf(number));
  Check(writer.status(), "begin");
  Report({number, (*writer)->committed_offset()});
  while ((*writer)->committed_offset() < payload.size()) {
    const uint64_t offset = (*writer)->committed_offset();
    Check((*writer)->Append(offset, std::string_view(payload).substr(offset, 16'384)), "append");
    Report({number, (*writer)->committed_offset()});
  }
  const absl::StatusOr<UploadWriter::Committed> committed = (*writer)->Commit(number, "content");
  Check(committed.status(), "commit");
  Acknowledgement acknowledgement{number, payload.size(), 1};
  std::memcpy(acknowledgement.scan_id, committed->scan.id.data(), sizeof(acknowledgement.scan_id));
  Report(acknowledgement);
}

// The child: each thread takes its share of the uploads that were cut short ("3 5 "), then numbers of its own, from
// `first` on, until it is killed.
int RunChild(const std::string& folder, uint64_t first, const std::string& cut_short) {
  absl::StatusOr<std::unique_ptr<ScanStore>> store = ScanStore::Open(folder, {});
  Check(store.status(), "open");
  std::istringstream text(cut_short);
  const std::vector<uint64_t> old_numbers{std::istream_iterator<uint64_t>(text), {}};
  std::vector<std::jthread> threads;
  for (uint64_t t = 0; t < kNumThreads; ++t) {
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < old_numbers.size(); i += kNumThreads) UploadOne(**store, old_numbers[i]);
      for (uint64_t number = first + t;; number += kNumThreads) UploadOne(**store, number);
    });
  }
  return 0;  // joins first, so never
}

class StoreCrashTest : public ::testing::Test {
 protected:
  // Lets a child work for some time, kills it and takes down what it had reported.
  void RunAndKill(std::chrono::microseconds life) {
    int ends[2];
    ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
    std::string first = std::to_string(next_number_);
    std::string cut_short;
    for (const auto& [number, offset] : uploads_) cut_short += std::to_string(number) + " ";
    char program[] = "/proc/self/exe";
    std::string flag = kChildFlag;
    char* arguments[] = {program, flag.data(), folder_path_.data(), first.data(), cut_short.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    pid_t child = -1;
    ASSERT_EQ(posix_spawn(&child, program, &actions, nullptr, arguments, environ), 0);
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    std::jthread reader([&] {
      Acknowledgement acknowledgement;
      while (read(ends[0], &acknowledgement, sizeof(acknowledgement)) == sizeof(acknowledgement)) Note(acknowledgement);
    });
    std::this_thread::sleep_for(life);
    EXPECT_EQ(kill(child, SIGKILL), 0);
    int status = 0;
    EXPECT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFSIGNALED(status)) << "the child ended by itself: " << WEXITSTATUS(status);
    reader.join();
    close(ends[0]);
  }

  void Note(const Acknowledgement& acknowledgement) {
    ++num_acknowledged_;
    next_number_ = std::max(next_number_, acknowledgement.number + 1);
    if (acknowledgement.is_scan != 0) {
      scans_[std::string(acknowledgement.scan_id, sizeof(acknowledgement.scan_id))] = acknowledgement.number;
      uploads_.erase(acknowledgement.number);
    } else {
      uploads_[acknowledgement.number] = acknowledgement.offset;
    }
  }

  // All that was acknowledged, by any child so far, is in the store. Scans may be there whose acknowledgement was not
  // sent any more; they have to be whole, too.
  void CheckStore() {
    const std::unique_ptr<ScanStore> store = OpenStore(folder_path_);
    ASSERT_NE(store, nullptr);
    EXPECT_THAT(store->DamagedScans(), IsEmpty());
    EXPECT_EQ(store->Recovery().num_orphaned_files, 0U) << "what a kill leaves is no loss";
    EXPECT_THAT(store->Recovery().emptied_uploads, IsEmpty());
    std::set<std::string> listed;
    std::string token;
    do {
      const absl::StatusOr<ScanPage> page = store->ListScans(100, token);
      ASSERT_THAT(page, IsOk());
      for (const StoredScan& scan : page->scans) {
        EXPECT_TRUE(listed.insert(scan.id).second) << scan.id << " is listed twice";
        CheckScan(*store, scan);
      }
      token = page->next_page_token;
    } while (!token.empty());
    for (const auto& [id, number] : scans_) EXPECT_TRUE(listed.contains(id)) << "scan of upload " << number;
    for (const auto& [number, offset] : uploads_) CheckUpload(*store, number, offset);
    EXPECT_EQ(store->Statistics().num_scans, listed.size());
    EXPECT_EQ(FilesBelow(folder_path_ + "/payloads").size(), listed.size());
    EXPECT_EQ(FilesBelow(folder_path_ + "/uploads").size(), store->Statistics().num_uploads);
  }

  void CheckScan(ScanStore& store, const StoredScan& scan) {
    // Scans are never changed: what was whole once, and has its size, was looked at enough.
    if (!seen_whole_.insert(scan.id).second) return;
    const absl::StatusOr<std::string> payload = store.ReadWholePayload(scan.id);
    ASSERT_THAT(payload, IsOk());
    EXPECT_EQ(*payload, PayloadOf(scan.finite_point_count)) << "the bytes of upload " << scan.finite_point_count;
  }

  // At least what was acknowledged of it is there and right; it is finished here. Unless it had become a scan.
  void CheckUpload(ScanStore& store, uint64_t number, uint64_t acknowledged_offset) {
    const std::string payload = PayloadOf(number);
    const absl::StatusOr<UploadState> state = store.GetUpload("u" + std::to_string(number));
    if (!state.ok()) {
      EXPECT_THAT(state, HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
      EXPECT_TRUE(store.FindScan(DescriptionOf(number)).value().has_value()) << "upload " << number << " is lost";
      return;
    }
    EXPECT_GE(state->committed_offset, acknowledged_offset) << "upload " << number;
    const absl::StatusOr<std::unique_ptr<UploadWriter>> writer = store.BeginUpload(DescriptionOf(number));
    ASSERT_THAT(writer, IsOk());
    const uint64_t offset = (*writer)->committed_offset();
    EXPECT_EQ(offset, state->committed_offset);
    EXPECT_EQ((*writer)->ReadAll().value(), payload.substr(0, offset)) << "upload " << number;
  }

  // What the last kill cut short can be brought to its end.
  void FinishUploads() {
    const std::unique_ptr<ScanStore> store = OpenStore(folder_path_);
    ASSERT_NE(store, nullptr);
    for (const auto& [number, offset] : uploads_) {
      const absl::StatusOr<UploadWriter::Committed> committed = Store(*store, DescriptionOf(number), PayloadOf(number));
      ASSERT_THAT(committed, IsOk());
      EXPECT_EQ(store->ReadWholePayload(committed->scan.id).value(), PayloadOf(number));
      EXPECT_THAT(store->GetUpload("u" + std::to_string(number)), HasReason(v1::ERROR_REASON_UPLOAD_NOT_FOUND));
    }
    // What is left was begun, and killed before that was acknowledged.
  }

  testing::TemporaryFolder folder_;
  std::string folder_path_ = folder_.File("store");
  uint64_t next_number_ = 0;
  std::size_t num_acknowledged_ = 0;
  std::size_t num_cut_short_ = 0;
  std::map<std::string, uint64_t> scans_;
  std::map<uint64_t, uint64_t> uploads_;  // number -> acknowledged offset
  std::set<std::string> seen_whole_;
};

TEST_F(StoreCrashTest, WhatWasAcknowledgedSurvivesFiftyKills) {
  std::mt19937_64 generator(20'260'711);
  // From before the store is open to dozens of scans later.
  std::uniform_int_distribution<int> life_us(5'000, 350'000);
  for (int i = 0; i < kNumKills && !HasFailure(); ++i) {
    RunAndKill(std::chrono::microseconds(life_us(generator)));
    num_cut_short_ += uploads_.size();
    CheckStore();
  }
  FinishUploads();
  std::printf("%d kills, %zu acknowledgements, %zu scans, %zu uploads cut short\n", kNumKills, num_acknowledged_,
              scans_.size(), num_cut_short_);
  // Otherwise nothing was put to the test.
  EXPECT_GT(scans_.size(), 20U);
  EXPECT_GT(num_cut_short_, 20U);
}

}  // namespace

}  // namespace curvereg::server

// The children are this program, too.
int main(int argc, char** argv) {
  if (argc == 5 && std::string_view(argv[1]) == curvereg::server::kChildFlag) {
    return curvereg::server::RunChild(argv[2], std::stoull(argv[3]), argv[4]);
  }
  ::testing::InitGoogleMock(&argc, argv);
  return RUN_ALL_TESTS();
}
