#include "assets/load_once.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace nocturne {
namespace {

TEST(LoadOnce, ThreadsShareOneLoad) {
  LoadOnce<int> values(2);
  std::atomic<int> loads = 0;
  std::atomic<int> sum = 0;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 8; ++i) {
      threads.emplace_back([&] {
        sum += values.get("a", [&](const std::string&) {
          ++loads;
          std::this_thread::sleep_for(std::chrono::milliseconds(50));
          return 5;
        });
      });
    }
  }
  EXPECT_EQ(loads, 1);
  EXPECT_EQ(sum, 40);
}

TEST(LoadOnce, OtherKeysAreNotHeldUp) {
  LoadOnce<int> values(2);
  std::promise<void> go_on;
  std::promise<void> loading;
  std::jthread slow([&] {
    values.get("slow", [&](const std::string&) {
      loading.set_value();
      go_on.get_future().wait();
      return 1;
    });
  });
  loading.get_future().wait();
  EXPECT_EQ(values.get("fast", [](const std::string&) { return 2; }), 2);
  go_on.set_value();
}

TEST(LoadOnce, KeepsTheLastUsed) {
  LoadOnce<std::string> values(2);
  std::vector<std::string> loads;
  const auto load = [&](const std::string& key) {
    loads.push_back(key);
    return key;
  };
  for (const char* key : {"a", "b", "a", "c", "a", "b"}) EXPECT_EQ(values.get(key, load), key);
  EXPECT_EQ(loads, (std::vector<std::string>{"a", "b", "c", "b"}));
}

TEST(LoadOnce, FailureIsForgotten) {
  LoadOnce<int> values(2);
  EXPECT_THROW(
      values.get("a", [](const std::string&) -> int { throw std::runtime_error("not now"); }),
      std::runtime_error);
  EXPECT_EQ(values.get("a", [](const std::string&) { return 3; }), 3);
}

}  // namespace
}  // namespace nocturne
