// The asset service as a reader sees it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace grpc {
class ChannelInterface;
}

namespace nocturne {

/// For all threads.
class AssetSource {
 public:
  using OnSize = std::function<void(std::uint64_t total_bytes)>;
  using OnBytes = std::function<void(std::string_view bytes)>;

  /// `target` in gRPC's words: host:port or unix:/path. With `authorities`, certificates in PEM, by
  /// TLS, to a service whose certificate one of them signed. Connects when first used.
  explicit AssetSource(const std::string& target, const std::string& authorities = "");

  /// Reads a file once: calls `on_size`, then `on_bytes` in order. An exception that they throw
  /// ends the call. Throws AssetUnavailable (try later) or AssetError.
  void fetch(const std::string& sha256, const OnSize& on_size, const OnBytes& on_bytes) const;

 private:
  std::shared_ptr<grpc::ChannelInterface> channel_;
};

}  // namespace nocturne
