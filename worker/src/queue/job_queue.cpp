#include "queue/job_queue.h"

#include "digest/sha256.h"
#include "log/log.h"
#include "queue/keys.h"
#include "queue/redis_errors.h"

namespace nocturne {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kBlock{1000};
// XAUTOCLAIM COUNT 1 looks at ten pending entries; so many calls look at most at 160 per take().
constexpr int kTakeOverCalls = 16;
constexpr const char* kStatusSeconds = "10";

std::string number(milliseconds duration) { return std::to_string(duration.count()); }

std::optional<std::string> field(const Reply& pairs, const std::string& name) {
  for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
    if (pairs.at(i).text() == name) return std::string(pairs.at(i + 1).text());
  }
  return std::nullopt;
}

}  // namespace

JobQueue::JobQueue(RedisAddress address, std::string consumer, milliseconds lease,
                   Identity identity, std::string stream)
    : connection_(std::move(address)),
      consumer_(std::move(consumer)),
      lease_(lease),
      identity_(std::move(identity)),
      stream_(std::move(stream)) {}

std::optional<TakenJob> JobQueue::take() {
  const auto now = std::chrono::steady_clock::now();
  if (now >= next_take_over_) {
    // First, and also while new jobs keep coming: other ranges of the tile wait for this one.
    next_take_over_ = now + kTakeOverInterval;
    if (auto job = take_over()) return job;
  }
  return take_new();
}

std::optional<TakenJob> JobQueue::take_new() {
  const Reply streams =
      connection_.command({"XREADGROUP", "GROUP", keys::kGroup, consumer_, "COUNT", "1", "BLOCK",
                           number(kBlock), "STREAMS", stream_, ">"});
  if (streams.is_nil() || streams.size() == 0) return std::nullopt;
  const Reply entries = streams.at(0).at(1);
  if (entries.size() == 0) return std::nullopt;
  return read_entry(entries.at(0));
}

std::optional<TakenJob> JobQueue::take_over() {
  for (int call = 0; call < kTakeOverCalls; ++call) {
    const Reply reply = connection_.command({"XAUTOCLAIM", stream_, keys::kGroup, consumer_,
                                             number(lease_), take_over_cursor_, "COUNT", "1"});
    take_over_cursor_ = reply.at(0).text();
    const Reply entries = reply.at(1);
    // Before Redis 7.0 a removed entry comes as nil.
    if (entries.size() > 0 && !entries.at(0).is_nil()) return read_entry(entries.at(0));
    if (take_over_cursor_ == "0-0") return std::nullopt;
  }
  return std::nullopt;
}

std::optional<TakenJob> JobQueue::read_entry(const Reply& entry) {
  TakenJob taken{.entry_id = std::string(entry.at(0).text()), .job = {}};
  const Reply fields = entry.at(1);
  const auto bytes = fields.is_nil() ? std::nullopt : field(fields, keys::kJobField);
  if (bytes && taken.job.ParseFromString(*bytes)) {
    taken.lease = field(fields, keys::kLeaseField).value_or("");
    return taken;
  }
  log_line(LogLevel::kWarning, "consumer=" + consumer_ + " dropped entry " + taken.entry_id +
                                   " of " + stream_ + ": its field '" + keys::kJobField +
                                   "' is not a job");
  drop(taken.entry_id);
  return std::nullopt;
}

void JobQueue::drop(const std::string& entry_id) {
  connection_.command({"XACK", stream_, keys::kGroup, entry_id});
  connection_.command({"XDEL", stream_, entry_id});
}

void JobQueue::complete(const std::string& entry_id, const v1::JobResult& result,
                        const std::string& lease) {
  RedisCommand add{"XADD", keys::kResults, "*", keys::kResultField, result.SerializeAsString()};
  if (!identity_.machine.empty()) {
    const std::string signature = hmac_sha256(identity_.key, lease + add.back());
    add.insert(add.end(),
               {keys::kMachineField, identity_.machine, keys::kSignatureField, signature});
  }
  const std::vector<Reply> replies =
      connection_.pipeline({{"MULTI"},
                            add,
                            {"XACK", stream_, keys::kGroup, entry_id},
                            {"XDEL", stream_, entry_id},
                            {"EXEC"}});
  // In order, so that the reason (-OOM of the XADD) comes before its consequence (-EXECABORT).
  for (const Reply& reply : replies) reply.throw_if_error();
  const Reply& executed = replies.back();
  if (executed.is_nil()) throw UnexpectedReply("Redis did not execute the transaction of a result");
  for (std::size_t i = 0; i < executed.size(); ++i) executed.at(i).throw_if_error();
}

void JobQueue::extend(const std::vector<HeldJob>& jobs) { set_idle(jobs, milliseconds{0}); }

void JobQueue::hand_back(const std::vector<HeldJob>& jobs) { set_idle(jobs, lease_); }

void JobQueue::set_idle(const std::vector<HeldJob>& jobs, milliseconds idle) {
  if (jobs.empty()) return;
  std::vector<RedisCommand> questions;
  for (const HeldJob& job : jobs) {
    questions.push_back(
        {"XPENDING", job.stream, keys::kGroup, job.entry_id, job.entry_id, "1", job.consumer});
  }
  const std::vector<Reply> answers = connection_.pipeline(questions);
  std::vector<RedisCommand> claims;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    // XCLAIM takes from anybody: a job that was taken over meanwhile stays where it is. Errors
    // (group wiped) mean the same: nothing to extend.
    if (answers[i].is_error() || answers[i].size() == 0) continue;
    claims.push_back({"XCLAIM", jobs[i].stream, keys::kGroup, jobs[i].consumer, "0",
                      jobs[i].entry_id, "IDLE", number(idle), "JUSTID"});
  }
  connection_.pipeline(claims);
}

std::vector<HeldJob> JobQueue::withdrawn(const std::vector<HeldJob>& jobs) {
  if (jobs.empty()) return {};
  RedisCommand question{"MGET"};
  for (const HeldJob& job : jobs) question.push_back(keys::withdrawn(job.stream, job.entry_id));
  const Reply marks = connection_.command(question);
  std::vector<HeldJob> found;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (!marks.at(i).is_nil()) found.push_back(jobs[i]);
  }
  return found;
}

std::optional<std::string> JobQueue::quarantine(const std::string& worker_id) {
  const Reply reasons = connection_.command(
      {"MGET", keys::quarantine(worker_id), keys::quarantine(identity_.machine)});
  for (std::size_t i = 0; i < reasons.size(); ++i) {
    if (!reasons.at(i).is_nil()) return std::string(reasons.at(i).text());
  }
  return std::nullopt;
}

void JobQueue::publish_status(const v1::WorkerStatus& status) {
  connection_.command(
      {"SET", keys::worker(status.worker_id()), status.SerializeAsString(), "EX", kStatusSeconds});
}

void JobQueue::withdraw_status(const std::string& worker_id) {
  connection_.command({"DEL", keys::worker(worker_id)});
}

}  // namespace nocturne
