// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/digest.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <xxhash.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "tests/testing/matchers.h"
#include "tests/testing/vector_state.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

using ::curvereg::testing::HasCode;
using ::curvereg::testing::IsOk;

constexpr auto kXxh3 = v1::DIGEST_ALGORITHM_XXH3_128;
constexpr auto kSha256 = v1::DIGEST_ALGORITHM_SHA256;

std::string SomeBytes(size_t size) {
  std::string bytes(size, '\0');
  for (size_t i = 0; i < size; ++i) bytes[i] = static_cast<char>((i * 2654435761U) >> 13);
  return bytes;
}

// RFC 3720, B.4.
TEST(Crc32cTest, GivesTheValuesOfTheStandard) {
  EXPECT_EQ(Crc32c("123456789"), 0xE3069283U);
  EXPECT_EQ(Crc32c(""), 0U);
  EXPECT_EQ(Crc32c(std::string(32, '\0')), 0x8A9136AAU);
  EXPECT_EQ(Crc32c(std::string(32, '\xFF')), 0x62A8AB43U);
  std::string rising(32, '\0');
  for (size_t i = 0; i < rising.size(); ++i) rising[i] = static_cast<char>(i);
  EXPECT_EQ(Crc32c(rising), 0x46DD794EU);
}

TEST(Crc32cTest, AgreesWithTheDefinitionAtEveryLengthAndAlignment) {
  const std::string bytes = SomeBytes(700);
  for (size_t begin = 0; begin < 9; ++begin) {
    uint32_t crc = 0xFFFFFFFF;  // bit by bit, from the polynomial
    for (size_t end = begin; end < bytes.size(); ++end) {
      ASSERT_EQ(Crc32c(std::string_view(bytes).substr(begin, end - begin)), ~crc) << begin << " to " << end;
      crc ^= static_cast<unsigned char>(bytes[end]);
      for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) != 0 ? 0x82F63B78U : 0U);
    }
  }
}

