#include "assets/asset_cache.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <thread>
#include <vector>

#include "assets/asset_service.h"
#include "assets/errors.h"

namespace nocturne {
namespace {

namespace fs = std::filesystem;

std::string content(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string content(const std::shared_ptr<const SealedFile>& file) { return content(file->path()); }

std::string many_bytes() {
  std::string bytes(350001, '\0');
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * i % 251);
  return bytes;
}

void change_a_byte(const fs::path& path) {
  {
    std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
    file.seekp(175000);
    file.put('\x7f');
  }
  ASSERT_NE(content(path), many_bytes());
}

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "nocturne-assets-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

class AssetCacheTest : public testing::Test {
 protected:
  AssetCacheOptions options() {
    return {.folder = folder_.path() / "cache",
            .service = service_.target(),
            .attempts = 3,
            .first_pause = std::chrono::milliseconds(20)};
  }

  fs::path cached(const std::string& sha) {
    return folder_.path() / "cache" / sha.substr(0, 2) / sha;
  }

  std::size_t files_in_cache() {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path() / "cache")) {
      if (entry.is_regular_file()) ++count;
    }
    return count;
  }

  TemporaryFolder folder_;
  test::AssetService service_{folder_.path()};
};

TEST_F(AssetCacheTest, FetchesOnceForAllTime) {
  const std::string sha = service_.put(many_bytes());
  {
    AssetCache cache(options());
    EXPECT_EQ(content(cache.find(sha)), many_bytes());
    EXPECT_EQ(content(cached(sha)), many_bytes());
    EXPECT_EQ(content(cache.find(sha)), many_bytes());
  }
  EXPECT_EQ(content(AssetCache(options()).find(sha)), many_bytes());
  EXPECT_EQ(service_.calls, 1);
  EXPECT_EQ(files_in_cache(), 1U);
}

TEST_F(AssetCacheTest, ThreadsShareOneFetch) {
  const std::string sha = service_.put(many_bytes());
  service_.delay_ms = 100;
  AssetCache cache(options());
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&] { EXPECT_EQ(content(cache.find(sha)), many_bytes()); });
    }
  }
  EXPECT_EQ(service_.calls, 1);
}

// Two caches on one folder stand for two processes.
TEST_F(AssetCacheTest, ProcessesShareTheFolder) {
  const std::string sha = service_.put(many_bytes());
  service_.delay_ms = 100;
  AssetCache a(options());
  AssetCache b(options());
  {
    std::jthread first([&] { EXPECT_EQ(content(a.find(sha)), many_bytes()); });
    std::jthread second([&] { EXPECT_EQ(content(b.find(sha)), many_bytes()); });
  }
  EXPECT_EQ(files_in_cache(), 1U);
}

TEST_F(AssetCacheTest, WhatWasNotUsedForLongestIsRemoved) {
  std::vector<std::string> shas;
  for (const char c : {'a', 'b', 'c', 'd'}) shas.push_back(service_.put(std::string(1000, c)));
  AssetCacheOptions small = options();
  small.max_cache_bytes = 3000;
  AssetCache cache(small);
  const auto hours_ago = [&](const std::string& sha, int hours) {
    cache.find(sha);
    fs::last_write_time(cached(sha), fs::file_time_type::clock::now() - std::chrono::hours(hours));
  };
  hours_ago(shas[0], 1);
  hours_ago(shas[1], 3);
  hours_ago(shas[2], 2);
  cache.find(shas[0]);
  const fs::path stranger = folder_.path() / "cache" / "notes.txt";
  std::ofstream(stranger) << std::string(5000, 'x');
  cache.find(shas[3]);
  EXPECT_EQ(files_in_cache(), 4U);
  EXPECT_TRUE(fs::exists(stranger));
  EXPECT_FALSE(fs::exists(cached(shas[1])));
  // It is there again for who needs it.
  EXPECT_EQ(content(cache.find(shas[1])), std::string(1000, 'b'));
  // At least the newest stays, or nothing could be traced.
  small.max_cache_bytes = 1;
  EXPECT_EQ(content(AssetCache(small).find(shas[1])), std::string(1000, 'b'));
  EXPECT_EQ(files_in_cache(), 2U);
}

