// A worker's threads against a real Redis: jobs taken, done, handed back, stopped and withdrawn.
// One file, though long: all tests share one worker, one server and the jobs on it.
#include "worker_loop/worker.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
#include <set>
#include <thread>

#include "digest/sha256.h"
#include "queue/job_queue.h"
#include "queue/redis_server.h"

namespace nocturne {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using test::make_job;

constexpr milliseconds kLease{600};

v1::Partial some_partial() {
  v1::Partial partial;
  partial.set_sums(std::string(2 * 2 * 4 * 8, '\1'));
  partial.set_photons(16);
  partial.set_rays(40);
  return partial;
}

bool eventually(const std::function<bool()>& condition) {
  for (int attempt = 0; attempt < 1500; ++attempt) {
    if (condition()) return true;
    std::this_thread::sleep_for(milliseconds(10));
  }
  return false;
}

class WorkerTest : public testing::Test {
 protected:
  WorkerTest() { server_.make_group(); }

  WorkerOptions options(const std::string& id, unsigned threads = 1) {
    return {.redis = server_.address(),
            .id = id,
            .floating_point_profile = "a1",
            .threads = threads,
            .lease = kLease};
  }

  bool results_reach(std::size_t count) {
    return eventually([&] { return server_.results().size() >= count; });
  }

  std::string publish_quick(const v1::Job& job) {
    return std::string(
        server_.run({"XADD", "nocturne:quick", "*", "job", job.SerializeAsString()}).text());
  }

  v1::JobResult only_result() {
    EXPECT_TRUE(results_reach(1));
    const auto results = server_.results();
    return results.size() == 1 ? results[0] : v1::JobResult();
  }

