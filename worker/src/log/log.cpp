#include "log/log.h"

#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

namespace nocturne {
namespace {

std::atomic<LogLevel> lowest_level{LogLevel::kInfo};

const char* name_of(LogLevel level) {
  switch (level) {
    case LogLevel::kDebug:
      return "DEBUG";
    case LogLevel::kInfo:
      return "INFO";
    case LogLevel::kWarning:
      return "WARNING";
  }
  return "?";
}

std::string utc_now() {
  const std::time_t now = std::time(nullptr);
  std::tm fields{};
  gmtime_r(&now, &fields);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &fields)};
}

bool WritesJson() {
  static const bool json = [] {
    const char* format = std::getenv("NOCTURNE_LOG");
    return format != nullptr && std::string_view(format) == "json";
  }();
  return json;
}

/// Bytes of other alphabets, which may be of no encoding, become question marks.
std::string quoted(std::string_view text) {
  std::string made = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') made += '\\';
    const bool is_plain = c >= ' ' && c <= '~';
    made += is_plain ? c : (c == '\n' || c == '\r' || c == '\t') ? ' ' : '?';
  }
  return made + '"';
}

/// The members for `name=value` in a text, each first of its name.
std::string members_of(std::string_view text) {
  constexpr std::array kNames = {"render", "tile", "samples", "worker", "thread", "scene"};
  std::string made;
  for (const std::string name : kNames) {
    const std::string start = name + '=';
    std::size_t at = text.find(start);
    while (at != std::string_view::npos && at != 0 && text[at - 1] != ' ' && text[at - 1] != '(') {
      at = text.find(start, at + 1);
    }
    if (at == std::string_view::npos) continue;
    std::string_view value = text.substr(at + start.size());
    value = value.substr(0, value.find_first_of(" ,;)\n\r"));
    while (!value.empty() && (value.back() == ':' || value.back() == '.')) value.remove_suffix(1);
    if (!value.empty()) made += ", " + quoted(name) + ": " + quoted(value);
  }
  return made;
}

std::string json_line(LogLevel level, std::string_view text) {
  return "{\"time\": " + quoted(utc_now()) + ", \"level\": " + quoted(name_of(level)) +
         ", \"program\": \"worker\", \"message\": " + quoted(text) + members_of(text) + '}';
}

std::string plain_line(LogLevel level, std::string_view text) {
  std::string line = utc_now() + ' ' + name_of(level) + ' ';
  for (const char c : text) line += (c == '\n' || c == '\r') ? ' ' : c;
  return line;
}

}  // namespace

void set_log_level(LogLevel lowest) { lowest_level = lowest; }

void log_line(LogLevel level, std::string_view text) {
  if (level < lowest_level.load()) return;
  const std::string line = (WritesJson() ? json_line(level, text) : plain_line(level, text)) + '\n';
  // One call, so that lines of several threads don't mix.
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace nocturne
