// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "files/cloud_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "files/file_bytes.h"
#include "tests/testing/corrupt_files.h"
#include "tests/testing/ordinary_user.h"
#include "tests/testing/test_data.h"

namespace curvereg {
namespace {

using ::testing::HasSubstr;
using testing::ReadBytes;
using testing::TemporaryFolder;
using testing::WriteBytes;

// Finite numbers of all sizes, and some that are not finite.
Scan OddScan(std::size_t num_points) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> mantissa(-1.0F, 1.0F);
  Scan scan;
  for (std::size_t i = 0; i < num_points; ++i) {
    const float size = std::pow(10.0F, 4.0F * mantissa(random));
    scan.points.emplace_back(size * mantissa(random), mantissa(random), -size);
  }
  scan.points.emplace_back(-0.0F, 1e-7F, 1.0F / 3.0F);
  scan.points.emplace_back(std::numeric_limits<float>::quiet_NaN(), 1.0F, 2.0F);
  scan.points.emplace_back(std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(), 0.0F);
  return scan;
}

bool AreSameBits(const Scan& a, const Scan& b) {
  return a.points.size() == b.points.size() &&
         (a.points.empty() || std::memcmp(a.points.data(), b.points.data(), a.points.size() * 12) == 0);
}

std::string Message(const absl::Status& status) { return std::string(status.message()); }

TEST(CloudFileTest, RoundTripsBitForBit) {
  const TemporaryFolder folder;
  const Scan scan = OddScan(1000);
  for (const char* name : {"a.pcd", "a.ply", "a.bin", "a.xyz", "a.txt", "a.csv", "A.PCD"}) {
    for (const CloudEncoding encoding : {CloudEncoding::kBinary, CloudEncoding::kAscii}) {
      const std::string path = folder.File(name);
      ASSERT_TRUE(WriteCloudFile(path, scan, encoding).ok());
      const absl::StatusOr<Scan> back = ReadCloudFile(path);
      ASSERT_TRUE(back.ok()) << back.status();
      EXPECT_TRUE(AreSameBits(scan, *back)) << name;
    }
  }
}

TEST(CloudFileTest, RoundTripsNoPointAndOnePoint) {
  const TemporaryFolder folder;
  Scan one;
  one.points.emplace_back(1.0F, 2.0F, 3.0F);
  for (const char* name : {"a.pcd", "a.ply", "a.bin", "a.xyz", "a.csv"}) {
    for (const CloudEncoding encoding : {CloudEncoding::kBinary, CloudEncoding::kAscii}) {
      ASSERT_TRUE(WriteCloudFile(folder.File(name), one, encoding).ok());
      EXPECT_TRUE(AreSameBits(one, ReadCloudFile(folder.File(name)).value())) << name;
      ASSERT_TRUE(WriteCloudFile(folder.File(name), Scan{}, encoding).ok());
      const absl::StatusOr<Scan> none = ReadCloudFile(folder.File(name));
      if (std::string(name) == "a.bin") {
        EXPECT_TRUE(absl::IsInvalidArgument(none.status())) << "an empty KITTI file is an empty file";
      } else {
        EXPECT_TRUE(none.ok() && none->points.empty()) << name << none.status();
      }
    }
  }
}

TEST(CloudFileTest, WritesTheSameBytesAgain) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteCloudFile(folder.File("a.ply"), OddScan(10)).ok());
  ASSERT_TRUE(WriteCloudFile(folder.File("b.ply"), OddScan(10)).ok());
  EXPECT_EQ(ReadBytes(folder.File("a.ply")), ReadBytes(folder.File("b.ply")));
}

TEST(CloudFileTest, ReadsByContentWhateverTheEnding) {
  const TemporaryFolder folder;
  const Scan scan = OddScan(10);
  for (const char* name : {"a.pcd", "a.ply", "a.xyz", "a.csv"}) {
    ASSERT_TRUE(WriteCloudFile(folder.File(name), scan).ok());
    for (const char* other : {"b.pcd", "b.ply", "b.bin", "b.xyz", "b.las", "b.dat", "b"}) {
      std::filesystem::copy_file(folder.File(name), folder.File(other),
                                 std::filesystem::copy_options::overwrite_existing);
      const absl::StatusOr<Scan> back = ReadCloudFile(folder.File(other));
      ASSERT_TRUE(back.ok()) << name << " as " << other << ": " << back.status();
      EXPECT_TRUE(AreSameBits(scan, *back));
    }
  }
}

