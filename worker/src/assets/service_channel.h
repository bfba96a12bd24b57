// The connection to the API's gRPC endpoint that all callers here use.
#pragma once

#include <grpcpp/grpcpp.h>

#include <memory>
#include <string>

namespace nocturne {

/// `target` in gRPC's words: host:port or unix:/path. With `authorities`, certificates in PEM, by
/// TLS. Connects when first used.
std::shared_ptr<grpc::Channel> service_channel(const std::string& target,
                                               const std::string& authorities);

/// Tells who calls, if NOCTURNE_TOKEN is set.
void add_token(grpc::ClientContext& context);

/// Whether a call that ended so may do better later.
bool may_pass(const grpc::Status& status);

}  // namespace nocturne
