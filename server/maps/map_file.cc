// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/maps/map_file.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

#include "absl/strings/str_cat.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

// Ends the file, after the serialised header. Read on the machine that wrote it.
struct Trailer {
  uint32_t header_bytes = 0;
  uint32_t header_crc = 0;
  std::array<char, 8> magic{};
};
static_assert(sizeof(Trailer) == 16);
constexpr std::array<char, 8> kMagic = {'C', 'u', 'r', 'v', 'M', 'a', 'p', '1'};

class StoredMap : public MapFile {
 public:
  StoredMap(StoreFile file, v1::MapHeader header) : file_(std::move(file)), header_(std::move(header)) {}

  const v1::MapHeader& header() const override { return header_; }

  absl::StatusOr<std::string> Read(uint64_t offset, uint64_t size) const override {
    const uint64_t end = header_.payload_bytes();
    if (offset > end) {
      return wire::MakeError(v1::ERROR_REASON_OFFSET_OUT_OF_RANGE, absl::StrCat("the map has ", end, " bytes"),
                             {{"committed_offset", absl::StrCat(end)}});
    }
    return file_.ReadAt(offset, std::min(size, end - offset));
  }

 private:
  StoreFile file_;
  v1::MapHeader header_;
};

absl::Status Damaged() { return wire::MakeError(v1::ERROR_REASON_STORED_SCAN_DAMAGED, "the file of a map is damaged"); }

}  // namespace

absl::StatusOr<std::shared_ptr<const MapFile>> OpenMapFile(const std::string& path) {
  absl::StatusOr<StoreFile> file = StoreFile::OpenToRead(path);
  if (!file.ok()) return file.status();
  const absl::StatusOr<uint64_t> size = file->Size();
  if (!size.ok()) return size.status();
  if (*size < sizeof(Trailer)) return Damaged();
  const absl::StatusOr<std::string> end = file->ReadAt(*size - sizeof(Trailer), sizeof(Trailer));
  if (!end.ok()) return end.status();
  Trailer trailer;
  if (end->size() != sizeof(trailer)) return Damaged();
  std::memcpy(&trailer, end->data(), sizeof(trailer));
  const uint64_t after_payload = uint64_t{trailer.header_bytes} + sizeof(trailer);
  if (trailer.magic != kMagic || after_payload > *size) return Damaged();
  const uint64_t payload_bytes = *size - after_payload;
  const absl::StatusOr<std::string> bytes = file->ReadAt(payload_bytes, trailer.header_bytes);
  if (!bytes.ok()) return bytes.status();
  v1::MapHeader header;
  if (wire::Crc32c(*bytes) != trailer.header_crc || !header.ParseFromString(*bytes) ||
      header.payload_bytes() != payload_bytes) {
    return Damaged();
  }
  return std::make_shared<const StoredMap>(*std::move(file), std::move(header));
}

absl::StatusOr<MapFileWriter> MapFileWriter::Create(const std::string& path, uint64_t max_bytes) {
  absl::StatusOr<StoreFile> file = StoreFile::OpenToWrite(path);
  if (!file.ok()) return file.status();
  if (absl::Status status = file->Truncate(0); !status.ok()) return status;
  absl::StatusOr<wire::Digester> digester = wire::Digester::Create(v1::DIGEST_ALGORITHM_XXH3_128);
  if (!digester.ok()) return digester.status();
  return MapFileWriter(*std::move(file), max_bytes, *std::move(digester));
}

absl::Status MapFileWriter::Append(std::string_view bytes) {
  if (written_bytes_ + pending_.size() + bytes.size() > max_bytes_) {
    return wire::MakeError(v1::ERROR_REASON_STORAGE_FULL, "the map is larger than the server keeps: larger cells",
                           {{"limit", absl::StrCat(max_bytes_)}});
  }
  digester_.Update(bytes);
  pending_ += bytes;
  return pending_.size() < kPieceBytes ? absl::OkStatus() : Flush();
}

absl::Status MapFileWriter::Flush() {
  absl::Status status = file_.WriteAt(written_bytes_, pending_);
  written_bytes_ += pending_.size();
  pending_.clear();
  return status;
}

absl::Status MapFileWriter::Finish(v1::MapHeader header) {
  header.set_payload_bytes(written_bytes_ + pending_.size());
  *header.mutable_payload_digest() = digester_.Digest();
  const std::string bytes = header.SerializeAsString();
  const Trailer trailer{static_cast<uint32_t>(bytes.size()), wire::Crc32c(bytes), kMagic};
  pending_ += bytes;
  pending_.append(reinterpret_cast<const char*>(&trailer), sizeof(trailer));
  absl::Status status = Flush();
  if (!status.ok()) return status;
  return file_.SyncData();
}

}  // namespace curvereg::server
