/// Whether what writes lines asks for the room that they take: in a run of bytes of which little is left.
#pragma once

#include <cstddef>
#include <string>

#include <catch2/catch.hpp>

#include "ocm/log/bytes.hpp"

namespace ocm::test {

/// How many bytes there is room for in a run that was empty.
inline std::size_t room_of_a_new_run() {
  log::Bytes bytes;
  const char* const first = bytes.room(1);
  std::size_t room = 1;
  while (bytes.room(room + 1) == first) ++room;
  return room;
}

/// What `write` appends is the same however little is left, and none of it is beyond the room of its run.
template <class Write>
void check_room(const Write& write, std::size_t step = 1) {
  log::Bytes alone;
  write(alone);
  const std::string lines{alone.view()};
  REQUIRE(lines.ends_with("\n"));
  const std::size_t room = room_of_a_new_run();
  for (std::size_t left = 0; left < lines.size() + 64; left += step) {
    log::Bytes out;
    out.zeros(room - left);
    const char* const before = out.view().data();
    write(out);
    CAPTURE(lines.substr(0, 200), left);
    REQUIRE((out.size() <= room || out.view().data() != before));
    REQUIRE((out.view().substr(room - left) == lines));
  }
}

}  // namespace ocm::test
