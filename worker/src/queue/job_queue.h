// Jobs and results on Redis streams, as one consumer of the group sees them.
//
// The stream is a hint: the coordinator knows the open ranges and merges a range once, so that a
// job done twice or a result delivered twice changes nothing.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "nocturne/v1/job.pb.h"
#include "queue/held_job.h"
#include "queue/identity.h"
#include "queue/redis_connection.h"

namespace nocturne {

struct TakenJob {
  std::string entry_id;
  v1::Job job;
  /// Proves that this worker was given the job; empty without enrolment.
  std::string lease{};
};

/// For one thread at a time; all functions throw RedisError, after which they may be called again.
class JobQueue {
 public:
  /// How often take() looks for jobs whose lease ran out.
  static constexpr std::chrono::milliseconds kTakeOverInterval{1000};

  /// `lease`: a job that nobody extended for so long is taken over by another consumer.
  /// `stream`: where jobs are taken from.
  JobQueue(RedisAddress address, std::string consumer, std::chrono::milliseconds lease,
           Identity identity = {}, std::string stream = keys::kJobs);

  /// The next job: one whose lease ran out, else a new one; waits for about a second.
  /// Entries that are no job are dropped with a log line.
  /// Throws ErrorReply with code NOGROUP while the coordinator has not made the group (again).
  std::optional<TakenJob> take();

  /// Publishes the result, signed with `lease` and our key if there is one, and acknowledges and
  /// removes the job, in one transaction.
  /// Returns only if Redis has accepted all of it. Throws ErrorReply with code OOM if Redis is
  /// full.
  void complete(const std::string& entry_id, const v1::JobResult& result,
                const std::string& lease = "");

  /// Renews the leases of those jobs that still belong to their consumer.
  void extend(const std::vector<HeldJob>& jobs);

  /// Lets other consumers take these jobs at once instead of after the lease.
  void hand_back(const std::vector<HeldJob>& jobs);

  /// Those of these jobs that the coordinator needs no more: their render was cancelled, paused or
  /// ended.
  std::vector<HeldJob> withdrawn(const std::vector<HeldJob>& jobs);

  /// Acknowledges and removes an entry of which nobody needs the result.
  void drop(const std::string& entry_id);

  /// Why the coordinator takes no results of this worker, or of its machine; empty if it does.
  std::optional<std::string> quarantine(const std::string& worker_id);

  /// Says for the next ten seconds that this worker lives.
  void publish_status(const v1::WorkerStatus& status);

  /// The worker has gone.
  void withdraw_status(const std::string& worker_id);

  /// An entry that this took.
  HeldJob held(const std::string& entry_id) const { return {consumer_, entry_id, stream_}; }

  /// Forgets the connection; the next call makes a new one.
  void disconnect() { connection_.disconnect(); }

 private:
  std::optional<TakenJob> take_new();
  std::optional<TakenJob> take_over();
  std::optional<TakenJob> read_entry(const Reply& entry);
  void set_idle(const std::vector<HeldJob>& jobs, std::chrono::milliseconds idle);

  RedisConnection connection_;
  std::string consumer_;
  std::chrono::milliseconds lease_;
  Identity identity_;
  std::string stream_;
  std::chrono::steady_clock::time_point next_take_over_;
  // Where the search for jobs with an outrun lease goes on.
  std::string take_over_cursor_ = "0-0";
};

}  // namespace nocturne
