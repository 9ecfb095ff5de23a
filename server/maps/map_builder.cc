// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/maps/map_builder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <condition_variable>
#include <cstdio>
#include <filesystem>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/cleanup/cleanup.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/stop_status.h"
#include "server/maps/map_file.h"
#include "server/maps/map_writing.h"
#include "server/store/store_file.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr char kSuffix[] = ".map";
constexpr double kDefaultCellM = 0.1;

// `num_digits` hexadecimal digits.
std::string Name(std::string_view bytes, std::size_t num_digits) {
  return wire::HexText(wire::DigestOf(v1::DIGEST_ALGORITHM_XXH3_128, bytes).value()).substr(0, num_digits);
}

std::string BytesOf(double number) {
  const auto bytes = std::bit_cast<std::array<char, sizeof(double)>>(number);
  return {bytes.data(), bytes.size()};
}

absl::StatusOr<MapRequest> Checked(MapRequest request) {
  if (request.kind == v1::MAP_KIND_UNSPECIFIED) request.kind = v1::MAP_KIND_POINTS;
  if (request.kind != v1::MAP_KIND_POINTS && request.kind != v1::MAP_KIND_ELEVATION_ASCII) {
    return wire::FieldError("kind", "is not one that this server knows");
  }
  if (request.cell_m == 0.0) request.cell_m = kDefaultCellM;
  if (!(request.cell_m >= 0.01 && request.cell_m <= 10.0)) {
    return wire::FieldError("cell_m", "must be 0.01 to 10, or 0 for the default");
  }
  return request;
}

// Names of files begin with what they are of: traverse, then request and version, then scans and poses.
std::string TraversePart(const std::string& traverse) { return absl::StrCat(Name(traverse, 16), "-"); }

std::string RequestPart(const MapRequest& request, uint64_t version) {
  const std::string text = absl::StrCat(request.traverse, "\n", request.segment, "\n", version, "\n",
                                        static_cast<int>(request.kind), "\n", request.remove_seen_through, "\n");
  return absl::StrCat(TraversePart(request.traverse), Name(text + BytesOf(request.cell_m), 32), "-");
}

std::string FileName(const MapRequest& request, const MapSource& source) {
  std::string bytes;
  for (const std::string& id : source.scan_ids) absl::StrAppend(&bytes, id, "\n");
  for (const RigidTransform& T : source.T_segment_scan) {
    for (int i = 0; i < 12; ++i) bytes += BytesOf(T.matrix()(i / 4, i % 4));
  }
  return absl::StrCat(RequestPart(request, source.version), Name(bytes, 32), kSuffix);
}

struct KeptFile {
  std::string name;
  uint64_t bytes = 0;
  std::filesystem::file_time_type used;
};

class MapBuilderImpl : public MapBuilder {
 public:
  MapBuilderImpl(std::string folder, const MapEnvironment& environment, const Options& options)
      : folder_(std::move(folder)), environment_(environment), options_(options) {}

  absl::Status RemoveUnfinished() const {
    const absl::StatusOr<std::vector<std::string>> names = ListFolder(folder_);
    if (!names.ok()) return names.status();
    for (const std::string& name : *names) {
      if (absl::EndsWith(name, kSuffix)) continue;
      if (absl::Status status = RemoveFile(PathOf(name)); !status.ok()) return status;
    }
    return absl::OkStatus();
  }

  absl::StatusOr<std::shared_ptr<const MapFile>> Build(const MapRequest& asked, const MapSource& source,
                                                       const Stop& stop) override {
    const absl::StatusOr<MapRequest> request = Checked(asked);
    if (!request.ok()) return request.status();
    const std::string name = FileName(*request, source);
    if (absl::Status status = TakeTurn(name, stop); !status.ok()) return status;
    // Also when a library throws, for lack of memory, so that others can build it.
    const absl::Cleanup end_of_turn = [&] { GiveUpTurn(name); };
    if (std::shared_ptr<const MapFile> map = OpenAndTouch(name); map != nullptr) return map;
    if (absl::Status status = BuildFile(*request, source, name, stop); !status.ok()) return status;
    std::shared_ptr<const MapFile> map = OpenAndTouch(name);
    if (map == nullptr) return wire::MakeError(v1::ERROR_REASON_STORAGE_FAULT, "the map is gone");
    return map;
  }

  std::shared_ptr<const MapFile> FindBuilt(const MapRequest& asked, uint64_t version) override {
    const absl::StatusOr<MapRequest> request = Checked(asked);
    if (!request.ok()) return nullptr;
    for (const KeptFile& file : KeptFiles(RequestPart(*request, version))) {
      if (std::shared_ptr<const MapFile> map = OpenAndTouch(file.name)) return map;
    }
    return nullptr;
  }

