// One connection to Redis (RESP2) that connects when it is first used and again after it was lost.
//
// hiredis writes without MSG_NOSIGNAL: a program that uses this must ignore SIGPIPE.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "queue/redis_address.h"
#include "queue/redis_reply.h"

struct redisContext;

namespace nocturne {

/// Name and arguments; may hold any bytes.
using RedisCommand = std::vector<std::string>;

/// For one thread at a time.
class RedisConnection {
 public:
  explicit RedisConnection(RedisAddress address) : address_(std::move(address)) {}

  /// Sends one command and waits for its reply, at most kAnswerSeconds.
  /// Throws ConnectionLost (the next call connects again) or ErrorReply.
  Reply command(const RedisCommand& command);

  /// Sends all commands at once; one reply for each, in order, errors among them.
  /// Throws ConnectionLost.
  std::vector<Reply> pipeline(const std::vector<RedisCommand>& commands);

  /// Forgets the connection, for example after a reply that makes no sense.
  void disconnect() { context_.reset(); }

  const RedisAddress& address() const { return address_; }

  /// Longer than any command blocks, shorter than a lease.
  static constexpr int kAnswerSeconds = 5;
  static constexpr int kConnectSeconds = 2;

 private:
  struct FreeContext {
    void operator()(redisContext* context) const;
  };

  void connect();
  void sign_on();
  void append(const RedisCommand& command);
  Reply read_reply();
  [[noreturn]] void lose();

  RedisAddress address_;
  std::unique_ptr<redisContext, FreeContext> context_;
};

}  // namespace nocturne
