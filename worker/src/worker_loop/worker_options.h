// What a worker needs to know.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <string>

#include "nocturne/v1/job.pb.h"
#include "queue/identity.h"
#include "queue/redis_address.h"
#include "worker_loop/running_jobs.h"

namespace nocturne {

/// This worker can't do the job now, another might: the job goes back instead of failing.
class HandBack : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Does a job that check_job() accepts; called by several threads at once. Throws HandBack, or
/// anything else with the reason why the job can't be done; anything after running.stop_token()
/// said to stop.
using TraceJob = std::function<v1::Partial(const v1::Job& job, RunningJob& running)>;

struct WorkerOptions {
  RedisAddress redis;
  /// Unique among the workers of one Redis; of one that enrolled, "<machine>/<name>".
  std::string id;
  Identity identity{};
  /// See rounding/floating_point_profile.h; jobs of other classes are handed back.
  std::string floating_point_profile;
  unsigned threads = 1;
  /// By so much, 0 to 19, the threads' nice value is raised, but for that of quick copies: others
  /// on the machine wait for an answer, and traced is all day.
  int nice = 0;
  /// Its time is set whenever Redis has heard that this worker lives, for probes; empty: none.
  std::filesystem::path alive{};
  /// A job that was not extended for so long is somebody else's; it is extended every third of it.
  std::chrono::milliseconds lease{10000};
};

}  // namespace nocturne
