// Cells of the sets of `analyse`, as RFC 4180 and spreadsheets have them.
#include <string>
#include <string_view>
#include <vector>

#include <catch2/catch.hpp>

#include "cli/analyse/set.hpp"

namespace tool_analyse_split_test {

using namespace ocm;

/// Lines as "number: cell|cell".
std::string cells(std::string_view text) {
  std::string all;
  for (const auto& line : cli::analyse::split_csv(text)) {
    all += std::to_string(line.number) + ": ";
    for (std::size_t i = 0; i < line.cells.size(); ++i) all += (i == 0 ? "" : "|") + line.cells[i];
    all += '\n';
  }
  return all;
}

TEST_CASE("cells of a line: blanks within stay, those around go", "[shared]") {
  CHECK(cells("a,b") == "1: a|b\n");
  CHECK(cells(" engine  speed\t, 0x101 ,,8\r\n") == "1: engine  speed|0x101||8\n");
  CHECK(cells("a\tb,c") == "1: a\tb|c\n");
  CHECK(cells("a,") == "1: a|\n");
  CHECK(cells(",") == "1: |\n");
  CHECK(cells(R"(the "first",8)") == "1: the \"first\"|8\n");
}

TEST_CASE("cells of a line: in quotes all is text, two of them are one, and blanks around them are none",
          "[shared]") {
  CHECK(cells(R"("a, b",8)") == "1: a, b|8\n");
  CHECK(cells(R"(" a ",8)") == "1:  a |8\n");
  CHECK(cells("\t\"a\" \t,8") == "1: a|8\n");
  CHECK(cells(R"("a ""first""",8)") == "1: a \"first\"|8\n");
  CHECK(cells(R"("",8)") == "1: |8\n");
  CHECK(cells(R"(8,"a" , "b" )") == "1: 8|a|b\n");
  // What stands behind the end of the text is none of it.
  CHECK(cells(std::string_view{R"(8,"a"")"}.substr(0, 5)) == "1: 8|a\n");
}

TEST_CASE("cells of a line: empty lines and remarks are none, and count", "[shared]") {
  CHECK(cells("").empty());
  CHECK(cells("\n \t\r\n#a,b\n # c\n").empty());
  CHECK(cells("\xEF\xBB\xBFid,name\n\n# a remark\n1,a # no remark") == "1: id|name\n4: 1|a # no remark\n");
  CHECK(cells("\n\xEF\xBB\xBF") == "2: \xEF\xBB\xBF\n");  // only the text has a mark
}

}  // namespace tool_analyse_split_test
