/// A socket on which programs of the same user ask this one in words: cli/shared/local_link.hpp says how.
/// Readable when there is something to do; what one program sends, or does not read, holds up nothing.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/host/descriptor.hpp"
#include "ocm/host/local_listener.hpp"
#include "ocm/transport/bus.hpp"

namespace ocm::cli {

/// A program that is connected. A server that remembers something of each derives from it.
struct LocalCaller {
  std::string verb;  ///< as it calls itself; empty: it has not said so
  std::int64_t process = 0;

  LocalCaller() = default;
  LocalCaller(const LocalCaller&) = delete;
  LocalCaller& operator=(const LocalCaller&) = delete;
  virtual ~LocalCaller() = default;
  /// "goto (process 1234)"
  [[nodiscard]] std::string who() const;
};

/// Answers of the protocol.
namespace answers {
[[nodiscard]] std::string yes(std::string_view text = {});
[[nodiscard]] std::string wait();
[[nodiscard]] std::string no(std::string_view what, std::string_view remedy);
}  // namespace answers

class LocalServer {
 public:
  static constexpr std::size_t most_callers = 64;
  static constexpr int most_requests = 32;  ///< of all callers together, in one `serve`
  static constexpr std::size_t longest_request = 4096;

  /// What is done with callers.
  struct Desk {
    std::function<std::unique_ptr<LocalCaller>()> make;  ///< for each that comes
    std::function<std::string(LocalCaller&)> greet;      ///< the answer to its first request
    std::function<std::string(LocalCaller&, std::string_view request)> take;  ///< to each other
    std::function<void(LocalCaller&)> gone;                                   ///< it greeted, and has ended
  };

  /// Refused where another program serves on the path; the failure has its process.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<LocalServer>> open(const std::string& path,
                                                                             const host::LocalService& what);

  /// What is referred to must outlive the server. Before it no program is answered.
  void begin(Desk desk) { desk_ = std::move(desk); }
  [[nodiscard]] int descriptor() const noexcept { return events_.get(); }
  /// Takes what there is, and waits for nothing.
  void serve();
  /// Whether programs find it: its file may have been removed.
  [[nodiscard]] bool is_found() const noexcept { return listener_.is_found(); }
  /// Listens on its path again; those that are connected remain so.
  [[nodiscard]] transport::Outcome<void> return_to_path();
  /// Programs that were disconnected: they did not greet, or did not read their answers.
  [[nodiscard]] std::uint64_t turned_away() const noexcept { return turned_away_; }
  /// Each that has greeted.
  template <class See>
  void for_each(See&& see) const {
    for (const auto& connection : connections_)
      if (!connection->caller->verb.empty()) see(*connection->caller);
  }

 private:
  struct Connection {
    host::Descriptor socket;
    std::unique_ptr<LocalCaller> caller;
  };
  LocalServer(host::LocalListener listener, host::Descriptor events, const host::LocalService& what)
      : listener_(std::move(listener)), events_(std::move(events)), what_(what) {}

  void accept();
  /// false: it is to be disconnected.
  [[nodiscard]] bool take(Connection& connection);
  [[nodiscard]] std::string answer(LocalCaller& caller, std::string_view request);

  host::LocalListener listener_;
  host::Descriptor events_;
  host::LocalService what_;
  std::vector<std::unique_ptr<Connection>> connections_;
  Desk desk_;
  std::uint64_t turned_away_ = 0;
};

}  // namespace ocm::cli