  test::RedisServer server_;
};

TEST_F(WorkerTest, InQuarantineItTakesNoJobs) {
  server_.run({"SET", "nocturne:quarantine:w", "It lied."});
  std::atomic<int> traced = 0;
  Worker worker(options("w"), [&](const v1::Job&, RunningJob&) {
    ++traced;
    return some_partial();
  });
  server_.publish(make_job(0));
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_EQ(traced, 0);
  EXPECT_EQ(server_.pending(), 0U);
  server_.run({"DEL", "nocturne:quarantine:w"});
  EXPECT_TRUE(results_reach(1));
}

TEST_F(WorkerTest, DoesAllJobsAndSaysSo) {
  Worker worker(options("w", 2), [](const v1::Job&, RunningJob&) { return some_partial(); });
  for (std::uint32_t i = 0; i < 20; ++i) server_.publish(make_job(i));
  ASSERT_TRUE(results_reach(20));
  std::set<std::uint32_t> tiles;
  for (const v1::JobResult& result : server_.results()) {
    EXPECT_EQ(result.worker_id(), "w");
    EXPECT_EQ(result.floating_point_profile(), "a1");
    EXPECT_EQ(result.partial().sums(), some_partial().sums());
    tiles.insert(result.job().tile_index());
  }
  EXPECT_EQ(tiles.size(), 20U);
  EXPECT_EQ(server_.pending(), 0U);

  v1::WorkerStatus status;
  EXPECT_TRUE(eventually([&] {
    const Reply bytes = server_.run({"GET", "nocturne:worker:w"});
    return !bytes.is_nil() && status.ParseFromString(std::string(bytes.text())) &&
           status.jobs_done() == 20;
  }));
  EXPECT_EQ(status.photons(), 320U);
  EXPECT_EQ(status.rays(), 800U);
  EXPECT_EQ(status.threads(), 2U);
  EXPECT_EQ(status.engine(), v1::ENGINE_CURRENT);
  EXPECT_EQ(status.floating_point_profile(), "a1");
  EXPECT_GT(status.started(), 1e9);
}

TEST_F(WorkerTest, GoneWorkerHasNoStatus) {
  {
    Worker worker(options("w"), [](const v1::Job&, RunningJob&) { return some_partial(); });
    EXPECT_TRUE(eventually([&] {
      return server_.run({"EXISTS", "nocturne:worker:w"}).integer() == 1;
    }));
  }
  EXPECT_EQ(server_.run({"EXISTS", "nocturne:worker:w"}).integer(), 0);
}

TEST_F(WorkerTest, ProbesSeeThatItLivesWhileRedisHearsIt) {
  WorkerOptions watched = options("w");
  watched.alive =
      std::filesystem::temp_directory_path() /
      ("nocturne-alive-" + std::to_string(testing::UnitTest::GetInstance()->random_seed()) +
       std::to_string(getpid()));
  Worker worker(watched, [](const v1::Job&, RunningJob&) { return some_partial(); });
  EXPECT_TRUE(eventually([&] { return std::filesystem::exists(watched.alive); }));
  std::filesystem::remove(watched.alive);
  EXPECT_TRUE(eventually([&] { return std::filesystem::exists(watched.alive); }));
  server_.kill();
  std::this_thread::sleep_for(milliseconds(500));
  std::filesystem::remove(watched.alive);
  std::this_thread::sleep_for(seconds(3));
  EXPECT_FALSE(std::filesystem::exists(watched.alive));
  server_.start();
  server_.make_group();
}

TEST_F(WorkerTest, SignsWithItsKeyAndTheLeaseOfTheJob) {
  WorkerOptions enrolled = options("m/w");
  enrolled.identity = {.machine = "m", .key = "the key"};
  Worker worker(enrolled, [](const v1::Job&, RunningJob&) { return some_partial(); });
  server_.run(
      {"XADD", "nocturne:jobs", "*", "job", make_job().SerializeAsString(), "lease", "secret"});
  ASSERT_TRUE(results_reach(1));
  const Reply fields = server_.run({"XRANGE", "nocturne:results", "-", "+"}).at(0).at(1);
  ASSERT_EQ(fields.size(), 6U);
  const std::string result(fields.at(1).text());
  EXPECT_EQ(fields.at(3).text(), "m");
  EXPECT_EQ(fields.at(5).text(), hmac_sha256("the key", "secret" + result));
}

TEST_F(WorkerTest, InQuarantineOfItsMachineItTakesNoJobs) {
  server_.run({"SET", "nocturne:quarantine:m", "It lied."});
  WorkerOptions enrolled = options("m/w");
  enrolled.identity = {.machine = "m", .key = "the key"};
  Worker worker(enrolled, [](const v1::Job&, RunningJob&) { return some_partial(); });
  server_.publish(make_job(0));
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_EQ(server_.pending(), 0U);
}

TEST_F(WorkerTest, ExceptionBecomesFailure) {
  Worker worker(options("w"), [](const v1::Job&, RunningJob&) -> v1::Partial {
    throw std::runtime_error("no such kernel \xff");
  });
  server_.publish(make_job());
  const v1::JobResult result = only_result();
  EXPECT_EQ(result.failure(), "no such kernel ?");
  EXPECT_EQ(result.job().SerializeAsString(), make_job().SerializeAsString());
  EXPECT_EQ(server_.pending(), 0U);
}

TEST_F(WorkerTest, BadJobIsRefusedBeforeItIsTraced) {
  std::atomic<bool> traced = false;
  Worker worker(options("w"), [&](const v1::Job&, RunningJob&) {
    traced = true;
    return some_partial();
  });
  v1::Job job = make_job();
  job.mutable_tile()->set_width(1U << 31);
  server_.publish(job);
  EXPECT_TRUE(only_result().failure().starts_with("job.tile.width is 2147483648"));
  EXPECT_FALSE(traced);
}

TEST_F(WorkerTest, OtherEngineIsRefusedInWords) {
  Worker worker(options("w"), [](const v1::Job&, RunningJob&) { return some_partial(); });
  v1::Job job = make_job();
  job.set_engine(static_cast<v1::Engine>(77));
  server_.publish(job);
  const std::string failure = only_result().failure();
  EXPECT_NE(failure.find("engine " + std::to_string(int{v1::ENGINE_CURRENT})), std::string::npos);
  EXPECT_NE(failure.find("engine 77"), std::string::npos);
}

TEST_F(WorkerTest, JobOfAnotherFloatingPointProfileIsLeftToThatClass) {
  v1::Job job = make_job();
  job.set_floating_point_profile("b2");
  std::atomic<int> traced_by_stranger = 0;
  testing::internal::CaptureStderr();
  Worker stranger(options("stranger"), [&](const v1::Job&, RunningJob&) {
    ++traced_by_stranger;
    return some_partial();
  });
  server_.publish(job);
  ASSERT_TRUE(eventually([&] { return server_.pending() == 1; }));
  WorkerOptions fitting = options("fitting");
  fitting.floating_point_profile = "b2";
  Worker other(fitting, [](const v1::Job&, RunningJob&) { return some_partial(); });
  EXPECT_EQ(only_result().worker_id(), "fitting");
  EXPECT_EQ(traced_by_stranger, 0);
  EXPECT_NE(testing::internal::GetCapturedStderr().find(
                "handed back: it needs a worker of floating-point profile b2, this one has a1"),
            std::string::npos);
}

TEST_F(WorkerTest, JobHandedBackIsDoneByAnother) {
  std::atomic<int> refused = 0;
  testing::internal::CaptureStderr();
  Worker full(options("full"), [&](const v1::Job&, RunningJob&) -> v1::Partial {
    ++refused;
    throw HandBack("disk full");
  });
  v1::Job job = make_job();
  server_.publish(job);
  ASSERT_TRUE(eventually([&] { return refused > 0; }));
  Worker good(options("good"), [](const v1::Job&, RunningJob&) { return some_partial(); });
  EXPECT_EQ(only_result().worker_id(), "good");
  const std::string samples =
      std::to_string(job.first_sample()) + ".." + std::to_string(job.end_sample());
  const std::string line = "Z WARNING worker=full thread=0 render=" + job.render_id() +
                           " tile=" + std::to_string(job.tile_index()) + " samples=" + samples +
                           " handed back: disk full\n";
  EXPECT_NE(testing::internal::GetCapturedStderr().find(line), std::string::npos);
}

TEST_F(WorkerTest, JobLongerThanTheLeaseIsDoneOnce) {
  std::atomic<int> traced = 0;
  const TraceJob slow = [&](const v1::Job&, RunningJob&) {
    ++traced;
    std::this_thread::sleep_for(4 * kLease);
    return some_partial();
  };
  Worker a(options("a"), slow);
  Worker b(options("b"), slow);
  server_.publish(make_job());
  EXPECT_TRUE(only_result().has_partial());
  EXPECT_EQ(traced, 1);
}

TEST_F(WorkerTest, ResultSurvivesARestartOfRedis) {
  std::promise<void> tracing, go_on;
  Worker worker(options("w"), [&](const v1::Job&, RunningJob&) {
    tracing.set_value();
    go_on.get_future().wait();
    return some_partial();
  });
  server_.publish(make_job(9));
  tracing.get_future().wait();
  server_.kill();
  go_on.set_value();
  std::this_thread::sleep_for(milliseconds(300));
  server_.start();
  EXPECT_EQ(only_result().job().tile_index(), 9U);
}

TEST_F(WorkerTest, GoesOnAfterFlushAll) {
  Worker worker(options("w"), [](const v1::Job&, RunningJob&) { return some_partial(); });
  server_.publish(make_job(1));
  ASSERT_TRUE(results_reach(1));
  server_.run({"FLUSHALL"});
  std::this_thread::sleep_for(milliseconds(300));
  server_.make_group();
  server_.publish(make_job(2));
  EXPECT_EQ(only_result().job().tile_index(), 2U);
}

TEST_F(WorkerTest, ResultWaitsForMemoryInRedis) {
  std::promise<void> tracing, go_on;
  Worker worker(options("w"), [&](const v1::Job&, RunningJob&) {
    tracing.set_value();
    go_on.get_future().wait();
    return some_partial();
  });
  server_.publish(make_job());
  tracing.get_future().wait();
  server_.run({"CONFIG", "SET", "maxmemory", "1"});
  go_on.set_value();
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_TRUE(server_.results().empty());
  server_.run({"CONFIG", "SET", "maxmemory", "0"});
  EXPECT_TRUE(only_result().has_partial());
}

TEST_F(WorkerTest, StopWaitsForTheJobAtHand) {
  std::promise<void> tracing;
  Worker worker(options("w"), [&](const v1::Job&, RunningJob&) {
    tracing.set_value();
    std::this_thread::sleep_for(milliseconds(300));
    return some_partial();
  });
  server_.publish(make_job(1));
  tracing.get_future().wait();
  server_.publish(make_job(2));
  EXPECT_TRUE(worker.stop(seconds(20)));
  EXPECT_EQ(server_.results().size(), 1U);
}

// Traces until a stop is requested, and takes processor time for it.
v1::Partial trace_for_ever(const v1::Job&, RunningJob& running) {
  running.begin_tracing();
  while (!running.stop_token().stop_requested()) {
  }
  throw std::runtime_error("stopped");
}

TEST_F(WorkerTest, JobThatIsWithdrawnFreesItsThreadWithinTwoSeconds) {
  Worker worker(options("w"), [](const v1::Job& job, RunningJob& running) {
    return job.tile_index() == 1 ? trace_for_ever(job, running) : some_partial();
  });
  const std::string entry = server_.publish(make_job(1));
  ASSERT_TRUE(eventually([&] { return server_.pending() == 1; }));
  const auto start = std::chrono::steady_clock::now();
  server_.run({"SET", "nocturne:withdrawn:" + entry, "", "EX", "60"});
  server_.publish(make_job(2));
  EXPECT_EQ(only_result().job().tile_index(), 2U);
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(2));
  EXPECT_EQ(server_.pending(), 0U);
}

