#include "assets/asset_source.h"

#include <chrono>

#include "assets/errors.h"
#include "assets/service_channel.h"
#include "nocturne/v1/asset_service.grpc.pb.h"

namespace nocturne {
namespace {

// A call that makes no progress must end. The largest asset (8 GiB) in this time is 5 MB/s.
constexpr std::chrono::minutes kDeadline{30};

[[noreturn]] void throw_status(const std::string& sha256, const grpc::Status& status) {
  const std::string text = "asset " + sha256 + ": " + status.error_message() + " (gRPC status " +
                           std::to_string(status.error_code()) + ")";
  if (may_pass(status)) throw AssetUnavailable(text);
  if (status.error_code() == grpc::StatusCode::NOT_FOUND) {
    throw AssetError("asset " + sha256 + " is not in the service's store");
  }
  throw AssetError(text);
}

}  // namespace

AssetSource::AssetSource(const std::string& target, const std::string& authorities)
    : channel_(service_channel(target, authorities)) {}

void AssetSource::fetch(const std::string& sha256, const OnSize& on_size,
                        const OnBytes& on_bytes) const {
  grpc::ClientContext context;  // Its end cancels a call that is not finished.
  context.set_deadline(std::chrono::system_clock::now() + kDeadline);
  add_token(context);
  v1::FetchRequest request;
  request.set_sha256(sha256);
  const auto stub = v1::AssetService::NewStub(channel_);
  const auto reader = stub->Fetch(&context, request);
  v1::Chunk chunk;
  bool first = true;
  try {
    while (reader->Read(&chunk)) {
      if (first) on_size(chunk.total_bytes());
      first = false;
      on_bytes(chunk.data());
    }
  } catch (...) {
    context.TryCancel();
    reader->Finish();
    throw;
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) throw_status(sha256, status);
  // An empty file has no chunk to announce its size.
  if (first) on_size(0);
}

}  // namespace nocturne
