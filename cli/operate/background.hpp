/// Work that may take its time, such as writing to a disk or to a pipe that is full, on a thread of its own:
/// the loop that must react never waits for it. In order; what there is no room for is
/// refused, and the caller counts it.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace ocm::cli::operate {

class Background {
 public:
  explicit Background(std::size_t most);
  /// Does what is left: see `finish`.
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// False: there is no room, and it will not be done.
  bool post(std::function<void()> work);
  /// Does all that is left, and ends. Writes that no program reads end by themselves after a signal.
  void finish();

 private:
  void run();

  std::size_t most_;  ///< that wait
  std::mutex mutex_;
  std::condition_variable more_;
  std::deque<std::function<void()>> work_;
  bool ends_ = false;
  std::thread thread_;
};

}  // namespace ocm::cli::operate