TEST_F(AssetCacheTest, EmptyFile) {
  const std::string sha = service_.put("");
  AssetCache cache(options());
  EXPECT_EQ(fs::file_size(cache.find(sha)->path()), 0U);
}

TEST_F(AssetCacheTest, MissingFileIsAnErrorAtOnce) {
  AssetCache cache(options());
  try {
    cache.find(std::string(64, 'a'));
    FAIL() << "found";
  } catch (const AssetUnavailable&) {
    FAIL() << "another worker will not find it either";
  } catch (const AssetError& error) {
    EXPECT_NE(std::string(error.what()).find(std::string(64, 'a')), std::string::npos);
  }
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(AssetCacheTest, NameThatIsNoDigestIsRefused) {
  AssetCache cache(options());
  const std::string escaping = "../" + std::string(61, 'a');
  for (const std::string& name : {std::string(), escaping, std::string(64, 'A')}) {
    EXPECT_THROW(cache.find(name), AssetError);
  }
  EXPECT_EQ(service_.calls, 0);
}

TEST_F(AssetCacheTest, OtherBytesAreRefusedAndLeaveNothing) {
  const std::string sha(64, 'b');
  service_.put_as(sha, many_bytes());
  AssetCache cache(options());
  EXPECT_THROW(cache.find(sha), AssetDamaged);
  EXPECT_EQ(service_.calls, 3);
  EXPECT_EQ(files_in_cache(), 0U);
}

TEST_F(AssetCacheTest, TruncatedFileIsRefusedAndLeavesNothing) {
  const std::string sha = service_.put(many_bytes());
  service_.announced_too_many = 1;
  AssetCache cache(options());
  EXPECT_THROW(cache.find(sha), AssetDamaged);
  EXPECT_EQ(files_in_cache(), 0U);
  service_.announced_too_many = 0;
  EXPECT_EQ(content(cache.find(sha)), many_bytes());
}

TEST_F(AssetCacheTest, MoreBytesThanAnnouncedAreRefused) {
  const std::string sha = service_.put(many_bytes());
  service_.announced_too_many = -1;
  AssetCache cache(options());
  EXPECT_THROW(cache.find(sha), AssetDamaged);
  EXPECT_EQ(files_in_cache(), 0U);
}

TEST_F(AssetCacheTest, InterruptedFetchIsTriedAgain) {
  const std::string sha = service_.put(many_bytes());
  service_.interruptions = 2;
  AssetCache cache(options());
  EXPECT_EQ(content(cache.find(sha)), many_bytes());
  EXPECT_EQ(service_.calls, 3);
  EXPECT_EQ(files_in_cache(), 1U);
}

TEST_F(AssetCacheTest, ServiceThatIsAwayIsUnavailableUntilItIsBack) {
  const std::string sha = service_.put(many_bytes());
  service_.stop();
  AssetCache cache(options());
  EXPECT_THROW(cache.find(sha), AssetUnavailable);
  service_.start();
  AssetCacheOptions patient = options();
  patient.attempts = 20;
  EXPECT_EQ(content(AssetCache(patient).find(sha)), many_bytes());
}

TEST_F(AssetCacheTest, TooLargeIsRefusedBeforeAnythingIsWritten) {
  const std::string sha = service_.put(many_bytes());
  AssetCacheOptions small = options();
  small.max_asset_bytes = many_bytes().size() - 1;
  AssetCache cache(small);
  try {
    cache.find(sha);
    FAIL() << "accepted";
  } catch (const AssetError& error) {
    EXPECT_NE(std::string(error.what()).find("--max-asset-bytes"), std::string::npos);
  }
  EXPECT_EQ(service_.calls, 1);
  EXPECT_EQ(files_in_cache(), 0U);
}

TEST_F(AssetCacheTest, DiskThatIsTooSmallMakesItUnavailable) {
  const std::string sha = service_.put(many_bytes());
  service_.announced_too_many = std::int64_t{1} << 60;
  AssetCacheOptions large = options();
  large.max_asset_bytes = std::uint64_t{1} << 62;
  AssetCache cache(large);
  EXPECT_THROW(cache.find(sha), AssetUnavailable);
  EXPECT_EQ(files_in_cache(), 0U);
}

TEST_F(AssetCacheTest, DamagedFileInTheCacheIsFetchedAgain) {
  const std::string sha = service_.put(many_bytes());
  AssetCache(options()).find(sha);
  std::ofstream(cached(sha), std::ios::binary | std::ios::in).put('!');
  ASSERT_NE(content(cached(sha)), many_bytes());
  EXPECT_EQ(content(AssetCache(options()).find(sha)), many_bytes());
  EXPECT_EQ(service_.calls, 2);
}

TEST_F(AssetCacheTest, FileDamagedAfterItWasCheckedIsFetchedAgain) {
  const std::string sha = service_.put(many_bytes());
  AssetCache cache(options());
  cache.find(sha);
  change_a_byte(cached(sha));
  EXPECT_EQ(content(cache.find(sha)), many_bytes());
  EXPECT_EQ(service_.calls, 2);
}

// Every holder of the file, mapped, open or by its name, sees the checked content.
TEST_F(AssetCacheTest, FileChangedInPlaceIsAsItWasForWhoHasIt) {
  const std::string sha = service_.put(many_bytes());
  AssetCache cache(options());
  const auto file = cache.find(sha);
  std::ifstream opened(file->path(), std::ios::binary);
  const int descriptor = open(file->path().c_str(), O_RDONLY);
  const std::size_t size = many_bytes().size();
  void* mapped = mmap(nullptr, size, PROT_READ, MAP_SHARED, descriptor, 0);
  ASSERT_NE(mapped, MAP_FAILED);
  close(descriptor);
  change_a_byte(cached(sha));
  EXPECT_EQ(std::string(static_cast<const char*>(mapped), size), many_bytes());
  munmap(mapped, size);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(opened), {}), many_bytes());
  EXPECT_EQ(content(file), many_bytes());
  EXPECT_EQ(cache.find(sha), file);
  EXPECT_EQ(service_.calls, 1);
}

