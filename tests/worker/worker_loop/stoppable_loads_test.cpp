#include "worker_loop/stoppable_loads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <vector>

namespace nocturne {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

constexpr double kAnyTime = 1e9;
// The promised time until a thread is free whose job is no longer needed.
constexpr auto kFree = 2s;

TEST(StoppableLoads, ThreadsShareOneLoad) {
  std::atomic<int> loads = 0, sum = 0;
  StoppableLoads<int> values(2, kAnyTime, [&](const std::string&, const std::stop_token&) {
    ++loads;
    std::this_thread::sleep_for(50ms);
    return 5;
  });
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) threads.emplace_back([&] { sum += values.get("a", {}); });
  }
  EXPECT_EQ(loads, 1);
  EXPECT_EQ(sum, 40);
}

TEST(StoppableLoads, KeepsTheLastUsed) {
  std::vector<std::string> loads;
  StoppableLoads<std::string> values(2, kAnyTime, [&](const std::string& key, std::stop_token) {
    loads.push_back(key);
    return key;
  });
  for (const char* key : {"a", "b", "a", "c", "a", "b"}) EXPECT_EQ(values.get(key, {}), key);
  EXPECT_EQ(loads, (std::vector<std::string>{"a", "b", "c", "b"}));
}

TEST(StoppableLoads, AFailedLoadIsTriedAgain) {
  std::atomic<int> loads = 0;
  StoppableLoads<int> values(2, kAnyTime, [&](const std::string&, std::stop_token) {
    if (++loads == 1) throw std::invalid_argument("no");
    return 7;
  });
  EXPECT_THROW(values.get("a", {}), std::invalid_argument);
  EXPECT_EQ(values.get("a", {}), 7);
}

// Loads until a stop is requested, and counts its calls.
struct Endless {
  std::atomic<int> begun = 0, ended = 0;
  bool busy = false;

  int operator()(std::stop_token stop) {
    ++begun;
    while (!stop.stop_requested()) {
      if (!busy) std::this_thread::sleep_for(1ms);
    }
    ++ended;
    throw std::runtime_error("stopped");
  }
  static void wait_for(const std::atomic<int>& count, int expected) {
    while (count < expected) std::this_thread::sleep_for(1ms);
  }
};

TEST(StoppableLoads, WhoIsStoppedLeavesAndOthersWaitOn) {
  Endless endless;
  StoppableLoads<int> values(
      2, kAnyTime, [&](const std::string&, std::stop_token stop) { return endless(stop); });
  std::stop_source first, second;
  const auto leave = [&](std::stop_source& source) {
    return std::async(std::launch::async, [&] { return values.get("a", source.get_token()); });
  };
  auto a = leave(first), b = leave(second);
  Endless::wait_for(endless.begun, 1);
  const auto asked = Clock::now();
  first.request_stop();
  EXPECT_THROW(a.get(), LoadStopped);
  EXPECT_LT(Clock::now() - asked, kFree);
  EXPECT_EQ(endless.ended, 0);
  second.request_stop();
  EXPECT_THROW(b.get(), LoadStopped);
  // Nobody waits any more.
  Endless::wait_for(endless.ended, 1);
  // The next caller starts a new load.
  std::stop_source third;
  auto c = leave(third);
  Endless::wait_for(endless.begun, 2);
  third.request_stop();
  EXPECT_THROW(c.get(), LoadStopped);
  Endless::wait_for(endless.ended, 2);
}

TEST(StoppableLoads, WhatTakesTooLongIsStoppedAndNotTriedAgain) {
  Endless endless;
  endless.busy = true;
  StoppableLoads<int> values(
      2, 0.2, [&](const std::string&, std::stop_token stop) { return endless(stop); });
  for (int i = 0; i < 3; ++i) {
    try {
      values.get("a", {});
      FAIL() << "loaded";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "loading the scene was stopped after 0.2 s of processor time");
    }
  }
  Endless::wait_for(endless.ended, 1);
  EXPECT_EQ(endless.begun, 1);
}

// Of processor time: a disk or a network that is slow is nobody's fault.
TEST(StoppableLoads, WaitingIsNotWork) {
  StoppableLoads<int> values(2, 0.2, [](const std::string&, std::stop_token) {
    std::this_thread::sleep_for(600ms);
    return 3;
  });
  EXPECT_EQ(values.get("a", {}), 3);
}

}  // namespace
}  // namespace nocturne
