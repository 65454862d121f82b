/// The socket on which programs of the same user speak to an operator: cli/shared/operator_link.hpp says how.
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

namespace ocm::cli::operate {

/// A program that is connected.
struct Caller {
  std::string verb;  ///< as it calls itself; empty: it has not said so
  std::int64_t process = 0;
  std::vector<std::uint16_t> commanded;  ///< topics; each was commanded once
  std::vector<std::uint16_t> limited;
};

/// Answers of the protocol.
[[nodiscard]] std::string yes(std::string_view text = {});
[[nodiscard]] std::string wait();
[[nodiscard]] std::string no(std::string_view what, std::string_view remedy);

class Control {
 public:
  static constexpr std::size_t most_callers = 64;
  static constexpr int most_requests = 32;  ///< of all callers together, between two looks at the bus

  /// The answer to a request.
  using Take = std::function<std::string(Caller& caller, std::string_view request)>;

  /// Refused where an operator has the bus already; the failure has its process.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<Control>> open(std::string_view bus);

  /// `name` is the operator's, which it says to who greets.
  void begin(std::string name, Take take);
  [[nodiscard]] int descriptor() const noexcept { return events_.get(); }
  /// Takes what there is, and waits for nothing.
  void serve();
  /// Programs that were disconnected: they did not greet, or did not read their answers.
  [[nodiscard]] std::uint64_t turned_away() const noexcept { return turned_away_; }

 private:
  struct Connection {
    host::Descriptor socket;
    Caller caller;
  };
  Control(host::LocalListener listener, host::Descriptor events)
      : listener_(std::move(listener)), events_(std::move(events)) {}

  void accept();
  /// false: it is to be disconnected.
  [[nodiscard]] bool take(Connection& connection);
  [[nodiscard]] std::string answer(Caller& caller, std::string_view request);

  host::LocalListener listener_;
  host::Descriptor events_;
  std::vector<std::unique_ptr<Connection>> connections_;
  std::string name_;
  Take take_;
  std::uint64_t turned_away_ = 0;
};

}  // namespace ocm::cli::operate
