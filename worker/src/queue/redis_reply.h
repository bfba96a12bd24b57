// A reply of Redis, read by type: whoever asks for a type that is not there gets an exception.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

struct redisReply;

namespace nocturne {

class Reply {
 public:
  /// Takes ownership; `raw` must not be null.
  explicit Reply(redisReply* raw);

  bool is_nil() const;
  bool is_error() const;

  /// Bytes of a string or status; valid as long as a copy of this reply or of its parent lives.
  /// Throws UnexpectedReply for other types.
  std::string_view text() const;

  /// Throws UnexpectedReply if this is not an integer.
  std::int64_t integer() const;

  /// Number of elements. Throws UnexpectedReply if this is not an array.
  std::size_t size() const;

  /// Element `index`. Throws UnexpectedReply if this is not an array or is shorter.
  Reply at(std::size_t index) const;

  /// Throws ErrorReply if Redis answered with an error.
  const Reply& throw_if_error() const;

 private:
  explicit Reply(std::shared_ptr<const redisReply> reply) : reply_(std::move(reply)) {}

  // Elements share the ownership of the whole reply.
  std::shared_ptr<const redisReply> reply_;
};

}  // namespace nocturne
