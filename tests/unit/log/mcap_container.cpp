#include "ocm/log/mcap_container.hpp"

#include <map>

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"

namespace log_mcap_container_test {

using namespace ocm;
using namespace ocm::log;
using log::testing::bytes;

void put(mcap::Container& container, Bytes& out, std::uint16_t channel, std::uint64_t ns,
         std::string_view text) {
  char* const at = container.begin_message(out, channel, ns, text.size());
  container.end_message(base::swar::copy(at, text));
}

struct Record {
  std::uint8_t kind;
  std::size_t place;  // in the file
  std::string_view content;
};
/// The records between the two magics; with those of chunks behind them.
std::vector<Record> records_of(std::string_view file) {
  REQUIRE(file.starts_with(mcap::magic));
  REQUIRE(file.ends_with(mcap::magic));
  std::vector<Record> records;
  for (std::size_t at = 8; at < file.size() - 8;) {
    const std::size_t length = static_cast<std::size_t>(base::swar::load64(file.data() + at + 1));
    REQUIRE(at + 9 + length <= file.size() - 8);
    records.push_back({static_cast<std::uint8_t>(file[at]), at, file.substr(at + 9, length)});
    at += 9 + length;
  }
  return records;
}
std::vector<Record> of_kind(const std::vector<Record>& records, std::uint8_t kind) {
  std::vector<Record> some;
  for (const Record& record : records)
    if (record.kind == kind) some.push_back(record);
  return some;
}

TEST_CASE("mcap_container: a file of one message, by hand") {
  mcap::Container container;
  Bytes out;
  container.begin(out, "x");
  const std::uint16_t schema = container.add_schema(out, "S", "{}");
  const std::uint16_t channel = container.add_channel(out, schema, "/c", {});
  put(container, out, channel, 258, "{}");
  container.finish(out);
  // [mcap.dev/spec: magic; records: opcode, length of 8 bytes, content; strings with a length of 4]
  const std::string schema_record =
      bytes("03 1B00000000000000 0100 01000000 53 0A000000") + "jsonschema" + bytes("02000000") + "{}";
  const std::string channel_record =
      bytes("04 1600000000000000 0100 0100 02000000") + "/c" + bytes("04000000") + "json" + bytes("00000000");
  const std::string message =
      bytes("05 1800000000000000 0100 00000000 0201000000000000 0201000000000000") + "{}";
  const std::string begin = bytes("89 4D434150 30 0D0A  01 0900000000000000 00000000 01000000") + "x" +
                            schema_record + channel_record;  // 8 + 18 + 36 + 31 = 93 bytes
  const std::uint32_t sum = crc32(message);
  const std::string sum_bytes(reinterpret_cast<const char*>(&sum), 4);
  const std::string chunk = bytes("06 4900000000000000 0201000000000000 0201000000000000 2100000000000000") +
                            sum_bytes + bytes("00000000 2100000000000000") + message;  // 82 bytes
  const std::string index = bytes("07 1600000000000000 0100 10000000 0201000000000000 0000000000000000");
  const std::string end = bytes("0F 0400000000000000 00000000");
  // the summary, at 93 + 82 + 31 + 13 = 219
  const std::string chunk_index = bytes(
      "08 4A00000000000000 0201000000000000 0201000000000000 5D00000000000000 5200000000000000"
      "0A000000 0100 AF00000000000000  1F00000000000000 00000000 2100000000000000 2100000000000000");
  const std::string statistics = bytes(
      "0B 3800000000000000 0100000000000000 0100 01000000 00000000 00000000 01000000"
      "0201000000000000 0201000000000000 0A000000 0100 0100000000000000");
  // groups at 219, 255, 286, 369; offsets at 434
  const std::string offsets = bytes(
      "0E 1100000000000000 03 DB00000000000000 2400000000000000"
      "0E 1100000000000000 04 FF00000000000000 1F00000000000000"
      "0E 1100000000000000 08 1E01000000000000 5300000000000000"
      "0E 1100000000000000 0B 7101000000000000 4100000000000000");
  const std::string footer = bytes("02 1400000000000000 DB00000000000000 B201000000000000");
  const std::string summary = schema_record + channel_record + chunk_index + statistics + offsets + footer;
  const std::uint32_t last = crc32(summary);
  const std::string last_bytes(reinterpret_cast<const char*>(&last), 4);
  CHECK(out.view() == begin + chunk + index + end + summary + last_bytes + bytes("89 4D434150 30 0D0A"));
}

TEST_CASE("mcap_container: without a message") {
  mcap::Container container;
  Bytes out;
  container.begin(out, "x");
  container.finish(out);
  const auto records = records_of(out.view());
  REQUIRE(records.size() == 5);
  CHECK(records[0].kind == mcap::opcode::header);
  CHECK(records[1].kind == mcap::opcode::data_end);
  CHECK(records[2].kind == mcap::opcode::statistics);
  CHECK(records[3].kind == mcap::opcode::summary_offset);
  CHECK(records[4].kind == mcap::opcode::footer);
  // No message, schema, channel, attachment, metadata and chunk, from 0 to 0.
  CHECK(records[2].content == std::string(46, '\0'));
}

static_assert(mcap::Container::chunk_size == 262'144 && mcap::Container::chunk_duration_ns == 1'000'000'000);
static_assert(mcap::Container::most_index == 67'108'864);

TEST_CASE("mcap_container: a message says its time twice, whatever stood in its place before") {
  mcap::Container container;
  Bytes out;
  container.begin(out, "x");
  const std::uint16_t channel = container.add_channel(out, container.add_schema(out, "S", "{}"), "/c", {});
  for (const std::uint64_t time : {UINT64_MAX, std::uint64_t{5}}) {
    put(container, out, channel, time, "{}");
    container.close_chunk(out);
  }
  container.finish(out);
  const auto chunks = of_kind(records_of(out.view()), mcap::opcode::chunk);
  REQUIRE(chunks.size() == 2);
  for (const Record& chunk : chunks) {
    const std::uint64_t time = &chunk == &chunks[0] ? UINT64_MAX : 5;
    CHECK(base::swar::load64(chunk.content.data() + 40 + 15) == time);
    CHECK(base::swar::load64(chunk.content.data() + 40 + 23) == time);
  }
}

TEST_CASE("mcap_container: a chunk is closed by its size, by a second either way, and when asked") {
  mcap::Container container;
  Bytes out;
  container.begin(out, "x");
  const std::uint16_t channel = container.add_channel(out, container.add_schema(out, "S", "{}"), "/c", {});
  const std::string big(mcap::Container::chunk_size - 31, 'x');
  constexpr std::uint64_t second = 1'000'000'000;
  put(container, out, channel, 5 * second, big);   // full with this one
  put(container, out, channel, 5 * second, "{}");  // the next one's first
  put(container, out, channel, 6 * second - 1, "{}");
  put(container, out, channel, 4 * second + 1, "{}");
  put(container, out, channel, 6 * second, "{}");  // a second behind
  put(container, out, channel, 5 * second, "{}");  // a second before
  container.close_chunk(out);
  container.close_chunk(out);  // nothing to close
  put(container, out, channel, 5 * second, "{}");
  container.finish(out);
  const auto chunks = of_kind(records_of(out.view()), mcap::opcode::chunk);
  std::vector<std::size_t> sizes;
  for (const Record& chunk : chunks) sizes.push_back(chunk.content.size() - 40);
  CHECK(sizes == std::vector<std::size_t>{31 + big.size(), 3 * 33, 33, 33, 33});
  mcap::Fields times{chunks[1].content};
  CHECK(times.u64() == 4 * second + 1);
  CHECK(times.u64() == 6 * second - 1);
}

TEST_CASE("mcap_container: every index leads to its message, and all are counted") {
  mcap::Container container;
  std::string file;
  Bytes out;
  const auto empty = [&] {  // as the file's owner does
    file += out.view();
    out.clear();
  };
  container.begin(out, "x");
  const mcap::Pair pairs[] = {{"k", "v"}};
  container.add_metadata(out, "about", pairs);
  empty();
  const std::uint16_t schema = container.add_schema(out, "S", "{}");
  std::uint16_t channels[3];
  for (auto& channel : channels) channel = container.add_channel(out, schema, "/c", pairs);
  std::mt19937 random{1};
  std::map<std::uint16_t, std::uint64_t> counts;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    const std::uint16_t channel = channels[random() % 3];
    put(container, out, channel, i * 10'000'000 + random() % 50'000'000, std::to_string(i));
    ++counts[channel];
    if (random() % 7 == 0) empty();
  }
  container.add_metadata(out, "end", pairs);
  container.finish(out);
  empty();

