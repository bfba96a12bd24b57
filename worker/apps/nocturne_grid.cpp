// Density grids between files: OpenVDB's, that of the worker, and plain arrays of simulations.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <functional>
#include <iostream>
#include <new>
#include <string>

#include "grid_commands.h"

namespace nocturne {
namespace {

constexpr int kBadInput = 2;

void limit_memory([[maybe_unused]] const GridLimits& limits) {
#ifndef __SANITIZE_ADDRESS__  // which reserves terabytes
  const auto bytes = static_cast<rlim_t>(limits.bytes);
  const rlimit limit{bytes, bytes};
  setrlimit(RLIMIT_AS, &limit);
#endif
}

// Messages repeat names from files.
std::string printable(std::string text) {
  for (char& letter : text) {
    if (static_cast<unsigned char>(letter) < ' ' || static_cast<unsigned char>(letter) > '~') {
      letter = '?';
    }
  }
  return text;
}

int answered(const std::function<nlohmann::json()>& command, const GridLimits& limits) {
  try {
    openvdb::initialize();
    constexpr auto kNoBadLetters = nlohmann::json::error_handler_t::replace;
    std::cout << command().dump(2, ' ', false, kNoBadLetters) << std::endl;
    return std::cout ? 0 : kBadInput;
  } catch (const std::bad_alloc&) {
    std::cerr << "nocturne-grid: needs more than " << limits.bytes << " bytes (--max-bytes)\n";
  } catch (const std::exception& error) {
    std::cerr << "nocturne-grid: " << printable(error.what()) << '\n';
  }
  return kBadInput;
}

// In a separate process: damage to a file that OpenVDB does not notice may kill it, and then
// somebody must be there to say so.
int run(const std::function<nlohmann::json()>& command, const GridLimits& limits) {
  const pid_t child = fork();
  if (child < 0) {
    std::perror("nocturne-grid: fork");
    return kBadInput;
  }
  if (child == 0) {
    limit_memory(limits);
    const int status = answered(command, limits);
    std::cout.flush();
    std::cerr.flush();
    // No destructors: threads of libraries may be anywhere.
    _exit(status);
  }
  int status = 0;
  if (waitpid(child, &status, 0) == child && WIFEXITED(status)) return WEXITSTATUS(status);
  std::cerr << "nocturne-grid: reading it failed with signal " << WTERMSIG(status)
            << ": the file is damaged\n";
  return kBadInput;
}

}  // namespace
}  // namespace nocturne

int main(int argc, char** argv) {
  CLI::App app(
      "Density grids: lists the grids of an OpenVDB file, converts one for the worker, makes one "
      "from arrays, and arrays again. Answers are JSON on standard output; whatever can't be used "
      "ends with status 2.");
  app.require_subcommand(1);
  nocturne::GridLimits limits;
  std::string input, output, name;
  std::function<nlohmann::json()> command;
  const auto add = [&](const char* verb, const char* help, const char* input_name) {
    CLI::App* sub = app.add_subcommand(verb, help);
    sub->add_option(input_name, input)->required();
    sub->add_option("--max-voxels", limits.voxels, "Most voxels of a grid")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    sub->add_option("--max-bytes", limits.bytes, "Most memory that this may take")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    return sub;
  };
  CLI::App* inspect = add("inspect", "What grids a file has", "file.vdb");
  inspect->callback([&] { command = [&] { return nocturne::inspect_grids(input, limits); }; });
  CLI::App* convert = add("convert", "A grid of floats as NanoVDB lays it out", "file.vdb");
  convert->add_option("--grid", name, "Its name")->required();
  convert->add_option("-o,--output", output, "File to write")->required();
  convert->callback(
      [&] { command = [&] { return nocturne::convert_grid(input, name, output, limits); }; });
  CLI::App* values = add("values", "All values of a grid for the worker", "file.nvdb");
  values->add_option("-o,--output", output, "File to write")->required();
  values->callback([&] { command = [&] { return nocturne::grid_values(input, output, limits); }; });
  CLI::App* create = add("create", "An OpenVDB file from arrays of numbers", "input.json");
  create->add_option("-o,--output", output, "File to write")->required();
  create->callback(
      [&] { command = [&] { return nocturne::create_grids(input, output, limits); }; });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : nocturne::kBadInput;
  }
  return nocturne::run(command, limits);
}
