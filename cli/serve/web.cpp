#include "cli/serve/web.hpp"

#include "cli/serve/assets.hpp"

namespace ocm::cli::serve {

bool has_page() noexcept {
  return !assets().empty();
}

}  // namespace ocm::cli::serve

#ifdef OCM_HAS_WEBSOCKETS

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <netdb.h>
#include <strings.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

#include <fmt/format.h>

#include "ocm/host/descriptor.hpp"

#include "cli/serve/foxglove.hpp"
#include "cli/serve/websockets.hpp"
#include "cli/shared/clock.hpp"

namespace ocm::cli::serve {
namespace {

constexpr std::size_t most_at_once = 32;       // messages in one turn of a viewer
constexpr std::size_t http_piece = 16 * 1024;  // bytes of a file in one turn
constexpr std::string_view content_policy =
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data:; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A viewer that is silent is asked, and hung up where it does not answer: a computer that was switched off
/// closes nothing.
constexpr lws_retry_bo_t patience{nullptr, 0, 0, 20, 40, 0};

/// What libwebsockets has said last of what is wrong.
std::string& last_error() {
  static std::string text;
  return text;
}
void note_error(int, const char* line) {
  const std::string_view text{line};
  last_error() = text.substr(0, text.find_last_not_of("\n ") + 1);  // npos + 1 is 0
}

std::string header(lws* wsi, lws_token_indexes which) {
  const int length = lws_hdr_total_length(wsi, which);
  if (length <= 0) return {};
  std::string text(static_cast<std::size_t>(length) + 1, '\0');
  const int copied = lws_hdr_copy(wsi, text.data(), length + 1, which);
  text.resize(copied < 0 ? 0 : static_cast<std::size_t>(copied));
  return text;
}

/// Takes the same time for every text of a length: how much of a token is right cannot be measured.
bool equal_in_constant_time(std::string_view a, std::string_view b) noexcept {
  if (a.size() != b.size()) return false;
  unsigned different = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    different |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return different == 0;
}

/// "[::1]:80" -> "[::1]". Whatever is no port stays: two headers are one text with a comma between, and are
/// the name of no server.
std::string_view without_port(std::string_view host) {
  const auto colon = host.rfind(':');
  if (colon == std::string_view::npos || host.ends_with(']')) return host;
  const std::string_view port = host.substr(colon + 1);
  const bool is_port = port.size() <= 5 && port.find_first_not_of("0123456789") == std::string_view::npos;
  return is_port ? host.substr(0, colon) : host;
}

std::string_view type_of(std::string_view name) {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  return "text/plain; charset=utf-8";
}

/// What the kernel keeps for a viewer that does not read would else be megabytes.
void limit_kernel_memory(lws* wsi) {
  const int bytes = 256 * 1024;
  ::setsockopt(lws_get_socket_fd(wsi), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
}

/// One connection: of a page that is fetched, or of a viewer.
struct Connection {
  lws* wsi = nullptr;
  ViewerId viewer = 0;    // 0: it only fetches
  std::string partial;    // of a message that is coming
  std::string_view body;  // that is still to be sent
  std::string own_body;   // where it is no file
  bool closes = false;
};

}  // namespace

struct Web::State {
  WebOptions options;
  Viewers* viewers = nullptr;
  Listener* listener = nullptr;
  lws_context* context = nullptr;
  std::array<lws_protocols, foxglove::subprotocols.size() + 2> protocols{};
  std::string scheme = "http";
  int port = 0;
  std::thread thread;
  std::atomic<bool> stops{false};
  std::atomic<bool> woken{false};
  std::atomic<std::uint64_t> refused{0};
  std::vector<Connection*> connections;  // of viewers
  std::vector<unsigned char> buffer;     // of one message

  static State& of(lws* wsi) { return *static_cast<State*>(lws_context_user(lws_get_context(wsi))); }

