// nocturne-worker: takes jobs from Redis, fetches scenes by digest, traces, publishes the sums.
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <thread>

#include "assets/asset_cache.h"
#include "assets/enrolment.h"
#include "job_tracer.h"
#include "log/log.h"
#include "rounding/floating_point_profile.h"
#include "worker_loop/worker.h"

namespace {

using nocturne::LogLevel;

struct Arguments {
  std::string redis;
  std::string id;
  std::string node;
  unsigned threads = std::max(1U, std::thread::hardware_concurrency());
  int nice = 10;
  unsigned lease_ms = 10000;
  unsigned grace_seconds = 1;
  double load_seconds = 600.0;
  bool debug = false;
  bool enrol = false;
  std::string alive;
  nocturne::AssetCacheOptions cache;
};

bool is_in_names(char c) {
  return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '.' ||
         c == '_' || c == '-';
}

std::string host_name() {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  return host;
}

std::string default_id() { return host_name() + "-" + std::to_string(getpid()); }

constexpr std::size_t kMaxNode = 64;

/// Of long names in clouds the ends differ.
std::string default_node() {
  const std::string host = host_name();
  std::string node = host.substr(host.size() - std::min(host.size(), kMaxNode));
  std::ranges::replace_if(
      node, [](char c) { return !is_in_names(c); }, '-');
  return node;
}

std::string check_name(const std::string& name, std::size_t longest) {
  const bool good =
      !name.empty() && name.size() <= longest && std::ranges::all_of(name, is_in_names);
  return good ? ""
              : "expected 1 ... " + std::to_string(longest) + " letters, digits, '.', '_' or '-'";
}

void add_options(CLI::App& app, Arguments& arguments) {
  app.add_option("--redis", arguments.redis,
                 "unix:///path or tcp://host:port; user and password come from the environment: "
                 "NOCTURNE_REDIS_USER, NOCTURNE_REDIS_PASSWORD")
      ->required();
  app.add_option("--assets", arguments.cache.service,
                 "asset service: host:port or unix:/path; a token for it comes from NOCTURNE_TOKEN")
      ->required();
  app.add_option("--assets-ca", arguments.cache.authorities,
                 "by TLS, to an asset service whose certificate is signed by one of these (PEM)")
      ->envname("NOCTURNE_ASSETS_CA");
  app.add_flag(
      "--enrol", arguments.enrol,
      "ask the asset service, by the token, to be one of its machines: it gives user and "
      "password for Redis, and a key that signs results; for coordinators with --enrolled");
  app.add_option("--cache", arguments.cache.folder, "folder for scenes and meshes")->required();
  app.add_option("--threads", arguments.threads, "jobs at the same time")
      ->envname("NOCTURNE_THREADS")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  app.add_option(
         "--nice", arguments.nice,
         "what threads at long jobs add to their nice value: other programs of the machine, "
         "and short jobs, go first")
      ->check(CLI::Range(0, 19))
      ->capture_default_str();
  app.add_option("--lease-ms", arguments.lease_ms,
                 "a job is somebody else's after this time without a sign of life")
      ->check(CLI::Range(500, 600000))
      ->capture_default_str();
  app.add_option("--id", arguments.id, "name of this worker, unique; default: host and process")
      ->check([](const std::string& id) { return check_name(id, 100); });
  app.add_option(
         "--node", arguments.node,
         "what it runs on: below its token, all that enrol by one name are one machine, and "
         "machines audit each other; default: the host's name")
      ->envname("NOCTURNE_NODE")
      ->check([](const std::string& node) { return check_name(node, kMaxNode); });
  app.add_option("--alive", arguments.alive,
                 "a file whose time is set every two seconds while Redis hears this worker: for "
                 "probes");
  app.add_option("--load-seconds", arguments.load_seconds,
                 "processor time after which loading a scene is stopped, and its jobs fail")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  app.add_option("--max-asset-bytes", arguments.cache.max_asset_bytes,
                 "larger files are refused; 8GiB")
      ->transform(CLI::AsSizeValue(false));
  app.add_option("--cache-size", arguments.cache.max_cache_bytes,
                 "files not used for longest are removed when the cache has more; 64GiB")
      ->transform(CLI::AsSizeValue(false));
  app.add_option(
         "--grace-seconds", arguments.grace_seconds,
         "after SIGTERM or SIGINT, how long running jobs may go on before they are stopped and "
         "handed back; a second signal ends the program at once")
      ->check(CLI::Range(0, 3600))
      ->capture_default_str();
  app.add_flag("--debug", arguments.debug, "a log line for every job");
}

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

/// Before the first thread starts, so that all threads leave these signals to wait_for_signal().
void block_signals() {
  const sigset_t signals = stop_signals();
  // A shell starts background jobs with SIGINT ignored.
  signal(SIGTERM, SIG_DFL);
  signal(SIGINT, SIG_DFL);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  // hiredis writes to sockets that may be closed.
  signal(SIGPIPE, SIG_IGN);
}

/// Returns at the first signal; the second one ends the process.
void wait_for_signal() {
  const sigset_t signals = stop_signals();
  int number = 0;
  sigwait(&signals, &number);
  pthread_sigmask(SIG_UNBLOCK, &signals, nullptr);
}

/// Before there is anything to hand back, a signal ends the process.
void pause_unless_signalled(std::chrono::milliseconds duration) {
  const sigset_t signals = stop_signals();
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(duration);
  const timespec time{.tv_sec = seconds.count(),
                      .tv_nsec = std::chrono::nanoseconds(duration - seconds).count()};
  if (sigtimedwait(&signals, nullptr, &time) > 0) std::_Exit(EXIT_SUCCESS);
}

void enrol(const Arguments& arguments, nocturne::WorkerOptions& options) {
  const nocturne::Enrolment given = nocturne::enrol(
      arguments.cache.service, nocturne::authorities_in(arguments.cache.authorities),
      arguments.node.empty() ? default_node() : arguments.node, pause_unless_signalled);
  options.redis.user = given.redis_user;
  options.redis.password = given.redis_password;
  options.identity = {given.machine, given.key};
  options.id = given.machine + "/" + options.id;
}

/// As many as this user may: each texture of a scene holds a file open.
void raise_open_files() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

int run(const Arguments& arguments) {
  block_signals();
  raise_open_files();
  nocturne::AssetCache assets(arguments.cache);
  nocturne::JobTracer tracer(assets, arguments.load_seconds);
  nocturne::WorkerOptions options{.redis = nocturne::redis_address(arguments.redis),
                                  .id = arguments.id.empty() ? default_id() : arguments.id,
                                  .floating_point_profile = nocturne::floating_point_profile(),
                                  .threads = arguments.threads,
                                  .nice = arguments.nice,
                                  .alive = arguments.alive,
                                  .lease = std::chrono::milliseconds(arguments.lease_ms)};
  if (arguments.enrol) enrol(arguments, options);
  std::optional<nocturne::Worker> worker(
      std::in_place, options,
      [&](const auto& job, auto& running) { return tracer.trace(job, running); });
  const std::string name = "worker=" + options.id;
  log_line(LogLevel::kInfo, name + " threads=" + std::to_string(options.threads) +
                                " floating_point_profile=" + options.floating_point_profile +
                                " starts, Redis at " + options.redis.text());
  wait_for_signal();
  log_line(LogLevel::kInfo, name + " stops");
  if (worker->stop(std::chrono::seconds(arguments.grace_seconds))) {
    worker.reset();
  } else {
    log_line(LogLevel::kInfo, name + " hands back what is not done");
    worker->hand_back();
  }
  // Threads may still load or trace; none of their results is needed.
  std::_Exit(EXIT_SUCCESS);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  CLI::App app("Does jobs of Nocturne: takes them from Redis, traces, publishes the sums.");
  add_options(app, arguments);
  CLI11_PARSE(app, argc, argv);
  if (arguments.debug) nocturne::set_log_level(LogLevel::kDebug);
  try {
    return run(arguments);
  } catch (const std::exception& error) {
    log_line(LogLevel::kWarning, std::string("nocturne-worker: ") + error.what());
    return EXIT_FAILURE;
  }
}
