#include "ocm/can/error_frame.hpp"

#include <algorithm>
#include <linux/can/error.h>

#include <catch2/catch.hpp>

#include "ocm/can/text.hpp"

namespace can_error_frame_test {

using namespace ocm;

constexpr auto words(const char* text) {
  return can::describe(*can::parse_frame(text));
}

// The kernel's header is the source of the numbers.
static_assert(can::error_class::tx_timeout == CAN_ERR_TX_TIMEOUT);
static_assert(can::error_class::arbitration_lost == CAN_ERR_LOSTARB);
static_assert(can::error_class::controller == CAN_ERR_CRTL);
static_assert(can::error_class::protocol == CAN_ERR_PROT);
static_assert(can::error_class::transceiver == CAN_ERR_TRX);
static_assert(can::error_class::no_acknowledgement == CAN_ERR_ACK);
static_assert(can::error_class::bus_off == CAN_ERR_BUSOFF);
static_assert(can::error_class::bus_error == CAN_ERR_BUSERROR);
static_assert(can::error_class::restarted == CAN_ERR_RESTARTED);
#ifdef CAN_ERR_CNT
static_assert(can::error_class::counters == CAN_ERR_CNT);
#endif
static_assert(can::controller_error::rx_overflow == CAN_ERR_CRTL_RX_OVERFLOW);
static_assert(can::controller_error::tx_overflow == CAN_ERR_CRTL_TX_OVERFLOW);
static_assert(can::controller_error::rx_warning == CAN_ERR_CRTL_RX_WARNING);
static_assert(can::controller_error::tx_warning == CAN_ERR_CRTL_TX_WARNING);
static_assert(can::controller_error::rx_passive == CAN_ERR_CRTL_RX_PASSIVE);
static_assert(can::controller_error::tx_passive == CAN_ERR_CRTL_TX_PASSIVE);
static_assert(can::controller_error::active == CAN_ERR_CRTL_ACTIVE);
static_assert(can::protocol_error::bit == CAN_ERR_PROT_BIT);
static_assert(can::protocol_error::form == CAN_ERR_PROT_FORM);
static_assert(can::protocol_error::stuff == CAN_ERR_PROT_STUFF);
static_assert(can::protocol_error::dominant_bit == CAN_ERR_PROT_BIT0);
static_assert(can::protocol_error::recessive_bit == CAN_ERR_PROT_BIT1);
static_assert(can::protocol_error::overload == CAN_ERR_PROT_OVERLOAD);
static_assert(can::protocol_error::active == CAN_ERR_PROT_ACTIVE);
static_assert(can::protocol_error::transmission == CAN_ERR_PROT_TX);
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_CRC_SEQ) == "the CRC");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_ACK) == "the acknowledge slot");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_ACK_DEL) == "the acknowledge delimiter");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_ID12_05) == "the identifier");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_EOF) == "the end of frame");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_INTERM) == "the intermission");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_SOF) == "the start of frame");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_ID28_21) == "the identifier" &&
              can::detail::error_location(CAN_ERR_PROT_LOC_ID20_18) == "the identifier" &&
              can::detail::error_location(CAN_ERR_PROT_LOC_ID17_13) == "the identifier" &&
              can::detail::error_location(CAN_ERR_PROT_LOC_ID04_00) == "the identifier");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_SRTR) == "the SRR bit");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_IDE) == "the IDE bit");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_RTR) == "the RTR bit");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_RES1) == "a reserved bit" &&
              can::detail::error_location(CAN_ERR_PROT_LOC_RES0) == "a reserved bit");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_DLC) == "the data length code");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_DATA) == "the data");
static_assert(can::detail::error_location(CAN_ERR_PROT_LOC_CRC_DEL) == "the CRC delimiter");
static_assert(can::detail::error_location(0x01).empty() && can::detail::error_location(0x1C).empty());

static_assert(words("20000040#0000000000000000") == "bus-off: the controller has left the bus");
static_assert(words("20000240#000000000000FF00") ==
              "bus-off: the controller has left the bus, error counters: sending 255, receiving 0");
static_assert(words("20000100#0000000000000000") == "the controller was restarted");
static_assert(words("20000004#0001000000000000") ==
              "the controller's receive buffer overflowed: frames are lost");
static_assert(words("20000004#0010000000000000") == "error passive (receiving)");
static_assert(words("20000004#0008000000006000") ==
              "error warning (sending), error counters: sending 96, receiving 0");
static_assert(words("20000204#003000000000C8C8") ==
              "error passive (both ways), error counters: sending 200, receiving 200");
static_assert(words("20000004#0040000000000000") == "error active again");
static_assert(words("20000004#0000000000000000") == "controller problem");
static_assert(words("20000004#0080000000000000") == "controller problem");
static_assert(words("20000004#0002000000000000") == "the controller's transmit buffer overflowed");
static_assert(words("20000004#0004000000000060") ==
              "error warning (receiving), error counters: sending 0, receiving 96");
