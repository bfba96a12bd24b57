// A real redis-server on a Unix socket in a separate folder.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>

#include "nocturne/v1/job.pb.h"
#include "queue/redis_connection.h"

namespace nocturne::test {

class RedisServer {
 public:
  RedisServer();
  ~RedisServer();
  RedisServer(const RedisServer&) = delete;
  RedisServer& operator=(const RedisServer&) = delete;

  /// Returns when the server answers; it is empty.
  void start();

  /// SIGKILL; everything in it is gone.
  void kill();

  RedisAddress address() const;

  /// One command on a connection of the test's own.
  Reply run(const RedisCommand& command) { return connection_.command(command); }

  /// What the coordinator does: makes the stream and its group.
  void make_group();

  /// Adds a job to the stream; returns its entry id.
  std::string publish(const v1::Job& job);

  /// All results on the stream, in order.
  std::vector<v1::JobResult> results();

  /// Number of jobs delivered and not acknowledged.
  std::size_t pending();

 private:
  std::filesystem::path folder_;
  RedisConnection connection_;
  pid_t process_ = 0;
};

/// A job that check_job() accepts; `tile_index` tells them apart.
v1::Job make_job(std::uint32_t tile_index = 0);

}  // namespace nocturne::test