TEST_F(WorkerTest, JobBeyondItsProcessorTimeIsAFailureThatSaysSo) {
  Worker worker(options("w"), trace_for_ever);
  v1::Job job = make_job();
  job.set_max_cpu_seconds(0.25);
  server_.publish(job);
  EXPECT_EQ(only_result().failure(),
            "it was stopped after 0.25 s of processor time, far more than its samples should take");
}

TEST_F(WorkerTest, QuickCopyIsDoneWhileLongJobsHoldAllThreads) {
  std::atomic<int> quick = 0;
  Worker worker(options("w", 2), [&](const v1::Job& job, RunningJob& running) {
    running.begin_tracing();
    if (job.tile_index() >= 2) {
      ++quick;
      return some_partial();
    }
    while (!running.stop_token().stop_requested()) std::this_thread::sleep_for(milliseconds(10));
    throw std::runtime_error("stopped");
  });
  // Two that have no end hold the threads, and a third waits behind them.
  for (const std::uint32_t tile : {0U, 1U, 2U}) server_.publish(make_job(tile));
  EXPECT_TRUE(eventually([&] { return server_.pending() == 2U; }));
  publish_quick(make_job(3));
  EXPECT_EQ(only_result().job().tile_index(), 3U);
  EXPECT_EQ(quick, 1);
  EXPECT_EQ(server_.run({"XLEN", "nocturne:quick"}).integer(), 0);
  EXPECT_TRUE(worker.stop(milliseconds(1500)));
}

