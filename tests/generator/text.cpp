// Numbers, words, lines, JSON and manual pages as the generated files have them, at the edges of each.
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <catch2/catch.hpp>

#include "generator/spec/model.hpp"
#include "generator/text/conversion.hpp"
#include "generator/text/json.hpp"
#include "generator/text/man.hpp"
#include "generator/text/words.hpp"
#include "generator/text/writer.hpp"

namespace generator_text_test {

using namespace ocm;
using generate::Json;
using generate::Writer;

spec::FieldModel field_of(base::Decimal scale, base::Decimal offset = {}) {
  spec::FieldModel field;
  field.scale = scale;
  field.offset = offset;
  field.raw_max = 255;
  return field;
}

TEST_CASE("text: numbers") {
  CHECK(generate::grouped(0) == "0");
  CHECK(generate::grouped(999) == "999");
  CHECK(generate::grouped(1000) == "1'000");
  CHECK(generate::grouped(1'234'567) == "1'234'567");
  CHECK(generate::hex(0) == "0x00");
  CHECK(generate::hex(0x1E) == "0x1E");
  CHECK(generate::double_literal({5, 0}) == "5.0");
  CHECK(generate::double_literal({5, -1}) == "0.5");
}

TEST_CASE("text: words") {
  CHECK(generate::capitalised("").empty());
  CHECK(generate::capitalised("a") == "A");
  CHECK(generate::capitalised("zebra") == "Zebra");
  CHECK(generate::capitalised("`a") == "`a");  // beside a and z
  CHECK(generate::capitalised("{z") == "{z");
  CHECK(generate::capitalised("Za") == "Za");
  CHECK(generate::title("power_status_") == "Power status ");
  CHECK(generate::quoted(R"(a "b")") == R"("a \"b\"")");
  CHECK(generate::with_source("", "").empty());
  CHECK(generate::with_source("text", "") == "text");
  CHECK(generate::with_source("", "page 3") == "[page 3]");
  CHECK(generate::with_source("text", "page 3") == "text [page 3]");
}

TEST_CASE("text: what is said of a field") {
  const auto remark = [](spec::FieldModel field, std::string description, std::string unit) {
    field.description = std::move(description);
    field.unit = std::move(unit);
    return generate::remark(field);
  };
  CHECK(remark(field_of({1, 0}), "", "") == "[0, 255]");
  CHECK(remark(field_of({1, 0}), "level", "V") == "level; [0, 255] V");
  CHECK(remark(field_of({5, -1}), "level", "V") == "level; 0.5 V a bit, [0, 127.5] V");
  CHECK(remark(field_of({5, -1}, {-40, 0}), "", "V") == "0.5 V a bit, from -40 V on, [-40, 87.5] V");
  CHECK(remark(field_of({1, 0}, {3, 0}), "", "") == "1 a bit, from 3 on, [3, 258]");
  CHECK(remark(field_of({-1, 0}), "", "V") == "-1 V a bit, [-255, 0] V");
  auto number = field_of({1, 0});
  number.number = protocol::Number::float32;
  CHECK(remark(number, "level", "V") == "level; in V");
  CHECK(remark(number, "level", "") == "level");
  number.range = spec::RangeModel{{-1, 0}, {25, -1}};
  CHECK(remark(number, "level", "V") == "level; [-1, 2.5] V");
  number.scale = {2, 0};
  CHECK(remark(number, "level", "V") == "level; 2 V a unit, [-1, 2.5] V");
  number.range.reset();
  CHECK(remark(number, "level", "V") == "level; 2 V a unit");
  auto named = field_of({1, 0});
  named.values = {{"on", 1}};
  named.source.general = "page 3";
  CHECK(remark(named, "state", "") == "state [page 3]");
}

TEST_CASE("text: a scale and an offset as whole numbers") {
  struct Row {
    base::Decimal scale;
    base::Decimal offset;
    const char* physical;
    const char* raw;
  };
  for (const Row& row :
       {Row{{1, 0}, {}, "n", "n"},
        Row{{175, -4}, {}, "n * 175.0 / 10'000.0", "n * 10'000.0 / 175.0"},
        Row{{1, -6}, {}, "n / 1'000'000.0", "n * 1'000'000.0"},
        Row{{9'765'625, -10}, {}, "n / 1'024.0", "n * 1'024.0"},  // one part in so many
        Row{{5, -1}, {}, "n / 2.0", "n * 2.0"},
        Row{{-5, -1}, {}, "n * -5.0 / 10.0", "n * 10.0 / -5.0"},
        Row{{5, -1}, {-40, 0}, "(n * 5.0 - 400.0) / 10.0", "(n * 10.0 + 400.0) / 5.0"},
        Row{{1, 0}, {25, -1}, "(n * 10.0 + 25.0) / 10.0", "(n * 10.0 - 25.0) / 10.0"},
        Row{{2, 0}, {-3, 0}, "n * 2.0 - 3.0", "(n + 3.0) / 2.0"},
        Row{{1, 0}, {3, 0}, "n + 3.0", "n - 3.0"},
        Row{{1, -1}, {3, 0}, "(n + 30.0) / 10.0", "n * 10.0 - 30.0"},
        Row{{1, 2}, {}, "n * 100.0", "n / 100.0"},
        Row{{2, 1}, {}, "n * 20.0", "n / 20.0"},
        Row{{1, 8}, {}, "n * 100'000'000.0", "n / 100'000'000.0"},
        Row{{1, 9}, {}, "n * 100'000'000e1", "n / 100'000'000e1"},
        Row{{99'999'999, 1}, {}, "n * 999'999'990.0", "n / 999'999'990.0"},
        Row{{1, -18}, {}, "n / 1'000'000'000'000'000'000.0", "n * 1'000'000'000'000'000'000.0"},
        Row{{1, -19}, {}, "n / 1e19", "n * 1e19"},
        Row{{3, -9}, {}, "n * 3.0 / 1'000'000'000.0", "n * 1'000'000'000.0 / 3.0"},
        Row{{3, -10}, {}, "n * 3.0 / 1e10", "n * 1e10 / 3.0"},
        Row{{}, {}, "n * 0.0", "n / 0.0"},  // every number means the offset
        Row{{}, {5, 0}, "n * 0.0 + 5.0", "(n - 5.0) / 0.0"},
        Row{{}, {25, -1}, "(n * 0.0 + 25.0) / 10.0", "(n * 10.0 - 25.0) / 0.0"}}) {
    const auto conversion = generate::conversion(field_of(row.scale, row.offset));
    CHECK(generate::to_physical(conversion, "n") == row.physical);
    CHECK(generate::to_raw(conversion, "n") == row.raw);
  }
}

std::string letters(std::size_t count) {
  return std::string(count, 'x');
}

TEST_CASE("text: a comment is broken where it does not fit, and a line may be full") {
  const auto written = [](const std::string& text) {
    Writer out;
    out.open("{");
    out.comment(text);
    return out.take();
  };
  CHECK(written("").size() == 2);
  CHECK(written("one two") == "{\n  /// one two\n");
  // 2 of indentation, 4 of the mark, 50, a blank, 53: 110 columns.
  CHECK(written(letters(50) + " " + letters(53)) == "{\n  /// " + letters(50) + " " + letters(53) + "\n");
  CHECK(written(letters(50) + " " + letters(54)) ==
        "{\n  /// " + letters(50) + "\n  /// " + letters(54) + "\n");
  // A letter of two bytes takes one column.
  CHECK(written("\xC3\xBC" + letters(49) + " " + letters(53)) ==
        "{\n  /// \xC3\xBC" + letters(49) + " " + letters(53) + "\n");
  CHECK(written(letters(200) + " a") == "{\n  /// " + letters(200) + "\n  /// a\n");
}

TEST_CASE("text: remarks stand behind the lines where all fit, else above them") {
  const auto written = [](std::size_t remark) {
    Writer out;
    out.open("{");
    out.remarked({{"int a;", "short"}, {"double of_many_letters;", ""}, {"float bcd;", letters(remark)}});
    return out.take();
  };
  // 2 of indentation, the longest line that has a remark, two blanks, 5 of the mark.
  CHECK(written(91) ==
        "{\n  int a;      ///< short\n  double of_many_letters;\n  float bcd;  ///< " + letters(91) + "\n");
  CHECK(written(92) ==
        "{\n  /// short\n  int a;\n  double of_many_letters;\n  /// " + letters(92) + "\n  float bcd;\n");
}

TEST_CASE("text: lists are broken to fit, and stand behind the sign or below it") {
  const auto assigned = [](std::size_t first, std::size_t second, const std::string& target = "t") {
    Writer out;
    out.open("{");
    out.assignment(target, "{", {letters(first), letters(second)}, "};");
    return out.take();
  };
  // 2 of indentation, "t = ", "{", 50, ", ", 49, "};": 110 columns.
  CHECK(assigned(50, 49) == "{\n  t = {" + letters(50) + ", " + letters(49) + "};\n");
  // A longer name leaves no room. Below it, indented by 6, the same list takes 110 columns again.
  CHECK(assigned(50, 49, "target") == "{\n  target =\n      {" + letters(50) + ", " + letters(49) + "};\n");
  CHECK(assigned(50, 50, "target") ==
        "{\n  target = {" + letters(50) + ",\n            " + letters(50) + "};\n");
  CHECK(assigned(50, 50) == "{\n  t = {" + letters(50) + ",\n       " + letters(50) + "};\n");
  Writer out;
  out.list("a{", {}, "};");
  out.list("b{", {"one"}, "};");
  out.list("c{", {"one", "two", "three"}, "};");
  CHECK(out.take() == "a{};\nb{one};\nc{one, two, three};\n");
}

TEST_CASE("text: JSON of each kind, on one line and on several") {
  Json list;
  list.push_back(1);
  list.push_back("two");
  Json all{{"list", list},
           {"none", nullptr},
           {"no", false},
           {"yes", true},
           {"less", -3},
           {"most", UINT64_MAX},
           {"half", 0.5},
           {"nothing", Json::array()},
           {"bare", Json::object()}};
  all["inner"]["x"] = "\xFF";
  all["no"] = "changed";
  CHECK(all.line() ==
        R"({"list":[1,"two"],"none":null,"no":"changed","yes":true,"less":-3,"most":18446744073709551615,)"
        "\"half\":0.5,\"nothing\":[],\"bare\":{},\"inner\":{\"x\":\"\xEF\xBF\xBD\"}}");
  CHECK(all["list"].lines() == "[\n  1,\n  \"two\"\n]\n");
  Json outer = Json::array();
  outer.push_back(Json{{"a", 1}, {"b", Json::array()}});
  CHECK(outer.lines() == "[\n  {\n    \"a\": 1,\n    \"b\": []\n  }\n]\n");
  CHECK(Json{}.is_null());
  CHECK_FALSE(list.is_null());
}

TEST_CASE("text: a manual page has no character that roff reads as its own") {
  CHECK(generate::ManPage{"a-z", "what it's for", "1.2"}
            .text("DESCRIPTION", "one -o\n\n.two\n'three\nback\\slash\n\n")
            .literal("EXAMPLES", "  a -b\n\n.last\n")
            .make() ==
        ".TH A\\-Z 1 \"\" \"ocm 1.2\" \"ocm\"\n"
        ".SH \"NAME\"\na\\-z \\- what it's for\n"
        ".SH \"DESCRIPTION\"\none \\-o\n.PP\n\\&.two\n\\&'three\nback\\eslash\n"
        ".SH \"EXAMPLES\"\n.nf\n  a \\-b\n\n\\&.last\n.fi\n");
}

}  // namespace generator_text_test
