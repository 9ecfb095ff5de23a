// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "wire/digest.h"

#include <isa-l/crc.h>
#include <openssl/evp.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <utility>

#ifdef __x86_64__
#include <xxh_x86dispatch.h>  // the processor's widest instructions, found at run time
#else
#include <xxhash.h>
#endif

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/simd.h"
#include "wire/error.h"

namespace curvereg::wire {
namespace {

// Bytes of a digest's value; 0 for algorithms that we do not know.
size_t DigestSize(v1::DigestAlgorithm algorithm) {
  switch (algorithm) {
    case v1::DIGEST_ALGORITHM_XXH3_128:
      return sizeof(XXH128_canonical_t);
    case v1::DIGEST_ALGORITHM_SHA256:
      return 32;
    default:
      return 0;
  }
}

absl::Status UnknownAlgorithm() { return FieldError("algorithm", "neither XXH3_128 nor SHA256"); }

std::string CanonicalBytes(XXH128_hash_t hash) {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, hash);
  return {reinterpret_cast<const char*>(canonical.digest), sizeof(canonical.digest)};
}

struct FreeState {
  void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  void operator()(EVP_MD_CTX* context) const { EVP_MD_CTX_free(context); }
};
using Sha256Context = std::unique_ptr<EVP_MD_CTX, FreeState>;

// SHA-256 of what went into the context; empty where OpenSSL fails, which equals no digest.
std::string FinishSha256(const EVP_MD_CTX* context) {
  const Sha256Context copy(EVP_MD_CTX_new());  // finishing ends a context
  unsigned char value[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  if (copy == nullptr || EVP_MD_CTX_copy_ex(copy.get(), context) != 1) return {};
  if (EVP_DigestFinal_ex(copy.get(), value, &size) != 1) return {};
  return {reinterpret_cast<const char*>(value), size};
}

}  // namespace

uint32_t Crc32c(std::string_view bytes) { return ExtendCrc32c(0, bytes); }

uint32_t ExtendCrc32c(uint32_t crc, std::string_view bytes) {
  constexpr size_t kMostAtOnce = size_t{1} << 30;  // the function counts in int
  crc = ~crc;
  while (!bytes.empty()) {
    const size_t size = std::min(bytes.size(), kMostAtOnce);
    // The function asks for bytes that it may write, and only reads.
    auto* data = reinterpret_cast<unsigned char*>(const_cast<char*>(bytes.data()));
    crc = crc32_iscsi(data, static_cast<int>(size), crc);
    bytes.remove_prefix(size);
  }
  ClearUpperVectorHalves();
  return ~crc;
}

// Exactly one of the two is set.
struct Digester::State {
  std::unique_ptr<XXH3_state_t, FreeState> xxh3;
  Sha256Context sha256;
};

Digester::Digester(std::unique_ptr<State> state) : state_(std::move(state)) {}
Digester::Digester(Digester&&) noexcept = default;
Digester& Digester::operator=(Digester&&) noexcept = default;
Digester::~Digester() = default;

absl::StatusOr<Digester> Digester::Create(v1::DigestAlgorithm algorithm) {
  auto state = std::make_unique<State>();
  if (algorithm == v1::DIGEST_ALGORITHM_XXH3_128) {
    state->xxh3.reset(XXH3_createState());
    if (state->xxh3 == nullptr || XXH3_128bits_reset(state->xxh3.get()) != XXH_OK) {
      return absl::ResourceExhaustedError("no memory for a digest");
    }
  } else if (algorithm == v1::DIGEST_ALGORITHM_SHA256) {
    state->sha256.reset(EVP_MD_CTX_new());
    if (state->sha256 == nullptr || EVP_DigestInit_ex(state->sha256.get(), EVP_sha256(), nullptr) != 1) {
      return absl::InternalError("OpenSSL does not give SHA-256");
    }
  } else {
    return UnknownAlgorithm();
  }
  return Digester(std::move(state));
}

void Digester::Update(std::string_view bytes) {
  if (bytes.empty()) return;
  // Both calls fail for null arguments only.
  if (state_->xxh3 != nullptr) {
    XXH3_128bits_update(state_->xxh3.get(), bytes.data(), bytes.size());
    ClearUpperVectorHalves();
  } else {
    EVP_DigestUpdate(state_->sha256.get(), bytes.data(), bytes.size());
  }
}

v1::Digest Digester::Digest() const {
  v1::Digest digest;
  if (state_->xxh3 != nullptr) {
    digest.set_algorithm(v1::DIGEST_ALGORITHM_XXH3_128);
    digest.set_value(CanonicalBytes(XXH3_128bits_digest(state_->xxh3.get())));
    ClearUpperVectorHalves();
  } else {
    digest.set_algorithm(v1::DIGEST_ALGORITHM_SHA256);
    digest.set_value(FinishSha256(state_->sha256.get()));
  }
  return digest;
}

v1::Digest DigestOf(v1::DigestAlgorithm algorithm, std::string_view bytes) {
  assert(DigestSize(algorithm) != 0);
  v1::Digest digest;
  digest.set_algorithm(algorithm);
  if (algorithm == v1::DIGEST_ALGORITHM_XXH3_128) {
    digest.set_value(CanonicalBytes(XXH3_128bits(bytes.data(), bytes.size())));
    ClearUpperVectorHalves();
  } else {
    unsigned char value[EVP_MAX_MD_SIZE];
    unsigned int size = 0;
    if (EVP_Digest(bytes.data(), bytes.size(), value, &size, EVP_sha256(), nullptr) == 1) {
      digest.set_value(value, size);
    }
  }
  return digest;
}

std::optional<uint64_t> Xxh3Of64Bits(const v1::Digest& digest, uint64_t num_bytes) {
  constexpr uint64_t kShort = 240;
  XXH128_canonical_t canonical;
  if (digest.algorithm() != v1::DIGEST_ALGORITHM_XXH3_128 || digest.value().size() != sizeof(canonical.digest)) {
    return std::nullopt;
  }
  if (num_bytes <= kShort) return std::nullopt;
  std::memcpy(canonical.digest, digest.value().data(), sizeof(canonical.digest));
  return XXH128_hashFromCanonical(&canonical).low64;
}

bool SameDigest(const v1::Digest& a, const v1::Digest& b) {
  return a.algorithm() == b.algorithm() && !a.value().empty() && a.value() == b.value();
}

absl::Status ValidateDigest(const v1::Digest& digest) {
  const size_t size = DigestSize(digest.algorithm());
  if (size == 0) return UnknownAlgorithm();
  if (digest.value().size() != size) {
    return FieldError("value", absl::StrCat("has ", digest.value().size(), " bytes; the algorithm gives ", size));
  }
  return absl::OkStatus();
}

std::string HexText(std::string_view bytes) {
  return absl::BytesToHexString(absl::string_view(bytes.data(), bytes.size()));
}

}  // namespace curvereg::wire
