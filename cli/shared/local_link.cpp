#include "cli/shared/local_link.hpp"

#include <cerrno>
#include <filesystem>
#include <poll.h>
#include <span>
#include <system_error>
#include <unistd.h>
#include <utility>

#include <fmt/format.h>

#include "ocm/host/local_socket.hpp"
#include "ocm/host/user_directory.hpp"

#include "cli/shared/clock.hpp"

namespace ocm::cli {
namespace {

/// Of a path, for the name of a socket, which has little room. [FNV-1a: draft-eastlake-fnv, section 5]
std::uint32_t hash(std::string_view text) {
  std::uint32_t value = 0x811C9DC5;
  for (const char c : text) value = (value ^ static_cast<unsigned char>(c)) * 0x01000193;
  return value;
}

LocalAnswer read_answer(std::string_view message) {
  using Kind = LocalAnswer::Kind;
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

std::string local_socket(std::string_view kind, std::string_view name) {
  return local_socket_in(host::user_directory(), kind, name);
}

std::string local_socket_in(std::string_view directory, std::string_view kind, std::string_view name) {
  return fmt::format("{}/{}-{}.sock", directory, kind, name);
}

std::string digits_of_path(std::string_view path) {
  std::error_code error;
  const auto plain = std::filesystem::weakly_canonical(std::string{path}, error);
  return fmt::format("{:08x}", hash(error ? std::string{path} : plain.string()));
}

transport::Outcome<std::unique_ptr<LocalLink>> LocalLink::connect(const std::string& path,
                                                                  const std::string& what,
                                                                  std::string_view verb,
                                                                  base::Duration patience) {
  const auto address = host::to_address(path);
  if (!address) return std::unique_ptr<LocalLink>{};
  host::Descriptor socket{::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)};
  if (!socket) return std::unique_ptr<LocalLink>{};
  if (::connect(socket.get(), reinterpret_cast<const sockaddr*>(&*address), sizeof *address) < 0) {
    if (errno != EAGAIN) return std::unique_ptr<LocalLink>{};  // none, or one that has died
    return transport::Failure{fmt::format("{} takes no more programs", what),
                              "is it stopped? `fg` lets it go on"};
  }
  const auto peer = host::peer_of(socket.get());
  if (!peer || peer->uid != ::geteuid()) return std::unique_ptr<LocalLink>{};
  std::string process = host::process_text(peer);
  std::unique_ptr<LocalLink> link{new LocalLink{std::move(socket), what + process, process}};
  auto answer = link->ask(fmt::format("{}{}", local_hello, verb), patience);
  if (answer.kind == LocalAnswer::Kind::silent || answer.kind == LocalAnswer::Kind::no)
    return std::move(answer.failure);
  link->greeting_ = std::move(answer.text);
  return link;
}

LocalAnswer LocalLink::silence(std::string what) {
  socket_.reset();
  silence_ = {LocalAnswer::Kind::silent,
              {},
              {std::move(what), "was it stopped (Ctrl-Z; `fg` lets it go on), or has it ended?"}};
  return silence_;
}

LocalAnswer LocalLink::ask(std::string_view request, base::Duration patience) {
  if (!socket_) return silence_;
  // One that turns this program away may have closed by now, and has said why.
  const bool sent = ::send(socket_.get(), request.data(), request.size(), MSG_NOSIGNAL) >= 0;
  const auto until = Clock::now() + patience;
  bool reset = false;
  for (;;) {
    std::string message(longest_local_message, '\0');
    const auto size = ::recv(socket_.get(), message.data(), message.size(), 0);
    if (size == 0 && sent) return silence(fmt::format("{} has ended", who_));
    if (size > 0) return read_answer(std::string_view{message}.substr(0, static_cast<std::size_t>(size)));
    // It has closed without reading the request; the answer comes behind this error.
    if (errno == ECONNRESET && !std::exchange(reset, true)) continue;
    if (!sent || (errno != EAGAIN && errno != EINTR)) return silence(fmt::format("{} has ended", who_));
    const auto left = until - Clock::now();
    if (left.count() <= 0) return silence(fmt::format("{} does not answer", who_));
    // A signal ends a wait early, and is seen by the caller after the answer.
    pollfd input{socket_.get(), POLLIN, 0};
    static_cast<void>(wait_for_input(std::span{&input, 1}, left));
  }
}

}  // namespace ocm::cli
