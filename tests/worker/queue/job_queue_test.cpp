#include "queue/job_queue.h"

#include <gtest/gtest.h>

#include <thread>

#include "queue/keys.h"
#include "queue/redis_errors.h"
#include "queue/redis_server.h"

namespace nocturne {
namespace {

using std::chrono::milliseconds;
using test::make_job;

constexpr milliseconds kLease{400};

class JobQueueTest : public testing::Test {
 protected:
  JobQueueTest() { server_.make_group(); }

  JobQueue queue(const std::string& consumer) { return {server_.address(), consumer, kLease}; }

  std::string owner(const std::string& entry_id) {
    const Reply rows =
        server_.run({"XPENDING", keys::kJobs, keys::kGroup, entry_id, entry_id, "1"});
    return rows.size() == 0 ? "" : std::string(rows.at(0).at(1).text());
  }

  std::int64_t jobs_on_stream() { return server_.run({"XLEN", keys::kJobs}).integer(); }

  test::RedisServer server_;
};

v1::JobResult failure(const v1::Job& job) {
  v1::JobResult result;
  *result.mutable_job() = job;
  result.set_failure("because");
  return result;
}

TEST_F(JobQueueTest, TakesAndCompletes) {
  server_.publish(make_job(7));
  JobQueue queue = this->queue("w/0");
  const auto taken = queue.take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->job.SerializeAsString(), make_job(7).SerializeAsString());
  EXPECT_EQ(owner(taken->entry_id), "w/0");
  EXPECT_TRUE(server_.results().empty());

  queue.complete(taken->entry_id, failure(taken->job));
  ASSERT_EQ(server_.results().size(), 1U);
  EXPECT_EQ(server_.results()[0].job().tile_index(), 7U);
  EXPECT_EQ(server_.pending(), 0U);
  EXPECT_EQ(jobs_on_stream(), 0);
}

TEST_F(JobQueueTest, NothingToTake) { EXPECT_FALSE(queue("w/0").take()); }

TEST_F(JobQueueTest, EveryJobGoesToOneConsumer) {
  server_.publish(make_job(1));
  server_.publish(make_job(2));
  const auto first = queue("a/0").take();
  const auto second = queue("b/0").take();
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->job.tile_index(), 1U);
  EXPECT_EQ(second->job.tile_index(), 2U);
}

TEST_F(JobQueueTest, TakesOverAfterTheLeaseAndNotBefore) {
  const std::string id = server_.publish(make_job(1));
  ASSERT_TRUE(queue("dead/0").take());
  server_.publish(make_job(2));
  const auto fresh = queue("b/0").take();
  ASSERT_TRUE(fresh);
  EXPECT_EQ(fresh->job.tile_index(), 2U);
  std::this_thread::sleep_for(kLease + milliseconds(50));
  const auto abandoned = queue("c/0").take();
  ASSERT_TRUE(abandoned);
  EXPECT_EQ(abandoned->entry_id, id);
  EXPECT_EQ(abandoned->job.tile_index(), 1U);
}

// XAUTOCLAIM COUNT 1 looks at ten entries only.
TEST_F(JobQueueTest, TakesOverFromBehindManyLivingJobs) {
  JobQueue busy = queue("busy/0");
  std::vector<HeldJob> held;
  for (std::uint32_t i = 0; i < 35; ++i) {
    server_.publish(make_job(i));
    const auto taken = busy.take();
    ASSERT_TRUE(taken);
    held.push_back({"busy/0", taken->entry_id});
  }
  std::this_thread::sleep_for(kLease + milliseconds(50));
  held.pop_back();
  busy.extend(held);
  const auto abandoned = queue("b/0").take();
  ASSERT_TRUE(abandoned);
  EXPECT_EQ(abandoned->job.tile_index(), 34U);
}

TEST_F(JobQueueTest, TakesOverWhileNewJobsKeepComing) {
  server_.publish(make_job(1));
  ASSERT_TRUE(queue("dead/0").take());
  std::this_thread::sleep_for(kLease + milliseconds(50));
  server_.publish(make_job(2));
  const auto taken = queue("b/0").take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->job.tile_index(), 1U);
}

TEST_F(JobQueueTest, ExtendKeepsTheJob) {
  server_.publish(make_job());
  JobQueue owner = queue("a/0");
  const auto taken = owner.take();
  ASSERT_TRUE(taken);
  std::this_thread::sleep_for(kLease + milliseconds(50));
  owner.extend({{"a/0", taken->entry_id}});
  server_.publish(make_job(2));
  const auto other = queue("b/0").take();
  ASSERT_TRUE(other);
  EXPECT_EQ(other->job.tile_index(), 2U);
  EXPECT_EQ(this->owner(taken->entry_id), "a/0");
}

TEST_F(JobQueueTest, ExtendDoesNotStealBack) {
  server_.publish(make_job());
  JobQueue slept = queue("slept/0");
  const auto taken = slept.take();
  ASSERT_TRUE(taken);
  std::this_thread::sleep_for(kLease + milliseconds(50));
  ASSERT_TRUE(queue("b/0").take());
  slept.extend({{"slept/0", taken->entry_id}});
  EXPECT_EQ(owner(taken->entry_id), "b/0");
}

