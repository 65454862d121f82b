// What may stand where a packed update does: 20 bytes are an update that packs to the same 20, or none; a
// stream gives none that is damaged; after any noise and a line end the next one is heard.
#include "ocm/mapper/link/packed.hpp"

#include "tests/robustness/fuzz/fuzz.hpp"

using namespace ocm;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Input input{data, size};
  mapper::link::Packet packet;
  const auto head = input.bytes(mapper::link::max_packet);
  std::copy(head.begin(), head.end(), packet.data.begin());
  packet.size = mapper::link::max_packet;
  // Random bytes have no right checksum: half of the inputs are given one.
  if (input.byte() % 2 == 0) {
    const std::uint16_t crc = base::crc16(packet.bytes().first(17));
    packet.data[17] = static_cast<std::uint8_t>(0x80 | crc >> 14);
    packet.data[18] = static_cast<std::uint8_t>(0x80 | (crc >> 7 & 0x7F));
    packet.data[19] = static_cast<std::uint8_t>(0x80 | (crc & 0x7F));
  }
  const auto update =
      mapper::link::unpack(std::span<const std::uint8_t, mapper::link::max_packet>{packet.data});
  if (update) {
    const auto again = mapper::link::pack(*update);
    fuzz::expect(again.ok() && *again == packet, "what is unpacked packs to the same bytes");
  }

  mapper::link::PackedReader reader;
  std::uint32_t fed = 0;
  while (!input.empty()) {
    const std::uint8_t byte = input.byte();
    if (!mapper::link::is_packed(byte)) {
      reader.interrupt();
      continue;
    }
    ++fed;
    if (reader.feed(byte))
      fuzz::expect(mapper::link::pack(reader.packed()).ok(), "an update that is heard can be sent");
  }
  const auto& f = reader.faults();
  fuzz::expect(f.stray + 20 * (reader.heard() + f.repeated + f.late + f.out_of_range) <= fed,
               "no byte is taken twice");
  reader.restart();
  const auto good = mapper::link::pack({7, {.x = -177, .servo = 49}});
  bool heard = false;
  for (const std::uint8_t byte : good->bytes()) heard = reader.feed(byte);
  fuzz::expect(heard && reader.packed().sequence == 7, "on a new link the next update is heard");
  return 0;
}
