#include "ocm/log/mcap.hpp"

#include <array>
#include <string>

#include <catch2/catch.hpp>

#include "tests/unit/log/log_testing.hpp"
#include "unit/base/explore.hpp"

namespace log_mcap_test {

using namespace ocm;
using namespace ocm::log;
using log::testing::bytes;
using log::testing::read_all;

std::string number(std::uint64_t value, std::size_t size) {
  return {reinterpret_cast<const char*>(&value), size};
}
std::string string(std::string_view text) {
  return number(text.size(), 4) + std::string{text};
}
std::string record(std::uint8_t kind, std::string_view content) {
  return static_cast<char>(kind) + number(content.size(), 8) + std::string{content};
}

const std::string magic{mcap::magic};
const std::string head = magic + record(1, string("") + string("by hand"));
const std::string schema =
    record(3, bytes("0700") + string("ocm.CanFrame") + string("jsonschema") + string("{}"));
const std::string channel = record(4, bytes("0900 0700") + string("/can3/raw") + string("json") + string(""));
const std::string said = schema + channel;
/// A message of channel 9 at 1.000000005 s.
std::string message(std::string_view json, std::uint16_t to = 9) {
  return record(5,
                number(to, 2) + number(0, 4) + number(1'000'000'005, 8) + number(0, 8) + std::string{json});
}
const std::string frame = message(R"({"id":291,"data":"1122"})");
const std::string tail =
    record(15, number(0, 4)) + record(2, number(0, 8) + number(0, 8) + number(0, 4)) + magic;

std::string chunk(std::string_view records, std::string_view compression = "", std::uint32_t sum = 0,
                  std::uint64_t size = 0) {
  return record(6, number(0, 8) + number(0, 8) + number(size != 0 ? size : records.size(), 8) +
                       number(sum, 4) + string(compression) + number(records.size(), 8) +
                       std::string{records});
}

/// In place of zstd: all bytes in the other order.
std::size_t reverse(std::string_view packed, std::span<char> into) {
  if (packed.size() > into.size()) return 0;
  std::copy(packed.rbegin(), packed.rend(), into.begin());
  return packed.size();
}

log::testing::Log read_mcap(std::string_view file) {
  return read_all<McapReader>(file, Unzstd{reverse});
}
/// Of a file with just this complaint, and as many entries.
Cause cause_of(std::string_view file, std::size_t entries) {
  const auto log = read_mcap(file);
  REQUIRE(log.entries.size() == entries);
  REQUIRE(log.complained == 1);
  return log.complaints[0].cause;
}

Entry wanted() {
  return {base::Time{base::Duration{1'000'000'005}}, {0x123, 2, {0x11, 0x22}}};
}

Interfaces three() {
  Interfaces interfaces;
  for (const char* name : {"can0", "", "v\xFF%/raw"}) interfaces.add(name);
  return interfaces;
}

TEST_CASE("mcap: a file by hand, with chunks and without") {
  CHECK(McapReader::recognises(head));
  for (const std::string& file :
       {head + said + frame + tail, head + chunk(said + frame) + tail,
        head + said + chunk(frame, "", crc32(frame)) + tail,
        head + chunk(said) + chunk("") + chunk(frame) + record(0x0F, number(0, 4)) + said + frame + tail,
        head + record(9, std::string(100, 'x')) + record(0x80, "x") + record(7, "") + said + chunk(frame) +
            tail}) {
    const auto log = read_mcap(file);
    CHECK(log.complained == 0);
    REQUIRE(log.entries.size() == 1);
    CHECK(log.entries[0] == wanted());
    CHECK(log.names[0] == "can3");
  }
}

TEST_CASE("mcap: a record as long as a footer is no footer") {
  for (const int kind : {7, 9, 12, 0x80}) {
    const std::string other = record(static_cast<std::uint8_t>(kind), std::string(mcap::footer_size, '\0'));
    const auto log = read_mcap(head + said + other + frame + tail);
    CHECK(log.complained == 0);
    CHECK(log.entries.size() == 1);
  }
}

TEST_CASE("mcap: random entries come back the same, whatever the batches and pieces") {
  auto entries = test::RandomEntries{3, {}}.many(3000);
  entries[7].time = base::Time{base::Duration{-1}};
  entries[8].time = base::Time{};
  McapWriter writer{"x", {{"robot", "r"}}};
  const std::vector<Recorded> recorded{{5, 1}, {0, 0}, {7, 70'000'000'000}};
  const std::string file = log::testing::write_all(writer, entries, three(), recorded);
  CHECK_FALSE(writer.lost().any());
  for (const std::size_t batch_size : {std::size_t{1}, std::size_t{256}}) {
    for (const std::size_t piece : {std::size_t{1}, std::size_t{1000}, std::size_t{1} << 20}) {
      test::Drops source{file, piece};
      const auto log = log::testing::read_from<McapReader>(source, batch_size);
      CHECK(log.complained == 0);
      REQUIRE(log.entries.size() == entries.size());
      for (std::size_t i = 0; i < entries.size(); ++i) {
        REQUIRE(log.entries[i] == entries[i]);
        REQUIRE(log.names[i] == three().name(entries[i].interface));
        REQUIRE(log::testing::can_exist(log.entries[i]));
      }
      REQUIRE(log.recorded.size() == 3);
      CHECK(log.recorded[2].received == 7);
      CHECK(log.recorded[2].dropped == 70'000'000'000);
    }
  }
}

TEST_CASE("mcap: a file says who wrote it, and what it is about if there is anything") {
  McapWriter writer{"x", {{"robot", "r"}}};
  const std::string file = log::testing::write_all(writer, {}, three());
  CHECK(file.starts_with(magic + record(1, string("") + string("x"))));
  CHECK(file.find(record(12, string("ocm") + string(string("robot") + string("r")))) != std::string::npos);
  McapWriter plain{"x"};
  const std::string without = log::testing::write_all(plain, {}, three());
  CHECK(without.find(string("ocm") + string("")) == std::string::npos);
}

TEST_CASE("mcap: an interface of which only the frames are known has a channel, too") {
  Interfaces one;
  one.add("can0");
  const std::vector<Entry> entries{Entry{{}, {1, 0, {}}, 0}, Entry{{}, {2, 0, {}}, 1}};
  McapWriter writer;
  const std::string file = log::testing::write_all(writer, entries, one);
  MemorySource source{file};
  Input input{source};
  McapReader reader{input};
  std::array<Entry, 3> some;
  REQUIRE(reader.read(some) == 2);
  CHECK(some[0] == entries[0]);
  CHECK(some[1] == entries[1]);
  CHECK(reader.read(some) == 0);
  CHECK(reader.interfaces().size() == 2);
  CHECK(reader.interfaces().name(1).empty());
}

TEST_CASE("mcap: there is a channel of each interface that is known, and no other") {
  Interfaces interfaces;
  for (const char* name : {"can0", "can1", "can2"}) {
    interfaces.add(name);
    McapWriter writer;
    Bytes out;
    writer.begin(out);
    writer.write(out, std::vector<Entry>(1), interfaces);
    writer.finish(out);
    MemorySource source{out.view()};
    Input input{source};
    McapReader reader{input};
    std::array<Entry, 2> some;
    REQUIRE(reader.read(some) == 1);
    CHECK(reader.read(some) == 0);
    CHECK(reader.interfaces().size() == interfaces.size());
  }
}

TEST_CASE("mcap: what flush has handed out is in the file, however it ends") {
  McapWriter writer;
  Bytes out;
  const auto entries = test::RandomEntries{3, {}}.many(10);
  writer.begin(out);
  writer.write(out, std::span{entries}.first(4), three());
  const std::size_t before = out.size();
  writer.flush(out);
  CHECK(out.size() > before);
  const std::string killed{out.view()};
  writer.write(out, std::span{entries}.subspan(4), three());
  const auto log = read_mcap(killed);
  REQUIRE(log.entries.size() == 4);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::truncated);
  CHECK(log.complaints[0].place == Place{killed.size()});
  writer.finish(out);
  CHECK(read_mcap(out.view()).entries.size() == 10);
}

TEST_CASE("mcap: a pipe shows what is there, and waits for nothing else") {
  const std::string first = head + said + chunk(frame + frame);
  const std::string file = first + chunk(frame) + record(7, std::string(100, '\0')) + tail;
  for (const std::size_t beyond : {0U, 5U, 20U, 60U}) {  // a bit of the next record
    test::Drops source{file, first.size() + beyond};
    Input input{source};
    McapReader reader{input};
    Entry some[10];
    CHECK(reader.read(some) == 2);
    CHECK(source.reads == 1);
    CHECK(reader.read(some) == 1);
    CHECK(reader.read(some) == 0);
    CHECK(reader.complaints().total() == 0);
  }
}

TEST_CASE("mcap: a pipe shows all that is there to its last byte") {
  const std::string first = head + said + chunk(frame + frame) + chunk(frame);
  const std::string file = first + frame + tail;
  test::Drops source{file, first.size()};
  Input input{source};
  McapReader reader{input};
  Entry some[10];
  CHECK(reader.read(some) == 3);
  CHECK(source.reads == 1);
  CHECK(reader.read(some) == 1);
  CHECK(reader.read(some) == 0);
  CHECK(reader.complaints().total() == 0);
}

TEST_CASE("mcap: a complaint says what is wrong, and where") {
  struct Case {
    std::string behind;
    Cause cause;
    std::string detail;
    std::size_t place, entries;
  };
  const std::string before = head + said;
  const std::size_t begin = before.size(), in_chunk = begin + 49;
  const std::string backwards{frame.rbegin(), frame.rend()};
  const std::string odd = frame + "\5", odd_backwards{odd.rbegin(), odd.rend()};
  std::string longer = chunk(frame), huge = record(12, std::string(60, '\6'));
  longer.replace(41, 8, number(frame.size() + 1, 8));
  huge.replace(1, 8, number(std::uint64_t{1} << 32, 8));
  const std::size_t footer = begin + frame.size() + 13;
  for (const Case& each : std::vector<Case>{
           {frame, Cause::truncated, "no end of the file", begin + frame.size(), 1},
           {frame + "\5", Cause::truncated, "the beginning of a record", begin + frame.size(), 1},
           {frame + tail.substr(0, tail.size() - 1), Cause::truncated, "the file's end", footer, 1},
           {frame + tail + "x", Cause::syntax, "the file does not end behind its footer", footer, 1},
           {std::string(20, '\0') + chunk(frame) + tail, Cause::syntax, "no record begins here", begin, 1},
           {frame + frame.substr(0, 20), Cause::truncated, "a message", begin + frame.size(), 1},
           {schema.substr(0, 20), Cause::truncated, "a schema", begin, 0},
           {channel.substr(0, 20), Cause::truncated, "a channel", begin, 0},
           {chunk(frame).substr(0, 20), Cause::truncated, "a chunk", begin, 0},
           {record(9, std::string(100, 'x')).substr(0, 50), Cause::truncated, "a record of kind 9", begin, 0},
           {huge + chunk(frame) + tail, Cause::too_long, "a record of kind 12 of 4294967296 bytes", begin, 1},
           {chunk(frame, "", crc32(frame) ^ 1) + tail, Cause::checksum, "a chunk, which is read unchecked",
            begin, 1},
           {chunk(backwards, "lz4") + frame + tail, Cause::compressed, "a chunk in lz4; zstd is read", begin,
            1},
           {chunk(backwards, "zstd", 1, 1000) + tail, Cause::compressed,
            "a chunk, " + std::to_string(frame.size()) + " of 1000 bytes", begin, 1},
           {chunk(backwards, "zstd", 0, Input::longest + 1) + frame + tail, Cause::too_long,
            "a chunk of 16777217 bytes", begin, 1},
           {record(6, std::string(39, '\0')) + frame + tail, Cause::syntax, "the head of a chunk", begin, 1},
           {longer + tail, Cause::length, "records beyond their chunk", begin, 1},
           {chunk(odd) + tail, Cause::syntax, "a record beyond its chunk", in_chunk + frame.size(), 1},
           {chunk(frame + chunk(frame)) + tail, Cause::syntax, "a chunk within a chunk",
            in_chunk + frame.size(), 1},
           {chunk(odd_backwards, "zstd") + tail, Cause::syntax, "a record beyond its chunk", begin, 1},
           {message("{}", 8) + frame + tail, Cause::syntax,
            "a message of channel 8, of which nothing is said", begin, 1},
       }) {
    CAPTURE(each.detail);
    const auto log = read_mcap(before + each.behind);
    CHECK(log.entries.size() == each.entries);
    REQUIRE(log.complained == 1);
    CHECK(log.complaints[0].cause == each.cause);
    CHECK(log.complaints[0].detail == each.detail);
    CHECK(log.complaints[0].place == Place{each.place});
  }
}

TEST_CASE("mcap: behind damage, a chunk is found that is packed, and none in a way that has no such name") {
  const std::string damage(20, '\0'), backwards{frame.rbegin(), frame.rend()};
  CHECK(cause_of(head + said + damage + chunk(backwards, "zstd") + tail, 1) == Cause::syntax);
  CHECK(cause_of(head + said + damage + chunk(frame, "brotl") + chunk(frame) + tail, 1) == Cause::syntax);
}

TEST_CASE("mcap: a packed chunk has the room that it says, whatever those before it had") {
  std::string many;
  while (many.size() < std::size_t{1} << 20) many += frame;
  const std::string few{frame.rbegin(), frame.rend()}, backwards{many.rbegin(), many.rend()};
  const auto log = read_mcap(head + said + chunk(few, "zstd") + chunk(backwards, "zstd", crc32(many)) +
                             chunk(few, "zstd") + tail);
  CHECK(log.complained == 0);
  CHECK(log.entries.size() == many.size() / frame.size() + 2);
  // As much as may be said, and one byte more.
  const std::string whole = head + said, end = frame + tail;
  CHECK(cause_of(whole + chunk(few, "zstd", 0, Input::longest) + end, 2) == Cause::compressed);
  CHECK(cause_of(whole + chunk(few, "zstd", 0, Input::longest + 1) + end, 1) == Cause::too_long);
}

TEST_CASE("mcap: chunks that are packed") {
  const std::string backwards{frame.rbegin(), frame.rend()};
  const auto log = read_mcap(head + said + chunk(backwards, "zstd", crc32(frame)) + frame + tail);
  CHECK(log.complained == 0);
  CHECK(log.entries.size() == 2);
  CHECK(cause_of(head + said + chunk(backwards, "lz4") + frame + tail, 1) == Cause::compressed);
  CHECK(cause_of(head + said + chunk(backwards, "zstd", 0, 3) + frame + tail, 1) == Cause::compressed);
  CHECK(cause_of(head + said + chunk(backwards, "zstd", 1, 1000) + frame + tail, 2) == Cause::compressed);
  CHECK(cause_of(head + said + chunk(backwards, "zstd", 0, UINT64_MAX) + frame + tail, 1) == Cause::too_long);
  const auto without = read_all<McapReader>(head + said + chunk(backwards, "zstd") + frame + tail);
  REQUIRE(without.complained == 1);
  CHECK(without.complaints[0].cause == Cause::compressed);
  CHECK(without.complaints[0].detail == "a chunk in zstd");
}

TEST_CASE("mcap: what was recorded is believed of channels of frames only") {
  const auto about = [](std::string_view of, std::string_view name = "ocm.recorded") {
    return record(12, string(name) + string(string("channel") + string(of) + string("received") +
                                            string("5") + string("dropped") + string("6")));
  };
  const std::string other = record(4, bytes("0A00 0000") + string("/x") + string("json") + string(""));
  for (const std::string& wrong :
       {about("10"), about("11"), about("70000"), about("x"), about("9", "theirs")})
    CHECK(read_mcap(head + said + other + frame + wrong + tail).recorded.empty());
  const auto log = read_mcap(head + said + other + frame + about("9") + about("9") + tail);
  CHECK(log.complained == 0);
  REQUIRE(log.recorded.size() == 1);
  CHECK(log.recorded[0].received == 10);
  CHECK(log.recorded[0].dropped == 12);
  // What names no channel is of none, of the first one neither.
  const std::string first = record(4, bytes("0100 0700") + string("/can0/raw") + string("json") + string(""));
  const std::string of_none = record(12, string("ocm.recorded") + string(string("received") + string("5")));
  CHECK(read_mcap(head + said + first + frame + of_none + tail).recorded.empty());
}

TEST_CASE("mcap: a wrong checksum is reported, and the chunk is read") {
  CHECK(cause_of(head + said + chunk(frame, "", crc32(frame) ^ 1) + tail, 1) == Cause::checksum);
}

TEST_CASE("mcap: messages that are no frames") {
  for (const bool chunked : {false, true}) {
    const auto with = [&](const std::string& what) {
      return head + said + (chunked ? chunk(what + frame) : what + frame) + tail;
    };
    CHECK(cause_of(with(message("{}")), 1) == Cause::identifier);
    CHECK(cause_of(with(message("x")), 1) == Cause::syntax);
    CHECK(cause_of(with(message(frame, 8)), 1) == Cause::syntax);  // of a channel without a description
    CHECK(cause_of(with(message("{}", 10)), 1) == Cause::syntax);  // just behind the last
    CHECK(cause_of(with(message(frame, 0xFFFF)), 1) == Cause::syntax);
    CHECK(cause_of(with(record(5, "x")), 1) == Cause::length);
    // The last time that there is, with nothing in it, and the first that there is not.
    CHECK(cause_of(with(record(5, bytes("0900 00000000 FFFFFFFFFFFFFF7F 0000000000000000") + "{}")), 1) ==
          Cause::identifier);
    CHECK(cause_of(with(record(5, bytes("0900 00000000 0000000000000080 0000000000000000") + "{}")), 1) ==
          Cause::time);
    CHECK(cause_of(with(record(5, bytes("0900 00000000 FFFFFFFFFFFFFFFF 0000000000000000") + "{}")), 1) ==
          Cause::time);
    CHECK(cause_of(with(record(3, "x")), 1) == Cause::syntax);
    CHECK(cause_of(with(record(4, "x")), 1) == Cause::syntax);
  }
  CHECK(cause_of(head + said + chunk(chunk(frame) + frame) + tail, 1) ==
        Cause::syntax);  // a chunk in a chunk
  CHECK(cause_of(head + said + chunk(frame + "\5") + frame + tail, 2) == Cause::syntax);
  CHECK(cause_of(head + said + chunk(frame + record(5, "")) + frame + tail, 2) == Cause::length);
  CHECK(cause_of(head + said + record(6, std::string(39, '\0')) + frame + tail, 1) == Cause::syntax);
}

TEST_CASE("mcap: other people's channels are skipped, and reported if there are no others") {
  const std::string theirs =
      record(3, bytes("0100") + string("std_msgs/String") + string("ros1msg") + string("")) +
      record(4, bytes("0100 0100") + string("/chatter") + string("ros1") + string(""));
  const std::string word = message("x", 1);
  const auto both = read_mcap(head + theirs + said + word + frame + chunk(word + frame + word) + tail);
  CHECK(both.complained == 0);
  CHECK(both.entries.size() == 2);
  CHECK(cause_of(head + theirs + word + word + tail, 0) == Cause::unsupported);
  CHECK(read_mcap(head + theirs + word + word + tail).complaints.at(0).detail ==
        "2 messages, none on a channel of CAN frames");
  CHECK(read_mcap(head + theirs + tail).complained == 0);
  // Our schema in another encoding is not ours.
  const std::string cbor = record(4, bytes("0900 0700") + string("/can3/raw") + string("cbor") + string(""));
  const auto log = read_mcap(head + schema + cbor + said + frame + tail);
  REQUIRE(log.complained == 1);
  CHECK(log.complaints[0].cause == Cause::unsupported);
  CHECK(log.entries.size() == 1);
  const std::string nothing = record(4, bytes("0A00 0800") + string("/x") + string("json") + string(""));
  CHECK(cause_of(head + said + nothing + frame + tail, 1) == Cause::syntax);
  const std::string none = record(4, bytes("0A00 0000") + string("/x") + string("json") + string(""));
  CHECK(read_mcap(head + said + none + message("", 10) + frame + tail).complained == 0);
}

TEST_CASE("mcap: a channel that is described again stays the same; two of one name stay two") {
  const std::string second =
      record(4, bytes("0A00 0700") + string("/can3/raw") + string("json") + string(""));
  const auto log = read_mcap(head + said + frame + said + frame + second + message(R"({"id":1})", 10) + tail);
  CHECK(log.complained == 0);
  REQUIRE(log.entries.size() == 3);
  CHECK(log.entries[1].interface == 0);
  CHECK(log.entries[2].interface == 1);
  CHECK(log.names[2] == "can3");
}

TEST_CASE("mcap: a channel that is described by another name is of another interface from there on") {
  const std::string renamed =
      record(4, bytes("0900 0700") + string("/can4/raw") + string("json") + string(""));
  const auto log = read_mcap(head + said + frame + renamed + frame + tail);
  CHECK(log.complained == 0);
  CHECK(log.names == std::vector<std::string>{"can3", "can4"});
}

TEST_CASE("mcap: schemas may have numbers that follow each other") {
  const std::string next = record(3, bytes("0800") + string("theirs") + string("x") + string(""));
  const auto log = read_mcap(head + schema + next + channel + frame + tail);
  CHECK(log.complained == 0);
  CHECK(log.entries.size() == 1);
}

TEST_CASE("mcap: lengths that cannot be are said, and reading goes on at the next chunk") {
  for (const std::uint64_t length : {std::uint64_t{1} << 32, std::uint64_t{1} << 63, UINT64_MAX,
                                     std::uint64_t{Input::longest}, (std::uint64_t{1} << 63) - 1}) {
    INFO(length);
    for (const int kind : {3, 4, 5, 6, 7, 12}) {
      std::string wrong = record(static_cast<std::uint8_t>(kind), std::string(60, '\6'));
      wrong.replace(1, 8, number(length, 8));
      const auto log = read_mcap(head + said + wrong + chunk(frame) + tail);
      REQUIRE(log.complained == 1);
      CHECK(log.complaints[0].cause == Cause::too_long);
      CHECK(log.entries.size() == 1);
    }
    std::string beyond = frame;
    beyond.replace(1, 8, number(length, 8));
    CHECK(cause_of(head + said + chunk(frame + beyond) + chunk(frame) + tail, 2) == Cause::syntax);
    std::string attached = record(9, std::string(60, '\6'));
    attached.replace(1, 8, number(length, 8));
    CHECK(cause_of(head + said + frame + attached + chunk(frame), 1) == Cause::truncated);
  }
  CHECK(cause_of(head + said + std::string(1000, '\0') + chunk(frame) + chunk(frame) + tail, 2) ==
        Cause::syntax);
  CHECK(cause_of(head + said + frame + record(2, std::string(21, 'x')), 1) == Cause::syntax);
}

TEST_CASE("mcap: the longest record that is read, and one that is longer") {
  const auto with_record_of = [](int kind, std::size_t size) {
    return read_mcap(head + said + record(static_cast<std::uint8_t>(kind), std::string(size, '\6')) +
                     chunk(frame) + tail);
  };
  const int metadata = 12;
  const auto longest = with_record_of(metadata, Input::longest - mcap::record_head);
  CHECK(longest.complained == 0);
  CHECK(longest.entries.size() == 1);
  const auto longer = with_record_of(metadata, Input::longest - mcap::record_head + 1);
  REQUIRE(longer.complained == 1);
  CHECK(longer.complaints[0].cause == Cause::too_long);
  CHECK(longer.entries.size() == 1);
}

TEST_CASE("mcap: cut off anywhere, all whole messages before are read, and it is said once") {
  const std::string first = head + said;
  const std::string file = first + chunk(frame + frame) + chunk(frame) + tail;
  const std::size_t in_first = first.size() + 49, second = in_first + 2 * frame.size(),
                    in_second = second + 49;
  for (std::size_t size = 1; size < file.size(); ++size) {
    INFO(size);
    const auto log = read_mcap(file.substr(0, size));
    REQUIRE(log.entries.size() == (size < in_first + frame.size()       ? 0
                                   : size < in_first + 2 * frame.size() ? 1
                                   : size < in_second + frame.size()    ? 2
                                                                        : 3));
    REQUIRE(log.complained == 1);
    REQUIRE(log.complaints[0].cause == Cause::truncated);
  }
}

TEST_CASE("mcap: any bit flipped, and every entry can exist") {
  const auto entries = test::RandomEntries{5, {}}.many(12);
  McapWriter writer;
  Bytes out;
  writer.begin(out);
  for (std::size_t i = 0; i < entries.size(); i += 3) {
    writer.write(out, std::span{entries}.subspan(i, 3), three());
    writer.flush(out);
  }
  const std::string whole{out.view()};  // the summary's bits say nothing
  std::uint64_t silent = 0;
  for (std::size_t bit = 0; bit < whole.size() * 8; bit += test::sanitized || test::emulated ? 7 : 1) {
    std::string file = whole + tail;
    file[bit / 8] = static_cast<char>(file[bit / 8] ^ 1 << bit % 8);
    const auto log = read_mcap(file);
    REQUIRE(log.entries.size() <= entries.size());
    for (const Entry& entry : log.entries) REQUIRE(log::testing::can_exist(entry));
    const bool same = std::equal(log.entries.begin(), log.entries.end(), entries.begin(), entries.end());
    if (!same && log.complained == 0) ++silent;
  }
  // Chunks, schemas and channels that became records of another kind are passed over without a word.
  CHECK(silent < whole.size() / 64);
}

TEST_CASE("mcap: what it is not") {
  CHECK_FALSE(McapReader::recognises("MCAP"));
  CHECK(cause_of("\x89MCAP", 0) == Cause::truncated);
  CHECK(cause_of("\x89MCAP1\r\n", 0) == Cause::unsupported);
  CHECK(cause_of("hello, world", 0) == Cause::syntax);
  CHECK(cause_of(head + said + frame + tail + "x", 1) == Cause::syntax);
  CHECK(cause_of(magic, 0) == Cause::truncated);
  CHECK(read_mcap(head + tail).complained == 0);
}

}  // namespace log_mcap_test
