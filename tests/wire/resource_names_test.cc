// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/resource_names.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "wire/error.h"

namespace curvereg::wire {
namespace {

using ::testing::HasSubstr;

constexpr std::string_view kScanId = "0123456789abcdef0123456789abcdef";

// The field that the error names; empty: another error, or none.
std::string FieldOf(const absl::Status& status) {
  const auto bad_request = BadRequestOf(status);
  if (ReasonOf(status) != v1::ERROR_REASON_INVALID_FIELD || !bad_request.has_value()) return "";
  return bad_request->field_violations(0).field();
}

TEST(ResourceNamesTest, ANameIsThePrefixAndTheId) {
  EXPECT_EQ(ScanName(kScanId), "scans/0123456789abcdef0123456789abcdef");
  EXPECT_EQ(UploadName("u-1"), "uploads/u-1");
  EXPECT_EQ(TraverseName("sol-12"), "traverses/sol-12");
}

TEST(ResourceNamesTest, TheIdOfANameIsTheOneThatItWasMadeOf) {
  EXPECT_EQ(*ScanIdOf(ScanName(kScanId), "name"), kScanId);
  EXPECT_EQ(*UploadIdOf(UploadName("u-1"), "upload"), "u-1");
  EXPECT_EQ(*TraverseIdOf(TraverseName("sol-12"), "name"), "sol-12");
}

TEST(ResourceNamesTest, AScanIdIs32LowerCaseHexadecimalDigits) {
  EXPECT_TRUE(IsScanName(ScanName(kScanId)));
  for (const std::string_view name :
       {"", "scans/", "0123456789abcdef0123456789abcdef", "scan/0123456789abcdef0123456789abcdef",
        "scans/0123456789abcdef0123456789abcde", "scans/0123456789abcdef0123456789abcdef0",
        "scans/0123456789ABCDEF0123456789abcdef", "scans/0123456789abcdeg0123456789abcdef",
        "scans//123456789abcdef0123456789abcdef", " scans/0123456789abcdef0123456789abcdef",
        "uploads/0123456789abcdef0123456789abcdef"}) {
    EXPECT_FALSE(IsScanName(name)) << name;
    const absl::Status status = ScanIdOf(name, "target.name").status();
    EXPECT_EQ(FieldOf(status), "target.name") << name;
    EXPECT_THAT(status.message(), HasSubstr("must be scans/ and 32 lower-case hexadecimal digits"));
  }
}

TEST(ResourceNamesTest, ANameOfAnotherKindIsRefused) {
  const absl::Status upload = UploadIdOf("traverses/a", "upload").status();
  EXPECT_EQ(FieldOf(upload), "upload");
  EXPECT_THAT(upload.message(), HasSubstr("must be uploads/ and 1 to 64 of a-z, 0-9 and '-'"));
  const absl::Status traverse = TraverseIdOf("uploads/a", "start.traverse").status();
  EXPECT_EQ(FieldOf(traverse), "start.traverse");
  EXPECT_THAT(traverse.message(), HasSubstr("must be traverses/ and 1 to 64 of a-z, 0-9 and '-'"));
  EXPECT_FALSE(UploadIdOf("uploads/", "upload").ok());
  EXPECT_FALSE(UploadIdOf("uploads/a/b", "upload").ok());
  EXPECT_FALSE(TraverseIdOf("sol-12", "name").ok());
}

TEST(ResourceNamesTest, ClientChosenIdsAreShortAndPlain) {
  EXPECT_TRUE(IsClientChosenId("0f8fad5b-d9cb-469f-a165-70867728950e"));
  EXPECT_TRUE(IsClientChosenId(std::string(64, 'z')));
  for (const char* text : {"", "A", "a/b", "..", "a.b", "a b", "\xc3\xa4"}) {
    EXPECT_FALSE(IsClientChosenId(text)) << text;
    EXPECT_FALSE(UploadIdOf(UploadName(text), "upload").ok()) << text;
    EXPECT_FALSE(TraverseIdOf(TraverseName(text), "name").ok()) << text;
  }
  EXPECT_FALSE(IsClientChosenId(std::string(65, 'z')));
  EXPECT_FALSE(IsClientChosenId(std::string("a\0", 2)));
}

}  // namespace
}  // namespace curvereg::wire
