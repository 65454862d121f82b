#include "ocm/log/reader.hpp"

#include <catch2/catch.hpp>

namespace log_reader_test {

using namespace ocm;

/// Every byte is a frame, an 'x' cannot be read.
class ByteReader final : public log::Reader {
 public:
  using Reader::Reader;
  std::size_t read(std::span<log::Entry> into) override {
    std::size_t count = 0;
    for (; count < into.size() && !input_->peek(1).empty(); input_->skip(1)) {
      const char c = input_->peek(1).front();
      if (c == 'x')
        complain(log::Cause::syntax, {input_->offset(), false}, "x");
      else
        into[count++].interface = interfaces_.number({&c, 1});
    }
    recorded_.assign(interfaces_.size(), {});
    return count;
  }
};

TEST_CASE("a reader gives entries, and keeps interfaces and complaints") {
  log::MemorySource source{"abxa"};
  log::Input input{source};
  ByteReader reader{input};
  log::Entry entries[2];
  CHECK(reader.read(entries) == 2);
  CHECK(reader.read(entries) == 1);
  CHECK(entries[0].interface == 0);
  CHECK(reader.read(entries) == 0);
  CHECK(reader.interfaces().size() == 2);
  CHECK(reader.complaints().first().at(0).place == log::Place{2, false});
  CHECK(reader.recorded().size() == 2);
}

}  // namespace log_reader_test