TEST(CloudFileTest, RefusesContentItDoesNotKnow) {
  const TemporaryFolder folder;
  ASSERT_TRUE(WriteCloudFile(folder.File("kitti.bin"), OddScan(10)).ok());
  const std::string kitti = ReadBytes(folder.File("kitti.bin"));
  const std::string png = std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16) + std::string(64, '\x11');
  for (const std::string& content : {kitti, png, std::string("some prose, and no numbers\nmore of it\n"),
                                     std::string("{\"json\": 1}"), std::string("# .PC"), std::string("pl")}) {
    for (const char* name : {"a.pcd", "a.ply", "a.las", "a.dat", "a"}) {
      WriteBytes(folder.File(name), content);
      const absl::Status status = ReadCloudFile(folder.File(name)).status();
      EXPECT_TRUE(absl::IsInvalidArgument(status)) << name << status;
      EXPECT_THAT(Message(status), HasSubstr(folder.File(name) + ": is not a "));
    }
  }
}

TEST(CloudFileTest, NamesFileAndCause) {
  const TemporaryFolder folder;
  const absl::Status missing = ReadCloudFile(folder.File("none.pcd")).status();
  EXPECT_TRUE(absl::IsNotFound(missing));
  EXPECT_EQ(Message(missing), folder.File("none.pcd") + ": cannot open: No such file or directory");
  const absl::Status is_folder = ReadCloudFile(folder.path()).status();
  EXPECT_TRUE(absl::IsInvalidArgument(is_folder));
  EXPECT_EQ(Message(is_folder), folder.path() + ": is a folder, not a file");
  for (const char* name : {"a.pcd", "a.ply", "a.bin", "a.xyz", "a.las"}) {
    WriteBytes(folder.File(name), "");
    const absl::Status empty = ReadCloudFile(folder.File(name)).status();
    EXPECT_TRUE(absl::IsInvalidArgument(empty));
    EXPECT_EQ(Message(empty), folder.File(name) + ": is empty");
  }
  WriteBytes(folder.File("cut.pcd"), "# .PCD v0.7\nVERSION 0.7\n");
  const absl::Status cut = ReadCloudFile(folder.File("cut.pcd")).status();
  EXPECT_TRUE(absl::IsDataLoss(cut));
  EXPECT_THAT(Message(cut), HasSubstr(folder.File("cut.pcd") + ": PCD header ends before"));
}

TEST(CloudFileTest, RefusesWhatMayNotBeRead) {
  const TemporaryFolder folder;
  const std::string path = folder.File("a.pcd");
  ASSERT_TRUE(WriteCloudFile(path, OddScan(10)).ok());
  ASSERT_EQ(chmod(path.c_str(), 0), 0);
  ASSERT_EQ(chmod(folder.path().c_str(), 0755), 0);
  const testing::OrdinaryUser user;
  if (!user.is_ordinary()) GTEST_SKIP() << "cannot give up the rights of root";
  const absl::Status status = ReadCloudFile(path).status();
  EXPECT_TRUE(absl::IsPermissionDenied(status));
  EXPECT_EQ(Message(status), path + ": cannot open: Permission denied");
}

TEST(CloudFileTest, RefusesOtherEndingsToWrite) {
  const TemporaryFolder folder;
  for (const char* name : {"a.las", "a.dat", "a", ".pcd"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(WriteCloudFile(folder.File(name), OddScan(10)))) << name;
    EXPECT_FALSE(std::filesystem::exists(folder.File(name)));
  }
}

