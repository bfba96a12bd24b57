#include "queue/redis_connection.h"

#include <hiredis/hiredis.h>

#include "queue/redis_errors.h"

namespace nocturne {

void RedisConnection::FreeContext::operator()(redisContext* context) const { redisFree(context); }

void RedisConnection::lose() {
  const std::string reason =
      context_ != nullptr && context_->err != 0 ? context_->errstr : "no memory for a connection";
  context_.reset();
  throw ConnectionLost("Redis at " + address_.text() + ": " + reason);
}

void RedisConnection::connect() {
  const timeval timeout{.tv_sec = kConnectSeconds, .tv_usec = 0};
  context_.reset(address_.socket_path.empty()
                     ? redisConnectWithTimeout(address_.host.c_str(), address_.port, timeout)
                     : redisConnectUnixWithTimeout(address_.socket_path.c_str(), timeout));
  if (context_ == nullptr || context_->err != 0) lose();
  if (redisSetTimeout(context_.get(), {.tv_sec = kAnswerSeconds, .tv_usec = 0}) != REDIS_OK) lose();
  if (address_.socket_path.empty() && redisEnableKeepAlive(context_.get()) != REDIS_OK) lose();
  if (!address_.password.empty()) sign_on();
}

void RedisConnection::sign_on() {
  append(address_.user.empty() ? RedisCommand{"AUTH", address_.password}
                               : RedisCommand{"AUTH", address_.user, address_.password});
  const Reply reply = read_reply();
  // Else the next command would go on unauthenticated.
  if (reply.is_error()) context_.reset();
  reply.throw_if_error();
}

void RedisConnection::append(const RedisCommand& command) {
  std::vector<const char*> arguments;
  std::vector<std::size_t> lengths;
  for (const std::string& argument : command) {
    arguments.push_back(argument.data());
    lengths.push_back(argument.size());
  }
  if (redisAppendCommandArgv(context_.get(), static_cast<int>(command.size()), arguments.data(),
                             lengths.data()) != REDIS_OK) {
    lose();
  }
}

Reply RedisConnection::read_reply() {
  void* reply = nullptr;
  if (redisGetReply(context_.get(), &reply) != REDIS_OK || reply == nullptr) lose();
  return Reply(static_cast<redisReply*>(reply));
}

Reply RedisConnection::command(const RedisCommand& command) {
  Reply reply = pipeline({command}).front();
  reply.throw_if_error();
  return reply;
}

std::vector<Reply> RedisConnection::pipeline(const std::vector<RedisCommand>& commands) {
  if (context_ == nullptr) connect();
  for (const RedisCommand& command : commands) append(command);
  std::vector<Reply> replies;
  replies.reserve(commands.size());
  while (replies.size() < commands.size()) replies.push_back(read_reply());
  return replies;
}

}  // namespace nocturne
