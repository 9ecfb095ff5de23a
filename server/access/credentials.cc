// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
#include "server/access/credentials.h"

#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <string>

#include "absl/strings/str_cat.h"
#include "server/settings/small_file.h"

namespace curvereg::server {
namespace {

using BioPtr = std::unique_ptr<BIO, decltype(&BIO_free)>;
using CertificatePtr = std::unique_ptr<X509, decltype(&X509_free)>;
using KeyPtr = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;

// Without it OpenSSL would ask for a locked key's password on the terminal.
int NoPassword(char* /*buffer*/, int /*size*/, int /*is_writing*/, void* /*user_data*/) { return 0; }

BioPtr Open(const std::string& pem) { return {BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())), &BIO_free}; }

CertificatePtr FirstCertificate(const std::string& pem) {
  const BioPtr bio = Open(pem);
  return {PEM_read_bio_X509(bio.get(), nullptr, NoPassword, nullptr), &X509_free};
}

KeyPtr PrivateKey(const std::string& pem) {
  const BioPtr bio = Open(pem);
  return {PEM_read_bio_PrivateKey(bio.get(), nullptr, NoPassword, nullptr), &EVP_PKEY_free};
}

absl::Status Invalid(const char* setting, const std::string& text) {
  return absl::InvalidArgumentError(absl::StrCat(setting, ": ", text));
}

absl::StatusOr<std::string> ReadPem(const char* setting, const std::string& path) {
  absl::StatusOr<std::string> pem = ReadSmallFile(path);
  if (!pem.ok()) return Invalid(setting, std::string(pem.status().message()));
  return pem;
}

// gRPC's watcher only logs what it cannot read and then refuses every connection: better not to start.
absl::Status CheckFiles(const TlsConfig& config) {
  const absl::StatusOr<std::string> certificate_pem = ReadPem("tls.certificate_file", config.certificate_file);
  if (!certificate_pem.ok()) return certificate_pem.status();
  const absl::StatusOr<std::string> key_pem = ReadPem("tls.key_file", config.key_file);
  if (!key_pem.ok()) return key_pem.status();
  const CertificatePtr certificate = FirstCertificate(*certificate_pem);
  if (certificate == nullptr) return Invalid("tls.certificate_file", config.certificate_file + ": no PEM certificate");
  const KeyPtr key = PrivateKey(*key_pem);
  if (key == nullptr) return Invalid("tls.key_file", config.key_file + ": no PEM private key without a password");
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    return Invalid("tls.key_file", config.key_file + " is not the key of " + config.certificate_file);
  }
  if (config.client_ca_file.empty()) return absl::OkStatus();
  const absl::StatusOr<std::string> ca_pem = ReadPem("tls.client_ca_file", config.client_ca_file);
  if (!ca_pem.ok()) return ca_pem.status();
  if (FirstCertificate(*ca_pem) != nullptr) return absl::OkStatus();
  return Invalid("tls.client_ca_file", config.client_ca_file + ": no PEM certificate");
}

}  // namespace

absl::StatusOr<std::shared_ptr<grpc::ServerCredentials>> MakeServerCredentials(const TlsConfig& config) {
  if (config.certificate_file.empty()) return grpc::InsecureServerCredentials();
  const absl::Status files = CheckFiles(config);
  ERR_clear_error();  // OpenSSL's queue of this thread is shared with gRPC
  if (!files.ok()) return files;
  const auto provider = std::make_shared<grpc::experimental::FileWatcherCertificateProvider>(
      config.key_file, config.certificate_file, config.client_ca_file,
      static_cast<unsigned>(config.reload_seconds < 1 ? 1 : config.reload_seconds));
  grpc::experimental::TlsServerCredentialsOptions options(provider);
  options.watch_identity_key_cert_pairs();
  if (config.client_ca_file.empty()) {
    options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  } else {
    options.watch_root_certs();
    options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace curvereg::server
