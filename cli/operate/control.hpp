/// The socket on which programs of the same user speak to an operator (cli/shared/operator_link.hpp), and
/// what the operator remembers of each.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "ocm/transport/bus.hpp"

#include "cli/shared/local_server.hpp"

namespace ocm::cli::operate {

using answers::no;
using answers::wait;
using answers::yes;

/// A program that is connected.
struct Caller : LocalCaller {
  std::vector<std::uint16_t> commanded;  ///< topics; each was commanded once
  std::vector<std::uint16_t> limited;
  std::vector<std::uint16_t> beyond;
  std::uint64_t handed_over = 0;  ///< frames of all to the bus, up to the last one of this program
};

class Control {
 public:
  /// The answer to a request.
  using Take = std::function<std::string(Caller& caller, std::string_view request)>;

  /// Refused where an operator has the bus already; the failure has its process.
  [[nodiscard]] static transport::Outcome<std::unique_ptr<Control>> open(std::string_view bus);

  /// `name` is the operator's, which it says to who greets.
  void begin(const std::string& name, Take take);
  [[nodiscard]] int descriptor() const noexcept { return server_->descriptor(); }
  /// Takes what there is, and waits for nothing.
  void serve() { server_->serve(); }
  /// Whether programs find it, and what makes that so again.
  [[nodiscard]] bool is_found() const noexcept { return server_->is_found(); }
  [[nodiscard]] transport::Outcome<void> return_to_path() { return server_->return_to_path(); }
  /// Programs that were disconnected: cli/shared/local_server.hpp says why.
  [[nodiscard]] std::uint64_t turned_away() const noexcept { return server_->turned_away(); }

 private:
  explicit Control(std::unique_ptr<LocalServer> server) : server_(std::move(server)) {}

  std::unique_ptr<LocalServer> server_;
};

}  // namespace ocm::cli::operate
