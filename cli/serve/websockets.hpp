/// The functions of libwebsockets, loaded when `serve` begins and not with the program: with OpenSSL, which
/// it brings along, that was two fifths of each start of each verb. They keep their names: within this
/// namespace a call looks as it does with the library linked. For web.cpp alone.
#pragma once

#include <dlfcn.h>
#include <libwebsockets.h>

#include <fmt/format.h>

#include "ocm/transport/bus.hpp"

namespace ocm::cli::serve {
namespace {

// clang-format off
#define OCM_WEBSOCKETS(each) \
  each(lws_add_http_common_headers) each(lws_add_http_header_by_name) each(lws_callback_on_writable) \
  each(lws_cancel_service) each(lws_close_reason) each(lws_context_destroy) \
  each(lws_context_user) each(lws_create_context) each(lws_finalize_write_http_header) \
  each(lws_frame_is_binary) each(lws_get_context) each(lws_get_socket_fd) \
  each(lws_get_urlarg_by_name) each(lws_get_vhost_by_name) each(lws_get_vhost_listen_port) \
  each(lws_hdr_copy) each(lws_hdr_total_length) each(lws_http_transaction_completed) \
  each(lws_is_final_fragment) each(lws_remaining_packet_payload) each(lws_return_http_status) \
  each(lws_send_pipe_choked) each(lws_service) each(lws_set_log_level) \
  each(lws_write)
// clang-format on
#define OCM_DECLARE(function) decltype(&::function) function = nullptr;
OCM_WEBSOCKETS(OCM_DECLARE)
#undef OCM_DECLARE

/// Once, before any of them is called. They stay until the program ends.
transport::Outcome<void> load_websockets() {
  if (lws_service != nullptr) return {};
  void* const library = dlopen(OCM_WEBSOCKETS_NAME, RTLD_NOW | RTLD_LOCAL);
  bool whole = library != nullptr;
#define OCM_FIND(function) \
  whole = whole && (function = reinterpret_cast<decltype(&::function)>(dlsym(library, #function))) != nullptr;
  OCM_WEBSOCKETS(OCM_FIND)
#undef OCM_FIND
  if (whole) return {};
  const char* const why = dlerror();
  return transport::Failure{
      fmt::format("cannot load libwebsockets, which serves: {}", why != nullptr ? why : OCM_WEBSOCKETS_NAME),
      "install it: on Debian 12 it is the package libwebsockets17"};
}
#undef OCM_WEBSOCKETS

}  // namespace
}  // namespace ocm::cli::serve