static_assert(words("200000A0#0000001900000000") == "no acknowledgement: no other node, or another bit rate");
static_assert(words("200000A8#0000001900000000") == "no acknowledgement: no other node, or another bit rate");
static_assert(words("200000A8#0000041900000000") ==
              "no acknowledgement: no other node, or another bit rate, stuff error in the acknowledge slot");
static_assert(words("20000088#0000000800000000") == "protocol error in the CRC");
static_assert(words("20000088#0000040000000000") == "stuff error");
static_assert(words("20000088#0000810A00000000") == "bit error in the data while sending");
static_assert(words("20000008#0000060000000000") == "form error, stuff error");
static_assert(words("20000008#0000080000000000") == "dominant bit could not be sent");
static_assert(words("20000008#0000100000000000") == "recessive bit could not be sent");
static_assert(words("20000008#0000200000000000") == "overload");
static_assert(words("20000008#0000400000000000") == "active error flag");
static_assert(words("20000080#0000000000000000") == "bus error");
static_assert(words("20000002#0B00000000000000") == "arbitration lost in bit 11");
static_assert(words("20000002#0000000000000000") == "arbitration lost");
static_assert(words("20000002#0100000000000000") == "arbitration lost in bit 1");
static_assert(words("20000010#0000000045000000") == "CANH is shorted to the battery, CANL is not connected");
static_assert(words("20000010#0000000005000000") == "CANH is shorted to the battery");
static_assert(words("20000010#0000000050000000") == "CANL is shorted to the battery");
static_assert(words("20000010#0000000067000000") ==
              "CANH is shorted to ground, CANL is shorted to the supply");
static_assert(words("20000010#0000000081000000") == "CANH is in an unknown state, CANL is shorted to CANH");
static_assert(words("20000010#0000000010000000") == "CANL is in an unknown state");
static_assert(words("20000010#0000000000000000") == "transceiver problem");
static_assert(words("20000001#0000000000000000") == "the driver gave up sending: timeout");
static_assert(words("20000400#0000000000000000") == "unknown error class 0x00000400");
static_assert(words("20000000#0000000000000000") == "error frame without a class");
static_assert(words("20000200#0000000000000102") == "error counters: sending 1, receiving 2");
static_assert(words("205#01").view().empty());

static_assert(can::lost_in_controller(*can::parse_frame("20000004#0001000000000000")));
static_assert(!can::lost_in_controller(*can::parse_frame("20000004#0002000000000000")));
static_assert(!can::lost_in_controller(*can::parse_frame("20000040#0001000000000000")));
static_assert(!can::lost_in_controller(*can::parse_frame("00000004#0001000000000000")));

constexpr auto state(std::string_view text) {
  return can::controller_state(*can::parse_frame(text));
}
using State = can::ControllerState;
static_assert(state("20000040#0004000000000000") == State::bus_off);
static_assert(state("20000004#0030000000000000") == State::passive);
static_assert(state("20000004#0018000000000000") == State::passive,
              "one side is passive, the other is not yet");
static_assert(state("20000004#0008000000000000") == State::warning);
static_assert(state("20000004#0040000000000000") == State::active);
static_assert(state("20000100#0000000000000000") == State::active, "restarted");
static_assert(state("20000104#0008000000000000") == State::warning);
static_assert(!state("20000004#0001000000000000"), "an overflow says nothing of it");
static_assert(!state("20000088#0000040000000000") && !state("20000200#0000000000000102"));
static_assert(!state("00000040#00") && !state("205#01"));
static_assert(can::name(State::passive) == "error passive");
static_assert(can::name(State::active) == "error active" && can::name(State::warning) == "error warning" &&
              can::name(State::bus_off) == "bus-off");

static_assert(can::error_counters(*can::parse_frame("20000200#0000000000000102")) ==
              can::ErrorCounters{1, 2});
static_assert(!can::error_counters(*can::parse_frame("20000004#0008000000006000")),
              "a driver that has none leaves zeros");
static_assert(!can::error_counters(*can::parse_frame("00000200#0000000000000102")));

TEST_CASE("the longest description of an error frame fits") {
  std::size_t longest = 0;
  bool overflowed = false;
  for (unsigned byte = 0; byte < 256; ++byte) {
    const auto b = static_cast<std::uint8_t>(byte);
    for (const std::uint32_t id :
         {can::max_extended_id, can::max_extended_id & ~can::error_class::protocol}) {
      const auto text =
          can::describe(can::Frame{id, 8, {255, 0x7F, 0xFF, b, b, 0, 255, 255}, can::Format::error});
      longest = std::max(longest, text.view().size());
      overflowed = overflowed || text.overflowed();
    }
  }
  CAPTURE(longest);
  CHECK_FALSE(overflowed);
  CHECK(longest > 500);  // every class was in it
}

}  // namespace can_error_frame_test
