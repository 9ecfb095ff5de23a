// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>

#include "tests/testing/corrupt_files.h"
#include "tests/testing/ordinary_user.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::ReadBytes;
using testing::TemporaryFolder;
using testing::WriteBytes;

std::size_t NumFiles(const std::string& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFileTest, AppearsWholeAtCommit) {
  const TemporaryFolder folder;
  const std::string path = folder.File("out.bin");
  const std::string large(5'000'001, 'x');  // more than the buffer, and no multiple of it
  absl::StatusOr<AtomicFile> file = AtomicFile::Create(path);
  ASSERT_TRUE(file.ok()) << file.status();
  file->Append("head");
  file->Append(large);
  EXPECT_FALSE(fs::exists(path));
  EXPECT_TRUE(file->Commit().ok());
  EXPECT_EQ(ReadBytes(path), "head" + large);
  EXPECT_EQ(NumFiles(folder.path()), 1U);
}

TEST(AtomicFileTest, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  const std::string path = folder.File("out.bin");
  WriteBytes(path, "before");
  {
    absl::StatusOr<AtomicFile> file = AtomicFile::Create(path);
    ASSERT_TRUE(file.ok()) << file.status();
    file->Append("after");
  }
  EXPECT_EQ(ReadBytes(path), "before");
  EXPECT_EQ(NumFiles(folder.path()), 1U);
}

TEST(AtomicFileTest, ReplacesAndKeepsModeAndLinks) {
  const TemporaryFolder folder;
  const std::string path = folder.File("out.bin");
  const std::string link = folder.File("link.bin");
  WriteBytes(path, "a longer text before");
  ASSERT_EQ(chmod(path.c_str(), 0640), 0);
  fs::create_symlink("out.bin", link);
  EXPECT_TRUE(WriteFileAtomically(link, "after").ok());
  EXPECT_EQ(ReadBytes(path), "after");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(fs::status(path).permissions(), fs::perms(0640));
}

TEST(AtomicFileTest, NamesFileAndCause) {
  const TemporaryFolder folder;
  const absl::Status missing = WriteFileAtomically(folder.File("no/out.bin"), "x");
  EXPECT_TRUE(absl::IsNotFound(missing));
  EXPECT_THAT(std::string(missing.message()), HasSubstr(folder.File("no/out.bin") + ": cannot write: No such file"));
  const absl::Status is_folder = WriteFileAtomically(folder.path(), "x");
  EXPECT_TRUE(absl::IsInvalidArgument(is_folder));
  EXPECT_THAT(std::string(is_folder.message()), HasSubstr("is a folder"));
}

TEST(AtomicFileTest, WritesToDevicesDirectly) {
  EXPECT_TRUE(WriteFileAtomically("/dev/null", "x").ok());
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full on this machine";
  const absl::Status full = WriteFileAtomically("/dev/full", "x");
  EXPECT_TRUE(absl::IsResourceExhausted(full));
  EXPECT_THAT(std::string(full.message()), HasSubstr("/dev/full: cannot write: No space left on device"));
}

TEST(AtomicFileTest, LeavesNothingBehindAtTheFileSizeLimit) {
  const TemporaryFolder folder;
  const std::string path = folder.File("out.bin");
  WriteBytes(path, "before");
  struct rlimit before {};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  struct rlimit small = before;
  small.rlim_cur = 100'000;
  auto* const handler = signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const absl::Status status = WriteFileAtomically(path, std::string(3'000'000, 'x'));
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  signal(SIGXFSZ, handler);
  EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(path));
  EXPECT_EQ(ReadBytes(path), "before");
  EXPECT_EQ(NumFiles(folder.path()), 1U);
}

TEST(AtomicFileTest, LeavesNothingBehindOnAFullDisk) {
  const TemporaryFolder folder;
  const std::string disk = folder.File("disk");
  fs::create_directory(disk);
  if (mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0) {
    GTEST_SKIP() << "cannot mount a small tmpfs: " << std::strerror(errno);
  }
  const std::string path = disk + "/out.bin";
  WriteBytes(path, "before");
  const absl::Status status = WriteFileAtomically(path, std::string(3'000'000, 'x'));
  const std::string content = ReadBytes(path);
  const std::size_t num_files = NumFiles(disk);
  ASSERT_EQ(umount(disk.c_str()), 0);
  EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
  EXPECT_EQ(std::string(status.message()), path + ": cannot write: No space left on device");
  EXPECT_EQ(content, "before");
  EXPECT_EQ(num_files, 1U);
}

TEST(AtomicFileTest, DoesNotReplaceWhatIsProtected) {
  const TemporaryFolder folder;
  const std::string path = folder.File("out.bin");
  WriteBytes(path, "before");
  ASSERT_EQ(chmod(path.c_str(), 0444), 0);
  // Protected by its own mode in a folder that all may write to, then the other way round.
  ASSERT_EQ(chmod(folder.path().c_str(), 0777), 0);
  absl::Status protected_file;
  {
    const testing::OrdinaryUser user;
    if (!user.is_ordinary()) GTEST_SKIP() << "cannot give up the rights of root";
    protected_file = WriteFileAtomically(path, "after");
  }
  ASSERT_EQ(chmod(folder.path().c_str(), 0555), 0);
  absl::Status protected_folder;
  {
    const testing::OrdinaryUser user;
    protected_folder = WriteFileAtomically(folder.File("new.bin"), "after");
  }
  ASSERT_EQ(chmod(folder.path().c_str(), 0777), 0);
  EXPECT_TRUE(absl::IsPermissionDenied(protected_file)) << protected_file;
  EXPECT_EQ(std::string(protected_file.message()), path + ": cannot write: Permission denied");
  EXPECT_TRUE(absl::IsPermissionDenied(protected_folder)) << protected_folder;
  EXPECT_EQ(ReadBytes(path), "before");
  EXPECT_EQ(NumFiles(folder.path()), 1U);
}

}  // namespace
}  // namespace curvereg
