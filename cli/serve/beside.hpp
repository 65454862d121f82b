/// The page beside a verb that has a bus or a line itself: in a thread of its own, as a program that joins.
#pragma once

#include <atomic>
#include <thread>

#include "cli/serve/server.hpp"

namespace ocm::cli::serve {

class PageBeside {
 public:
  /// `options.over` is its own. The session must outlive it. What keeps the page from being shown is said on
  /// stderr, and the verb goes on without it.
  PageBeside(Session& session, ServeOptions options);
  /// Ends it; what it shows must still be served, or it waits for some seconds.
  ~PageBeside();
  PageBeside(const PageBeside&) = delete;
  PageBeside& operator=(const PageBeside&) = delete;

  /// Asks it to end. Whether it has; to be asked again while what it shows is served on.
  [[nodiscard]] bool end();

 private:
  std::atomic<bool> stops_{false};
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

}  // namespace ocm::cli::serve