  [[nodiscard]] bool knows_host(std::string_view host) const {
    const std::string_view name = without_port(host);
    const std::string bracketed = "[" + options.address + "]";
    if (name == options.address || name == bracketed || name == "localhost" || name == "127.0.0.1" ||
        name == "[::1]")
      return true;
    return std::find(options.names.begin(), options.names.end(), name) != options.names.end();
  }
  /// Why a request is not served; empty: it is.
  [[nodiscard]] std::string obstacle(lws* wsi) const {
    const std::string host = header(wsi, WSI_TOKEN_HOST);
    if (host.empty()) return "a request without Host; a browser says there which server it means";
    if (!knows_host(host))
      return fmt::format("this server has no name '{}'; --name gives it one", without_port(host));
    const std::string origin = header(wsi, WSI_TOKEN_ORIGIN);
    if (origin.empty() || origin == scheme + "://" + host) return {};
    if (std::find(options.origins.begin(), options.origins.end(), origin) != options.origins.end()) return {};
    if (origin == "null")
      return "a page without an origin (a file, a sandboxed frame) may not connect: open it from a web "
             "server, and "
             "name that with --allow-origin";
    return fmt::format("a page of {} may not connect; --allow-origin {} lets it", origin, origin);
  }
  enum class Token { none, right, wrong };
  [[nodiscard]] Token token_of(lws* wsi) const {
    std::array<char, 200> text{};
    const char* const token =
        lws_get_urlarg_by_name(wsi, "token=", text.data(), static_cast<int>(text.size()));
    if (token == nullptr) return Token::none;
    return !options.token.empty() && equal_in_constant_time(token, options.token) ? Token::right
                                                                                  : Token::wrong;
  }
  /// One that shows a token wants to command, and must not find out by buttons that are missing.
  void opened(const Connection& connection, Token token) {
    listener->opened(connection.viewer, token == Token::right);
    if (token != Token::wrong) return;
    viewers->tell(
        connection.viewer,
        foxglove::status(foxglove::Level::warning,
                         options.token.empty()
                             ? "this server takes no commands: it was started without --allow-commands"
                             : "the token of this address is not that of this server, so you only look: "
                               "open the address that amiroctl serve has printed",
                         "token"));
  }

