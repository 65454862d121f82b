#include "cli/logs/json_scanner.hpp"

#include <string>
#include <string_view>

#include <catch2/catch.hpp>

namespace tool_output_json_scanner_test {

using ocm::cli::logs::JsonScanner;
using ocm::cli::logs::JsonValue;
using ocm::cli::logs::unescape;

/// The text that the inside of a JSON string stands for; "(none)": it is none.
std::string text_of(std::string_view inside) {
  std::string out;
  return unescape(inside, out) ? out : "(none)";
}

TEST_CASE("JSON strings: each escape", "[output]") {  // [RFC 8259, 7]
  CHECK(text_of("") == "");
  CHECK(text_of("can0") == "can0");
  CHECK(text_of(R"(\"\\\/\b\f\n\r\t)") == "\"\\/\b\f\n\r\t");
  for (const std::string_view wrong :
       {R"(\)", R"(\a)", R"(\u)", R"(\u12)", R"(\u123)", R"(\u12g4)", R"(\x41)"})
    CHECK(text_of(wrong) == "(none)");
  // Whatever stands behind it.
  CHECK(text_of(std::string_view{R"(\n)"}.substr(0, 1)) == "(none)");
  CHECK(text_of(std::string_view{R"(\u0041)"}.substr(0, 5)) == "(none)");
}

TEST_CASE("JSON strings: the text is that of this string alone", "[output]") {
  std::string out = "before";
  CHECK(unescape("a", out));
  CHECK(out == "a");
  CHECK(unescape("", out));
  CHECK(out.empty());
}

TEST_CASE("JSON strings: the first and last code of each length of UTF-8", "[output]") {  // [RFC 3629, 3]
  CHECK(text_of(R"(\u007f)") == "\x7F");
  CHECK(text_of(R"(\u0080)") == "\xC2\x80");
  CHECK(text_of(R"(\u07FF)") == "\xDF\xBF");
  CHECK(text_of(R"(\u0800)") == "\xE0\xA0\x80");
  CHECK(text_of(R"(\ud7ff)") == "\xED\x9F\xBF");
  CHECK(text_of(R"(\ue000)") == "\xEE\x80\x80");
  CHECK(text_of(R"(\uffff)") == "\xEF\xBF\xBF");
  CHECK(text_of(R"(\ud800\udc00)") == "\xF0\x90\x80\x80");
  CHECK(text_of(R"(\ud83d\ude00!)") == "\xF0\x9F\x98\x80!");
  CHECK(text_of(R"(\udbff\udfff)") == "\xF4\x8F\xBF\xBF");
}

TEST_CASE("JSON strings: half a pair is none, and a byte of old logs is that byte", "[output]") {
  CHECK(text_of(R"(\ud800)") == "(none)");
  CHECK(text_of(R"(\ud800\u0041)") == "(none)");
  CHECK(text_of(R"(\ud800\ue000)") == "(none)");
  CHECK(text_of(R"(\ud800\udbff)") == "(none)");
  // What comes first has no second half.
  CHECK(text_of(R"(\ud7ff\udc00)") == "(none)");
  CHECK(text_of(R"(\udc00\udc00)") == "(none)");
  CHECK(text_of(R"(\udc80\udcff)") == "\x80\xFF");
  CHECK(text_of(R"(\udbff)") == "(none)");
  CHECK(text_of(R"(\udc00)") == "(none)");
  CHECK(text_of(R"(\udc7f)") == "(none)");
  CHECK(text_of(R"(\udc80)") == "\x80");  // [PEP 383]
  CHECK(text_of(R"(\udcff)") == "\xFF");
  CHECK(text_of(R"(\udd00)") == "(none)");
  CHECK(text_of(R"(\udfff)") == "(none)");
}

TEST_CASE("JSON strings: a byte in words", "[output]") {
  CHECK(text_of(R"(\\xff)") == "\xFF");
  CHECK(text_of(R"(a\\x5cb)") == "a\\b");
  CHECK(text_of(R"(\\xf)") == "\\xf");
  CHECK(text_of(R"(\\xg0)") == "\\xg0");
  CHECK(text_of(R"(\\x0g)") == "\\x0g");
}

TEST_CASE("JSON lines: a string has no control characters, and blanks are three", "[output]") {
  for (int c = 0; c < 256; ++c) {
    INFO(c);
    const std::string text = std::string{'"'} + static_cast<char>(c) + "a\"";
    JsonScanner inside{text};
    JsonValue value;
    CHECK(inside.take_value(value) == (c >= 0x20));
    CHECK(value.text.size() == (c < 0x20 || c == '"' ? 0 : 2));
    const std::string before = static_cast<char>(c) + std::string{"1"};
    JsonScanner blank{before};
    CHECK(blank.take('1') == (c == ' ' || c == '\t' || c == '\r' || c == '1'));
  }
}

TEST_CASE(
    "JSON lines: a number ends where no more of it comes, and what is neither it nor a string has no text",
    "[output]") {
  for (const std::string number : {"0", "-1", "1.5", "2e3", "2E+3", "-0.5e-7"}) {
    CAPTURE(number);
    const std::string text = number + " ,7";
    JsonScanner scanner{text};
    JsonValue value;
    REQUIRE(scanner.take_value(value));
    CHECK(value.text == number);
    CHECK_FALSE(value.is_string);
    CHECK_FALSE(value.escaped);
    CHECK(scanner.take(','));
  }
  for (const std::string_view word : {"true", "false", "null", "[1]", "{\"a\":1}"}) {
    CAPTURE(word);
    JsonScanner scanner{word};
    JsonValue value{"before", true, true};
    CHECK(scanner.take_value(value));
    CHECK_FALSE(value);
    CHECK(scanner.at_end());
  }
  for (const std::string_view word : {"", " \t\r", "True", "nul", "+1", ".5", "a"}) {
    CAPTURE(word);
    JsonScanner scanner{word};
    JsonValue value;
    CHECK_FALSE(scanner.take_value(value));
  }
}

TEST_CASE("JSON lines: what is passed over is 32 deep at most", "[output]") {
  const auto skipped = [](const std::string& text) {
    JsonScanner scanner{text};
    return scanner.skip_value() && scanner.at_end();
  };
  const auto within = [](std::size_t depth, std::string_view begin, std::string_view inside, char end) {
    std::string text;
    for (std::size_t i = 0; i < depth; ++i) text += begin;
    text += inside;
    return text + std::string(depth, end);
  };
  CHECK(skipped(within(32, "[", "", ']')));
  CHECK_FALSE(skipped(within(33, "[", "", ']')));
  CHECK(skipped(within(31, R"({"a":)", "1", '}')));
  CHECK_FALSE(skipped(within(32, R"({"a":)", "1", '}')));
}

TEST_CASE("JSON lines: a value that is cut off is none, whatever stands behind the line", "[output]") {
  constexpr std::string_view text = R"({"a":["b",{"c\"":"d"},true,null,[]],"e":"f"})";
  for (std::size_t size = 0; size <= text.size(); ++size) {
    INFO(size);
    JsonScanner scanner{text.substr(0, size)};
    CHECK((scanner.skip_value() && scanner.at_end()) == (size == text.size()));
  }
  for (const std::string_view word : {R"("b)", R"("b\)", R"("b\")"}) {
    const std::string behind = std::string{word} + "\"}";
    JsonScanner scanner{std::string_view{behind}.substr(0, word.size())};
    JsonValue value;
    CHECK_FALSE(scanner.take_value(value));
  }
}

}  // namespace tool_output_json_scanner_test
