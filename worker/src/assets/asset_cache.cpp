#include "assets/asset_cache.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>
#include <system_error>
#include <thread>
#include <vector>

#include "assets/download.h"
#include "assets/errors.h"
#include "digest/sha256.h"
#include "log/log.h"

namespace nocturne {
namespace {

namespace fs = std::filesystem;

// More files at the same time are only checked once more.
constexpr std::size_t kAtOnce = 1024;
constexpr std::chrono::milliseconds kLongestPause{2000};
// A download that still runs has written more recently than this.
constexpr std::chrono::hours kAbandonedAfter{1};

void make_folder(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw AssetUnavailable("cache " + folder.string() + ": " + error.message());
}

}  // namespace

std::string authorities_in(const fs::path& path) {
  if (path.empty()) return "";
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.find("-----BEGIN CERTIFICATE-----") == std::string::npos) {
    throw AssetUnavailable(path.string() + ": has no certificate in PEM, or can't be read");
  }
  return text;
}

AssetCache::AssetCache(AssetCacheOptions options)
    : options_(std::move(options)),
      source_(options_.service, authorities_in(options_.authorities)),
      at_work_(kAtOnce) {
  make_folder(options_.folder);
  remove_abandoned_downloads();
  trim();
}

std::shared_ptr<const SealedFile> AssetCache::find(const std::string& sha256) {
  // It becomes part of a path.
  if (!is_sha256_hex(sha256)) throw AssetError("not a SHA-256 in hexadecimal: " + sha256);
  return at_work_.get(sha256, [this](const std::string& key) {
    Held found = held(key);
    if (!found) hold(key, found = checked_or_fetched(key));
    // Who asks from here on finds it held, or wants it checked again.
    at_work_.forget(key);
    return found;
  });
}

AssetCache::Held AssetCache::held(const std::string& sha256) {
  const std::lock_guard lock(mutex_);
  const auto found = held_.find(sha256);
  return found == held_.end() ? nullptr : found->second.lock();
}

void AssetCache::hold(const std::string& sha256, const Held& file) {
  const std::lock_guard lock(mutex_);
  std::erase_if(held_, [](const auto& each) { return each.second.expired(); });
  held_[sha256] = file;
}

AssetCache::Held AssetCache::checked_or_fetched(const std::string& sha256) {
  const fs::path target = options_.folder / sha256.substr(0, 2) / sha256;
  std::error_code error;
  Held found = SealedFile::copy(target, sha256, options_.max_asset_bytes);
  if (!found) {
    if (fs::exists(target, error)) {
      log_line(LogLevel::kWarning,
               "cache file " + target.string() + " is damaged: fetching it again");
    }
    fetch_with_retries(sha256, target);
    found = SealedFile::copy(target, sha256, options_.max_asset_bytes);
  }
  if (!found) {
    throw AssetUnavailable("cache file " + target.string() +
                           " was damaged as soon as it was there");
  }
  // Its time says when it was last used; a folder that can't be written is only trimmed less well.
  fs::last_write_time(target, fs::file_time_type::clock::now(), error);
  return found;
}

void AssetCache::fetch_with_retries(const std::string& sha256, const fs::path& target) {
  auto pause = options_.first_pause;
  for (int attempt = 1;; ++attempt) {
    try {
      return fetch(sha256, target);
    } catch (const AssetUnavailable&) {
      if (attempt >= options_.attempts) throw;
    } catch (const AssetDamaged&) {
      if (attempt >= options_.attempts) throw;
    }
    std::this_thread::sleep_for(pause);
    pause = std::min(2 * pause, kLongestPause);
  }
}

void AssetCache::fetch(const std::string& sha256, const fs::path& target) {
  make_folder(target.parent_path());
  std::optional<Download> download;
  source_.fetch(
      sha256,
      [&](std::uint64_t total_bytes) {
        if (total_bytes > options_.max_asset_bytes) {
          throw AssetError("asset " + sha256 + " has " + std::to_string(total_bytes) +
                           " bytes, this worker takes at most " +
                           std::to_string(options_.max_asset_bytes) + " (--max-asset-bytes)");
        }
        download.emplace(options_.folder, sha256, total_bytes);
      },
      [&](std::string_view bytes) { download->write(bytes); });
  download->commit(target);
  trim();
}

void AssetCache::remove_abandoned_downloads() {
  const auto limit = fs::file_time_type::clock::now() - kAbandonedAfter;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(options_.folder, error)) {
    if (!entry.path().filename().string().starts_with(Download::kPrefix)) continue;
    const auto written = entry.last_write_time(error);
    if (!error && written < limit) fs::remove(entry.path(), error);
  }
}

// Who has a removed file open goes on reading it; who looks for it fetches it again.
void AssetCache::trim() {
  struct File {
    fs::file_time_type used;
    std::uint64_t bytes;
    fs::path path;
  };
  std::vector<File> files;
  std::uint64_t bytes = 0;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(options_.folder, error), end; entry != end && !error;
       entry.increment(error)) {
    // Another process may remove it just now.
    std::error_code gone;
    if (!is_sha256_hex(entry->path().filename().string())) continue;
    const File file{entry->last_write_time(gone), entry->file_size(gone), entry->path()};
    if (gone) continue;
    files.push_back(file);
    bytes += file.bytes;
  }
  std::ranges::sort(files, {}, &File::used);
  // The newest stays, however large: it is wanted now.
  for (std::size_t i = 0; i + 1 < files.size() && bytes > options_.max_cache_bytes; ++i) {
    if (fs::remove(files[i].path, error)) bytes -= files[i].bytes;
  }
}

}  // namespace nocturne
