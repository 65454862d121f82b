// DBC files as they are in the wild, each trait once: what the reader makes of it, and what it says of it.
#include <algorithm>
#include <string>
#include <vector>

#include <catch2/catch.hpp>

#include "generator/dbc/encoding.hpp"
#include "generator/dbc/reader.hpp"

namespace generator_dbc_test {

using namespace ocm;
using dbc::Message;
using dbc::Signal;

std::vector<std::string> printed(const std::vector<dbc::Finding>& findings) {
  std::vector<std::string> lines;
  for (const auto& f : findings) lines.push_back(std::to_string(f.line) + ": " + f.what + "; " + f.remedy);
  return lines;
}

dbc::Document read(const std::string& text, const std::vector<std::string>& doubts = {}) {
  auto reading = dbc::read(text);
  CAPTURE(text);
  CHECK(printed(reading.problems).empty());
  CHECK(printed(reading.doubts) == doubts);
  REQUIRE(reading.document);
  return *reading.document;
}
/// The only message of a text.
Message message(const std::string& text, const std::vector<std::string>& doubts = {}) {
  const auto document = read(text, doubts);
  REQUIRE(document.messages.size() == 1);
  return document.messages[0];
}
const Signal& signal(const Message& of, std::string_view name) {
  const Signal* found = of.find(name);
  REQUIRE(found != nullptr);
  return *found;
}
/// The name of what says whether a signal is there.
std::string selector(const Message& of, std::string_view name) {
  const auto index = signal(of, name).selector;
  return index ? of.signals.at(*index).name : std::string{};
}
std::vector<std::string> problems(const std::string& text) {
  const auto reading = dbc::read(text);
  CHECK(reading.document.has_value() == reading.problems.empty());
  return printed(reading.problems);
}

constexpr const char* head =
    "VERSION \"1.2\"\n\nNS_ :\n\tNS_DESC_\n\tCM_\n\tBA_DEF_\n\nBS_:\n\nBU_: Motor Dash\n";

TEST_CASE("dbc: each character of code page 1252 that Unicode has elsewhere") {
  std::string bytes;
  for (int byte = 0x80; byte < 0xA0; ++byte) bytes += static_cast<char>(byte);
  // As Python's codec "cp1252" reads them; U+FFFD for the five that mean nothing.
  CHECK(dbc::to_utf8(bytes) ==
        "€�‚ƒ„…†‡ˆ‰Š‹Œ�Ž�"
        "�‘’“”•–—˜™š›œ�žŸ");
}

TEST_CASE("dbc: every other byte of code page 1252 is that character, there and back") {
  std::string all;
  for (int byte = 0; byte < 0x100; ++byte) {
    const std::string one(1, static_cast<char>(byte));
    if (byte == 0x81 || byte == 0x8D || byte == 0x8F || byte == 0x90 || byte == 0x9D) continue;
    CAPTURE(byte);
    CHECK(dbc::has_cp1252(dbc::to_utf8(one)));
    CHECK(dbc::to_cp1252(dbc::to_utf8(one)) == one);
    all += one;
  }
  CHECK(dbc::to_cp1252(dbc::to_utf8(all)) == all);
  CHECK(dbc::to_utf8("\xA0") == "\xC2\xA0");
  CHECK(dbc::to_utf8("\xFF") == "\xC3\xBF");
  CHECK(dbc::has_cp1252(""));
  // What it does not have: what stands for nothing, U+0080, U+0081, U+009F, U+0100, a Chinese character.
  for (const char* text : {"a\xEF\xBF\xBD", "\xC2\x80", "\xC2\x81", "\xC2\x9F", "\xC4\x80",
                           "\xE4\xB8\xAD"
                           "b"}) {
    CAPTURE(text);
    CHECK_FALSE(dbc::has_cp1252(text));
    CHECK_FALSE(dbc::to_cp1252(text).has_value());
  }
  // Its bytes would be read as UTF-8.
  CHECK(dbc::has_cp1252("\xC3\x83\xC2\xBA"));
  CHECK_FALSE(dbc::to_cp1252("\xC3\x83\xC2\xBA").has_value());
}

TEST_CASE("dbc: of a long word or string a message shows forty characters") {
  const std::string word(40, 'W');
  message(
      "BO_ 1 A: 8 X\n" + word + " 1;\n" + word + "W 1;\n",
      {"2: unknown statement '" + word + "'; left out", "3: unknown statement '" + word + "...'; left out"});
  const std::string form = " is expected; CM_ [BO_ IDENTIFIER | SG_ IDENTIFIER SIGNAL | BU_ NODE] \"TEXT\";";
  message("BO_ 1 A: 8 X\nCM_ BO_ \"" + word + "W\";\n",
          {"2: CM_: the string \"" + word + "\", where a message's identifier" + form});
}

TEST_CASE("dbc: a message with its signals") {
  const auto file = read(std::string{head} +
                         "BO_ 256 Engine: 8 Motor\n"
                         " SG_ Rpm : 7|16@0+ (0.25,0) [0|16383.75] \"rpm\" Dash\n"
                         " SG_ Torque : 16|12@1- (0.5,-100) [-1124|923.5] \"Nm\" Dash, Vector__XXX\n"
                         "CM_ \"a small car\";\nCM_ BU_ Dash \"what the driver sees\";\n"
                         "CM_ BO_ 256 \"of the\r\nengine\";\nCM_ SG_ 256 Rpm \"at the \\\"crank\\\"\";\n");
  CHECK(file.version == "1.2");
  CHECK(file.comment == "a small car");
  REQUIRE(file.nodes.size() == 2);
  CHECK(file.nodes[1].name == "Dash");
  CHECK(file.nodes[1].comment == "what the driver sees");
  REQUIRE(file.messages.size() == 1);
  const Message& engine = file.messages[0];
  CHECK(engine.name == "Engine");
  CHECK(engine.id == 256);
  CHECK(engine.format == Message::Format::base);
  CHECK(engine.length == 8);
  CHECK_FALSE(engine.fd);
  CHECK(engine.sender == "Motor");
  CHECK(engine.comment == "of the\nengine");
  CHECK(engine.line == 11);
  const Signal& rpm = signal(engine, "Rpm");
  CHECK(rpm.position.start == 7);
  CHECK(rpm.position.width == 16);
  CHECK(rpm.position.order == protocol::ByteOrder::big);
  CHECK_FALSE(rpm.is_signed);
  CHECK(rpm.scale == base::Decimal{25, -2});
  CHECK(rpm.has_range);
  CHECK(rpm.max == base::Decimal{1638375, -2});
  CHECK(rpm.unit == "rpm");
  CHECK(rpm.comment == "at the \"crank\"");
  const Signal& torque = signal(engine, "Torque");
  CHECK(torque.position.order == protocol::ByteOrder::little);
  CHECK(torque.is_signed);
  CHECK(torque.offset == base::Decimal{-1, 2});
  CHECK(torque.receivers == std::vector<std::string>{"Dash"});
}

TEST_CASE("dbc: identifiers of 11 and 29 bits") {
  CHECK(message("BO_ 2047 A: 8 X\n").format == Message::Format::base);
  const Message wide = message("BO_ 2566844672 A: 8 X\n");
  CHECK(wide.format == Message::Format::extended);
  CHECK(wide.id == 0x18FEF100);
  const Message short_and_wide = message("BO_ 2147483651 A: 8 X\n");
  CHECK(short_and_wide.format == Message::Format::extended);
  CHECK(short_and_wide.id == 3);
  const Message forgotten =
      message("BO_ 103596083 A: 8 X\n",
              {"1: the identifier 103596083 of A has more than 11 bits, and no flag that says "
               "so; read as 29 bits, which are written 2251079731"});
  CHECK(forgotten.format == Message::Format::extended);
  CHECK(forgotten.id == 103596083);
  CHECK(message("BO_ 3758096385 A: 8 X\n",
                {"1: the identifier 3758096385 of A has more than 29 bits; read as 1"})
            .id == 1);
  // Either of the two bits above the 29 is one too many.
  for (const char* id : {"2684354561", "1073741825", "536870913"}) {
    CAPTURE(id);
    CHECK(message("BO_ " + std::string{id} + " A: 8 X\n",
                  {"1: the identifier " + std::string{id} + " of A has more than 29 bits; read as 1"})
              .id == 1);
  }
  // Both of one message are said in the order in which they are found.
  CHECK(message(
            "BO_ 1610614784 A: 8 X\n",
            {"1: the identifier 1610614784 of A has more than 29 bits; read as 2048",
             "1: the identifier 1610614784 of A has more than 11 bits, and no flag that says so; read as 29 "
             "bits, which are written 2147485696"})
            .id == 2048);
}

TEST_CASE("dbc: signals without a message are kept apart, and are no message") {
  for (const char* id : {"3221225472", "1073741824"}) {
    const auto file =
        read("BO_ " + std::string{id} +
             " VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n SG_ Old : 0|8@1+ (1,0) [0|0] \"\" X\n");
    CHECK(file.messages.empty());
    REQUIRE(file.independent.size() == 1);
    CHECK(file.independent[0].name == "Old");
  }
}

TEST_CASE("dbc: numbers as people write them") {
  const std::string text = "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (";
  const auto scale = [&](const std::string& number) {
    return message(text + number + ",0) [0|0] \"\" X\n").signals[0].scale;
  };
  CHECK(scale(".25") == base::Decimal{25, -2});
  CHECK(scale("+127") == base::Decimal{127, 0});
  CHECK(scale("3.6622E-009") == base::Decimal{36622, -13});
  CHECK(scale("1.0") == base::Decimal{1, 0});
  CHECK(scale("0E-17") == base::Decimal{});
  CHECK(scale("1.84467e+19") == base::Decimal{184467, 14});
  CHECK(scale("18446744073709551615") == base::Decimal{184467440737095516, 2});  // 18 digits are kept
  CHECK(scale("0.333333333333333333333") == base::Decimal{333333333333333333, -18});
  CHECK(scale("99999999999999999999") == base::Decimal{999999999999999999, 2});
  // So is an exponent behind too many digits.
  CHECK(scale("0.333333333333333333333e3") == base::Decimal{333333333333333333, -15});
  CHECK(scale("123456789012345678901E-3") == base::Decimal{123456789012345678, 0});
  CHECK(problems(text + "1e999,0) [0|0] \"\" X\n") ==
        std::vector<std::string>{"2: SG_: '1e999', where the scale is expected; SG_ NAME : "
                                 "START|WIDTH@ORDER+ (SCALE,OFFSET) [MIN|MAX] \"UNIT\" RECEIVER"});
}

TEST_CASE("dbc: a signal may begin at the last bit that a message can have") {
  const Message last = message("BO_ 1 A: 1785 X\n SG_ S : 14279|1@1+ (1,0) [0|0] \"\" X\n");
  CHECK(signal(last, "S").position.start == 14279);
}

TEST_CASE("dbc: a list of words may end the file, behind the last of them") {
  CHECK(message("BO_ 1 A: 8 X\nNS_ :\n\tCM_").name == "A");
}

TEST_CASE("dbc: a comment asks for another file where it is the network's, and begins with the word") {
  CHECK(message("BO_ 1 A: 8 X\nCM_ BO_ 1 \"IMPORT of goods\";\n").comment == "IMPORT of goods");
  const auto file = read("BO_ 1 A: 8 X\nCM_ \"no IMPORT base.dbc\";\n");
  CHECK(file.comment == "no IMPORT base.dbc");
  CHECK(file.imports.empty());
}

TEST_CASE("dbc: a signal without bits is left out") {
  CHECK(message("BO_ 1 A: 8 X\n SG_ S : 0|0@1+ (1,0) [0|0] \"\" X\n", {"2: S has no bits; left out"})
            .signals.empty());
}

TEST_CASE("dbc: a range is advice: none, upside down") {
  const std::string text = "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) ";
  CHECK_FALSE(message(text + "[0|0] \"\" X\n").signals[0].has_range);
  CHECK_FALSE(message(text + "\"\" X\n").signals[0].has_range);
  CHECK(message(text + "[0|1] \"\" X\n").signals[0].has_range);
  CHECK(message(text + "[3|3] \"\" X\n").signals[0].has_range);
  CHECK_FALSE(message(text + "[1|0] \"\" X\n", {"2: the range of S is upside down; read as if it had none"})
                  .signals[0]
                  .has_range);
}

TEST_CASE("dbc: names that are no identifiers, no receiver, no sender, tabs") {
  const Message odd = message("BO_ 1 2017_5:8\n\tSG_ 5.a+b : 0|1@1- (1,0) [0|0] \"\"\n");
  CHECK(odd.name == "2017_5");
  CHECK(odd.sender.empty());
  CHECK(odd.signals.at(0).name == "5.a+b");
  CHECK(odd.signals.at(0).is_signed);
}

TEST_CASE("dbc: values by name, tables, negative keys, over lines") {
  const std::string text =
      "VAL_TABLE_ Gears 0 \"P\" 1 \"R\" ;\nBO_ 1 A: 8 X\n SG_ S : 0|8@1- (1,0) [0|0] \"\" X\n";
  using Values = std::vector<dbc::NamedValue>;
  CHECK(message(text + "VAL_ 1 S -1 \"SNA\" 0 \"off\" 1 \"off\" ;\n").signals[0].values ==
        Values{{-1, "SNA"}, {0, "off"}, {1, "off"}});
  CHECK(message(text + "VAL_ 1 S Gears ;\n").signals[0].values == Values{{0, "P"}, {1, "R"}});
  CHECK(message(text + "VAL_ 1 S 0 \"a\"\n 1 \"b\";\n").signals[0].values == Values{{0, "a"}, {1, "b"}});
  CHECK(message(text + "VAL_ 1 S 18446744073709551615 \"all\";\n").signals[0].values == Values{{-1, "all"}});
  CHECK(message(text + "VAL_ 1 S 0 \"a\"\nCM_ \"end\";\n",
                {"4: the statement has no semicolon at its end; read as if it had one"})
            .signals[0]
            .values == Values{{0, "a"}});
  CHECK(message(text + "VAL_ 1 S Gear ;\n", {"4: there is no VAL_TABLE_ Gear; left out"})
            .signals[0]
            .values.empty());
}

TEST_CASE("dbc: comments and values of what is not there, or before it") {
  CHECK(message("CM_ BO_ 1 \"before it\";\nBO_ 1 A: 8 X\n").comment == "before it");
  message("BO_ 1 A: 8 X\nCM_ SG_ 1 B \"x\";\nVAL_ 2 B 0 \"y\";\nCM_ BU_ Z \"z\";\nBA_ \"Q\" BO_ 3 1;\n",
          {"2: the comment is of a signal B of message 1, which is not in the file; left out",
           "3: the list of values is of a signal B of message 2, which is not in the file; left out",
           "4: the comment is of a node Z, which is not in the file; left out",
           "5: the attribute Q is of a message 3, which is not in the file; left out"});
}

TEST_CASE("dbc: what others lose a whole file for is left out, with its line") {
  message("BO_ 1 A: 8 X\nCM_ 145 \"x\";\nFOO_ 1 2;\nBA_DEF_ BO_ \"Q\" NUMBER;\n",
          {"2: CM_: '145', where a string is expected; CM_ [BO_ IDENTIFIER | SG_ IDENTIFIER SIGNAL | BU_ "
           "NODE] \"TEXT\";",
           "3: unknown statement 'FOO_'; left out",
           "4: BA_DEF_: 'NUMBER', where INT, HEX, FLOAT, STRING or ENUM is expected; BA_DEF_ [BO_ | SG_ | "
           "BU_] \"NAME\" TYPE ...;"});
}

TEST_CASE("dbc: what would make frames mean something else is a problem") {
  using Lines = std::vector<std::string>;
  CHECK(problems("hello") == Lines{"1: there is no statement of DBC in it; a DBC file, with messages such as "
                                   "BO_ 256 Engine: 8 Motor"});
  CHECK(problems("") == Lines{"1: there is no statement of DBC in it; a DBC file, with messages such as BO_ "
                              "256 Engine: 8 Motor"});
  CHECK(problems("BO_ A 8 X\n") ==
        Lines{"1: BO_: 'A', where a message's identifier is expected; BO_ IDENTIFIER NAME: LENGTH SENDER"});
  CHECK(problems("BO_ 4294967296 A: 8 X\n").size() == 1);
  CHECK(problems("BO_ 1 A: 1786 X\n").size() == 1);
  CHECK(problems("SG_ S : 0|8@1+ (1,0) [0|0] \"\" X\n")
            .at(0)
            .rfind("1: SG_: a signal before the first message", 0) == 0);
  CHECK(problems("\n\nSG_ S : 0|8@1+ (1,0) [0|0] \"\" X\n")
            .at(0)
            .rfind("3: SG_: a signal before the first message", 0) == 0);
  const std::string message = "BO_ 1 A: 8 X\n SG_ S ";
  for (const char* bad : {": 14280|8@1+ (1,0)", ": 0|65@1+ (1,0)", ": 0|8@2+ (1,0)", ": 0|8@1 (1,0)",
                          ": 0|8@1+ (1)", "n3 : 0|8@1+ (1,0)", "m : 0|8@1+ (1,0)", ": 0|8@1+ (one,0)"}) {
    CAPTURE(bad);
    CHECK(problems(message + bad + " [0|0] \"\" X\n").size() == 1);
  }
  // Cut off: within a string, and within a statement.
  CHECK(problems(message + ": 0|8@1+ (1,0) [0|0] \"\" X\nCM_ \"the en").size() == 1);
  CHECK(problems(message + ": 0|8@1+ (1,0) [0|") ==
        Lines{"2: SG_: the file ends here, where the greatest value is expected; SG_ NAME : "
              "START|WIDTH@ORDER+ (SCALE,OFFSET) [MIN|MAX] \"UNIT\" RECEIVER"});
  CHECK(problems(message + ": 0|8@1+ (1,0) [0|0] \"\" X\nVAL_ 1 S 0").size() == 1);
}

TEST_CASE("dbc: a text ends where it says, also behind a backslash and in front of a quote") {
  const std::string_view longer = "BO_ 1 A: 8 X\nCM_ \"say \\\"so\\\"\";\n";
  const auto reading = dbc::read(longer.substr(0, longer.find('\\') + 1));
  CHECK_FALSE(reading.document.has_value());
  CHECK(printed(reading.problems) ==
        std::vector<std::string>{"2: CM_: a string is not closed, where a string is expected; CM_ [BO_ "
                                 "IDENTIFIER | SG_ IDENTIFIER SIGNAL | BU_ NODE] \"TEXT\";"});
}

TEST_CASE("dbc: the same identifier, and the same name, twice") {
  const auto file = read(
      "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" X\nBO_ 1 B: 4 X\nBO_ 2 B: 4 X\n SG_ T : 0|8@1+ (1,0) "
      "[0|0] \"\" X\n SG_ T : 8|8@1+ (1,0) [0|0] \"\" X\n",
      {"3: the identifier 1 of B is that of A in line 1; this one counts",
       "6: B has two signals T; give one another name"});
  REQUIRE(file.messages.size() == 2);
  CHECK(file.messages[0].name == "B");
  CHECK(file.messages[0].signals.empty());
  read("BO_ 1 B: 8 X\nBO_ 2 B: 4 X\n",
       {"2: the name B is that of the message in line 1; both are kept; give one another name"});
  // A selector that only the replaced one has makes no problem.
  const auto replaced = read(
      "BO_ 1 A: 8 X\n SG_ Page M : 0|8@1+ (1,0) [0|0] \"\" X\n SG_ P m1 : 8|8@1+ (1,0) [0|0] \"\" X\n"
      "BO_ 1 B: 8 X\n SG_ Page M : 0|8@1+ (1,0) [0|0] \"\" X\nSG_MUL_VAL_ 1 P Page 1-1;\n",
      {"4: the identifier 1 of B is that of A in line 1; this one counts"});
  REQUIRE(replaced.messages.size() == 1);
  CHECK(replaced.messages[0].signals.size() == 1);
}

TEST_CASE("dbc: floating-point signals") {
  const std::string text =
      "BO_ 1 A: 8 X\n SG_ S : 7|32@0- (1,0) [0|0] \"\" X\n SG_ D : 0|64@1- (1,0) [0|0] \"\" X\n";
  const std::vector<std::string> overlap = {"3: S and D of A have bits in common; each is read by itself"};
  const Message both = message(text + "SIG_VALTYPE_ 1 S : 1;\nSIG_VALTYPE_ 1 D 2;\n", overlap);
  CHECK(signal(both, "S").number == Signal::Number::float32);
  CHECK(signal(both, "D").number == Signal::Number::float64);
  CHECK(signal(message(text + "SIG_VALTYPE_ 1 S : 0;\n", overlap), "S").number == Signal::Number::integer);
  // Of half a float there is none here, as cantools has it: the file is read all the same.
  const Message half =
      message("BO_ 1 A: 8 X\n SG_ S : 0|16@1- (1,0) [0|0] \"\" X\nSIG_VALTYPE_ 1 S : 1;\n",
              {"3: S is a floating-point number of 16 bits; read as an integer: 1 is float32, "
               "with 32 bits, and 2 float64, with 64"});
  CHECK(signal(half, "S").number == Signal::Number::integer);
  CHECK(signal(half, "S").is_signed);
}

TEST_CASE("dbc: types of numbers up to 3, which is none that is known, and no further") {
  const std::string text =
      "BO_ 1 A: 16 X\n SG_ S : 0|32@1- (1,0) [0|0] \"\" X\n SG_ D : 64|64@1- (1,0) [0|0] \"\" X\n";
  for (const char* name : {"S", "D"}) {
    CAPTURE(name);
    const Message known = message(
        text + "SIG_VALTYPE_ 1 " + name + " : 3;\n",
        {"4: " + std::string{name} + " is a floating-point number of " + (*name == 'S' ? "32" : "64") +
         " bits; read as an integer: 1 is float32, with 32 bits, and 2 float64, with 64"});
    CHECK(signal(known, name).number == Signal::Number::integer);
  }
  CHECK(problems(text + "SIG_VALTYPE_ 1 S : 4;\n") ==
        std::vector<std::string>{"4: SIG_VALTYPE_: '4', where 0, 1 for float32 or 2 for float64 is expected; "
                                 "SIG_VALTYPE_ IDENTIFIER SIGNAL : TYPE;"});
}

TEST_CASE("dbc: one selector: pages, ranges, both") {
  const std::string text =
      "BO_ 1 A: 8 X\n SG_ P0 m0 : 8|8@1+ (1,0) [0|0] \"\" X\n SG_ P1 m1 : 8|8@1+ (1,0) [0|0] \"\" X\n SG_ "
      "Page M : 0|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ Other : 16|8@1+ (1,0) [0|0] \"\" X\n";
  const Message plain = message(text);
  CHECK(signal(plain, "Page").is_selector);
  CHECK(selector(plain, "P0") == "Page");
  CHECK(signal(plain, "P1").selected == std::vector<dbc::SelectorRange>{{1, 1}});
  CHECK(selector(plain, "Other").empty());
  const Message ranges = message(text + "SG_MUL_VAL_ 1 P1 Page 1-1, 4-6, 9-9;\n");
  CHECK(signal(ranges, "P1").selected == std::vector<dbc::SelectorRange>{{1, 1}, {4, 6}, {9, 9}});
  // The page of the signal itself is one of them, where they leave it out.
  CHECK(signal(message(text + "SG_MUL_VAL_ 1 P1 Page 4-6;\n"), "P1").selected ==
        std::vector<dbc::SelectorRange>{{4, 6}, {1, 1}});
  CHECK(problems(text + "SG_MUL_VAL_ 1 P1 Page 6-4;\n").size() == 1);
  CHECK(problems(text + "SG_MUL_VAL_ 1 P1 Nothing 1-1;\n") ==
        std::vector<std::string>{
            "3: the selector Nothing of P1 is not in A; another signal of the same message"});
}

TEST_CASE("dbc: as many signals in a message as there are indexes, and no more") {
  const auto text = [](int signals) {
    std::string of = "BO_ 1 A: 8 X\n";
    for (int i = 0; i < signals; ++i) of += " SG_ S" + std::to_string(i) + " : 0|8@1+ (1,0) [0|0] \"\" X\n";
    return of;
  };
  CHECK(dbc::read(text(65'535)).document.has_value());
  // In the order of the file, whatever is looked for first.
  CHECK(
      problems("BO_ 2 B: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" X\nSG_MUL_VAL_ 2 S Nothing 0-0;\n" +
               text(65'536)) ==
      std::vector<std::string>{"2: the selector Nothing of S is not in B; another signal of the same message",
                               "4: A has 65536 signals; at most 65535 in a message"});
}

TEST_CASE("dbc: up to two thousand signals of a message are compared with each other") {
  const auto text = [](int signals) {
    std::string of = "BO_ 1 A: 1785 X\n";
    for (int i = 0; i + 1 < signals; ++i)
      of += " SG_ S" + std::to_string(i) + " : " + std::to_string(i) + "|1@1+ (1,0) [0|0] \"\" X\n";
    return of + " SG_ Last : 0|1@1+ (1,0) [0|0] \"\" X\n";
  };
  message(text(2000), {"2001: S0 and Last of A have bits in common; each is read by itself"});
  message(text(2001));
}

TEST_CASE("dbc: a row of selectors has an end, and ranges may be many") {
  const auto row = [](int signals) {
    std::string of = "BO_ 1 A: 8 X\n SG_ S0 M : 0|8@1+ (1,0) [0|0] \"\" X\n";
    std::string ranges;
    for (int i = 1; i < signals; ++i) {
      const std::string number = std::to_string(i);
      of += " SG_ S" + number + " m0M : 0|8@1+ (1,0) [0|0] \"\" X\n";
      ranges += "SG_MUL_VAL_ 1 S" + number + " S" + std::to_string(i - 1) + " 0-0;\n";
    }
    return of + ranges;
  };
  CHECK(problems(row(65)).empty());
  const std::vector<std::string> too_deep{
      "67: S65 has more than 64 selectors one above another; fewer: files have two or three"};
  CHECK(problems(row(66)) == too_deep);
  CHECK(problems(row(20'000)) == too_deep);  // compared with all above it minutes went by

  const auto pages = [](const char* signal, int first) {
    std::string of = std::string{"SG_MUL_VAL_ 1 "} + signal + " Page ";
    for (int i = 99'999; i >= 0; --i) {
      const std::string value = std::to_string(4 * i + first);
      of.append(value).append("-").append(value).append(i == 0 ? ";\n" : ", ");
    }
    return of;
  };
  const std::string text =
      "BO_ 1 A: 8 X\n SG_ Page M : 0|32@1+ (1,0) [0|0] \"\" X\n SG_ T m0 : 40|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ U m2 : 40|8@1+ (1,0) [0|0] \"\" X\n" +
      pages("T", 0);
  message(text + pages("U", 2));
  message(text + pages("U", 2) + "SG_MUL_VAL_ 1 U Page 200000-200000;\n",
          {"4: T and U of A have bits in common; each is read by itself"});
}

TEST_CASE("dbc: a range of a selector may be there many times") {
  const auto pages = [](const char* signal, const std::string& range) {
    std::string of = std::string{"SG_MUL_VAL_ 1 "} + signal + " Page ";
    for (int i = 0; i < 100; ++i) of.append(i == 0 ? "" : ", ").append(range);
    return of + ";\n";
  };
  const std::string text =
      "BO_ 1 A: 8 X\n SG_ Page M : 0|32@1+ (1,0) [0|0] \"\" X\n SG_ T m0 : 40|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ U m2 : 40|8@1+ (1,0) [0|0] \"\" X\n";
  const std::string greatest = "18446744073709551615-18446744073709551615";
  message(text + pages("T", greatest) + pages("U", "1-1"));
  message(text + pages("T", greatest) + pages("U", greatest),
          {"4: T and U of A have bits in common; each is read by itself"});
}

TEST_CASE("dbc: several selectors, one below another") {
  const std::string text =
      "BO_ 1 A: 8 X\n SG_ S0 M : 0|4@1- (1,0) [0|0] \"\" X\n SG_ S1 m0M : 4|4@1- (1,0) [0|0] \"\" X\n SG_ S2 "
      "m0 : 8|8@1- (1,0) [0|0] \"\" X\n"
      " SG_ S3 m1 : 8|8@1- (1,0) [0|0] \"\" X\n SG_ S6 M : 32|8@1- (1,0) [0|0] \"\" X\n SG_ S7 m1 : 40|24@1- "
      "(1,0) [0|0] \"\" X\n";
  const Message whole = message(text +
                                "SG_MUL_VAL_ 1 S1 S0 0-0;\nSG_MUL_VAL_ 1 S2 S1 0-0;\nSG_MUL_VAL_ 1 S3 S0 "
                                "1-1;\nSG_MUL_VAL_ 1 S7 S6 1-2, 5-5;\n");
  CHECK(selector(whole, "S2") == "S1");
  CHECK(signal(whole, "S2").selected == std::vector<dbc::SelectorRange>{{0, 0}});
  CHECK(selector(whole, "S3") == "S0");
  CHECK(signal(whole, "S7").selected == std::vector<dbc::SelectorRange>{{1, 2}, {5, 5}});
  // Two selectors that stand above all, and nothing says which.
  const auto reading = dbc::read(text);
  REQUIRE(reading.document);
  CHECK(selector(reading.document->messages[0], "S3").empty());
  CHECK(printed(reading.doubts).at(0) ==
        "3: S1 of A is there with some value of a selector, and there are several; read as always there");
  // One stands above all.
  const Message one = message(
      "BO_ 1 A: 8 X\n SG_ S0 M : 0|4@1- (1,0) [0|0] \"\" X\n SG_ S1 m0M : 4|4@1- (1,0) [0|0] \"\" X\n",
      {"3: S1 does not say which of the selectors of A it is of; read as of S0; SG_MUL_VAL_ would say it"});
  CHECK(selector(one, "S1") == "S0");
  CHECK(problems(
            "BO_ 1 A: 8 X\n SG_ S0 m0M : 0|4@1- (1,0) [0|0] \"\" X\n SG_ S1 m0M : 4|4@1- (1,0) [0|0] \"\" X\n"
            "SG_MUL_VAL_ 1 S0 S1 0-0;\nSG_MUL_VAL_ 1 S1 S0 0-0;\n")
            .size() == 1);
}

TEST_CASE("dbc: bits in common, but for pages that are never there together; past the end") {
  const std::string a = "BO_ 1 A: 2 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" X\n";
  message(a + " SG_ T : 8|8@1+ (1,0) [0|0] \"\" X\n");
  message(a + " SG_ T : 7|8@0+ (1,0) [0|0] \"\" X\n",
          {"3: S and T of A have bits in common; each is read by itself"});
  message(a + " SG_ T : 0|1@0+ (1,0) [0|0] \"\" X\n",
          {"3: S and T of A have bits in common; each is read by itself"});
  message(a + " SG_ T : 0|2@0+ (1,0) [0|0] \"\" X\n",
          {"3: S and T of A have bits in common; each is read by itself"});
  message(a + " SG_ T : 15|8@0+ (1,0) [0|0] \"\" X\n");
  message(a + " SG_ T : 8|9@1+ (1,0) [0|0] \"\" X\n",
          {"3: T ends in byte 2 of A, which has 2 bytes; it is there in longer frames only"});
  message(a + " SG_ T : 15|9@0+ (1,0) [0|0] \"\" X\n",
          {"3: T ends in byte 2 of A, which has 2 bytes; it is there in longer frames only"});
}

TEST_CASE("dbc: attributes and their defaults") {
  const std::string text =
      "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (0.5,1) [0|0] \"\" X\nBO_ 2 B: 8 X\n"
      "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_DEF_ \"GenMsgCycleTime\" 100;\n"
      "BA_DEF_ BO_ \"GenMsgSendType\" ENUM \"cyclic\",\"spontaneous\";\nBA_DEF_DEF_ \"GenMsgSendType\" "
      "\"cyclic\";\n"
      "BA_DEF_ SG_ \"GenSigStartValue\" FLOAT -1 1;\nBA_DEF_ BO_ \"Owner\" STRING ;\nBA_DEF_ \"DBName\" "
      "STRING ;\n"
      "BA_ \"GenMsgCycleTime\" BO_ 1 12.5;\nBA_ \"GenMsgSendType\" BO_ 2 1;\nBA_ \"GenMsgDelayTime\" BO_ 1 "
      "5;\n"
      "BA_ \"GenSigStartValue\" SG_ 1 S 637.5;\nBA_ \"Owner\" BO_ 1 \"me\";\nBA_ \"DBName\" \"car\";\n";
  const auto file = read(text);
  const Message& a = file.messages[0];
  const Message& b = file.messages[1];
  CHECK(a.cycle_ms == base::Decimal{125, -1});
  CHECK(b.cycle_ms == base::Decimal{1, 2});
  CHECK(a.delay_ms == base::Decimal{5, 0});
  CHECK_FALSE(b.delay_ms);
  CHECK(a.send_type == "cyclic");
  CHECK(b.send_type == "spontaneous");
  CHECK(a.signals[0].start_value == "637.5");
  CHECK(a.attributes == std::vector<dbc::Attribute>{{"Owner", "me"}});
  CHECK(file.attributes == std::vector<dbc::Attribute>{{"DBName", "car"}});
}

TEST_CASE("dbc: what is defined without a default has none, and an empty one says nothing") {
  for (const char* given :
       {"", "BA_DEF_DEF_ \"GenMsgSendType\" \"\";\nBA_DEF_DEF_ \"GenSigSendType\" \"\";\n"}) {
    CAPTURE(given);
    const Message of = message(
        "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" X\n"
        "BA_DEF_ BO_ \"GenMsgCycleTime\" INT 0 65535;\nBA_DEF_ BO_ \"GenMsgSendType\" ENUM "
        "\"Cyclic\",\"OnChange\";\nBA_DEF_ SG_ \"GenSigSendType\" ENUM \"Cyclic\",\"OnChange\";\n" +
        std::string{given});
    CHECK_FALSE(of.cycle_ms);
    CHECK(of.send_type.empty());
    CHECK(of.attributes.empty());
    CHECK(of.signals[0].attributes.empty());
  }
}

TEST_CASE("dbc: a time of a message is above zero, or there is none") {
  const auto stated = [](const std::string& value) {
    const Message of = message("BO_ 1 A: 8 X\nBA_ \"GenMsgCycleTime\" BO_ 1 " + value +
                               ";\nBA_ \"GenMsgDelayTime\" BO_ 1 " + value + ";\n");
    CHECK(of.attributes.empty());
    CHECK(of.cycle_ms == of.delay_ms);
    return of.cycle_ms;
  };
  CHECK(stated("0.5") == base::Decimal{5, -1});
  CHECK(stated("1") == base::Decimal{1, 0});
  for (const char* none : {"0", "0.0", "-5", "\"\"", "\"often\""}) {
    CAPTURE(none);
    CHECK_FALSE(stated(none).has_value());
  }
}

TEST_CASE("dbc: a number of an enumeration is one of its names, and a number where there are no more") {
  const auto value = [](const std::string& names, const std::string& number) {
    const auto file = read("BO_ 1 A: 8 X\nBO_ 2 B: 8 X\nBA_DEF_ BO_ \"GenMsgSendType\" ENUM " + names +
                           ";\nBA_DEF_DEF_ \"GenMsgSendType\" " + number +
                           ";\nBA_ \"GenMsgSendType\" BO_ 1 " + number + ";\n");
    CHECK(file.messages.at(0).send_type == file.messages.at(1).send_type);
    return file.messages.at(0).send_type;
  };
  CHECK(value("\"a\",\"b\"", "0") == "a");
  CHECK(value("\"a\",\"b\"", "1") == "b");
  CHECK(value("\"a\",\"b\"", "2") == "2");
  CHECK(value("\"a\",\"b\"", "\"b\"") == "b");
  CHECK(value("\"1\",\"0\"", "0") == "0");  // a name, though it is a number
  CHECK(value("\"1\",\"0\"", "1") == "1");
  CHECK(value("\"1\",\"b\",\"c\"", "2") == "c");
}

TEST_CASE("dbc: CAN FD and J1939 by VFrameFormat, whatever the file's list of formats is") {
  const std::string list =
      "BA_DEF_ BO_ \"VFrameFormat\" ENUM "
      "\"StandardCAN\",\"ExtendedCAN\",\"StandardCAN_FD\",\"ExtendedCAN_FD\",\"J1939PG\";\n"
      "BA_DEF_DEF_ \"VFrameFormat\" \"J1939PG\";\n";
  const auto file = read(
      "BO_ 2364540158 EEC1: 8 X\nBO_ 2566844926 Long: 39 X\nBO_ 5 Fd: 64 X\nBO_ 6 Small: 8 X\nBO_ 7 Plain: "
      "12 X\n" +
      list +
      "BA_ \"VFrameFormat\" BO_ 5 2;\nBA_ \"VFrameFormat\" BO_ 6 \"StandardCAN_FD\";\nBA_ \"VFrameFormat\" "
      "BO_ 7 0;\n");
  CHECK(file.messages[0].format == Message::Format::j1939);
  CHECK(file.messages[1].format == Message::Format::j1939);
  CHECK_FALSE(file.messages[1].fd);  // transport protocol
  CHECK(file.messages[2].fd);
  CHECK(file.messages[3].fd);
  CHECK(file.messages[4].fd);  // nothing else has 12 bytes
  CHECK(file.messages[4].format == Message::Format::base);
  const auto by_protocol = read(
      "BO_ 2364540158 EEC1: 8 X\nBO_ 3 Own: 8 X\nBA_DEF_ \"ProtocolType\" STRING ;\nBA_DEF_DEF_ "
      "\"ProtocolType\" \"\";\nBA_ \"ProtocolType\" \"J1939\";\n");
  CHECK(by_protocol.messages[0].format == Message::Format::j1939);
  CHECK(by_protocol.messages[1].format == Message::Format::base);
  message("BO_ 1 A: 80 X\n", {});  // who takes it for frames says that none has so many
  for (const char* format : {"", "FD", "_FD"}) {
    CAPTURE(format);
    CHECK_FALSE(message("BO_ 1 A: 8 X\nBA_ \"VFrameFormat\" BO_ 1 \"" + std::string{format} + "\";\n").fd);
  }
}

TEST_CASE("dbc: J1939 by the protocol of the network, given or by default") {
  const auto format = [](const std::string& attributes) {
    return message("BO_ 2364540158 EEC1: 8 X\n" + attributes).format;
  };
  const std::string bus_type = "BA_DEF_ \"BusType\" STRING ;\nBA_DEF_DEF_ \"BusType\" ";
  const std::string protocol = "BA_DEF_ \"ProtocolType\" STRING ;\nBA_DEF_DEF_ \"ProtocolType\" \"J1939\";\n";
  CHECK(format("") == Message::Format::extended);
  CHECK(format(protocol) == Message::Format::j1939);
  CHECK(format(bus_type + "\"CAN\";\n" + protocol) == Message::Format::j1939);
  CHECK(format(protocol + "BA_ \"ProtocolType\" \"CAN\";\n") == Message::Format::extended);
  CHECK(format(bus_type + "\"J1939\";\n") == Message::Format::extended);
  CHECK(format("BA_DEF_ BO_ \"ProtocolType\" STRING ;\nBA_DEF_DEF_ \"ProtocolType\" \"J1939\";\n") ==
        Message::Format::extended);
}

TEST_CASE("dbc: signals that are sent when something happens, by default, have that of each") {
  const auto attributes = [](const std::string& usual) {
    return message(
               "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" X\nBA_DEF_ SG_ \"GenSigSendType\" ENUM "
               "\"other\",\"" +
               usual + "\";\nBA_DEF_DEF_ \"GenSigSendType\" \"" + usual + "\";\n")
        .signals.at(0)
        .attributes;
  };
  for (const char* usual : {"OnChange", "OnWriteWithRepetition", "IfActive", "IfActiveWithRepetition"}) {
    CAPTURE(usual);
    CHECK(attributes(usual) == std::vector<dbc::Attribute>{{"GenSigSendType", usual}});
  }
  for (const char* usual : {"Cyclic", "NoSigSendType"}) {
    CAPTURE(usual);
    CHECK(attributes(usual).empty());
  }
}

TEST_CASE("dbc: long names replace the short ones wherever they are named") {
  const auto file = read(
      "BU_: N1 N2\nBO_ 1 A: 8 N1\n SG_ Page M : 0|8@1+ (1,0) [0|0] \"\" N2\n SG_ S m1 : 8|8@1+ (1,0) [0|0] "
      "\"\" N1,N2\nBO_TX_BU_ 1 : N1,N2;\n"
      "BA_DEF_ BU_ \"SystemNodeLongSymbol\" STRING ;\nBA_DEF_ BO_ \"SystemMessageLongSymbol\" STRING "
      ";\nBA_DEF_ SG_ \"SystemSignalLongSymbol\" STRING ;\n"
      "BA_ \"SystemNodeLongSymbol\" BU_ N2 \"A_node_with_a_name_of_more_than_32_characters\";\n"
      "BA_ \"SystemMessageLongSymbol\" BO_ 1 \"A_message_with_a_name_of_more_than_32_characters\";\n"
      "BA_ \"SystemSignalLongSymbol\" SG_ 1 Page \"A_selector_with_a_name_of_more_than_32_characters\";\n");
  const std::string node = "A_node_with_a_name_of_more_than_32_characters";
  CHECK(file.nodes[1].name == node);
  const Message& a = file.messages[0];
  CHECK(a.name == "A_message_with_a_name_of_more_than_32_characters");
  CHECK(a.other_senders == std::vector<std::string>{node});
  CHECK(selector(a, "S") == "A_selector_with_a_name_of_more_than_32_characters");
  CHECK(signal(a, "S").receivers == std::vector<std::string>{"N1", node});
  CHECK(a.attributes.empty());
}

TEST_CASE("dbc: statements that mean nothing for frames, and a file to read before") {
  const auto file = read(
      "CM_ \"IMPORT _base.dbc\";\nBO_ 1 A: 8 X\nEV_ E: 0 [0|0] \"\" 0 1 DUMMY_NODE_VECTOR0 "
      "Vector__XXX;\nVAL_ E 0 \"off\";\n"
      "SIG_GROUP_ 1 G 1 : S;\nBA_DEF_REL_ BU_SG_REL_ \"R\" INT 0 1;\nBA_DEF_DEF_REL_ \"R\" 0;\n",
      {"1: IMPORT: _base.dbc goes in front of this file; read without it: give that file, too"});
  CHECK(file.imports == std::vector<std::string>{"_base.dbc"});
  REQUIRE(file.unused.size() == 4);
  CHECK(file.unused[2].keyword == "BA_DEF_REL_");
  CHECK(file.messages.size() == 1);
}

TEST_CASE("dbc: characters of UTF-8 or of code page 1252") {
  const std::string text = "BO_ 1 A: 8 X\n SG_ S : 0|8@1+ (1,0) [0|0] \"";
  const auto unit = [&](const std::string& bytes) {
    return message(text + bytes + "\" X\n").signals[0].unit;
  };
  CHECK(unit("\xC2\xBA/s") == "\xC2\xBA/s");                  // UTF-8 already
  CHECK(unit("\xBA/s") == "\xC2\xBA/s");                      // code page 1252
  CHECK(unit("\x80") == "\xE2\x82\xAC");                      // the euro
  CHECK(unit("\x81") == "\xEF\xBF\xBD");                      // nothing
  CHECK(unit("\xB5\xC2\xBA") == "\xC2\xB5\xC3\x82\xC2\xBA");  // one of them is enough
  CHECK(message("\xEF\xBB\xBF"
                "BO_ 1 A: 8 X\n")
            .name == "A");
}

}  // namespace generator_dbc_test
