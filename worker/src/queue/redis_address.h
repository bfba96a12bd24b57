// Where Redis is and how to sign on.
#pragma once

#include <string>

namespace nocturne {

struct RedisAddress {
  /// Path of a Unix socket; empty where host and port are used.
  std::string socket_path;
  std::string host;
  int port = 6379;
  /// From the environment only: arguments can be read by everyone on the machine. Empty: not sent.
  std::string user;
  std::string password;

  /// For log lines; without user and password.
  std::string text() const;
};

/// Reads `unix:///path`, `tcp://host[:port]` or `redis://host[:port]`, IPv6 hosts in brackets, and
/// user and password from NOCTURNE_REDIS_USER and NOCTURNE_REDIS_PASSWORD.
/// Throws std::invalid_argument that names the error in the URL, also if a password is in it.
RedisAddress redis_address(const std::string& url);

}  // namespace nocturne
