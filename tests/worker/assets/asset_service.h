// An asset service in this process, on a Unix socket, with faults on demand.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "nocturne/v1/asset_service.grpc.pb.h"

namespace nocturne::test {

class AssetService final : public v1::AssetService::Service {
 public:
  /// The socket is made in `folder`.
  explicit AssetService(const std::filesystem::path& folder);
  ~AssetService() override;

  /// Serves these bytes; returns their digest.
  std::string put(const std::string& bytes);

  /// Serves these bytes under this digest, right or wrong.
  void put_as(const std::string& sha256, const std::string& bytes) { files_[sha256] = bytes; }

  std::string target() const { return target_; }

  void start();
  void stop();

  grpc::Status Fetch(grpc::ServerContext* context, const v1::FetchRequest* request,
                     grpc::ServerWriter<v1::Chunk>* writer) override;

  /// Announced bytes minus sent bytes, for every file.
  std::atomic<std::int64_t> announced_too_many = 0;
  /// So many calls end with UNAVAILABLE in the middle of the file.
  std::atomic<int> interruptions = 0;
  /// Time per call.
  std::atomic<int> delay_ms = 0;
  std::atomic<int> calls = 0;

 private:
  std::string target_;
  std::map<std::string, std::string> files_;
  std::unique_ptr<grpc::Server> server_;
};

}  // namespace nocturne::test
