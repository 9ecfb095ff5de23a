// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/store/upload_table.h"

#include <sys/stat.h>

#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/store/scan_identity.h"
#include "wire/error.h"
#include "wire/resource_names.h"

namespace curvereg::server {
namespace {

using std::chrono::system_clock;

// Uploads end, or are forgotten, at a leisurely pace.
constexpr std::chrono::seconds kTooManyRetryDelay{10};

// When the bytes last changed: the time of the last progress outlives the process without a row for it.
system_clock::time_point LastChange(const std::string& path) {
  struct stat info {};
  if (stat(path.c_str(), &info) != 0) return system_clock::now();
  const auto since_epoch = std::chrono::seconds(info.st_mtim.tv_sec) + std::chrono::nanoseconds(info.st_mtim.tv_nsec);
  return system_clock::time_point(std::chrono::duration_cast<system_clock::duration>(since_epoch));
}

// The same upload. A digest that only one of them tells is no difference: it may come as late as the finish.
bool SameUpload(const UploadDescription& a, const UploadDescription& b) {
  const bool same_digest = !a.payload_digest.has_value() || !b.payload_digest.has_value() ||
                           a.payload_digest->algorithm() != b.payload_digest->algorithm() ||
                           wire::SameDigest(*a.payload_digest, *b.payload_digest);
  return same_digest && a.payload_bytes == b.payload_bytes && CanonicalHeader(a.header) == CanonicalHeader(b.header);
}

// Of an upload among orphaned files and removal marks.
std::string LabelOf(const std::string& upload_id) { return "upload-" + upload_id; }

absl::Status StoreFullError(uint64_t declared_bytes) {
  return wire::MakeError(v1::ERROR_REASON_STORAGE_FULL, "the declared bytes do not fit into the store",
                         {{"value", absl::StrCat(declared_bytes)}});
}

}  // namespace

UploadTable::UploadTable(std::string folder, const ScanStoreOptions& options, ScanCatalog& catalog,
                         const RemovalMarks& removals, StoreSpace& space)
    : folder_(std::move(folder)), options_(options), catalog_(catalog), removals_(removals), space_(space) {}

absl::Status UploadTable::Load(const std::set<FileIdentity>& stored, const SetAside& set_aside) {
  const absl::StatusOr<std::vector<UploadDescription>> descriptions = catalog_.Uploads();
  if (!descriptions.ok()) return descriptions.status();
  for (const UploadDescription& description : *descriptions) {
    if (absl::Status status = Adopt(description); !status.ok()) return status;
  }
  const absl::StatusOr<std::vector<std::string>> names = ListFolder(folder_);
  if (!names.ok()) return names.status();
  for (const std::string& name : *names) {
    if (!wire::IsClientChosenId(name) || Find(name) != nullptr) continue;
    const std::optional<FileInfo> file = LookAt(PathOf(name));
    if (!file.has_value()) continue;
    // Whoever is stopped while an upload begins leaves an empty file; while it is committed, one that is a payload by
    // now; while it is dropped, a marked one. Anything else had a row when it was acknowledged.
    const bool is_left_over =
        file->bytes == 0 || stored.contains(file->identity) || removals_.IsSet(PathOf(name), LabelOf(name));
    const absl::Status status = is_left_over ? RemoveFile(PathOf(name)) : set_aside(PathOf(name), LabelOf(name));
    if (!status.ok()) return status;
  }
  return absl::OkStatus();
}

std::set<FileIdentity> UploadTable::Files() const {
  const std::lock_guard lock(mutex_);
  std::set<FileIdentity> files;
  for (const auto& [id, upload] : uploads_) {
    if (const std::optional<FileInfo> info = LookAt(PathOf(id)); info.has_value()) files.insert(info->identity);
  }
  return files;
}

absl::Status UploadTable::Adopt(const UploadDescription& description) {
  // Files are made before their rows.
  const bool was_there = LookAt(PathOf(description.id)).has_value();
  absl::StatusOr<StoreFile> file = StoreFile::OpenToWrite(PathOf(description.id));
  if (!file.ok()) return file.status();
  absl::StatusOr<uint64_t> size = file->Size();
  if (!size.ok()) return size.status();
  const bool is_longer = *size > description.payload_bytes;  // nothing of ours wrote that
  if (is_longer) {
    if (absl::Status status = file->Truncate(0); !status.ok()) return status;
    size = 0;
  }
  if (!was_there || is_longer) emptied_.push_back(description.id);
  auto upload = std::make_shared<Upload>();
  upload->description = description;
  upload->committed_offset = *size;
  upload->last_progress = LastChange(PathOf(description.id));
  space_.Adopt(description.payload_bytes, *size);
  const std::lock_guard lock(mutex_);
  uploads_[description.id] = std::move(upload);
  return absl::OkStatus();
}

std::shared_ptr<Upload> UploadTable::Find(const std::string& upload_id) const {
  const std::lock_guard lock(mutex_);
  const auto found = uploads_.find(upload_id);
  return found == uploads_.end() ? nullptr : found->second;
}

absl::StatusOr<UploadTable::Grant> UploadTable::Begin(const UploadDescription& description) {
  if (!wire::IsClientChosenId(description.id)) return wire::FieldError("upload", "not 1 to 64 of a-z, 0-9 and '-'");
  if (description.payload_bytes == 0) return wire::FieldError("payload_bytes", "0");
  while (true) {
    const std::shared_ptr<Upload> upload = Find(description.id);
    if (upload == nullptr) {
      absl::StatusOr<Grant> grant = BeginNew(description);
      // Somebody else began it meanwhile: resume that one.
      if (grant.ok() || !absl::IsAlreadyExists(grant.status())) return grant;
    } else {
      const std::lock_guard lock(upload->mutex);
      // One that has ended leaves the table before its mutex is free.
      if (!upload->has_ended) return Resume(upload, description);
    }
  }
}

absl::StatusOr<UploadTable::Grant> UploadTable::Resume(const std::shared_ptr<Upload>& upload,
                                                       const UploadDescription& description) {
  if (!SameUpload(upload->description, description)) {
    return wire::MakeError(v1::ERROR_REASON_UPLOAD_DIFFERS, "the upload was begun with another header, size or digest");
  }
  if (!upload->description.payload_digest.has_value() && description.payload_digest.has_value()) {
    if (absl::Status status = catalog_.PutUpload(description); !status.ok()) return status;
    upload->description.payload_digest = description.payload_digest;
  }
  absl::StatusOr<StoreFile> file = StoreFile::OpenToWrite(PathOf(description.id));
  if (!file.ok()) return file.status();
  const absl::StatusOr<uint64_t> size = file->Size();
  if (!size.ok()) return size.status();
  if (*size < upload->committed_offset) {  // somebody else's doing; what is gone has to come again
    space_.Release(0, upload->committed_offset - *size);
    upload->committed_offset = *size;
    upload->digester.reset();
    upload->digested_bytes = 0;
  }
  upload->last_progress = system_clock::now();  // a sender that comes back is alive
  return Grant{upload, ++upload->writer_epoch, upload->committed_offset, *std::move(file)};
}

absl::StatusOr<UploadTable::Grant> UploadTable::BeginNew(const UploadDescription& description) {
  auto upload = std::make_shared<Upload>();
  upload->description = description;
  upload->last_progress = system_clock::now();
  const std::lock_guard lock(upload->mutex);
  if (absl::Status status = Admit(upload); !status.ok()) return status;
  // Bytes that an earlier upload of this name left behind, if its file could not be removed, are none of this one's.
  // The file may be a payload by now, so it is not written to.
  absl::Status status = RemoveFile(PathOf(description.id));
  absl::StatusOr<StoreFile> file = absl::UnknownError("not opened");
  if (status.ok()) {
    file = StoreFile::OpenToWrite(PathOf(description.id));
    status = file.status();
  }
  if (status.ok()) status = catalog_.PutUpload(description);
  if (status.ok()) return Grant{upload, ++upload->writer_epoch, upload->committed_offset, *std::move(file)};
  End(*upload);
  return status;
}

absl::Status UploadTable::Admit(const std::shared_ptr<Upload>& upload) {
  const UploadDescription& description = upload->description;
  const std::lock_guard lock(mutex_);
  if (uploads_.contains(description.id)) return absl::AlreadyExistsError("begun meanwhile");
  if (uploads_.size() >= static_cast<std::size_t>(options_.max_uploads)) {
    return wire::WithRetryDelay(wire::MakeError(v1::ERROR_REASON_TOO_MANY_UPLOADS, "too many uploads are unfinished",
                                                {{"limit", absl::StrCat(options_.max_uploads)}}),
                                kTooManyRetryDelay);
  }
  if (FreeBytes(folder_) < description.payload_bytes || !space_.Reserve(description.payload_bytes)) {
    return StoreFullError(description.payload_bytes);
  }
  uploads_[description.id] = upload;
  return absl::OkStatus();
}

absl::StatusOr<UploadState> UploadTable::State(const std::string& upload_id) {
  if (const std::shared_ptr<Upload> upload = Find(upload_id); upload != nullptr) {
    const std::lock_guard lock(upload->mutex);
    if (!upload->has_ended) {
      return UploadState{upload->description, upload->committed_offset,
                         upload->last_progress + options_.upload_lifetime};
    }
  }
  return wire::MakeError(v1::ERROR_REASON_UPLOAD_NOT_FOUND, "no unfinished upload of this name");
}

absl::StatusOr<int> UploadTable::Expire(system_clock::time_point now) {
  std::vector<std::shared_ptr<Upload>> uploads;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [id, upload] : uploads_) uploads.push_back(upload);
  }
  int num_expired = 0;
  for (const std::shared_ptr<Upload>& upload : uploads) {
    const std::lock_guard lock(upload->mutex);
    if (upload->has_ended || now - upload->last_progress <= options_.upload_lifetime) continue;
    Drop(*upload);
    ++num_expired;
  }
  return num_expired;
}

