// The commands of nocturne-grid. All throw std::exception with a message and return a report.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "vdb_file.h"

namespace nocturne {

nlohmann::json inspect_grids(const std::filesystem::path& vdb, const GridLimits& limits);

/// A grid of floats that are no less than 0, as NanoVDB lays it out for the worker.
nlohmann::json convert_grid(const std::filesystem::path& vdb, const std::string& name,
                            const std::filesystem::path& output, const GridLimits& limits);

/// All values of a grid in the worker's layout, as an array: docs/how-to/density-grids.md.
nlohmann::json grid_values(const std::filesystem::path& nvdb, const std::filesystem::path& output,
                           const GridLimits& limits);

/// From arrays: docs/how-to/density-grids.md.
nlohmann::json create_grids(const std::filesystem::path& input, const std::filesystem::path& output,
                            const GridLimits& limits);

}  // namespace nocturne
