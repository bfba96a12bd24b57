// One line per event on standard error: time, level, text. What a line is about stands in it as
// `name=value`, in the names of the coordinator's log: worker, thread, render, tile, samples,
// scene. With NOCTURNE_LOG=json in the environment a line is a JSON object, and these are its
// members.
#pragma once

#include <string_view>

namespace nocturne {

enum class LogLevel { kDebug, kInfo, kWarning };

/// Lines below this level are left out; kInfo until it is called.
void set_log_level(LogLevel lowest);

/// Writes one line, also when several threads write at once. Line breaks in `text` become spaces.
void log_line(LogLevel level, std::string_view text);

}  // namespace nocturne
