#include "queue/redis_reply.h"

#include <hiredis/hiredis.h>

#include "queue/redis_errors.h"

namespace nocturne {
namespace {

const char* type_name(int type) {
  switch (type) {
    case REDIS_REPLY_STRING:
      return "a string";
    case REDIS_REPLY_ARRAY:
      return "an array";
    case REDIS_REPLY_INTEGER:
      return "an integer";
    case REDIS_REPLY_NIL:
      return "nil";
    case REDIS_REPLY_STATUS:
      return "a status";
    case REDIS_REPLY_ERROR:
      return "an error";
    default:
      return "an unknown type";
  }
}

[[noreturn]] void throw_unexpected(const char* expected, int type) {
  throw UnexpectedReply(std::string("expected ") + expected + " from Redis, got " +
                        type_name(type));
}

}  // namespace

Reply::Reply(redisReply* raw) : reply_(raw, [](redisReply* reply) { freeReplyObject(reply); }) {}

bool Reply::is_nil() const { return reply_->type == REDIS_REPLY_NIL; }

bool Reply::is_error() const { return reply_->type == REDIS_REPLY_ERROR; }

std::string_view Reply::text() const {
  if (reply_->type != REDIS_REPLY_STRING && reply_->type != REDIS_REPLY_STATUS) {
    throw_unexpected("a string", reply_->type);
  }
  return {reply_->str, reply_->len};
}

std::int64_t Reply::integer() const {
  if (reply_->type != REDIS_REPLY_INTEGER) throw_unexpected("an integer", reply_->type);
  return reply_->integer;
}

std::size_t Reply::size() const {
  if (reply_->type != REDIS_REPLY_ARRAY) throw_unexpected("an array", reply_->type);
  return reply_->elements;
}

Reply Reply::at(std::size_t index) const {
  if (index >= size() || reply_->element[index] == nullptr) {
    throw UnexpectedReply("an array from Redis is shorter than expected: no element " +
                          std::to_string(index));
  }
  return Reply(std::shared_ptr<const redisReply>(reply_, reply_->element[index]));
}

const Reply& Reply::throw_if_error() const {
  if (is_error()) throw ErrorReply(std::string(reply_->str, reply_->len));
  return *this;
}

}  // namespace nocturne
