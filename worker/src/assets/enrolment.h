// How a machine becomes one of the service's.
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace nocturne {

/// The credentials that prove its identity; no one else may read them.
struct Enrolment {
  std::string machine;
  /// Signs results: HMAC-SHA-256.
  std::string key;
  std::string redis_user, redis_password;
};

/// Asks until the service answers, `pause`ing between. `target` and `authorities` as of
/// AssetSource; the token in NOCTURNE_TOKEN says whose machine it is, and `node` which one. Throws
/// AssetError where the service refuses for good.
Enrolment enrol(const std::string& target, const std::string& authorities, const std::string& node,
                const std::function<void(std::chrono::milliseconds)>& pause);

}  // namespace nocturne
