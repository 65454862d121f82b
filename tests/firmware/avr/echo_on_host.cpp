// The image's link_echo.hpp compiled for the host, where an int has 32 bits: what the 8-bit one must not
// differ from. Lines on stdin: `pin 0|1`, `send HEX`, `run MS`; on stdout all that it said as hex, then its
// reader's counters and what it could not say.
#include <cstdint>
#include <cstdio>
#include <iostream>
#include <string>

#include "ocm/base/text.hpp"

#include "firmware/avr/link_echo.hpp"

int main() {
  ocm::firmware::avr::LinkEcho echo;
  std::uint32_t now_ms = 0;
  bool linked = false;
  std::string said;
  for (std::string command, argument; std::cin >> command >> argument;) {
    if (command == "pin") linked = argument == "0";
    if (command == "send")
      for (std::size_t i = 0; i + 1 < argument.size(); i += 2)
        echo.receive(static_cast<std::uint8_t>(ocm::base::hex_digit(argument[i]) << 4 |
                                               ocm::base::hex_digit(argument[i + 1])));
    for (std::uint32_t ms = command == "run" ? static_cast<std::uint32_t>(std::stoul(argument)) : 0; ms > 0;
         --ms)
      echo.tick(++now_ms, linked);
    for (auto packet = echo.take(); packet; packet = echo.take())
      said.append(reinterpret_cast<const char*>(packet->bytes().data()), packet->bytes().size());
  }
  for (const char c : said) std::printf("%02x", static_cast<unsigned char>(c));
  const auto& faults = echo.reader().faults();
  std::printf("\n%u %u %u %u %u %u %u %u %u %u %u\n", faults.torn, faults.unclosed, faults.headless,
              faults.unknown, faults.bad_number, faults.wrong_count, faults.out_of_range, faults.too_long,
              echo.reader().heard(), echo.reader().stray(), unsigned{echo.unsaid()});
}