  int respond(lws* wsi, Connection& connection, unsigned status, std::string_view type, std::string_view body,
              bool with_body = true) {
    std::array<unsigned char, LWS_PRE + 2048> head{};
    unsigned char* at = head.data() + LWS_PRE;
    unsigned char* const begin = at;
    unsigned char* const end = head.data() + head.size() - 1;
    const auto add = [&](const char* name, std::string_view value) {
      return lws_add_http_header_by_name(wsi, reinterpret_cast<const unsigned char*>(name),
                                         reinterpret_cast<const unsigned char*>(value.data()),
                                         static_cast<int>(value.size()), &at, end) == 0;
    };
    const std::string content_type{type};
    if (lws_add_http_common_headers(wsi, status, content_type.c_str(), body.size(), &at, end) != 0) return -1;
    if (!add("content-security-policy:", content_policy) || !add("x-content-type-options:", "nosniff") ||
        !add("referrer-policy:", "no-referrer") || !add("cross-origin-resource-policy:", "same-origin") ||
        !add("cross-origin-opener-policy:", "same-origin") || !add("cache-control:", "no-cache"))
      return -1;
    if (lws_finalize_write_http_header(wsi, begin, &at, end) != 0) return -1;
    connection.body = with_body ? body : std::string_view{};
    if (connection.body.empty())
      return connection.closes || lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
    lws_callback_on_writable(wsi);
    return 0;
  }
  int refuse(lws* wsi, Connection& connection, unsigned status, std::string text) {
    ++refused;
    connection.closes = true;
    connection.own_body = std::move(text) + "\n";
    return respond(wsi, connection, status, "text/plain; charset=utf-8", connection.own_body,
                   lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) <= 0);
  }
  int give(lws* wsi, Connection& connection, std::string_view path) {
    const bool head = lws_hdr_total_length(wsi, WSI_TOKEN_HEAD_URI) > 0;
    if (!head && lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) <= 0)
      return refuse(wsi, connection, HTTP_STATUS_METHOD_NOT_ALLOWED, "only GET and HEAD are served");
    if (lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_CONTENT_LENGTH) > 0 ||
        lws_hdr_total_length(wsi, WSI_TOKEN_HTTP_TRANSFER_ENCODING) > 0)
      return refuse(wsi, connection, HTTP_STATUS_REQ_ENTITY_TOO_LARGE, "no request has a body here");
    if (const std::string why = obstacle(wsi); !why.empty())
      return refuse(wsi, connection, HTTP_STATUS_FORBIDDEN, why);
    path.remove_prefix(path.starts_with('/') ? 1 : 0);
    if (path.empty()) path = "index.html";
    for (const Asset& asset : assets())
      if (asset.name == path)
        return respond(wsi, connection, HTTP_STATUS_OK, type_of(asset.name), asset.content, !head);
    return refuse(wsi, connection, HTTP_STATUS_NOT_FOUND, "there is no such page");
  }
  static int send_piece(lws* wsi, Connection& connection) {
    const std::size_t size = std::min(connection.body.size(), http_piece);
    const bool last = size == connection.body.size();
    std::vector<unsigned char> piece(LWS_PRE + size);
    std::memcpy(piece.data() + LWS_PRE, connection.body.data(), size);
    if (lws_write(wsi, piece.data() + LWS_PRE, size, last ? LWS_WRITE_HTTP_FINAL : LWS_WRITE_HTTP) < 0)
      return -1;
    connection.body.remove_prefix(size);
    if (last) return connection.closes || lws_http_transaction_completed(wsi) != 0 ? -1 : 0;
    lws_callback_on_writable(wsi);
    return 0;
  }

  /// To a viewer: as much as its socket takes.
  int send_messages(lws* wsi, Connection& connection) {
    const base::Time now{Clock::now().time_since_epoch()};  // the system's may be set back
    if (lws_send_pipe_choked(wsi) == 0 && viewers->take_asked(connection.viewer)) {
      constexpr std::size_t size = 1;  // of an answer without any byte libwebsockets says nothing
      if (buffer.size() < LWS_PRE + size) buffer.resize(LWS_PRE + size);
      if (lws_write(wsi, buffer.data() + LWS_PRE, size, LWS_WRITE_PING) < 0) return -1;
    }
    for (std::size_t i = 0; i < most_at_once; ++i) {
      if (lws_send_pipe_choked(wsi) != 0) break;
      const auto message = viewers->next(connection.viewer, now);
      if (!message) return 0;
      const std::size_t head = message->binary ? message->head.size() : 0;
      const std::size_t size = head + message->payload->size();
      if (buffer.size() < LWS_PRE + size) buffer.resize(LWS_PRE + size);
      unsigned char* const at = buffer.data() + LWS_PRE;
      std::memcpy(at, message->head.data(), head);
      std::memcpy(at + head, message->payload->data(), message->payload->size());
      if (lws_write(wsi, at, size, message->binary ? LWS_WRITE_BINARY : LWS_WRITE_TEXT) < 0) return -1;
    }
    if (viewers->has_next(connection.viewer)) lws_callback_on_writable(wsi);
    return 0;
  }
  int take_message(lws* wsi, Connection& connection, std::string_view piece) {
    viewers->hear(connection.viewer);
    if (connection.partial.size() + piece.size() > foxglove::longest_message) {
      std::string why = fmt::format("longer than {} bytes", foxglove::longest_message);
      lws_close_reason(wsi, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, reinterpret_cast<unsigned char*>(why.data()),
                       why.size());
      return -1;
    }
    connection.partial += piece;
    if (lws_remaining_packet_payload(wsi) != 0 || lws_is_final_fragment(wsi) == 0) return 0;
    if (lws_frame_is_binary(wsi) != 0)
      listener->binary(connection.viewer, connection.partial);
    else
      listener->text(connection.viewer, connection.partial);
    connection.partial.clear();
    if (viewers->has_next(connection.viewer)) lws_callback_on_writable(wsi);
    return 0;
  }

  /// Before a connection becomes one of another protocol; nonzero: it does not.
  int upgrade(lws* wsi, const char* protocol) {
    if (::strcasecmp(protocol, "websocket") == 0 && header(wsi, WSI_TOKEN_VERSION) == "13") return 0;
    ++refused;
    lws_return_http_status(wsi, HTTP_STATUS_BAD_REQUEST, "expected WebSocket, version 13");
    return 1;
  }
  /// Before a viewer is connected; nonzero: it is not.
  int filter(lws* wsi) {
    std::string why = obstacle(wsi);
    if (why.empty() && options.token_to_view && token_of(wsi) != Token::right)
      why = "the token is missing: open the address that amiroctl serve has printed";
    if (why.empty() && connections.size() >= most_viewers) why = "there are too many viewers";
    if (why.empty()) return 0;
    ++refused;
    lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, why.c_str());
    return 1;
  }

  int of_page(lws* wsi, lws_callback_reasons reason, Connection** slot, void* in, std::size_t size) {
    switch (reason) {
      case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:  // libwebsockets would speak HTTP/2, too, and version 8
        return upgrade(wsi, static_cast<const char*>(in));
      case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:  // without a subprotocol
        ++refused;
        lws_return_http_status(wsi, HTTP_STATUS_BAD_REQUEST, "offer the subprotocol foxglove.websocket.v1");
        return 1;
      case LWS_CALLBACK_HTTP:
        if (*slot == nullptr) *slot = new Connection;
        (*slot)->wsi = wsi;
        return give(wsi, **slot, {static_cast<const char*>(in), size});
      case LWS_CALLBACK_HTTP_WRITEABLE:
        return *slot == nullptr || (*slot)->body.empty() ? 0 : send_piece(wsi, **slot);
      case LWS_CALLBACK_HTTP_DROP_PROTOCOL:
      case LWS_CALLBACK_CLOSED_HTTP:
        if (slot != nullptr) delete std::exchange(*slot, nullptr);
        return 0;
      case LWS_CALLBACK_EVENT_WAIT_CANCELLED:
        woken = false;
        for (const Connection* connection : connections)
          if (viewers->has_next(connection->viewer)) lws_callback_on_writable(connection->wsi);
        return 0;
      default:
        return 0;
    }
  }
  int of_viewer(lws* wsi, lws_callback_reasons reason, Connection** slot, void* in, std::size_t size) {
    switch (reason) {
      case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
        return filter(wsi);
      case LWS_CALLBACK_ESTABLISHED:
        *slot = new Connection;
        (*slot)->wsi = wsi;
        (*slot)->viewer = viewers->add();
        connections.push_back(*slot);
        limit_kernel_memory(wsi);
        opened(**slot, token_of(wsi));
        lws_callback_on_writable(wsi);
        return 0;
      case LWS_CALLBACK_SERVER_WRITEABLE:
        return *slot == nullptr ? 0 : send_messages(wsi, **slot);
      case LWS_CALLBACK_RECEIVE:
        return *slot == nullptr ? -1 : take_message(wsi, **slot, {static_cast<const char*>(in), size});
      case LWS_CALLBACK_RECEIVE_PONG:
        if (*slot != nullptr) viewers->hear((*slot)->viewer);
        return 0;
      case LWS_CALLBACK_CLOSED:
        if (*slot == nullptr) return 0;
        listener->gone((*slot)->viewer);
        viewers->remove((*slot)->viewer);
        std::erase(connections, *slot);
        delete std::exchange(*slot, nullptr);
        return 0;
      default:
        return 0;
    }
  }

  static int page_callback(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) {
    return of(wsi).of_page(wsi, reason, static_cast<Connection**>(user), in, size);
  }
  static int viewer_callback(lws* wsi, lws_callback_reasons reason, void* user, void* in, std::size_t size) {
    return of(wsi).of_viewer(wsi, reason, static_cast<Connection**>(user), in, size);
  }
};