TEST_F(WorkerTest, LongJobsGiveWayToQuickCopies) {
  std::atomic<int> of_long = -1, of_quick = -1;
  WorkerOptions all = options("w", 1);
  all.nice = 3;
  const Worker worker(all, [&](const v1::Job& job, RunningJob&) {
    (job.tile_index() == 0 ? of_long : of_quick) = getpriority(PRIO_PROCESS, 0);
    return some_partial();
  });
  server_.publish(make_job(0));
  publish_quick(make_job(1));
  EXPECT_TRUE(results_reach(2));
  const int ours = getpriority(PRIO_PROCESS, 0);
  EXPECT_EQ(of_quick, ours);
  EXPECT_EQ(of_long, std::min(19, ours + 3));
}

TEST_F(WorkerTest, QuickCopyIsStoppedWhileItsSceneLoadsTooLong) {
  Worker worker(options("w"), [&](const v1::Job&, RunningJob& running) -> v1::Partial {
    while (!running.stop_token().stop_requested()) std::this_thread::sleep_for(milliseconds(10));
    throw std::runtime_error("stopped");
  });
  publish_quick(make_job(0));
  EXPECT_TRUE(only_result().stopped_too_long());
}

TEST_F(WorkerTest, QuickCopyIsWithdrawnHandedBackAndTakenOver) {
  std::atomic<int> begun = 0;
  const TraceJob endless = [&](const v1::Job&, RunningJob& running) -> v1::Partial {
    ++begun;
    running.begin_tracing();
    while (!running.stop_token().stop_requested()) std::this_thread::sleep_for(milliseconds(10));
    throw std::runtime_error("stopped");
  };
  Worker first(options("first"), endless);
  const std::string entry = publish_quick(make_job(0));
  EXPECT_TRUE(eventually([&] { return begun == 1; }));
  EXPECT_TRUE(first.stop(milliseconds(1500)));
  Worker second(options("second"), endless);
  EXPECT_TRUE(eventually([&] { return begun == 2; }));
  // That of the same entry of the other stream is another job.
  server_.run({"SET", "nocturne:withdrawn:" + entry, ""});
  std::this_thread::sleep_for(milliseconds(1000));
  EXPECT_EQ(server_.run({"XLEN", "nocturne:quick"}).integer(), 1);
  server_.run({"SET", "nocturne:withdrawn:quick:" + entry, ""});
  EXPECT_TRUE(eventually([&] { return server_.run({"XLEN", "nocturne:quick"}).integer() == 0; }));
  EXPECT_TRUE(server_.results().empty());
}