// FIPS 180-4's examples.
TEST(DigestTest, GivesSha256OfTheStandard) {
  EXPECT_EQ(HexText(DigestOf(kSha256, "abc").value()),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(HexText(DigestOf(kSha256, "").value()), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

// The empty input's value is the one that the algorithm's description gives.
TEST(DigestTest, GivesXxh3InCanonicalOrder) {
  EXPECT_EQ(HexText(DigestOf(kXxh3, "").value()), "99aa06d3014798d86001c324468d497f");
  const XXH128_hash_t hash = XXH3_128bits("abc", 3);
  std::string high_first;
  for (const uint64_t half : {hash.high64, hash.low64}) {
    for (int shift = 56; shift >= 0; shift -= 8) high_first.push_back(static_cast<char>(half >> shift));
  }
  EXPECT_EQ(DigestOf(kXxh3, "abc").value(), high_first);
}

TEST(DigesterTest, PiecesGiveTheDigestOfTheWhole) {
  const std::string bytes = SomeBytes(100'000);
  for (const auto algorithm : {kXxh3, kSha256}) {
    absl::StatusOr<Digester> digester = Digester::Create(algorithm);
    ASSERT_THAT(digester, IsOk());
    EXPECT_TRUE(SameDigest(digester->Digest(), DigestOf(algorithm, "")));
    size_t begin = 0;
    for (size_t size = 1; begin < bytes.size(); size = size * 3 + 1) {
      digester->Update(std::string_view(bytes).substr(begin, size));
      begin = std::min(begin + size, bytes.size());
      EXPECT_TRUE(SameDigest(digester->Digest(), DigestOf(algorithm, std::string_view(bytes).substr(0, begin))));
    }
    Digester moved = *std::move(digester);
    moved.Update("");
    EXPECT_TRUE(SameDigest(moved.Digest(), DigestOf(algorithm, bytes)));
    EXPECT_THAT(ValidateDigest(moved.Digest()), IsOk());
  }
}

TEST(DigesterTest, RefusesAlgorithmsThatItDoesNotKnow) {
  for (const auto algorithm : {v1::DIGEST_ALGORITHM_UNSPECIFIED, static_cast<v1::DigestAlgorithm>(77)}) {
    const absl::StatusOr<Digester> digester = Digester::Create(algorithm);
    EXPECT_EQ(ReasonOf(digester.status()), v1::ERROR_REASON_INVALID_FIELD);
    EXPECT_EQ(BadRequestOf(digester.status())->field_violations(0).field(), "algorithm");
  }
}

TEST(DigestTest, TellsDigestsApart) {
  const v1::Digest digest = DigestOf(kXxh3, "abc");
  EXPECT_TRUE(SameDigest(digest, DigestOf(kXxh3, "abc")));
  EXPECT_FALSE(SameDigest(digest, DigestOf(kXxh3, "abd")));
  EXPECT_FALSE(SameDigest(digest, DigestOf(kSha256, "abc")));
  EXPECT_FALSE(SameDigest(v1::Digest(), v1::Digest())) << "no digest equals nothing";
}

TEST(DigestTest, ValidationNamesTheField) {
  v1::Digest digest = DigestOf(kSha256, "abc");
  digest.mutable_value()->pop_back();
  EXPECT_EQ(BadRequestOf(ValidateDigest(digest))->field_violations(0).field(), "value");
  digest.set_algorithm(v1::DIGEST_ALGORITHM_UNSPECIFIED);
  EXPECT_THAT(ValidateDigest(digest), HasCode(absl::StatusCode::kInvalidArgument));
  EXPECT_EQ(BadRequestOf(ValidateDigest(digest))->field_violations(0).field(), "algorithm");
}

TEST(HexTextTest, WritesLowerCase) {
  EXPECT_EQ(HexText(""), "");
  EXPECT_EQ(HexText(std::string_view("\x00\xAF\x10", 3)), "00af10");
}

TEST(Crc32cTest, GoesOnFromAnEarlierOne) {
  const std::string bytes = "123456789";
  for (std::size_t cut = 0; cut <= bytes.size(); ++cut) {
    EXPECT_EQ(ExtendCrc32c(Crc32c(bytes.substr(0, cut)), bytes.substr(cut)), 0xE3069283U) << cut;
  }
}

// All lengths around the ends of XXH3's formulas and blocks, and some long ones.
TEST(DigestTest, HoldsXxh3Of64Bits) {
  std::string bytes;
  for (int i = 0; i < 300'000; ++i) bytes.push_back(static_cast<char>(i * 31 % 251));
  std::vector<std::size_t> sizes = {16'384, 65'537, 299'999, bytes.size()};
  for (std::size_t size = 0; size < 2200; ++size) sizes.push_back(size);
  for (const std::size_t size : sizes) {
    const v1::Digest digest = DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, bytes.substr(0, size));
    const std::optional<uint64_t> hash = Xxh3Of64Bits(digest, size);
    ASSERT_EQ(hash.has_value(), size > 240) << size;
    if (size > 240) {
      EXPECT_EQ(*hash, XXH3_64bits(bytes.data(), size)) << size;
    }
  }
  EXPECT_FALSE(Xxh3Of64Bits(DigestOf(v1::DIGEST_ALGORITHM_SHA256, bytes), bytes.size()).has_value());
}

// Left in use they slow down whatever comes after on the thread, a registration for example by a fifth.
TEST(DigestTest, LeavesTheUpperVectorHalvesUnused) {
  if (!curvereg::testing::UpperVectorHalvesInUse().has_value()) GTEST_SKIP() << "the processor does not tell";
  const std::string bytes = SomeBytes(1 << 20);
  Digester digester = Digester::Create(kXxh3).value();
  digester.Update(bytes);
  EXPECT_FALSE(*curvereg::testing::UpperVectorHalvesInUse());
  static_cast<void>(digester.Digest());
  EXPECT_FALSE(*curvereg::testing::UpperVectorHalvesInUse());
  static_cast<void>(DigestOf(kXxh3, bytes));
  EXPECT_FALSE(*curvereg::testing::UpperVectorHalvesInUse());
  static_cast<void>(Crc32c(bytes));
  EXPECT_FALSE(*curvereg::testing::UpperVectorHalvesInUse());
}

}  // namespace
}  // namespace curvereg::wire
