#include "ocm/log/writer.hpp"

#include <catch2/catch.hpp>

namespace log_writer_test {

using namespace ocm::log;

TEST_CASE("losses are counted by kind, and each kind has its words") {
  Losses lost;
  CHECK_FALSE(lost.any());
  lost.add(Lost::direction);
  lost.add(Lost::direction);
  CHECK(lost.any());
  CHECK(lost.count(Lost::direction) == 2);
  CHECK(lost.count(Lost::entry) == 0);
  for (std::size_t i = 0; i < losses; ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK(describe(static_cast<Lost>(i)) != describe(static_cast<Lost>(j)));
}

TEST_CASE("a writer without head, records and end writes none") {
  class Nothing final : public Writer {
    void write(Bytes&, std::span<const Entry>, const Interfaces&) override {}
  } nothing;
  Writer& writer = nothing;
  Bytes out;
  writer.begin(out);
  writer.recorded(out, {});
  writer.finish(out);
  CHECK(out.size() == 0);
  CHECK_FALSE(writer.lost().any());
}

}  // namespace log_writer_test