  const auto records = records_of(file);
  const auto chunk_at = [&](std::uint64_t place) {
    for (const Record& record : records)
      if (record.place == place) return record;
    return Record{};
  };
  std::map<std::uint16_t, std::uint32_t> numbers;  // of a channel's messages: a gap shows
  std::uint64_t found = 0, lowest_of_all = UINT64_MAX, highest_of_all = 0;
  for (const Record& record : of_kind(records, mcap::opcode::chunk_index)) {
    mcap::Fields fields{record.content};
    const std::uint64_t first = fields.u64(), last = fields.u64();
    const Record chunk = chunk_at(fields.u64());
    REQUIRE(chunk.kind == mcap::opcode::chunk);
    CHECK(fields.u64() == chunk.content.size() + 9);
    mcap::Fields offsets{fields.string()};
    std::uint64_t lowest = UINT64_MAX, highest = 0;
    while (!offsets.rest().empty()) {
      const std::uint16_t channel = offsets.u16();
      const Record index = chunk_at(offsets.u64());
      REQUIRE(index.kind == mcap::opcode::message_index);
      mcap::Fields entries{index.content};
      REQUIRE(entries.u16() == channel);
      mcap::Fields list{entries.string()};
      while (!list.rest().empty()) {
        const std::uint64_t time = list.u64(), offset = list.u64();
        const std::string_view message = chunk.content.substr(40 + static_cast<std::size_t>(offset));
        REQUIRE(message[0] == mcap::opcode::message);
        REQUIRE(base::swar::load16(message.data() + 9) == channel);
        REQUIRE(log::packet::load32(message.data() + 11) == numbers[channel]++);
        REQUIRE(base::swar::load64(message.data() + 15) == time);
        lowest = std::min(lowest, time);
        highest = std::max(highest, time);
        ++found;
      }
    }
    lowest_of_all = std::min(lowest_of_all, lowest);
    highest_of_all = std::max(highest_of_all, highest);
    CHECK(first == lowest);
    CHECK(last == highest);
  }
  CHECK(found == 5000);

