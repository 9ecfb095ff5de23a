// SPDX-FileCopyrightText: 2026 The Curvereg authors
// SPDX-License-Identifier: Apache-2.0
//
// Certificates for a test or benchmark, made by the openssl command.
#ifndef CURVEREG_TESTS_TESTING_CERTIFICATES_H_
#define CURVEREG_TESTS_TESTING_CERTIFICATES_H_

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace curvereg::testing {

// False: GTEST_SKIP() << "the openssl command is missing".
inline bool HasOpenssl() { return std::system("command -v openssl >/dev/null 2>&1") == 0; }

// NAME.pem and NAME.key in a folder, good for two days. Throws std::runtime_error where openssl fails.
class Certificates {
 public:
  explicit Certificates(std::string folder) : folder_(std::move(folder)) {}

  std::string Pem(const std::string& name) const { return folder_ + "/" + name + ".pem"; }
  std::string Key(const std::string& name) const { return folder_ + "/" + name + ".key"; }

  void MakeAuthority(const std::string& name) const {
    Run("req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=" + name + " -keyout " +
        name + ".key -out " + name + ".pem");
  }
  // `names`: of the subject, for example "DNS:localhost,IP:127.0.0.1".
  void MakeLeaf(const std::string& name, const std::string& authority, const std::string& names) const {
    std::ofstream(folder_ + "/extensions") << "subjectAltName=" << names << "\n";
    Run("req -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -subj /CN=" + name + " -keyout " + name +
        ".key -out " + name + ".csr");
    Run("x509 -req -days 2 -in " + name + ".csr -CA " + authority + ".pem -CAkey " + authority +
        ".key -CAcreateserial -extfile extensions -out " + name + ".pem");
  }

 private:
  void Run(const std::string& arguments) const {
    const std::string log = folder_ + "/openssl.log";
    const int status = std::system(("cd '" + folder_ + "' && openssl " + arguments + " >'" + log + "' 2>&1").c_str());
    std::ostringstream text;
    text << std::ifstream(log).rdbuf();
    if (status != 0) throw std::runtime_error("openssl " + arguments + "\n" + text.str());
  }

  const std::string folder_;
};

}  // namespace curvereg::testing

#endif  // CURVEREG_TESTS_TESTING_CERTIFICATES_H_
