#include "cli/shared/operator_link.hpp"

#include <cerrno>
#include <filesystem>
#include <poll.h>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "ocm/host/local_socket.hpp"
#include "ocm/host/user_directory.hpp"

#include "cli/shared/buses.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli {
namespace {

/// Of a path, for the name of a socket, which has little room. [FNV-1a: draft-eastlake-fnv, section 5]
std::uint32_t hash(std::string_view text) {
  std::uint32_t value = 0x811C9DC5;
  for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 0x01000193;
  return value;
}

/// By its own name, however it was typed.
std::string plain_path(std::string_view address) {
  std::error_code error;
  const auto path = std::filesystem::weakly_canonical(std::string{address}, error);
  return error ? std::string{address} : path.string();
}

OperatorAnswer read_answer(std::string_view message) {
  using Kind = OperatorAnswer::Kind;
  const std::size_t end = message.find('\n');
  const std::string_view first = message.substr(0, end);
  std::string text{end == std::string_view::npos ? std::string_view{} : message.substr(end + 1)};
  if (first == "ok") return {Kind::ok, std::move(text), {}};
  if (first == "wait") return {Kind::wait, std::move(text), {}};
  const std::size_t line = text.find('\n');
  return {Kind::no,
          {},
          {text.substr(0, line), line == std::string::npos ? std::string{} : text.substr(line + 1)}};
}

}  // namespace

std::string operator_path(std::string_view bus) {
  const BusName name = parse_bus_name(bus);
  std::string key;
  switch (name.kind) {
    case BusName::Kind::interface:
      key = name.address;
      break;
    case BusName::Kind::simulated:
      key = name.address.empty() ? "sim" : fmt::format("sim-{:08x}", hash(plain_path(name.address)));
      break;
    case BusName::Kind::serial:
      key = fmt::format("slcan-{:08x}", hash(plain_path(name.address.substr(0, name.address.find('@')))));
      break;
  }
  return fmt::format("{}/operator-{}.sock", host::user_directory(), key);
}

transport::Outcome<std::unique_ptr<OperatorLink>> OperatorLink::connect(std::string_view bus,
                                                                        std::string_view verb) {
  const auto address = host::to_address(operator_path(bus));
  if (!address) return std::unique_ptr<OperatorLink>{};
  host::Descriptor socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  if (!socket) return std::unique_ptr<OperatorLink>{};
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) < 0) {
    if (errno != EAGAIN) return std::unique_ptr<OperatorLink>{};  // none, or one that has died
    return transport::Failure{fmt::format("the operator on {} takes no more programs", bus),
                              "is it stopped? `fg` lets it go on"};
  }
  const auto peer = host::peer_of(socket.get());
  if (!peer || peer->uid != ::geteuid()) return std::unique_ptr<OperatorLink>{};
  const std::string process = host::process_text(peer);
  std::unique_ptr<OperatorLink> link{
      new OperatorLink{std::move(socket), fmt::format("the operator on {}{}", bus, process)}};
  auto answer = link->ask(fmt::format("{}{}", operator_hello, verb), std::chrono::seconds{1});
  if (answer.kind != OperatorAnswer::Kind::ok) return std::move(answer.failure);
  link->who_ = fmt::format("operator {}{}", answer.text, process);
  return link;
}

OperatorAnswer OperatorLink::silence(std::string what) {
  socket_.reset();
  return {OperatorAnswer::Kind::silent,
          {},
          {std::move(what), "was it stopped (Ctrl-Z; `fg` lets it go on), or has it ended?"}};
}

OperatorAnswer OperatorLink::ask(std::string_view request, base::Duration patience) {
  if (!socket_) return silence(fmt::format("{} is gone", who_));
  if (::send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL) < 0)
    return silence(fmt::format("{} is gone", who_));
  const auto until = Clock::now() + patience;
  for (;;) {
    std::string message(longest_operator_message, '\0');
    const auto size = ::recv(socket_.get(), message.data(), message.size(), 0);
    if (size == 0) return silence(fmt::format("{} has ended", who_));
    if (size > 0) return read_answer(std::string_view{message}.substr(0, static_cast<std::size_t>(size)));
    if (errno != EAGAIN && errno != EINTR) return silence(fmt::format("{} is gone", who_));
    const auto left = until - Clock::now();
    if (left.count() <= 0) return silence(fmt::format("{} does not answer", who_));
    // A signal ends a wait early, and is seen by the caller after the answer.
    pollfd input{socket_.get(), POLLIN, 0};
    static_cast<void>(wait_for_input(std::span{&input, 1}, left));
  }
}

}  // namespace ocm::cli
