#include "cli/operate/control.hpp"

#include <utility>

#include "cli/shared/operator_link.hpp"

namespace ocm::cli::operate {
namespace {

constexpr host::LocalService service{"an operator", "an operator", host::Cause::other, false};

}  // namespace

transport::Outcome<std::unique_ptr<Control>> Control::open(std::string_view bus) {
  auto server = LocalServer::open(operator_path(bus), service);
  if (!server) return std::move(server.error);
  return std::unique_ptr<Control>{new Control{std::move(*server)}};
}

void Control::begin(const std::string& name, Take take) {
  server_->begin({[] { return std::make_unique<Caller>(); },
                  [name](LocalCaller&) { return yes(name); },
                  [take = std::move(take)](LocalCaller& caller, std::string_view request) {
                    return take(static_cast<Caller&>(caller), request);
                  },
                  {}});
}

}  // namespace ocm::cli::operate
