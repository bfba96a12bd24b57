// Loads a value per key once, also when several threads ask for it at the same time.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <future>
#include <list>
#include <mutex>
#include <string>
#include <utility>

namespace nocturne {

/// Keeps the `capacity` values used last (those being loaded included). For all threads; loading
/// one key does not hold up the others. A failed load is forgotten, all who waited get its
/// exception.
template <class Value>
class LoadOnce {
 public:
  using Load = std::function<Value(const std::string& key)>;

  explicit LoadOnce(std::size_t capacity) : capacity_(capacity) {}

  /// The value of `key`, from `load(key)` if it is not there.
  Value get(const std::string& key, const Load& load) {
    std::promise<Value> promise;
    std::shared_future<Value> future;
    if (find_or_announce(key, promise, future)) return future.get();
    try {
      promise.set_value(load(key));
    } catch (...) {
      forget(key);
      promise.set_exception(std::current_exception());
    }
    return future.get();
  }

  /// The next get() loads again.
  void forget(const std::string& key) {
    const std::lock_guard lock(mutex_);
    entries_.remove_if([&](const Entry& entry) { return entry.first == key; });
  }

 private:
  using Entry = std::pair<std::string, std::shared_future<Value>>;

  /// True: `future` is another call's. False: the caller has to keep `promise`.
  bool find_or_announce(const std::string& key, std::promise<Value>& promise,
                        std::shared_future<Value>& future) {
    const std::lock_guard lock(mutex_);
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
      if (entry->first != key) continue;
      entries_.splice(entries_.begin(), entries_, entry);
      future = entries_.front().second;
      return true;
    }
    future = promise.get_future().share();
    entries_.emplace_front(key, future);
    if (entries_.size() > capacity_) entries_.pop_back();
    return false;
  }

  std::size_t capacity_;
  std::mutex mutex_;
  // The last used comes first; few enough to be searched one by one.
  std::list<Entry> entries_;
};

}  // namespace nocturne
