#include "assets/asset_service.h"

#include <grpcpp/grpcpp.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <thread>

#include "digest/sha256.h"

namespace nocturne::test {

AssetService::AssetService(const std::filesystem::path& folder)
    : target_("unix:" + (folder / "assets.sock").string()) {
  start();
}

AssetService::~AssetService() { stop(); }

void AssetService::start() {
  grpc::ServerBuilder builder;
  builder.AddListeningPort(target_, grpc::InsecureServerCredentials());
  builder.RegisterService(this);
  server_ = builder.BuildAndStart();
  if (server_ == nullptr) throw std::runtime_error("the asset service does not start");
}

void AssetService::stop() {
  if (server_ == nullptr) return;
  server_->Shutdown(std::chrono::system_clock::now());
  server_->Wait();
  server_.reset();
}

std::string AssetService::put(const std::string& bytes) {
  Sha256 digest;
  digest.update(bytes);
  std::string sha256 = digest.hex();
  put_as(sha256, bytes);
  return sha256;
}

grpc::Status AssetService::Fetch(grpc::ServerContext* /*context*/, const v1::FetchRequest* request,
                                 grpc::ServerWriter<v1::Chunk>* writer) {
  constexpr std::size_t kChunkBytes = 100000;
  ++calls;
  std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
  const auto file = files_.find(request->sha256());
  if (file == files_.end()) return {grpc::StatusCode::NOT_FOUND, "no such asset"};
  const std::string& bytes = file->second;
  const bool interrupted = interruptions-- > 0;
  for (std::size_t at = 0; at < bytes.size(); at += kChunkBytes) {
    v1::Chunk chunk;
    if (at == 0) {
      chunk.set_total_bytes(
          static_cast<std::uint64_t>(static_cast<std::int64_t>(bytes.size()) + announced_too_many));
    }
    chunk.set_data(bytes.substr(at, kChunkBytes));
    if (!writer->Write(chunk)) break;
    if (interrupted) return {grpc::StatusCode::UNAVAILABLE, "going away"};
  }
  return grpc::Status::OK;
}

}  // namespace nocturne::test