  const auto statistics = of_kind(records, mcap::opcode::statistics);
  REQUIRE(statistics.size() == 1);
  mcap::Fields fields{statistics[0].content};
  CHECK(fields.u64() == 5000);
  CHECK(fields.u16() == 1);
  CHECK(fields.u32() == 3);
  CHECK(fields.u32() == 0);
  CHECK(fields.u32() == 2);
  CHECK(fields.u32() == of_kind(records, mcap::opcode::chunk).size());
  CHECK(fields.u64() == lowest_of_all);
  CHECK(fields.u64() == highest_of_all);
  mcap::Fields per_channel{fields.string()};
  for (const auto& [channel, count] : counts) {
    CHECK(per_channel.u16() == channel);
    CHECK(per_channel.u64() == count);
  }
  for (const Record& record : of_kind(records, mcap::opcode::metadata_index)) {
    mcap::Fields index{record.content};
    const Record metadata = chunk_at(index.u64());
    CHECK(metadata.kind == mcap::opcode::metadata);
    CHECK(index.u64() == metadata.content.size() + 9);
  }
}

TEST_CASE("mcap_container: an index that grows too long is left out, all of it") {
  for (const std::size_t limit : {std::size_t{830}, std::size_t{829}}) {  // ten entries have 83 bytes each
    mcap::Container container{limit};
    Bytes out;
    container.begin(out, "x");
    const std::uint16_t channel = container.add_channel(out, container.add_schema(out, "S", "{}"), "/c", {});
    for (std::uint64_t i = 0; i < 10; ++i) {
      put(container, out, channel, i, "{}");
      container.close_chunk(out);
    }
    container.finish(out);
    const auto records = records_of(out.view());
    CHECK(of_kind(records, mcap::opcode::chunk).size() == 10);
    CHECK(of_kind(records, mcap::opcode::chunk_index).size() == (limit == 830 ? 10 : 0));
    CHECK(of_kind(records, mcap::opcode::statistics).size() == 1);
  }
}

TEST_CASE("mcap_container: fields end where the record ends") {
  mcap::Fields fields{std::string_view{"\x02\0\0\0ab\x09\0\0\0c", 11}};
  CHECK(fields.string() == "ab");
  CHECK(fields.whole());
  CHECK(fields.string().empty());
  CHECK_FALSE(fields.whole());
  CHECK(fields.u64() == 0);
}

TEST_CASE("mcap_container: names as printable ASCII") {
  CHECK(mcap::escaped("can0") == "can0");
  CHECK(mcap::escaped("a b%/\xC3\xBC") == "a%20b%25/%C3%BC");
  CHECK(mcap::unescaped("%4") == "%4");
  CHECK(mcap::unescaped("%4G%") == "%4G%");
  CHECK(mcap::unescaped(std::string_view{"%41", 2}) == "%4");  // what is behind the name is not read
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  CHECK(mcap::unescaped(mcap::escaped(all)) == all);
}

}  // namespace log_mcap_container_test
