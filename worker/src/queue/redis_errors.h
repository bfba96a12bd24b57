// Errors of Redis. The caller decides whether to retry.
#pragma once

#include <stdexcept>
#include <string>

namespace nocturne {

class RedisError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// No connection, or it broke or timed out; whether the command was executed is unknown.
class ConnectionLost : public RedisError {
 public:
  using RedisError::RedisError;
};

/// Redis refused the command.
class ErrorReply : public RedisError {
 public:
  using RedisError::RedisError;

  /// The error's first word: "NOGROUP", "OOM", "WRONGTYPE" ...
  std::string code() const {
    const std::string text = what();
    return text.substr(0, text.find(' '));
  }
};

/// A reply of another shape than the command gives.
class UnexpectedReply : public RedisError {
 public:
  using RedisError::RedisError;
};

}  // namespace nocturne