void UploadTable::AddProgress(Upload& upload, uint64_t bytes) {
  upload.committed_offset += bytes;
  upload.last_progress = system_clock::now();
  space_.AddUploaded(bytes);
}

void UploadTable::Drop(Upload& upload) {
  const std::string& id = upload.description.id;
  removals_.Set(PathOf(id), LabelOf(id));
  const bool has_row = !catalog_.RemoveUpload(id).ok();
  if (has_row) {
    // On a full disk for example: an upload without bytes at the next start, which expires.
    removals_.Clear(LabelOf(id));
    const std::optional<FileInfo> file = LookAt(PathOf(id));
    const bool is_payload = file.has_value() && file->num_names > 1;
    absl::StatusOr<StoreFile> emptied = StoreFile::OpenToWrite(PathOf(id));
    if (!is_payload && emptied.ok() && emptied->Truncate(0).ok()) return Forget(upload);
  }
  End(upload);
}

void UploadTable::End(Upload& upload) {
  const std::string& id = upload.description.id;
  // One that stays behind, marked or a payload by now, is removed at the next start.
  if (RemoveFile(PathOf(id)).ok()) removals_.Clear(LabelOf(id));
  Forget(upload);
}

void UploadTable::Forget(Upload& upload) {
  upload.has_ended = true;
  space_.Release(upload.description.payload_bytes, upload.committed_offset);
  const std::lock_guard lock(mutex_);
  uploads_.erase(upload.description.id);
}

uint64_t UploadTable::num_uploads() const {
  const std::lock_guard lock(mutex_);
  return uploads_.size();
}

}  // namespace curvereg::server