  void Forget(const std::string& traverse) override {
    for (const KeptFile& file : KeptFiles(TraversePart(traverse))) RemoveFile(PathOf(file.name)).IgnoreError();
  }

 private:
  std::string PathOf(const std::string& name) const { return absl::StrCat(folder_, "/", name); }

  // Waits until nobody else builds this map.
  absl::Status TakeTurn(const std::string& name, const Stop& stop) {
    std::unique_lock lock(mutex_);
    const auto is_free = [&] { return !building_.contains(name); };
    const bool is_ours = stop.deadline.has_value()
                             ? turn_ended_.wait_until(lock, stop.cancellation, *stop.deadline, is_free)
                             : turn_ended_.wait(lock, stop.cancellation, is_free);
    if (!is_ours) return StopStatus(stop, "the map");
    building_.insert(name);
    return absl::OkStatus();
  }

  void GiveUpTurn(const std::string& name) {
    {
      const std::lock_guard lock(mutex_);
      building_.erase(name);
    }
    turn_ended_.notify_all();
  }

  // Null when it is not there, or not whole.
  std::shared_ptr<const MapFile> OpenAndTouch(const std::string& name) const {
    absl::StatusOr<std::shared_ptr<const MapFile>> map = OpenMapFile(PathOf(name));
    if (!map.ok()) return nullptr;
    std::error_code ignored;  // then it counts as used when it was built
    std::filesystem::last_write_time(PathOf(name), std::filesystem::file_time_type::clock::now(), ignored);
    return *std::move(map);
  }

  absl::Status BuildFile(const MapRequest& request, const MapSource& source, const std::string& name,
                         const Stop& stop) const {
    const std::string path = PathOf(name);
    const std::string unfinished = path + ".part";
    absl::Status status = WriteUnfinished(request, source, unfinished, stop);
    if (status.ok() && std::rename(unfinished.c_str(), path.c_str()) != 0) {
      status = FileError(path, "cannot rename", errno);
    }
    if (!status.ok()) {
      RemoveFile(unfinished).IgnoreError();
      return status;
    }
    RemoveOld(name);
    return SyncFolder(folder_);
  }

  absl::Status WriteUnfinished(const MapRequest& request, const MapSource& source, const std::string& path,
                               const Stop& stop) const {
    absl::StatusOr<MapFileWriter> writer = MapFileWriter::Create(path, options_.max_stored_bytes);
    if (!writer.ok()) return writer.status();
    const absl::StatusOr<uint64_t> num_cells = WriteMap(
        {request.kind, request.cell_m, request.remove_seen_through}, source, environment_,
        [&](std::string_view bytes) { return writer->Append(bytes); }, stop);
    if (!num_cells.ok()) return num_cells.status();
    v1::MapHeader header;
    header.set_version(source.version);
    header.set_cell_count(*num_cells);
    return writer->Finish(std::move(header));
  }

  // Those whose names begin so, newest first.
  std::vector<KeptFile> KeptFiles(const std::string& prefix) const {
    std::vector<KeptFile> files;
    const absl::StatusOr<std::vector<std::string>> names = ListFolder(folder_);
    if (!names.ok()) return files;
    for (const std::string& name : *names) {
      if (!absl::StartsWith(name, prefix) || !absl::EndsWith(name, kSuffix)) continue;
      std::error_code error;
      const uint64_t bytes = std::filesystem::file_size(PathOf(name), error);
      if (error) continue;
      const auto used = std::filesystem::last_write_time(PathOf(name), error);
      if (!error) files.push_back({name, bytes, used});
    }
    std::sort(files.begin(), files.end(), [](const KeptFile& a, const KeptFile& b) {
      return a.used != b.used ? a.used > b.used : a.name < b.name;
    });
    return files;
  }

  // Beyond the total size; `newest` stays.
  void RemoveOld(const std::string& newest) const {
    std::error_code error;
    uint64_t total = std::filesystem::file_size(PathOf(newest), error);
    if (error) total = 0;
    for (const KeptFile& file : KeptFiles("")) {
      if (file.name == newest) continue;
      total += file.bytes;
      if (total > options_.max_stored_bytes) RemoveFile(PathOf(file.name)).IgnoreError();
    }
  }

  const std::string folder_;
  const MapEnvironment environment_;
  const Options options_;
  std::mutex mutex_;
  std::condition_variable_any turn_ended_;
  std::set<std::string> building_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MapBuilder>> MapBuilder::Open(const std::string& data_dir,
                                                             const MapEnvironment& environment,
                                                             const Options& options) {
  const std::string folder = absl::StrCat(data_dir, "/maps");
  absl::Status status = MakeFolder(folder);
  if (!status.ok()) return status;
  auto builder = std::make_unique<MapBuilderImpl>(folder, environment, options);
  status = builder->RemoveUnfinished();
  if (!status.ok()) return status;
  return builder;
}

}  // namespace curvereg::server
