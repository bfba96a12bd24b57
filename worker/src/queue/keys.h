// All names in Redis that a worker uses. The coordinator's list of the same names:
// nocturne_coordinator/queue/keys.py.
#pragma once

#include <string>

namespace nocturne::keys {

/// Stream of jobs, consumer group kGroup; one field kJobField with a serialised v1::Job.
inline const std::string kJobs = "nocturne:jobs";
inline const std::string kGroup = "workers";
inline const std::string kJobField = "job";

/// The same for copies of jobs of small renders, which two further threads of each worker do.
inline const std::string kQuickJobs = "nocturne:quick";

/// Stream of results; one field kResultField with a serialised v1::JobResult.
inline const std::string kResults = "nocturne:results";
inline const std::string kResultField = "result";

/// Where workers enrol: of a job, a secret of who took it; of a result, who signed it, and how.
inline const std::string kLeaseField = "lease";
inline const std::string kMachineField = "machine";
inline const std::string kSignatureField = "signature";

/// Serialised v1::WorkerStatus with a time to live.
inline std::string worker(const std::string& worker_id) { return "nocturne:worker:" + worker_id; }

/// Why the worker's results are not taken, with a time to live; missing: they are.
inline std::string quarantine(const std::string& worker_id) {
  return "nocturne:quarantine:" + worker_id;
}

/// Says that nobody needs the job of this entry any more, with a time to live.
inline std::string withdrawn(const std::string& stream, const std::string& entry_id) {
  return (stream == kQuickJobs ? "nocturne:withdrawn:quick:" : "nocturne:withdrawn:") + entry_id;
}

/// Name of one thread of a worker in the consumer group.
inline std::string consumer(const std::string& worker_id, unsigned thread) {
  return worker_id + "/" + std::to_string(thread);
}

}  // namespace nocturne::keys
