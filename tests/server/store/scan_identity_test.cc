// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_identity.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "google/protobuf/descriptor.h"
#include "google/protobuf/message.h"
#include "wire/digest.h"

namespace curvereg::server {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;

// Sets the field to something that is neither its default nor what Set before.
void Set(Message& message, const FieldDescriptor& field, int seed) {
  const google::protobuf::Reflection& reflection = *message.GetReflection();
  switch (field.cpp_type()) {
    case FieldDescriptor::CPPTYPE_INT32:
      return reflection.SetInt32(&message, &field, seed);
    case FieldDescriptor::CPPTYPE_INT64:
      return reflection.SetInt64(&message, &field, seed);
    case FieldDescriptor::CPPTYPE_UINT32:
      return reflection.SetUInt32(&message, &field, static_cast<uint32_t>(seed));
    case FieldDescriptor::CPPTYPE_UINT64:
      return reflection.SetUInt64(&message, &field, static_cast<uint64_t>(seed));
    case FieldDescriptor::CPPTYPE_DOUBLE:
      return reflection.SetDouble(&message, &field, 0.5 * seed);
    case FieldDescriptor::CPPTYPE_ENUM:
      return reflection.SetEnumValue(&message, &field, seed % 2 + 1);
    case FieldDescriptor::CPPTYPE_STRING:
      return reflection.SetString(&message, &field, std::string(static_cast<std::size_t>(seed), 'x'));
    default:
      FAIL() << "a kind of field that the test does not know: " << field.full_name();
  }
}

// The header, and what it is after each of its fields, at any depth, is changed alone. `part` lies within `header`.
void ChangeEachField(v1::PointCloudHeader& header, Message& part, std::vector<std::string>& forms,
                     std::vector<std::string>& names) {
  const google::protobuf::Reflection& reflection = *part.GetReflection();
  for (int i = 0; i < part.GetDescriptor()->field_count(); ++i) {
    const FieldDescriptor& field = *part.GetDescriptor()->field(i);
    names.push_back(std::string(field.full_name()));
    if (field.cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE) {
      Message& inner =
          field.is_repeated() ? *reflection.AddMessage(&part, &field) : *reflection.MutableMessage(&part, &field);
      forms.push_back(CanonicalHeader(header));  // there, though empty
      ChangeEachField(header, inner, forms, names);
    } else {
      Set(part, field, 3);
      forms.push_back(CanonicalHeader(header));
      names.push_back(std::string(field.full_name()) + " again");
      Set(part, field, 4);
      forms.push_back(CanonicalHeader(header));
    }
  }
}

TEST(ScanIdentityTest, EveryFieldOfTheHeaderMatters) {
  v1::PointCloudHeader header;
  std::vector<std::string> forms = {CanonicalHeader(header)};
  std::vector<std::string> names = {"empty"};
  ChangeEachField(header, header, forms, names);
  ASSERT_EQ(forms.size(), names.size());
  ASSERT_GT(forms.size(), 40U);
  std::set<std::string> seen;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    EXPECT_TRUE(seen.insert(forms[i]).second) << names[i] << " makes no difference";
  }
}

TEST(ScanIdentityTest, ACountOfZeroMeansOne) {
  v1::PointCloudHeader a;
  a.mutable_layout()->add_fields()->set_name("x");
  v1::PointCloudHeader b = a;
  b.mutable_layout()->mutable_fields(0)->set_count(1);
  EXPECT_EQ(CanonicalHeader(a), CanonicalHeader(b));
  b.mutable_layout()->mutable_fields(0)->set_count(2);
  EXPECT_NE(CanonicalHeader(a), CanonicalHeader(b));
}

TEST(ScanIdentityTest, IdsStayWhatTheyAre) {
  // On disk and in clients' hands: if this fails, the form has changed and every stored scan would be damaged.
  v1::PointCloudHeader header;
  header.set_frame_id("lidar");
  header.mutable_time()->set_seconds(1'700'000'000);
  header.set_point_count(224'000);
  header.set_encoding(v1::POINT_ENCODING_QUANTIZED_ZSTD);
  header.mutable_quantization()->set_step_m(0.001);
  const v1::Digest digest = wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, "payload");
  EXPECT_EQ(ScanId(header, digest), "a9ac02cb9d1695209130cc50894b8fa1");
  EXPECT_NE(ScanId(header, wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, "payloae")), ScanId(header, digest));
}

}  // namespace
}  // namespace curvereg::server