TEST_F(JobQueueTest, ExtendDoesNotCountAsDelivery) {
  server_.publish(make_job());
  JobQueue queue = this->queue("a/0");
  const auto taken = queue.take();
  ASSERT_TRUE(taken);
  for (int i = 0; i < 3; ++i) queue.extend({{"a/0", taken->entry_id}});
  const Reply rows = server_.run({"XPENDING", keys::kJobs, keys::kGroup, "-", "+", "1"});
  EXPECT_EQ(rows.at(0).at(3).integer(), 1);
}

TEST_F(JobQueueTest, HandedBackJobIsFreeAtOnce) {
  server_.publish(make_job(5));
  JobQueue first = queue("a/0");
  const auto taken = first.take();
  ASSERT_TRUE(taken);
  first.hand_back({{"a/0", taken->entry_id}});
  const auto again = queue("b/0").take();
  ASSERT_TRUE(again);
  EXPECT_EQ(again->entry_id, taken->entry_id);
}

TEST_F(JobQueueTest, CompletingAJobThatIsGoneStillPublishes) {
  server_.publish(make_job());
  JobQueue queue = this->queue("a/0");
  const auto taken = queue.take();
  ASSERT_TRUE(taken);
  server_.run({"FLUSHALL"});
  queue.complete(taken->entry_id, failure(taken->job));
  EXPECT_EQ(server_.results().size(), 1U);
}

TEST_F(JobQueueTest, WipedRedisSaysNoGroupUntilItIsMadeAgain) {
  JobQueue queue = this->queue("a/0");
  EXPECT_FALSE(queue.take());
  server_.run({"FLUSHALL"});
  try {
    queue.take();
    FAIL() << "took from nothing";
  } catch (const ErrorReply& error) {
    EXPECT_EQ(error.code(), "NOGROUP");
  }
  EXPECT_NO_THROW(queue.extend({{"a/0", "1-1"}}));
  server_.make_group();
  server_.publish(make_job());
  EXPECT_TRUE(queue.take());
}

TEST_F(JobQueueTest, RestartedRedisIsFoundAgain) {
  JobQueue queue = this->queue("a/0");
  EXPECT_FALSE(queue.take());
  server_.kill();
  EXPECT_THROW(queue.take(), ConnectionLost);
  EXPECT_THROW(queue.take(), ConnectionLost);
  server_.start();
  server_.make_group();
  server_.publish(make_job());
  EXPECT_TRUE(queue.take());
}

TEST_F(JobQueueTest, FullRedisRefusesAllOfAResult) {
  server_.publish(make_job());
  JobQueue queue = this->queue("a/0");
  const auto taken = queue.take();
  ASSERT_TRUE(taken);
  server_.run({"CONFIG", "SET", "maxmemory", "1"});
  try {
    queue.complete(taken->entry_id, failure(taken->job));
    FAIL() << "accepted";
  } catch (const ErrorReply& error) {
    EXPECT_EQ(error.code(), "OOM");
  }
  EXPECT_EQ(server_.pending(), 1U);
  server_.run({"CONFIG", "SET", "maxmemory", "0"});
  EXPECT_TRUE(server_.results().empty());
  queue.complete(taken->entry_id, failure(taken->job));
  EXPECT_EQ(server_.results().size(), 1U);
  EXPECT_EQ(server_.pending(), 0U);
}

TEST_F(JobQueueTest, EntriesThatAreNoJobAreDropped) {
  server_.run({"XADD", keys::kJobs, "*", "job", "\xff\xff not a job"});
  server_.run({"XADD", keys::kJobs, "*", "other", "field"});
  server_.publish(make_job(3));
  JobQueue queue = this->queue("a/0");
  EXPECT_FALSE(queue.take());
  EXPECT_FALSE(queue.take());
  const auto taken = queue.take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->job.tile_index(), 3U);
  EXPECT_EQ(jobs_on_stream(), 1);
  EXPECT_EQ(server_.pending(), 1U);
}

TEST_F(JobQueueTest, StatusLivesTenSeconds) {
  v1::WorkerStatus status;
  status.set_worker_id("w");
  status.set_threads(3);
  JobQueue queue = this->queue("w");
  queue.publish_status(status);
  v1::WorkerStatus read;
  ASSERT_TRUE(read.ParseFromString(std::string(server_.run({"GET", "nocturne:worker:w"}).text())));
  EXPECT_EQ(read.threads(), 3U);
  const std::int64_t left_ms = server_.run({"PTTL", "nocturne:worker:w"}).integer();
  EXPECT_GT(left_ms, 5000);
  EXPECT_LE(left_ms, 10000);
  queue.withdraw_status("w");
  EXPECT_EQ(server_.run({"EXISTS", "nocturne:worker:w"}).integer(), 0);
}

TEST_F(JobQueueTest, SignsOn) {
  server_.publish(make_job());
  server_.run({"ACL", "SETUSER", "worker", "on", ">secret", "~*", "+@all"});
  server_.run({"CONFIG", "SET", "requirepass", "other"});
  RedisAddress address = server_.address();
  EXPECT_THROW(JobQueue(address, "a/0", kLease).take(), ErrorReply);
  address.user = "worker";
  address.password = "wrong";
  EXPECT_THROW(JobQueue(address, "a/0", kLease).take(), ErrorReply);
  address.password = "secret";
  EXPECT_TRUE(JobQueue(address, "a/0", kLease).take());
}

}  // namespace
}  // namespace nocturne
