#include "queue/redis_address.h"

#include <charconv>
#include <cstdlib>
#include <stdexcept>

namespace nocturne {
namespace {

constexpr const char* kForms =
    "expected unix:///path/of/socket, tcp://host:port or redis://host:port";

int parse_port(const std::string& text) {
  int port = 0;
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, port);
  if (error != std::errc() || stopped != end || port < 1 || port > 65535) {
    throw std::invalid_argument("Redis URL: port '" + text + "' is not in 1 ... 65535");
  }
  return port;
}

RedisAddress parse_host_and_port(std::string rest) {
  if (rest.find('@') != std::string::npos) {
    throw std::invalid_argument(
        "Redis URL: user and password don't belong in it; set NOCTURNE_REDIS_USER and "
        "NOCTURNE_REDIS_PASSWORD");
  }
  if (!rest.empty() && rest.back() == '/') rest.pop_back();
  RedisAddress address;
  const bool bracketed = !rest.empty() && rest.front() == '[';
  const std::size_t host_end = bracketed ? rest.find(']') : rest.rfind(':');
  if (bracketed && host_end == std::string::npos) {
    throw std::invalid_argument("Redis URL: ']' is missing after an IPv6 address");
  }
  address.host = bracketed ? rest.substr(1, host_end - 1) : rest.substr(0, host_end);
  const std::size_t colon = bracketed ? host_end + 1 : host_end;
  if (colon < rest.size()) {
    if (rest[colon] != ':') throw std::invalid_argument(std::string("Redis URL: ") + kForms);
    address.port = parse_port(rest.substr(colon + 1));
  }
  if (address.host.empty()) throw std::invalid_argument(std::string("Redis URL: ") + kForms);
  return address;
}

RedisAddress parse(const std::string& url) {
  const std::string unix_scheme = "unix://";
  if (url.starts_with(unix_scheme) && url.size() > unix_scheme.size()) {
    RedisAddress address;
    address.socket_path = url.substr(unix_scheme.size());
    return address;
  }
  for (const std::string scheme : {"tcp://", "redis://"}) {
    if (url.starts_with(scheme)) return parse_host_and_port(url.substr(scheme.size()));
  }
  throw std::invalid_argument(std::string("Redis URL: ") + kForms);
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

}  // namespace

std::string RedisAddress::text() const {
  return socket_path.empty() ? host + ":" + std::to_string(port) : socket_path;
}

RedisAddress redis_address(const std::string& url) {
  RedisAddress address = parse(url);
  address.user = environment("NOCTURNE_REDIS_USER");
  address.password = environment("NOCTURNE_REDIS_PASSWORD");
  return address;
}

}  // namespace nocturne