TEST_F(AssetCacheTest, NobodyCanWriteToWhatWasChecked) {
  const auto file = AssetCache(options()).find(service_.put(many_bytes()));
  const int descriptor = open(file->path().c_str(), O_RDWR);
  ASSERT_GE(descriptor, 0);
  EXPECT_EQ(write(descriptor, "x", 1), -1);
  EXPECT_EQ(errno, EPERM);
  EXPECT_EQ(ftruncate(descriptor, 0), -1);
  EXPECT_EQ(mmap(nullptr, 1, PROT_WRITE, MAP_SHARED, descriptor, 0), MAP_FAILED);
  close(descriptor);
}

TEST_F(AssetCacheTest, FileThatVanishedIsFetchedAgain) {
  const std::string sha = service_.put(many_bytes());
  AssetCache cache(options());
  cache.find(sha);
  fs::remove(cached(sha));
  EXPECT_EQ(content(cache.find(sha)), many_bytes());
}

TEST_F(AssetCacheTest, CacheThatCannotBeMadeIsUnavailable) {
  std::ofstream(folder_.path() / "file") << "x";
  AssetCacheOptions impossible = options();
  impossible.folder = folder_.path() / "file" / "cache";
  EXPECT_THROW(AssetCache cache(impossible), AssetUnavailable);
}

TEST_F(AssetCacheTest, OldDownloadsOfKilledProcessesAreRemoved) {
  const fs::path cache = folder_.path() / "cache";
  fs::create_directories(cache);
  std::ofstream(cache / ".fetch-old") << "x";
  std::ofstream(cache / ".fetch-new") << "x";
  fs::last_write_time(cache / ".fetch-old",
                      fs::file_time_type::clock::now() - std::chrono::hours(2));
  const AssetCache started(options());
  EXPECT_FALSE(fs::exists(cache / ".fetch-old"));
  EXPECT_TRUE(fs::exists(cache / ".fetch-new"));
}

}  // namespace
}  // namespace nocturne
