#include "hemi/io/table_file.hpp"

#include "cli/program.hpp"
#include "hemi/core/error.hpp"

#include <catch2/catch.hpp>

using namespace hemi;
using Catch::Contains;
using hemi::cli_test::Directory;

TEST_CASE("tables: what is written reads back", "[io]") {
    const Directory directory;
    io::TextTable table;
    table.columns = {"group", "a, b", "say \"c\""};
    table.rows = {{"floor", "1", ""}, {"wall, left", "\"", "2.5"}};
    io::write_table(directory.path("table.csv"), table);
    const io::TextTable again = io::read_table(directory.path("table.csv"));
    CHECK(again.columns == table.columns);
    CHECK(again.rows == table.rows);
    CHECK(again.lines == std::vector<std::size_t>{2, 3});
    CHECK(again.column("a, b") == 1u);
    CHECK_FALSE(again.column("d"));
}

TEST_CASE("tables: comments, empty lines, line ends and marks of spreadsheets", "[io]") {
    const Directory directory;
    const io::TextTable table = io::read_table(
        directory.write("table.csv", "\xef\xbb\xbf# times in hours\r\n time , floor\r\n\r\n 0 , 300 \r\n"
                                     "1,\"301\"\r\n"));
    CHECK(table.columns == std::vector<std::string>{"time", "floor"});
    REQUIRE(table.rows.size() == 2);
    CHECK(table.rows[0] == std::vector<std::string>{"0", "300"});
    CHECK(table.rows[1] == std::vector<std::string>{"1", "301"});
    CHECK(table.lines[1] == 5);
}

TEST_CASE("tables: what is wrong is told with its line", "[io]") {
    const Directory directory;
    const auto read = [&](const char* text) { return io::read_table(directory.write("table.csv", text)); };
    CHECK_THROWS_WITH(read("a,b\n1,2\n3\n"),
                      Contains("table.csv:3") && Contains("1 cells") && Contains("2 columns"));
    CHECK_THROWS_WITH(read("a,b\n1,\"2\n"), Contains("table.csv:2") && Contains("quotes"));
    CHECK_THROWS_WITH(read("a,b\n\"1\"2,3\n"), Contains("table.csv:2"));
    CHECK_THROWS_AS(read("# nothing\n\n"), InputError);
    CHECK_THROWS_AS(io::read_table(directory.path("missing.csv")), InputError);
}
