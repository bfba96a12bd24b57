#include "assets/service_channel.h"

#include <grpc/grpc.h>

#include <cstdlib>

namespace nocturne {
namespace {

// Above what a sensible service sends as one chunk, and all that a bad one can make us hold.
constexpr int kMaxChunkBytes = 16 << 20;
// gRPC's own default waits up to two minutes between attempts to connect.
constexpr int kLongestReconnectMs = 2000;

/// gRPC 1.51 may wait ten seconds for its poller when its last object goes; a worker that
/// is asked to stop doesn't have them. So gRPC stays until the process ends.
void keep_grpc() {
  static const bool kept = (grpc_init(), true);
  static_cast<void>(kept);
}

}  // namespace

std::shared_ptr<grpc::Channel> service_channel(const std::string& target,
                                               const std::string& authorities) {
  keep_grpc();
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxChunkBytes);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kLongestReconnectMs);
  // The service is where Redis is; there is no web proxy in between.
  arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  const auto credentials =
      authorities.empty()
          ? grpc::InsecureChannelCredentials()
          : grpc::SslCredentials(
                {.pem_root_certs = authorities, .pem_private_key = "", .pem_cert_chain = ""});
  return grpc::CreateCustomChannel(target, credentials, arguments);
}

void add_token(grpc::ClientContext& context) {
  if (const char* token = std::getenv("NOCTURNE_TOKEN")) {
    context.AddMetadata("authorization", std::string("Bearer ") + token);
  }
}

bool may_pass(const grpc::Status& status) {
  switch (status.error_code()) {
    case grpc::StatusCode::UNAVAILABLE:
    case grpc::StatusCode::DEADLINE_EXCEEDED:
    case grpc::StatusCode::RESOURCE_EXHAUSTED:
    case grpc::StatusCode::CANCELLED:
    case grpc::StatusCode::UNAUTHENTICATED:
    case grpc::StatusCode::PERMISSION_DENIED:
      return true;
    default:
      return false;
  }
}

}  // namespace nocturne
