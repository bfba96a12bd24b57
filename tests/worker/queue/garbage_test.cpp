// What no Redis should send must not crash a worker: every function throws RedisError or returns.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>

#include "queue/job_queue.h"
#include "queue/redis_errors.h"

namespace nocturne {
namespace {

/// Sends the same bytes to everyone who connects and closes the connection.
class GarbageServer {
 public:
  explicit GarbageServer(std::string bytes) : bytes_(std::move(bytes)) {
    signal(SIGPIPE, SIG_IGN);
    std::string folder =
        (std::filesystem::temp_directory_path() / "nocturne-garbage-XXXXXX").string();
    folder_ = mkdtemp(folder.data());
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::strncpy(address.sun_path, socket_path().c_str(), sizeof address.sun_path - 1);
    listener_ = socket(AF_UNIX, SOCK_STREAM, 0);
    if (bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener_, 8) != 0) {
      throw std::runtime_error("can't listen");
    }
    thread_ = std::thread([this] { serve(); });
  }

  ~GarbageServer() {
    shutdown(listener_, SHUT_RDWR);
    thread_.join();
    close(listener_);
    std::filesystem::remove_all(folder_);
  }

  std::string socket_path() const { return folder_ / "redis.sock"; }

 private:
  void serve() {
    for (int peer = 0; (peer = accept(listener_, nullptr, nullptr)) >= 0;) {
      char request[4096];
      if (read(peer, request, sizeof request) > 0) {
        EXPECT_EQ(write(peer, bytes_.data(), bytes_.size()), ssize_t(bytes_.size()));
      }
      close(peer);
    }
  }

  std::string bytes_;
  std::filesystem::path folder_;
  int listener_;
  std::thread thread_;
};

class Garbage : public testing::TestWithParam<std::string> {};

TEST_P(Garbage, ThrowsRedisError) {
  const GarbageServer server(GetParam());
  RedisAddress address;
  address.socket_path = server.socket_path();
  JobQueue queue(address, "w/0", std::chrono::seconds(1));
  EXPECT_THROW(queue.take(), RedisError);
  EXPECT_THROW(queue.complete("1-1", v1::JobResult()), RedisError);
  EXPECT_THROW(queue.take(), RedisError);  // A new JobQueue would first look for lost jobs.
}

TEST_P(Garbage, ExtendThrowsRedisError) {
  const GarbageServer server(GetParam());
  RedisAddress address;
  address.socket_path = server.socket_path();
  JobQueue queue(address, "w/0", std::chrono::seconds(1));
  EXPECT_THROW(queue.extend({{"w/0", "1-1"}}), RedisError);
}

// What take() asks first is answered by an array of a cursor and an array of entries.
INSTANTIATE_TEST_SUITE_P(
    Replies, Garbage,
    testing::Values(std::string(), std::string("HTTP/1.1 400 Bad Request\r\n\r\n"),
                    std::string("\0\0\0\0\0\0", 6), std::string("+NaN\r\n"),
                    std::string("$5\r\nab"), std::string(":12\r\n"),
                    std::string("*2\r\n$3\r\n5-5\r\n:1\r\n"),
                    std::string("*2\r\n:1\r\n*1\r\n*2\r\n:1\r\n:2\r\n"),
                    std::string("*1\r\n*2\r\n$1\r\na\r\n*1\r\n$3\r\nabc\r\n"),
                    std::string("*2\r\n$3\r\n0-0\r\n*1\r\n*2\r\n$3\r\n1-1\r\n*2\r\n:1\r\n:2\r\n"),
                    std::string("*-5\r\n"), std::string("%1\r\n+a\r\n+b\r\n")));

}  // namespace
}  // namespace nocturne
