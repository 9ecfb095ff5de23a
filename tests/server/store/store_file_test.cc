// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/store_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cerrno>
#include <filesystem>
#include <limits>

#include "tests/server/store/store_testing.h"

namespace curvereg::server {
namespace {

using ::testing::HasSubstr;
using testing::IsOk;
using ::testing::Not;
using ::testing::UnorderedElementsAre;

class StoreFileTest : public ::testing::Test {
 protected:
  StoreFile Open() {
    absl::StatusOr<StoreFile> file = StoreFile::OpenToWrite(path_);
    EXPECT_THAT(file, IsOk());
    return *std::move(file);
  }

  testing::TemporaryFolder folder_;
  const std::string path_ = folder_.File("file");
};

TEST_F(StoreFileTest, WritesPiecesOneAfterTheOther) {
  std::string expected = "0123";
  std::vector<std::string> texts;
  for (int i = 0; i < 600; ++i)
    texts.push_back(std::string(static_cast<std::size_t>(i % 3), static_cast<char>('a' + i % 26)));
  std::vector<std::string_view> pieces;  // more than the kernel takes at once as this writes them, some of them empty
  for (const std::string& text : texts) {
    pieces.push_back(text);
    expected += text;
  }
  StoreFile file = Open();
  ASSERT_THAT(file.WriteAt(0, "0123456789"), IsOk());
  ASSERT_THAT(file.Truncate(4), IsOk());
  ASSERT_THAT(file.WriteAt(4, pieces), IsOk());
  ASSERT_THAT(file.SyncData(), IsOk());
  EXPECT_EQ(ReadFile(path_), expected);
  EXPECT_EQ(*file.Size(), expected.size());
}

TEST_F(StoreFileTest, ReadsFewerBytesAtTheEnd) {
  StoreFile file = Open();
  ASSERT_THAT(file.WriteAt(0, "0123456789"), IsOk());
  const auto read = StoreFile::OpenToRead(path_);
  ASSERT_THAT(read, IsOk());
  EXPECT_EQ(*read->ReadAt(2, 3), "234");
  EXPECT_EQ(*read->ReadAt(7, 100), "789");
  EXPECT_EQ(*read->ReadAt(10, 1), "");
  EXPECT_EQ(*read->ReadAt(100, 1), "");
}

TEST_F(StoreFileTest, AllocateMakesItThatLongAndPreallocateDoesNot) {
  StoreFile file = Open();
  file.Preallocate(0, 1 << 20);
  EXPECT_EQ(*file.Size(), 0U);
  ASSERT_THAT(file.Allocate(1 << 20), IsOk());
  EXPECT_EQ(*file.Size(), 1U << 20);
  file.StartWriteback(0, 1 << 20);
  EXPECT_THAT(file.SyncData(), IsOk());
}

TEST_F(StoreFileTest, TheLockIsHeldUntilTheFileIsClosed) {
  StoreFile second = Open();
  {
    StoreFile first = Open();
    EXPECT_TRUE(*first.TryLock());
    EXPECT_FALSE(*second.TryLock());
    StoreFile moved = std::move(first);
    EXPECT_FALSE(*second.TryLock());
  }
  EXPECT_TRUE(*second.TryLock());
}

TEST_F(StoreFileTest, IsForItsOwnerAlone) {
  const StoreFile file = Open();
  struct stat info {};
  ASSERT_EQ(stat(path_.c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0600U);
  ASSERT_THAT(MakeFolder(folder_.File("folder")), IsOk());
  ASSERT_EQ(stat(folder_.File("folder").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777U, 0700U);
  EXPECT_THAT(MakeFolder(folder_.File("folder")), IsOk()) << "it is there";
}

TEST_F(StoreFileTest, ErrorsNameTheFileWithoutItsFolder) {
  const absl::Status missing = StoreFile::OpenToRead(path_).status();
  EXPECT_THAT(missing, HasReason(v1::ERROR_REASON_STORAGE_FAULT));
  EXPECT_THAT(std::string(missing.message()), HasSubstr("file: cannot open: No such file or directory"));
  EXPECT_THAT(std::string(missing.message()), Not(HasSubstr(folder_.path())));
  EXPECT_THAT(FileError("a/b", "cannot write", ENOSPC), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_THAT(FileError("a/b", "cannot write", EDQUOT), HasReason(v1::ERROR_REASON_STORAGE_FULL));
  EXPECT_THAT(FileError("a/b", "cannot write", EIO), HasReason(v1::ERROR_REASON_STORAGE_FAULT));
}

TEST_F(StoreFileTest, FollowsNoSymbolicLink) {
  WriteFile(folder_.File("target"), "bytes");
  std::filesystem::create_symlink(folder_.File("target"), path_);
  EXPECT_THAT(StoreFile::OpenToRead(path_), HasReason(v1::ERROR_REASON_STORAGE_FAULT));
  EXPECT_THAT(StoreFile::OpenToWrite(path_), HasReason(v1::ERROR_REASON_STORAGE_FAULT));
  EXPECT_FALSE(LookAt(path_).has_value()) << "nor is it a regular file";
}

TEST_F(StoreFileTest, AFileIsKnownByMoreThanItsName) {
  WriteFile(path_, "12345");
  const auto before = LookAt(path_);
  ASSERT_TRUE(before.has_value());
  EXPECT_EQ(before->bytes, 5U);
  EXPECT_EQ(before->num_names, 1U);
  std::filesystem::create_hard_link(path_, folder_.File("other"));
  const auto other = LookAt(folder_.File("other"));
  ASSERT_TRUE(other.has_value());
  EXPECT_EQ(other->num_names, 2U);
  EXPECT_TRUE(other->identity == before->identity);
  EXPECT_FALSE(LookAt(folder_.path()).has_value()) << "a folder";
  EXPECT_THAT(*ListFolder(folder_.path()), UnorderedElementsAre("file", "other"));
  EXPECT_THAT(SyncFolder(folder_.path()), IsOk());
}

TEST_F(StoreFileTest, RemovingWhatIsNotThereIsNoError) {
  WriteFile(path_, "bytes");
  EXPECT_THAT(RemoveFile(path_), IsOk());
  EXPECT_FALSE(LookAt(path_).has_value());
  EXPECT_THAT(RemoveFile(path_), IsOk());
  EXPECT_THAT(RemoveFile(folder_.path()), HasReason(v1::ERROR_REASON_STORAGE_FAULT)) << "a folder";
  EXPECT_THAT(ListFolder(path_), HasReason(v1::ERROR_REASON_STORAGE_FAULT));
}

TEST_F(StoreFileTest, FreeBytesOfNoFolderAreUnlimited) {
  EXPECT_LT(FreeBytes(folder_.path()), std::numeric_limits<uint64_t>::max());
  EXPECT_EQ(FreeBytes(folder_.File("none")), std::numeric_limits<uint64_t>::max());
}

}  // namespace
}  // namespace curvereg::server
