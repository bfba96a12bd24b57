// Files by SHA-256 on the local disk, fetched from the asset service when they are not there.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "assets/asset_source.h"
#include "assets/load_once.h"
#include "assets/sealed_file.h"

namespace nocturne {

struct AssetCacheOptions {
  /// Created if it does not exist. May be shared by several processes.
  std::filesystem::path folder;
  /// In gRPC's words: host:port or unix:/path.
  std::string service;
  /// PEM file of certificate authorities, one of which signed the service's certificate. Empty: no
  /// TLS.
  std::filesystem::path authorities{};
  /// A larger file is refused before anything of it is written.
  std::uint64_t max_asset_bytes = std::uint64_t{8} << 30;
  /// When all files together have more, those not used for longest are removed.
  std::uint64_t max_cache_bytes = std::uint64_t{64} << 30;
  /// Calls for one file before giving up, and the pause after the first; it doubles up to 2 s.
  int attempts = 6;
  std::chrono::milliseconds first_pause{100};
};

/// The text of a PEM file; empty where no path is given. Throws AssetUnavailable.
std::string authorities_in(const std::filesystem::path& path);

/// For all threads; a file that several ask for at once is fetched once.
class AssetCache {
 public:
  /// Throws AssetUnavailable if the folder can't be made, or the authorities can't be read.
  explicit AssetCache(AssetCacheOptions options);

  /// The bytes of a file as they were when their digest was checked: others may write to the disk.
  /// While somebody has them, all who ask get the same. `sha256`: 64 lower-case hexadecimal
  /// digits. Throws AssetUnavailable (this worker, now) or AssetError (nobody, ever; also for a bad
  /// digest).
  std::shared_ptr<const SealedFile> find(const std::string& sha256);

 private:
  using Held = std::shared_ptr<const SealedFile>;

  Held checked_or_fetched(const std::string& sha256);
  Held held(const std::string& sha256);
  void hold(const std::string& sha256, const Held& file);
  void fetch_with_retries(const std::string& sha256, const std::filesystem::path& target);
  void fetch(const std::string& sha256, const std::filesystem::path& target);
  void remove_abandoned_downloads();
  void trim();

  AssetCacheOptions options_;
  AssetSource source_;
  /// Calls for one file at the same time.
  LoadOnce<Held> at_work_;
  std::mutex mutex_;
  /// Those that somebody has.
  std::map<std::string, std::weak_ptr<const SealedFile>> held_;
};

}  // namespace nocturne