namespace {

/// libwebsockets does not say why it cannot listen: this does, before it is asked.
transport::Failure why_not(const WebOptions& options) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICHOST | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  if (getaddrinfo(options.address.c_str(), std::to_string(options.port).c_str(), &hints, &found) != 0)
    return {fmt::format("--address {}: not an address", options.address),
            "write the address of an interface of this machine, such as 192.168.1.20"};
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> owner{found, &freeaddrinfo};
  const host::Descriptor socket{::socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC, 0)};
  const int yes = 1;
  ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  if (::bind(socket.get(), found->ai_addr, found->ai_addrlen) == 0 && ::listen(socket.get(), 1) == 0)
    return {};
  const int error = errno;
  return {fmt::format("cannot listen on {} port {}: {}", options.address, options.port, std::strerror(error)),
          error == EADDRINUSE ? "another program listens there: --port takes another port, 0 any that is free"
                              : "--address takes an address of this machine, --port a port from 1024 on"};
}

/// Of the files of TLS.
transport::Failure why_not_readable(const char* option, const std::string& file) {
  if (file.empty() || ::access(file.c_str(), R_OK) == 0) return {};
  return {fmt::format("{} {}: {}", option, file, std::strerror(errno)), "name a PEM file that can be read"};
}

}  // namespace

