// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/scans/upload_message.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream.h>

#include <algorithm>
#include <climits>
#include <cstdint>

#include "wire/digest.h"

namespace curvereg::server {
namespace {

using google::protobuf::io::CodedInputStream;

// Number and wire type, as they stand before each field.
enum WireType : uint32_t { kVarint = 0, kLengthDelimited = 2, kFixed32 = 5 };
constexpr uint32_t Tag(int field_number, WireType type) { return static_cast<uint32_t>(field_number) << 3 | type; }

class SliceStream final : public google::protobuf::io::ZeroCopyInputStream {
 public:
  explicit SliceStream(const std::vector<grpc::Slice>& slices) : slices_(slices) {}

  bool Next(const void** data, int* size) override {
    while (index_ < slices_.size() && offset_ == slices_[index_].size()) {
      ++index_;
      offset_ = 0;
    }
    if (index_ == slices_.size()) return false;
    const grpc::Slice& slice = slices_[index_];
    const std::size_t length = std::min<std::size_t>(slice.size() - offset_, INT_MAX);
    *data = slice.begin() + offset_;
    *size = static_cast<int>(length);
    offset_ += length;
    count_ += *size;
    return true;
  }

  // Precondition: the last Next returned these bytes, so they are in the same slice.
  void BackUp(int count) override {
    offset_ -= static_cast<std::size_t>(count);
    count_ -= count;
  }

  bool Skip(int count) override {
    const void* data = nullptr;
    int size = 0;
    while (count > 0 && Next(&data, &size)) {
      if (size > count) BackUp(size - count);
      count -= std::min(size, count);
    }
    return count == 0;
  }

  int64_t ByteCount() const override { return count_; }

 private:
  const std::vector<grpc::Slice>& slices_;
  std::size_t index_ = 0;
  std::size_t offset_ = 0;  // within slices_[index_]
  int64_t count_ = 0;
};

// The next `size` bytes, as pieces of the slices.
bool ReadPieces(CodedInputStream& in, int size, std::vector<std::string_view>& pieces) {
  while (size > 0) {
    const void* data = nullptr;
    int available = 0;
    if (!in.GetDirectBufferPointer(&data, &available)) return false;
    const int taken = std::min(size, available);
    pieces.emplace_back(static_cast<const char*>(data), static_cast<std::size_t>(taken));
    if (!in.Skip(taken)) return false;
    size -= taken;
  }
  return true;
}

bool ReadChunkField(CodedInputStream& in, uint32_t tag, v1::PayloadChunk& chunk, std::vector<std::string_view>& data) {
  uint64_t offset = 0;
  uint32_t crc32c = 0;
  int size = 0;
  switch (tag) {
    case Tag(v1::PayloadChunk::kOffsetFieldNumber, kVarint):
      if (!in.ReadVarint64(&offset)) return false;
      chunk.set_offset(offset);
      return true;
    case Tag(v1::PayloadChunk::kCrc32CFieldNumber, kFixed32):
      if (!in.ReadLittleEndian32(&crc32c)) return false;
      chunk.set_crc32c(crc32c);
      return true;
    case Tag(v1::PayloadChunk::kDataFieldNumber, kLengthDelimited):
      // A field that occurs twice is left to protobuf, which keeps the last one.
      return data.empty() && in.ReadVarintSizeAsInt(&size) && ReadPieces(in, size, data);
    default:
      return false;
  }
}

// Reads a request that is one chunk of known fields. False: it is another request, or none; protobuf is to parse it.
bool ReadPlainChunk(const std::vector<grpc::Slice>& slices, v1::PayloadChunk& chunk,
                    std::vector<std::string_view>& data) {
  SliceStream stream(slices);
  CodedInputStream in(&stream);
  int size = 0;
  if (in.ReadTag() != Tag(v1::UploadScanRequest::kChunkFieldNumber, kLengthDelimited) ||
      !in.ReadVarintSizeAsInt(&size)) {
    return false;
  }
  const CodedInputStream::Limit outer = in.PushLimit(size);
  while (in.BytesUntilLimit() > 0) {
    if (!ReadChunkField(in, in.ReadTag(), chunk, data)) return false;
  }
  in.PopLimit(outer);
  return in.ReadTag() == 0 && in.ConsumedEntireMessage();
}

}  // namespace

bool UploadMessage::Parse(const grpc::ByteBuffer& buffer) {
  Clear();
  if (!buffer.Dump(&slices_).ok()) return false;
  if (!ReadPlainChunk(slices_, *request_.mutable_chunk(), chunk_data_)) {
    chunk_data_.clear();
    SliceStream stream(slices_);
    if (!request_.ParseFromZeroCopyStream(&stream)) return false;
    FindDataInRequest();
  }
  ComputeCrc();
  return true;
}

void UploadMessage::FindDataInRequest() {
  if (!request_.chunk().data().empty()) chunk_data_.emplace_back(request_.chunk().data());
}

void UploadMessage::ComputeCrc() {
  for (const std::string_view piece : chunk_data_) chunk_crc32c_ = wire::ExtendCrc32c(chunk_crc32c_, piece);
}

void UploadMessage::Clear() {
  chunk_data_.clear();
  request_.Clear();
  slices_.clear();
  chunk_crc32c_ = 0;
}

}  // namespace curvereg::server
