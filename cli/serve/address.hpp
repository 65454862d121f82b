/// The address of the page: what it needs to command, and what it shows first, are behind its #, which no
/// browser sends to a server.
#pragma once

#include <string>
#include <string_view>

namespace ocm::cli::serve {

/// "http://127.0.0.1:8484/#0f1d...&plot=/gyroscope.z"; `token` and `shows` may be empty.
[[nodiscard]] inline std::string page_address(std::string_view url, std::string_view token,
                                              std::string_view shows) {
  std::string address{url};
  if (!token.empty() || !shows.empty()) address += '#';
  address += token;
  if (!token.empty() && !shows.empty()) address += '&';
  return address += shows;
}

/// Has this user's browser open it. Without a display, or without xdg-open, a remark says so.
void open_in_browser(const std::string& address);

}  // namespace ocm::cli::serve