TEST(CloudFileTest, LeavesNothingBehindOnAFullDisk) {
  const TemporaryFolder folder;
  if (mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
    GTEST_SKIP() << "cannot mount a small tmpfs: " << std::strerror(errno);
  }
  std::vector<absl::Status> statuses;
  for (const char* name : {"a.pcd", "a.ply", "a.bin", "a.xyz"}) {
    statuses.push_back(WriteCloudFile(folder.File(name), OddScan(100'000)));
  }
  const bool is_empty = std::filesystem::is_empty(folder.path());
  ASSERT_EQ(umount(folder.path().c_str()), 0);
  EXPECT_TRUE(is_empty);
  for (const absl::Status& status : statuses) {
    EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
    EXPECT_THAT(Message(status), HasSubstr("No space left on device"));
  }
}

TEST(CloudFileTest, RefusesMoreThanTheLimit) {
  const TemporaryFolder folder;
  CloudReadOptions options;
  options.max_points = 12;
  for (const char* name : {"a.pcd", "a.ply", "a.bin", "a.xyz"}) {
    ASSERT_TRUE(WriteCloudFile(folder.File(name), OddScan(10)).ok());
    const absl::Status status = ReadCloudFile(folder.File(name), options).status();
    EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
    EXPECT_THAT(Message(status), HasSubstr(folder.File(name)));
  }
  // A file without end is cut off by its size, before memory is.
  options.max_points = 1000;
  EXPECT_TRUE(absl::IsResourceExhausted(ReadCloudFile("/dev/zero", options).status()));
}

TEST(CloudFileTest, ReadsFromAPipe) {
  const TemporaryFolder folder;
  const Scan scan = OddScan(1'000'000);
  ASSERT_TRUE(WriteCloudFile(folder.File("a.pcd"), scan).ok());
  ASSERT_EQ(mkfifo(folder.File("pipe").c_str(), 0600), 0);
  std::thread writer([&] { WriteBytes(folder.File("pipe"), ReadBytes(folder.File("a.pcd"))); });
  const absl::StatusOr<Scan> back = ReadCloudFile(folder.File("pipe"));
  writer.join();
  ASSERT_TRUE(back.ok()) << back.status();
  EXPECT_TRUE(AreSameBits(scan, *back));
}

TEST(CloudFileTest, ReportsProgressFromStartToEnd) {
  const TemporaryFolder folder;
  const Scan scan = OddScan(600'000);
  for (const char* name : {"a.pcd", "a.ply", "a.bin", "a.xyz"}) {
    ASSERT_TRUE(WriteCloudFile(folder.File(name), scan, CloudEncoding::kAscii).ok());
    std::vector<double> shares;
    CloudReadOptions options;
    options.progress = [&](double share) { shares.push_back(share); };
    ASSERT_TRUE(ReadCloudFile(folder.File(name), options).ok());
    ASSERT_GE(shares.size(), 3U) << name;
    EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end())) << name;
    EXPECT_GE(shares.front(), 0.0);
    EXPECT_EQ(shares.back(), 1.0);
  }
}

TEST(CloudFileTest, ReadsTheRealScans) {
  const auto folder = testing::RealDataPath("");
  if (!folder.has_value()) GTEST_SKIP() << "the real scans are not on this machine";
  int num_scans = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(*folder)) {
    if (entry.path().extension() != ".pcd") continue;
    const absl::StatusOr<Scan> scan = ReadCloudFile(entry.path().string());
    ASSERT_TRUE(scan.ok()) << scan.status();
    EXPECT_TRUE(ValidateScan(*scan).ok()) << entry.path();
    ++num_scans;
  }
  EXPECT_GE(num_scans, 30);
}

TEST(HasCloudEndingTest, KnowsEndingsInAnyCase) {
  for (const char* name : {"a.pcd", "b/a.PLY", "a.b.bin", "a.xyz", "a.Csv", "a.txt", "a.las"}) {
    EXPECT_TRUE(HasCloudEnding(name)) << name;
  }
  for (const char* name : {"a", "pcd", ".pcd", "a.pcd/b", "a.laz", "a.pcdx", ""})
    EXPECT_FALSE(HasCloudEnding(name)) << name;
}

TEST(FileBytesTest, ReadsNumbersOfBothOrders) {
  EXPECT_EQ(LoadLittleEndian<uint32_t>("\x01\x02\x03\x04"), 0x04030201U);
  EXPECT_EQ(LoadBigEndian<uint32_t>("\x01\x02\x03\x04"), 0x01020304U);
  EXPECT_EQ(LoadBigEndian<double>("\x3f\xf8\0\0\0\0\0\0"), 1.5);
}

TEST(FileBytesTest, RefusesMoreThanTheLimit) {
  const TemporaryFolder folder;
  WriteBytes(folder.File("a"), "0123456789");
  EXPECT_EQ(ReadFileBytes(folder.File("a"), 10).value().view(), "0123456789");
  EXPECT_TRUE(absl::IsResourceExhausted(ReadFileBytes(folder.File("a"), 9).status()));
}

}  // namespace
}  // namespace curvereg
