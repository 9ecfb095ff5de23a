// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/scan_identity.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "wire/digest.h"

namespace curvereg::server {
namespace {

// Tells this form from any later one.
constexpr std::string_view kForm = "curvereg scan 1\n";

void PutInteger(uint64_t value, std::string& out) {
  for (int shift = 0; shift < 64; shift += 8) out.push_back(static_cast<char>(value >> shift));
}

void PutSigned(int64_t value, std::string& out) { PutInteger(static_cast<uint64_t>(value), out); }

void PutDouble(double value, std::string& out) { PutInteger(std::bit_cast<uint64_t>(value), out); }

void PutText(std::string_view text, std::string& out) {
  PutInteger(text.size(), out);
  out.append(text);
}

bool PutPresence(bool is_present, std::string& out) {
  out.push_back(is_present ? '\1' : '\0');
  return is_present;
}

void PutVector(const v1::Vector3& vector, std::string& out) {
  PutDouble(vector.x(), out);
  PutDouble(vector.y(), out);
  PutDouble(vector.z(), out);
}

void PutLayout(const v1::PointLayout& layout, std::string& out) {
  PutInteger(static_cast<uint64_t>(layout.fields_size()), out);
  for (const v1::PointField& field : layout.fields()) {
    PutText(field.name(), out);
    PutInteger(field.offset(), out);
    PutSigned(field.type(), out);
    PutInteger(std::max(field.count(), 1U), out);  // 0 means 1
  }
  PutInteger(layout.point_stride(), out);
  PutInteger(layout.width(), out);
  PutInteger(layout.row_padding(), out);
}

void PutQuantization(const v1::Quantization& quantization, std::string& out) {
  if (PutPresence(quantization.has_origin(), out)) PutVector(quantization.origin(), out);
  PutDouble(quantization.step_m(), out);
  PutInteger(quantization.bytes_per_coordinate(), out);
  PutDouble(quantization.max_error_m(), out);
}

void PutTransform(const v1::RigidTransform& transform, std::string& out) {
  if (PutPresence(transform.has_translation(), out)) PutVector(transform.translation(), out);
  if (!PutPresence(transform.has_rotation(), out)) return;
  PutDouble(transform.rotation().x(), out);
  PutDouble(transform.rotation().y(), out);
  PutDouble(transform.rotation().z(), out);
  PutDouble(transform.rotation().w(), out);
}

}  // namespace

std::string CanonicalHeader(const v1::PointCloudHeader& header) {
  std::string out(kForm);
  PutText(header.frame_id(), out);
  if (PutPresence(header.has_time(), out)) {
    PutSigned(header.time().seconds(), out);
    PutSigned(header.time().nanos(), out);
  }
  PutInteger(header.point_count(), out);
  PutSigned(header.encoding(), out);
  if (PutPresence(header.has_layout(), out)) PutLayout(header.layout(), out);
  if (PutPresence(header.has_quantization(), out)) PutQuantization(header.quantization(), out);
  if (PutPresence(header.has_gravity(), out)) PutVector(header.gravity(), out);
  if (PutPresence(header.has_t_world_sensor(), out)) PutTransform(header.t_world_sensor(), out);
  return out;
}

std::string ScanId(const v1::PointCloudHeader& header, const v1::Digest& payload_digest) {
  std::string bytes = CanonicalHeader(header);
  bytes.append(payload_digest.value());
  return wire::HexText(wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, bytes).value());
}

}  // namespace curvereg::server
