// Loads a value per key, once for all threads that wait for it, on a separate thread: who waits
// can leave, and a load that takes too long, or that nobody waits for any more, is stopped.
#pragma once

#include <pthread.h>
#include <time.h>

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <exception>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

namespace nocturne {

/// Who waited was asked to stop.
class LoadStopped : public std::runtime_error {
 public:
  LoadStopped() : std::runtime_error("the scene was not loaded to its end") {}
};

/// Keeps the `capacity` values used last (those being loaded included). For all threads. A failed
/// load is forgotten and all who waited get its exception; one that took too long is remembered.
template <class Value>
class StoppableLoads {
 public:
  /// To be asked now and then whether to go on.
  using Load = std::function<Value(const std::string& key, std::stop_token stop)>;

  /// Threads of loads that were given up may call `load` for a while after this is gone: all that
  /// it uses must live as long as the process, or until they saw that they are to stop.
  StoppableLoads(std::size_t capacity, double max_cpu_seconds, Load load)
      : shared_(std::make_shared<Shared>(capacity, max_cpu_seconds, std::move(load))) {}
  ~StoppableLoads() {
    const std::lock_guard lock(shared_->mutex);
    for (const auto& one : shared_->kept) one->stop.request_stop();
  }
  StoppableLoads(const StoppableLoads&) = delete;
  StoppableLoads& operator=(const StoppableLoads&) = delete;

  /// Throws LoadStopped soon after a stop is requested, std::runtime_error where it took too long,
  /// and what the load throws.
  Value get(const std::string& key, std::stop_token stop) {
    std::unique_lock lock(shared_->mutex);
    const std::shared_ptr<One> one = find_or_begin(key);
    ++one->waiting;
    while (!one->is_over() && !stop.stop_requested()) {
      shared_->changed.wait_for(lock, stop, kLook, [&] { return one->is_over(); });
      if (!one->is_over() && one->cpu_seconds() > shared_->max_cpu_seconds) give_up(*one);
    }
    --one->waiting;
    if (!one->is_over() && one->waiting == 0) {
      one->stop.request_stop();
      shared_->kept.remove(one);
    }
    if (one->value) return *one->value;
    if (one->error) std::rethrow_exception(one->error);
    throw LoadStopped();
  }

 private:
  static constexpr std::chrono::milliseconds kLook{100};

  struct One {
    explicit One(std::string name) : key(std::move(name)) {}

    const std::string key;
    int waiting = 0;
    // Of the thread that loads, while it does.
    std::optional<clockid_t> clock;
    std::optional<Value> value;
    std::exception_ptr error;
    std::stop_source stop;

    bool is_over() const { return value || error; }
    double cpu_seconds() const {
      timespec time{};
      if (clock) clock_gettime(*clock, &time);
      return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }
  };

  struct Shared {
    Shared(std::size_t most, double seconds, Load how)
        : capacity(most), max_cpu_seconds(seconds), load(std::move(how)) {}

    const std::size_t capacity;
    const double max_cpu_seconds;
    const Load load;
    std::mutex mutex;
    std::condition_variable_any changed;
    // The last used comes first; few enough to be searched one by one.
    std::list<std::shared_ptr<One>> kept;
  };

  std::shared_ptr<One> find_or_begin(const std::string& key) {
    auto& kept = shared_->kept;
    for (auto one = kept.begin(); one != kept.end(); ++one) {
      if ((*one)->key != key) continue;
      kept.splice(kept.begin(), kept, one);
      return kept.front();
    }
    kept.push_front(std::make_shared<One>(key));
    if (kept.size() > shared_->capacity) kept.pop_back();
    // Both may outlive this.
    std::thread(run, shared_, kept.front()).detach();
    return kept.front();
  }

  static void run(const std::shared_ptr<Shared>& shared, const std::shared_ptr<One>& one) {
    {
      const std::lock_guard lock(shared->mutex);
      pthread_getcpuclockid(pthread_self(), &one->clock.emplace());
    }
    std::optional<Value> value;
    std::exception_ptr error;
    try {
      value.emplace(shared->load(one->key, one->stop.get_token()));
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(shared->mutex);
    one->clock.reset();
    // Else it was given up.
    if (!one->is_over()) {
      one->value = std::move(value);
      one->error = error;
      if (error) shared->kept.remove(one);
    }
    shared->changed.notify_all();
  }

  void give_up(One& one) {
    std::ostringstream text;
    text << "loading the scene was stopped after " << shared_->max_cpu_seconds
         << " s of processor time";
    one.error = std::make_exception_ptr(std::runtime_error(text.str()));
    one.stop.request_stop();
    shared_->changed.notify_all();
  }

  std::shared_ptr<Shared> shared_;
};

}  // namespace nocturne
