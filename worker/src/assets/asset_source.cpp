#include "assets/asset_source.h"

#include <grpc/grpc.h>
#include <grpcpp/grpcpp.h>

#include <chrono>
#include <cstdlib>

#include "assets/errors.h"
#include "nocturne/v1/asset_service.grpc.pb.h"

namespace nocturne {
namespace {

// A call that makes no progress must end. The largest asset (8 GiB) in this time is 5 MB/s.
constexpr std::chrono::minutes kDeadline{30};
// Above what a sensible service sends as one chunk, and all that a bad one can make us hold.
constexpr int kMaxChunkBytes = 16 << 20;
// gRPC's own default waits up to two minutes between attempts to connect.
constexpr int kLongestReconnectMs = 2000;

/// gRPC 1.51 may wait ten seconds for a poller of its own when its last object goes; a worker that
/// is told to stop doesn't have them. So gRPC stays until the process ends.
void keep_grpc() {
  static const bool kept = (grpc_init(), true);
  static_cast<void>(kept);
}

std::shared_ptr<grpc::Channel> make_channel(const std::string& target,
                                            const std::string& authorities) {
  keep_grpc();
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxChunkBytes);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kLongestReconnectMs);
  // The service is where Redis is; a web proxy is not on the way.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  const auto credentials =
      authorities.empty()
          ? grpc::InsecureChannelCredentials()
          : grpc::SslCredentials(
                {.pem_root_certs = authorities, .pem_private_key = "", .pem_cert_chain = ""});
  return grpc::CreateCustomChannel(target, credentials, arguments);
}

[[noreturn]] void throw_status(const std::string& sha256, const grpc::Status& status) {
  const std::string text = "asset " + sha256 + ": " + status.error_message() + " (gRPC status " +
                           std::to_string(status.error_code()) + ")";
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::DEADLINE_EXCEEDED:
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
    case grpc::StatusCode::CANCELLED:
    case grpc::StatusCode::UNAUTHENTICATED:
    case grpc::StatusCode::PERMISSION_DENIED:
      throw AssetUnavailable(text);
    case grpc::StatusCode::NOT_FOUND:
      throw AssetError("asset " + sha256 + " is not in the service's store");
    default:
      throw AssetError(text);
  }
}

}  // namespace

AssetSource::AssetSource(const std::string& target, const std::string& authorities)
    : channel_(make_channel(target, authorities)) {}

void AssetSource::fetch(const std::string& sha256, const OnSize& on_size,
                        const OnBytes& on_bytes) const {
  grpc::ClientContext context;  // Its end cancels a call that is not finished.
  context.set_deadline(std::chrono::system_clock::now() + kDeadline);
  if (const char* token = std::getenv("NOCTURNE_TOKEN")) {
    context.AddMetadata("authorization", std::string("Bearer ") + token);
  }
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
