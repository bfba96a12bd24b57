#include "assets/enrolment.h"

#include <algorithm>

#include "assets/errors.h"
#include "assets/service_channel.h"
#include "log/log.h"
#include "nocturne/v1/worker_service.grpc.pb.h"

namespace nocturne {
namespace {

constexpr std::chrono::seconds kDeadline{5};
constexpr std::chrono::milliseconds kShortestPause{100};
constexpr std::chrono::milliseconds kLongestPause{2000};

}  // namespace

Enrolment enrol(const std::string& target, const std::string& authorities, const std::string& node,
                const std::function<void(std::chrono::milliseconds)>& pause) {
  const auto stub = v1::WorkerService::NewStub(service_channel(target, authorities));
  for (auto next = kShortestPause;; next = std::min(2 * next, kLongestPause)) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + kDeadline);
    add_token(context);
    v1::Enrolment given;
    v1::EnrolRequest asked;
    asked.set_node(node);
    const grpc::Status status = stub->Enrol(&context, asked, &given);
    if (status.ok()) {
      return {given.machine(), given.key(), given.redis_user(), given.redis_password()};
    }
    const std::string text = "can't enrol at " + target + ": " + status.error_message() +
                             " (gRPC status " + std::to_string(status.error_code()) + ")";
    if (!may_pass(status)) throw AssetError(text);
    log_line(LogLevel::kWarning, text + "; trying again");
    pause(next);
  }
}

}  // namespace nocturne
