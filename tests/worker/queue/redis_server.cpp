#include "queue/redis_server.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <stdexcept>
#include <thread>

#include "queue/keys.h"
#include "queue/redis_errors.h"

namespace nocturne::test {
namespace {

std::filesystem::path make_folder() {
  std::string name = (std::filesystem::temp_directory_path() / "nocturne-redis-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  return name;
}

RedisAddress address_in(const std::filesystem::path& folder) {
  RedisAddress address;
  address.socket_path = folder / "redis.sock";
  return address;
}

}  // namespace

RedisServer::RedisServer() : folder_(make_folder()), connection_(address_in(folder_)) {
  signal(SIGPIPE, SIG_IGN);
  start();
}

RedisServer::~RedisServer() {
  if (process_ != 0) kill();
  std::filesystem::remove_all(folder_);
}

RedisAddress RedisServer::address() const { return address_in(folder_); }

void RedisServer::start() {
  const std::string socket = folder_ / "redis.sock";
  const std::string log = folder_ / "log";
  process_ = fork();
  if (process_ == 0) {
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    execlp("redis-server", "redis-server", "--port", "0", "--unixsocket", socket.c_str(), "--save",
           "", "--appendonly", "no", "--dir", folder_.c_str(), "--logfile", log.c_str(), nullptr);
    _exit(127);
  }
  for (int attempt = 0; attempt < 1000; ++attempt) {
    try {
      connection_.command({"PING"});
      return;
    } catch (const RedisError&) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  throw std::runtime_error("redis-server does not start; is it installed?");
}

void RedisServer::kill() {
  ::kill(process_, SIGKILL);
  waitpid(process_, nullptr, 0);
  process_ = 0;
  connection_.disconnect();
}

void RedisServer::make_group() {
  for (const std::string& stream : {keys::kJobs, keys::kQuickJobs}) {
    run({"XGROUP", "CREATE", stream, keys::kGroup, "0", "MKSTREAM"});
  }
}

std::string RedisServer::publish(const v1::Job& job) {
  return std::string(
      run({"XADD", keys::kJobs, "*", keys::kJobField, job.SerializeAsString()}).text());
}

std::vector<v1::JobResult> RedisServer::results() {
  const Reply entries = run({"XRANGE", keys::kResults, "-", "+"});
  std::vector<v1::JobResult> results(entries.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Reply fields = entries.at(i).at(1);
    if (fields.at(0).text() != keys::kResultField ||
        !results[i].ParseFromString(std::string(fields.at(1).text()))) {
      throw std::runtime_error("an entry of the result stream is not a result");
    }
  }
  return results;
}

std::size_t RedisServer::pending() {
  return static_cast<std::size_t>(run({"XPENDING", keys::kJobs, keys::kGroup}).at(0).integer());
}

v1::Job make_job(std::uint32_t tile_index) {
  v1::Job job;
  job.set_render_id("r1");
  job.set_tile_index(tile_index);
  job.mutable_tile()->set_width(2);
  job.mutable_tile()->set_height(2);
  job.set_end_sample(4);
  job.set_scene(std::string(32, 's'));
  job.set_film_width(64);
  job.set_film_height(32);
  job.set_engine(v1::ENGINE_CURRENT);
  return job;
}

}  // namespace nocturne::test