Web::Web(std::unique_ptr<State> state) : state_(std::move(state)) {}

transport::Outcome<std::unique_ptr<Web>> Web::open(const WebOptions& options, Viewers& viewers,
                                                   Listener& listener) {
  for (const auto& failure : {why_not(options), why_not_readable("--certificate", options.certificate),
                              why_not_readable("--key", options.key)})
    if (!failure.what.empty()) return failure;

  auto state = std::make_unique<State>();
  state->options = options;
  state->viewers = &viewers;
  state->listener = &listener;
  auto* protocol = state->protocols.data();
  *protocol++ = {"http", State::page_callback, sizeof(Connection*), 0, 0, nullptr, 0};
  for (const char* const name : foxglove::subprotocols)
    *protocol++ = {name, State::viewer_callback, sizeof(Connection*), 4096, 0, nullptr, 0};

  if (const auto loaded = load_websockets(); !loaded) return loaded.error;
  lws_set_log_level(LLL_ERR, note_error);
  lws_context_creation_info info{};
  info.iface = options.address.c_str();
  info.port = options.port;
  info.protocols = state->protocols.data();
  info.user = state.get();
  info.uid = info.gid = static_cast<decltype(info.uid)>(-1);
  info.options = LWS_SERVER_OPTION_VALIDATE_UTF8 | LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND;
  info.timeout_secs = 10;
  info.keepalive_timeout = 10;
  info.fd_limit_per_thread = most_viewers + 64;
  info.retry_and_idle_policy = &patience;
  info.server_string = "amiroctl";
  if (options.address.find(':') == std::string::npos) info.options |= LWS_SERVER_OPTION_DISABLE_IPV6;
  if (!options.certificate.empty()) {
    state->scheme = "https";
    info.options |= LWS_SERVER_OPTION_DO_SSL_GLOBAL_INIT;
    info.ssl_cert_filepath = options.certificate.c_str();
    info.ssl_private_key_filepath = options.key.c_str();
    info.alpn = "http/1.1";
  }
  state->context = lws_create_context(&info);
  if (state->context == nullptr)
    return transport::Failure{fmt::format("cannot serve: {}", last_error()),
                              options.certificate.empty() ? "--port takes another port"
                                                          : "is the key of --key that of --certificate?"};
  state->port = lws_get_vhost_listen_port(lws_get_vhost_by_name(state->context, "default"));

  // Signals are the other thread's.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  state->thread = std::thread{[state = state.get()] {
    while (!state->stops && lws_service(state->context, 0) >= 0) {
    }
  }};
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  return std::unique_ptr<Web>{new Web{std::move(state)}};
}

Web::~Web() {
  // What has come goes out first; a viewer that reads nothing is waited for a tenth of a second.
  wake();
  for (int i = 0; i < 50 && state_->viewers->anything_waits(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds{2});
  state_->stops = true;
  lws_cancel_service(state_->context);
  state_->thread.join();
  lws_context_destroy(state_->context);
}

std::string Web::url() const {
  const bool v6 = state_->options.address.find(':') != std::string::npos;
  const std::string& host =
      state_->options.names.empty() ? state_->options.address : state_->options.names[0];
  return fmt::format("{}://{}{}{}:{}/", state_->scheme, v6 && state_->options.names.empty() ? "[" : "", host,
                     v6 && state_->options.names.empty() ? "]" : "", state_->port);
}

void Web::wake() noexcept {
  if (!state_->woken.exchange(true)) lws_cancel_service(state_->context);
}

std::uint64_t Web::refused() const noexcept {
  return state_->refused;
}

}  // namespace ocm::cli::serve

#else

namespace ocm::cli::serve {

struct Web::State {};

transport::Outcome<std::unique_ptr<Web>> Web::open(const WebOptions&, Viewers&, Listener&) {
  return transport::Failure{};  // serve looks at has_websockets first
}
Web::~Web() = default;
std::string Web::url() const {
  return {};
}
void Web::wake() noexcept {}
std::uint64_t Web::refused() const noexcept {
  return 0;
}

}  // namespace ocm::cli::serve

#endif