TEST_F(WorkerTest, JobThatOutlastsTheGraceIsStoppedAndHandedBack) {
  WorkerOptions slow = options("w", 2);
  slow.lease = seconds(60);
  Worker worker(slow, trace_for_ever);
  server_.publish(make_job(3));
  ASSERT_TRUE(eventually([&] { return server_.pending() == 1; }));
  const auto start = std::chrono::steady_clock::now();
  // The other thread waits for a job, a second at most.
  EXPECT_TRUE(worker.stop(milliseconds(1100)));
  EXPECT_LT(std::chrono::steady_clock::now() - start, seconds(2));
  JobQueue other(server_.address(), "other/0", seconds(60));
  const auto taken = other.take();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->job.tile_index(), 3U);
}

TEST_F(WorkerTest, JobThatCanNotBeStoppedIsHandedBackAllTheSame) {
  constexpr seconds kLongLease{60};
  WorkerOptions slow = options("w");
  slow.lease = kLongLease;
  std::promise<void> tracing, go_on;
  Worker worker(slow, [&](const v1::Job&, RunningJob&) {
    tracing.set_value();
    go_on.get_future().wait();
    return some_partial();
  });
  server_.publish(make_job(3));
  tracing.get_future().wait();
  EXPECT_FALSE(worker.stop(milliseconds(50)));
  JobQueue other(server_.address(), "other/0", kLongLease);
  worker.hand_back();
  const auto taken = other.take();
  go_on.set_value();
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->job.tile_index(), 3U);
}

}  // namespace
}  // namespace nocturne
