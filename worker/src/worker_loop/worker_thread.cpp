#include "worker_loop/worker_thread.h"

#include <chrono>
#include <new>
#include <sstream>
#include <string_view>
#include <utility>

#include "log/log.h"
#include "queue/keys.h"
#include "queue/redis_errors.h"
#include "worker_loop/check_job.h"

namespace nocturne {
namespace {

using Clock = std::chrono::steady_clock;

// The coordinator makes the group again within about this time.
constexpr std::chrono::milliseconds kGroupPause{200};
constexpr std::chrono::milliseconds kQuarantinePause{1000};

/// Text that fits a protobuf string (UTF-8) and a page.
std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 2000;
  std::string result(text.substr(0, kLongest));
  for (char& c : result) {
    if (c < 0x20 || c > 0x7e) c = '?';
  }
  return result;
}

std::string description(const v1::Job& job) {
  return "render=" + printable(job.render_id()) + " tile=" + std::to_string(job.tile_index()) +
         " samples=" + std::to_string(job.first_sample()) + ".." + std::to_string(job.end_sample());
}

void check_engine(const v1::Job& job, const std::string& worker_id) {
  if (job.engine() == v1::ENGINE_CURRENT) return;
  throw JobError("worker " + worker_id + " has engine " + std::to_string(int{v1::ENGINE_CURRENT}) +
                 ", the job needs engine " + std::to_string(int{job.engine()}) +
                 ": run coordinator and workers of the same version");
}

std::string too_long(const v1::Job& job) {
  std::ostringstream text;
  text << "it was stopped after " << job.max_cpu_seconds()
       << " s of processor time, far more than its samples should take";
  return text.str();
}

/// Not the job's fault: workers of its class do it.
void check_floating_point_profile(const v1::Job& job, const std::string& floating_point_profile) {
  if (job.floating_point_profile().empty() ||
      job.floating_point_profile() == floating_point_profile)
    return;
  throw HandBack("it needs a worker of floating-point profile " +
                 printable(job.floating_point_profile()) + ", this one has " +
                 floating_point_profile);
}

}  // namespace

WorkerThread::WorkerThread(const WorkerOptions& options, unsigned index, const TraceJob& trace,
                           RunningJobs& jobs, Tally& tally)
    : options_(options),
      index_(index),
      name_("worker=" + options.id + " thread=" + std::to_string(index)),
      trace_(trace),
      jobs_(jobs),
      tally_(tally),
      queue_(options.redis, keys::consumer(options.id, index), options.lease, options.identity,
             index < options.threads ? keys::kJobs : keys::kQuickJobs) {}

void WorkerThread::run(std::stop_token stop) {
  while (!stop.stop_requested()) {
    try {
      step(stop);
    } catch (const ErrorReply& error) {
      report_trouble(error.what());
      if (error.code() == "NOGROUP" || error.code() == "UNBLOCKED") {
        wait_unless_stopped(stop, kGroupPause);
      } else {
        back_off_.wait(stop);
      }
    } catch (const std::exception& error) {
      report_trouble(error.what());
      queue_.disconnect();
      back_off_.wait(stop);
    }
  }
}

void WorkerThread::step(std::stop_token stop) {
  if (const auto reason = queue_.quarantine(options_.id)) {
    report_trouble("is to take no jobs: " + printable(*reason));
    tally_.rest(index_);
    return wait_unless_stopped(stop, kQuarantinePause);
  }
  const std::optional<TakenJob> taken = queue_.take();
  back_off_.reset();
  last_trouble_.clear();
  if (taken) {
    work(*taken, stop);
  } else {
    tally_.rest(index_);
  }
}

void WorkerThread::work(const TakenJob& taken, std::stop_token stop) {
  if (stop.stop_requested()) return give_back(taken);
  std::optional<RunningJob> running;
  running.emplace(jobs_, queue_.held(taken.entry_id), taken.job.max_cpu_seconds());
  const auto start = Clock::now();
  const std::optional<v1::JobResult> result = result_of(taken.job, *running);
  if (!result) {
    const StopReason reason = running->stop_reason();
    // Else the heartbeat would keep it.
    running.reset();
    if (reason == StopReason::kWithdrawn) return queue_.drop(taken.entry_id);
    give_back(taken);
    // So that another worker, which may be in mid-job now, takes it before this one sees it again.
    return wait_unless_stopped(stop, options_.lease + JobQueue::kTakeOverInterval);
  }
  if (result->has_partial()) {
    tally_.record(index_, result->partial(),
                  std::chrono::duration<double>(Clock::now() - start).count());
  }
  deliver(taken, *result, stop);
}

/// Empty if the job has to go back, or nobody needs it any more.
std::optional<v1::JobResult> WorkerThread::result_of(const v1::Job& job, RunningJob& running) {
  v1::JobResult result;
  try {
    check_engine(job, options_.id);
    check_job(job);
    check_floating_point_profile(job, options_.floating_point_profile);
    *result.mutable_partial() = trace_(job, running);
  } catch (const HandBack& reason) {
    report_trouble(description(job) + " handed back: " + reason.what());
    return std::nullopt;
  } catch (const std::bad_alloc&) {
    result.set_failure("worker " + options_.id + " has not enough memory for this job");
  } catch (const std::exception& error) {
    const StopReason stopped = running.stop_reason();
    if (stopped == StopReason::kWithdrawn || stopped == StopReason::kShutdown) {
      log_line(LogLevel::kDebug, name_ + ' ' + description(job) + " stopped");
      return std::nullopt;
    }
    result.set_stopped_too_long(stopped == StopReason::kTooLong);
    result.set_failure(stopped == StopReason::kTooLong ? too_long(job) : printable(error.what()));
  }
  *result.mutable_job() = job;
  result.set_worker_id(options_.id);
  result.set_floating_point_profile(options_.floating_point_profile);
  if (result.has_failure()) report_trouble(description(job) + " failed: " + result.failure());
  return result;
}

void WorkerThread::deliver(const TakenJob& taken, const v1::JobResult& result,
                           std::stop_token stop) {
  // At least once, also when a stop has been requested meanwhile.
  while (true) {
    try {
      queue_.complete(taken.entry_id, result, taken.lease);
      log_line(LogLevel::kDebug, name_ + ' ' + description(taken.job) + " done");
      return back_off_.reset();
    } catch (const RedisError& error) {
      report_trouble(std::string("a result waits: ") + error.what());
      queue_.disconnect();
    }
    if (stop.stop_requested()) return;
    back_off_.wait(stop);
  }
}

void WorkerThread::give_back(const TakenJob& taken) {
  queue_.hand_back({queue_.held(taken.entry_id)});
}

void WorkerThread::report_trouble(const std::string& text) {
  if (text == std::exchange(last_trouble_, text)) return;
  log_line(LogLevel::kWarning, name_ + ' ' + text);
}

}  // namespace nocturne
