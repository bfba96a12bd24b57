// The jobs that the threads of this process are working on, so that one thread can keep all their
// leases alive.
#pragma once

#include <mutex>
#include <string>
#include <vector>

namespace nocturne {

/// An entry of the job stream, delivered to one consumer of the group.
struct HeldJob {
  std::string consumer;
  std::string entry_id;

  friend bool operator==(const HeldJob&, const HeldJob&) = default;
};

/// For all threads.
class HeldJobs {
 public:
  /// A job is held as long as this lives.
  class Hold {
   public:
    Hold(HeldJobs& all, HeldJob job);
    ~Hold();
    Hold(const Hold&) = delete;
    Hold& operator=(const Hold&) = delete;

   private:
    HeldJobs& all_;
    HeldJob job_;
  };

  std::vector<HeldJob> list() const;

 private:
  mutable std::mutex mutex_;
  std::vector<HeldJob> jobs_;
};

}  // namespace nocturne
