// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/access/access.h"

#include <openssl/crypto.h>
#include <openssl/rand.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/access/token_file.h"
#include "server/settings/small_file.h"
#include "wire/digest.h"
#include "wire/error.h"

namespace curvereg::server {
namespace {

constexpr std::array kScopes = {Scope::kRead, Scope::kWrite, Scope::kAdmin};
constexpr std::string_view kBearer = "bearer ";
constexpr std::size_t kTokenBytes = 32;
constexpr std::size_t kMaxNameBytes = 64;

class OpenAccess final : public Access {
 public:
  absl::StatusOr<std::string> Check(std::string_view /*authorization*/, Scope /*needed*/) const override {
    return std::string();
  }
};

// The token of "Bearer TOKEN"; the scheme's case does not matter (RFC 9110, 11.1).
std::string_view TokenOf(std::string_view authorization) {
  if (authorization.size() <= kBearer.size()) return {};
  const bool is_bearer = std::equal(kBearer.begin(), kBearer.end(), authorization.begin(),
                                    [](char a, char b) { return a == std::tolower(static_cast<unsigned char>(b)); });
  return is_bearer ? authorization.substr(kBearer.size()) : std::string_view();
}

// Every entry is compared, and wholly, so that the time tells nothing about the tokens.
const TokenEntry* FindToken(const std::vector<TokenEntry>& entries, std::string_view token) {
  const std::string digest = TokenDigest(token);
  const TokenEntry* found = nullptr;
  for (const TokenEntry& entry : entries) {
    if (CRYPTO_memcmp(entry.sha256.data(), digest.data(), digest.size()) == 0) found = &entry;
  }
  return found;
}

class FileAccess final : public Access {
 public:
  FileAccess(std::string path, Logger& logger) : path_(std::move(path)), logger_(logger) {}

  absl::Status Read() {
    absl::StatusOr<std::string> text = ReadSmallFile(path_);
    if (!text.ok()) return text.status();
    const std::lock_guard reading(read_mutex_);
    if (entries_ != nullptr && *text == text_) return absl::OkStatus();
    absl::StatusOr<std::vector<TokenEntry>> entries = ParseTokenFile(*text, path_);
    if (!entries.ok()) return entries.status();
    const auto num_tokens = static_cast<int64_t>(entries->size());
    text_ = *std::move(text);
    {
      const std::lock_guard lock(mutex_);
      entries_ = std::make_shared<const std::vector<TokenEntry>>(*std::move(entries));
    }
    logger_.Info("tokens_read", {{"file", path_}, {"tokens", num_tokens}});
    return absl::OkStatus();
  }

  void KeepReading(std::chrono::seconds interval) {
    reader_ = std::jthread([this, interval](const std::stop_token& stop) {
      std::mutex mutex;
      std::unique_lock lock(mutex);
      std::condition_variable_any woken;
      std::string last_error;
      while (!woken.wait_for(lock, stop, interval, [&stop] { return stop.stop_requested(); })) {
        const absl::Status status = Read();
        const std::string error(status.message());
        if (error != last_error && !status.ok()) {
          logger_.Error("tokens_not_read", {{"file", path_}, {"message", error}});
        }
        last_error = error;
      }
    });
  }

  absl::StatusOr<std::string> Check(std::string_view authorization, Scope needed) const override {
    const std::string_view token = TokenOf(authorization);
    std::shared_ptr<const std::vector<TokenEntry>> entries;
    {
      const std::lock_guard lock(mutex_);
      entries = entries_;
    }
    const TokenEntry* entry = token.empty() ? nullptr : FindToken(*entries, token);
    if (entry == nullptr) {
      return wire::MakeError(v1::ERROR_REASON_UNAUTHENTICATED,
                             token.empty() ? "a bearer token is needed" : "the token is not known");
    }
    if (entry->scope < needed) {
      return wire::MakeError(v1::ERROR_REASON_SCOPE_MISSING,
                             absl::StrCat("the token lacks the scope \"", ScopeName(needed).data(), "\""),
                             {{"scope", std::string(ScopeName(needed))}});
    }
    return entry->name;
  }

 private:
  const std::string path_;
  Logger& logger_;
  std::mutex read_mutex_;
  std::string text_;  // as last read well
  mutable std::mutex mutex_;
  std::shared_ptr<const std::vector<TokenEntry>> entries_;
  std::jthread reader_;  // last: ends before what it uses
};

}  // namespace

std::unique_ptr<Access> Access::Open() { return std::make_unique<OpenAccess>(); }

absl::StatusOr<std::unique_ptr<Access>> Access::FromFile(const std::string& path, int reload_seconds, Logger& logger) {
  auto access = std::make_unique<FileAccess>(path, logger);
  const absl::Status status = access->Read();
  if (!status.ok()) return absl::InvalidArgumentError(absl::StrCat("token_file: ", status.message()));
  access->KeepReading(std::chrono::seconds(std::max(1, reload_seconds)));
  return access;
}

std::string_view ScopeName(Scope scope) {
  switch (scope) {
    case Scope::kRead:
      return "read";
    case Scope::kWrite:
      return "write";
    case Scope::kAdmin:
      return "admin";
  }
  return "";
}

std::optional<Scope> ScopeFromName(std::string_view name) {
  for (const Scope scope : kScopes) {
    if (ScopeName(scope) == name) return scope;
  }
  return std::nullopt;
}

bool IsTokenName(std::string_view name) {
  return !name.empty() && name.size() <= kMaxNameBytes && std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
           std::string_view("-_.@").find(c) != std::string_view::npos;
  });
}

std::string TokenDigest(std::string_view token) { return wire::DigestOf(v1::DIGEST_ALGORITHM_SHA256, token).value(); }

absl::StatusOr<NewToken> MakeToken(std::string_view name, Scope scope) {
  if (!IsTokenName(name)) {
    return absl::InvalidArgumentError(
        absl::StrCat("\"", std::string(name), "\" is not a name: 1 to ", kMaxNameBytes, " of a-z A-Z 0-9 - _ . @"));
  }
  std::array<unsigned char, kTokenBytes> random{};
  if (RAND_bytes(random.data(), static_cast<int>(random.size())) != 1) {
    return absl::InternalError("the system gives no random numbers");
  }
  NewToken result;
  result.token = "cvr_" + wire::HexText({reinterpret_cast<const char*>(random.data()), random.size()});
  result.toml = absl::StrCat("[[token]]\nname = \"", std::string(name), "\"\nscope = \"", ScopeName(scope).data(),
                             "\"\nsha256 = \"", wire::HexText(TokenDigest(result.token)), "\"\n");
  return result;
}

}  // namespace curvereg::server
