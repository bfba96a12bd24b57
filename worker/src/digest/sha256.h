// SHA-256 of bytes as they come.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

struct evp_md_ctx_st;

namespace nocturne {

class Sha256 {
 public:
  Sha256();
  void update(std::string_view bytes);
  /// 64 lower-case hexadecimal digits; once, at the end.
  std::string hex();

 private:
  struct Free {
    void operator()(evp_md_ctx_st* context) const;
  };
  std::unique_ptr<evp_md_ctx_st, Free> context_;
};

/// Digest of a file's bytes. Throws std::runtime_error if it can't be read.
std::string sha256_of_file(const std::filesystem::path& path);

/// HMAC-SHA-256 (RFC 2104), 32 bytes.
std::string hmac_sha256(std::string_view key, std::string_view bytes);

/// Bytes as lower-case hexadecimal digits.
std::string to_hex(std::string_view bytes);

/// Whether this is the hexadecimal form of a digest: 64 digits, lower case.
bool is_sha256_hex(std::string_view text);

}  // namespace nocturne
