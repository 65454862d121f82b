/// The frames that a verb looks at: of logs, one after another, or of the bus as they come. What is done with
/// them is the same.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/base/time.hpp"
#include "ocm/log/entry.hpp"
#include "ocm/log/interfaces.hpp"

#include "cli/shared/arguments.hpp"
#include "cli/shared/session.hpp"
#include "cli/watch/listening.hpp"

namespace ocm::cli {

struct WatchOptions {
  std::string format;                      ///< of the logs; empty: find out
  std::optional<base::Duration> duration;  ///< none: no end
  std::uint64_t count = 0;
};

/// --from, --duration and -n.
void add_watch_options(Verb verb, WatchOptions& options);

/// The words of a command line that are logs, and those that are something else.
struct Words {
  std::vector<std::string> files;
  std::vector<std::string> others;
};
/// `live` is the bus, and no word. What `means_something` is no file, even if there is one of that name:
/// ./NAME is. Several logs and `live` are exit_usage.
[[nodiscard]] Words split_words(std::string_view verb, const std::vector<std::string>& words,
                                const std::function<bool(std::string_view)>& means_something);

class Watching {
 public:
  using Take = TakeEntries;
  using Lost = TakeLost;

  Watching(Session& session, const WatchOptions& options, std::vector<std::string> files);

  [[nodiscard]] bool live() const noexcept { return files_.empty(); }
  /// Whether it ends by itself.
  [[nodiscard]] bool ends() const noexcept { return !live() || duration_ || count_ != 0; }
  /// "drive.log", "2 logs", "can0": for people. Of a bus only once it runs.
  [[nodiscard]] std::string source() const;
  /// After `run`, to be said once the results are out: the bus went away or does not answer, or a log broke
  /// off. Leaves through `fail` for a bus; the exit code for a log, `code` when all is well.
  [[nodiscard]] int ending(int code) const;

  /// Hands on all frames until the logs are at their end, the limits are reached or a signal comes. On a live
  /// bus calls `each_second` as well, whether or not something came. Leaves through `fail` when there is no
  /// bus or a log cannot be read at all; places that could not be read are reported on stderr.
  void run(const Take& take, const Lost& lost, const std::function<void()>& each_second = {});

 private:
  void read(const std::string& file, const Take& take, const Lost& lost);
  void listen(const Take& take, const Lost& lost, const std::function<void()>& each_second);
  /// Those of `entries` that are within the limits; marks the end.
  std::span<const log::Entry> within(std::span<const log::Entry> entries);

  Session* session_;
  std::string format_;
  std::vector<std::string> files_;
  std::optional<base::Duration> duration_;
  std::uint64_t count_ = 0;
  std::uint64_t taken_ = 0;
  std::optional<base::Time> first_;
  bool done_ = false;
  std::string bus_;
  transport::Failure gone_;
  bool time_is_up_ = false;  ///< of a bus
  bool broke_off_ = false;
};

}  // namespace ocm::cli
