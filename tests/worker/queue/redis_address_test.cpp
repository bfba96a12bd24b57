#include "queue/redis_address.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace nocturne {
namespace {

TEST(RedisAddress, UnixSocket) {
  const RedisAddress address = redis_address("unix:///run/redis/redis.sock");
  EXPECT_EQ(address.socket_path, "/run/redis/redis.sock");
  EXPECT_EQ(address.text(), "/run/redis/redis.sock");
}

TEST(RedisAddress, HostAndPort) {
  EXPECT_EQ(redis_address("tcp://redis:7000").text(), "redis:7000");
  EXPECT_EQ(redis_address("redis://redis").text(), "redis:6379");
  EXPECT_EQ(redis_address("redis://redis:1/").text(), "redis:1");
  const RedisAddress v6 = redis_address("tcp://[::1]:7000");
  EXPECT_EQ(v6.host, "::1");
  EXPECT_EQ(v6.port, 7000);
}

class BadUrl : public testing::TestWithParam<const char*> {};

TEST_P(BadUrl, IsRefused) { EXPECT_THROW(redis_address(GetParam()), std::invalid_argument); }

INSTANTIATE_TEST_SUITE_P(RedisAddress, BadUrl,
                         testing::Values("", "redis", "http://a", "unix://", "tcp://", "tcp://:1",
                                         "tcp://a:0", "tcp://a:65536", "tcp://a:b",
                                         "tcp://a:", "tcp://[::1", "tcp://[::1]7"));

TEST(RedisAddress, PasswordInUrlIsRefusedAndNotRepeated) {
  try {
    redis_address("redis://me:secret@host:1");
    FAIL() << "accepted";
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("NOCTURNE_REDIS_PASSWORD"), std::string::npos);
    EXPECT_EQ(text.find("secret"), std::string::npos);
  }
}

TEST(RedisAddress, PasswordComesFromTheEnvironment) {
  setenv("NOCTURNE_REDIS_USER", "me", 1);
  setenv("NOCTURNE_REDIS_PASSWORD", "secret", 1);
  const RedisAddress address = redis_address("tcp://host:1");
  unsetenv("NOCTURNE_REDIS_USER");
  unsetenv("NOCTURNE_REDIS_PASSWORD");
  EXPECT_EQ(address.user, "me");
  EXPECT_EQ(address.password, "secret");
  EXPECT_EQ(address.text(), "host:1");
}

}  // namespace
}  // namespace nocturne
