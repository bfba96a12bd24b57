#include "log/log.h"

#include <atomic>
#include <cstdio>
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

}  // namespace

void set_log_level(LogLevel lowest) { lowest_level = lowest; }

void log_line(LogLevel level, std::string_view text) {
  if (level < lowest_level.load()) return;
  std::string line = utc_now() + ' ' + name_of(level) + ' ';
  for (const char c : text) line += (c == '\n' || c == '\r') ? ' ' : c;
  line += '\n';
  // One call, so that lines of several threads don't mix.
  std::fwrite(line.data(), 1, line.size(), stderr);
}

}  // namespace nocturne
