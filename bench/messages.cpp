// ns a frame of plain messages: the header generated of a DBC file against the same work in plain shifts.
//
//   messages [--check]     --check: compares the sums on a few thousand frames, and measures nothing
#include "bench/messages.hpp"

#include <random>

#include "bench/ways.hpp"

namespace {

using namespace ocm::bench;
using ocm::can::Frame;

/// How many bits each field of a message has, in the order of `identifiers`; below zero those with a sign. Of
/// the last one its second page.
constexpr int widths[][7] = {{16, -12, 8, 8, 1, 1, 4},
                             {3, -4, 8, 16},
                             {16, 16, 16, 16},
                             {16, -12, 12, 1, 2, -16},
                             {1, 1, 1, 1, 1, 1, 7},
                             {2, 2, 1, 1, 8},
                             {2, 2},
                             {16, -16, 8, -8, 3},
                             {-32, -32},
                             {16, 8, 1}};

Work<CarNumbers> make_work(std::size_t count, bool random_order) {
  std::mt19937_64 random{20261124};
  Work<CarNumbers> work;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t message = (random_order ? random() : i) % identifiers.size();
    Frame frame{identifiers[message], 8, {}};
    for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random());
    // Pages in turn with the messages, four and one that is empty.
    if (frame.id == 0x400) frame.data[0] = static_cast<std::uint8_t>((random_order ? random() : i / 10) % 5);
    CarNumbers numbers{identifiers[message], {}};
    for (std::size_t f = 0; f < numbers.field.size(); ++f) {
      const int width = widths[message][f];
      if (width == 0) continue;
      const std::uint64_t bits = random();
      numbers.field[f] = width < 0
                             ? static_cast<std::int32_t>(static_cast<std::int64_t>(bits) >> (64 + width))
                             : static_cast<std::int32_t>(bits >> (64 - width));
    }
    work.frames.push_back(frame);
    work.numbers.push_back(numbers);
  }
  return work;
}

}  // namespace

int main(int argc, char** argv) {
  Ways<CarNumbers> ways{
      "messages",
      {{"by hand", decode_car_by_hand}, {"library", decode_car_by_library}, {"table", decode_car_by_table}},
      {{"by hand", encode_car_by_hand}, {"library", encode_car_by_library}}};
  if (has_vectors()) ways.decoders.push_back({"table, AVX2", decode_car_by_vectors});
  return ways.main(argc, argv, make_work);
}
