#include "hemi/io/factor_file.hpp"

#include "io_fixtures.hpp"
#include "support/places.hpp"

#include <clocale>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <locale>
#include <sstream>

namespace hemi::io_test {

namespace {

using Writer = void (*)(const std::filesystem::path&, const FormFactorMatrix&);
using Reader = FormFactorMatrix (*)(const std::filesystem::path&);

struct Format {
    const char* name;
    Writer write;
    Reader read;
};
constexpr Format formats[] = {{"a.mtx", &io::write_mtx, &io::read_mtx},
                              {"a.csv", &io::write_csv, &io::read_csv},
                              {"a.npz", &io::write_npz, &io::read_npz}};

void write_expected(const Folder& folder, const FormFactorMatrix& matrix) {
    std::string text = std::to_string(matrix.size()) + "\n";
    for (std::uint32_t i = 0; i < matrix.size(); ++i) {
        const RowView row = matrix.row(i);
        for (std::size_t k = 0; k < row.columns.size(); ++k) {
            text += fmt::format("{} {} {:a}\n", i, row.columns[k], row.values[k]);
        }
    }
    folder.write("expected.txt", text);
}

/// What SciPy makes of our files, and files of its own. By Debian's Python: another one may lack SciPy.
void run_scipy(const std::filesystem::path& folder) {
    const std::string command = "/usr/bin/python3 '" + std::string(HEMI_TEST_DATA) +
                                "/io/compare_with_scipy.py' '" + folder.string() + "'";
    REQUIRE(std::system(command.c_str()) == 0);
}

class DecimalComma : public std::numpunct<char> {
    char do_decimal_point() const override { return ','; }
    char do_thousands_sep() const override { return '.'; }
    std::string do_grouping() const override { return "\3"; }
};

struct Bad {
    std::string text;
    std::vector<std::string> parts;
};

} // namespace

TEST_CASE("Exchange formats: what is written is read back bit for bit", "[io]") {
    const Folder folder;
    const FormFactorMatrix matrix = random_matrix(150, true);
    for (const Format& format : formats) {
        INFO(format.name);
        format.write(folder / format.name, matrix);
        const FormFactorMatrix back = format.read(folder / format.name);
        require_same_entries(matrix, back);
        REQUIRE(back.all_known());
        REQUIRE(back.row(3).environment == 0.0);
    }
    REQUIRE(folder.files() == 3);
}

TEST_CASE("Exchange formats: what hemi writes SciPy reads, and the other way round", "[io]") {
    const Folder folder;
    const FormFactorMatrix matrix = random_matrix(150, true);
    for (const Format& format : formats) {
        format.write(folder / format.name, matrix);
    }
    io::write_npy(folder / "a.npy", matrix);
    write_expected(folder, matrix);
    run_scipy(folder / "");
    for (const char* name : {"compressed.npz", "stored.npz", "shuffled.npz"}) {
        INFO(name);
        require_same_entries(matrix, io::read_npz(folder / name));
    }
    require_same_entries(matrix, io::read_mtx(folder / "scipy.mtx"));
    REQUIRE(io::read_npz(folder / "good.npz").entries() == 3);
    const std::vector<Bad> table{
        {"csc", {"csc.npz: format.npy: sparse format \"csc\"; must be \"csr\""}},
        {"no_data", {"has no member data.npy"}},
        {"negative", {"F(0, 2) = -0.25; must be finite and not negative"}},
        {"not_a_number", {"F(0, 2) = nan"}},
        {"integers", {"data.npy: type \"<i8\"; must be <f4 or <f8"}},
        {"big_endian", {"data.npy: type \">f4\""}},
        {"column", {"row 0: column 3; must be below 3"}},
        {"negative_column", {"indices.npy: element 1 is -1"}},
        {"twice", {"row 0: column 1"}},
        {"short_rows", {"indptr.npy: must be 4 offsets"}},
        {"falling_rows", {"indptr.npy: must be 4 offsets that ascend"}},
        {"too_many_rows", {"3 indices and 3 values; indptr.npy says 9"}},
        {"oblong", {"shape.npy: a shape of (3, 4)"}},
        {"huge", {"shape.npy: a shape of (1099511627776, 1099511627776)"}},
        {"two_dimensions", {"data.npy: shape (1, 3); must have one dimension"}},
        {"text_shape", {"shape.npy: type \"<U1\""}},
    };
    for (const Bad& bad : table) {
        INFO(bad.text);
        const auto path = folder / (bad.text + ".npz");
        std::vector<std::string> parts = bad.parts;
        parts.push_back(path.string() + ":");
        require_parts(message_of<InputError>([&] { (void)io::read_npz(path); }), parts);
    }
}

TEST_CASE("Exchange formats: a decimal comma of the locale changes nothing", "[io]") {
    const Folder folder;
    const FormFactorMatrix matrix = random_matrix(20, true);
    const std::locale before = std::locale::global(std::locale(std::locale(), new DecimalComma));
    const char* found = std::setlocale(LC_NUMERIC, "de_DE.UTF-8"); // as far as it is installed
    for (const Format& format : formats) {
        format.write(folder / format.name, matrix);
        require_same_entries(matrix, format.read(folder / format.name));
    }
    if (found != nullptr) {
        std::setlocale(LC_NUMERIC, "C");
    }
    std::locale::global(before);
}

TEST_CASE("Exchange formats: rows that were not computed cannot be written", "[io]") {
    const Folder folder;
    for (const Format& format : formats) {
        const std::string message =
            message_of<InvalidArgument>([&] { format.write(folder / format.name, FormFactorMatrix(3)); });
        require_parts(message, {"not computed", "use .hff"});
        REQUIRE_THROWS_AS(format.write("/dev/full", random_matrix(10, true)), IoError);
    }
    REQUIRE(folder.files() == 0);
}

TEST_CASE("Matrix Market: the entries are 1-based, in nine digits", "[io]") {
    const Folder folder;
    FormFactorMatrix matrix(2);
    matrix.set_block({0, {0, 1, 2}, {1, 0}, {1.0f / 3.0f, 1.0f}, {}, {0, 0}, {0, 0}, {1, 1}});
    io::write_mtx(folder / "a.mtx", matrix);
    const std::string text = io::read_file(folder / "a.mtx");
    REQUIRE(text.starts_with("%%MatrixMarket matrix coordinate real general\n%"));
    REQUIRE(text.ends_with("\n2 2 2\n1 2 0.333333343\n2 1 1\n"));
    io::write_csv(folder / "a.csv", matrix);
    REQUIRE(io::read_file(folder / "a.csv") == "i,j,F\n0,1,0.333333343\n1,0,1\n");
}

TEST_CASE("Matrix Market: entries in any order, comments and empty lines are read", "[io]") {
    const Folder folder;
    const auto path =
        folder.write("a.mtx", "%%matrixmarket MATRIX coordinate Real general\r\n% x\r\n\r\n 3 3 3\r\n"
                              "3 1 0.5\r\n% y\r\n1 3 2.5e-1\r\n\r\n1 2 +0.125\r\n");
    const FormFactorMatrix matrix = io::read_mtx(path);
    REQUIRE(matrix.size() == 3);
    REQUIRE(matrix.row(0).columns[1] == 2);
    REQUIRE(matrix.row(0).values[0] == 0.125f);
    REQUIRE(matrix.row(1).columns.empty());
    REQUIRE(matrix.row(2).values[0] == 0.5f);
}

TEST_CASE("Matrix Market: what is wrong is named with its line, its value and what would be right", "[io]") {
    const std::string head = "%%MatrixMarket matrix coordinate real general\n";
    const std::vector<Bad> table{
        {"", {":1: no Matrix Market file"}},
        {"1 1 1\n", {":1: no Matrix Market file"}},
        {"%%MatrixMarket matrix array real general\n", {":1:", "array real", "coordinate real general"}},
        {"%%MatrixMarket matrix coordinate complex general\n", {":1:", "must be"}},
        {"%%MatrixMarket matrix coordinate real symmetric\n", {":1:", "must be"}},
        {head, {"cut short: the line with rows"}},
        {head + "2 2\n", {":2: must be three whole numbers"}},
        {head + "2 x 1\n", {":2: must be three whole numbers"}},
        {head + "2 3 0\n", {":2: 2 rows and 3 columns"}},
        {head + "4000000000 4000000000 0\n", {":2: 4000000000 rows and 0 entries in a file of", "cannot be"}},
        {head + "2 2 4000000000000\n", {":2: 2 rows and 4000000000000 entries in a file of"}},
        {head + "2 2 1\n", {"cut short: 0 entries; the size line says 1"}},
        {head + "2 2 1\n1 1 0.5\n1 2 0.5\n", {":4: more entries than the 1"}},
        {head + "2 2 1\n0 1 0.5\n", {":3: row \"0\"; must be a whole number from 1 to 2"}},
        {head + "2 2 1\n1 3 0.5\n", {":3: column \"3\"; must be a whole number from 1 to 2"}},
        {head + "2 2 1\n1 -1 0.5\n", {":3: column \"-1\""}},
        {head + "2 2 1\n1 1.5 0.5\n", {":3: column \"1.5\""}},
        {head + "2 2 1\n1 1\n", {":3: value \"\"; a form factor must be finite and not negative"}},
        {head + "2 2 1\n1 1 -0.5\n", {":3: value \"-0.5\""}},
        {head + "2 2 1\n1 1 nan\n", {":3: value \"nan\""}},
        {head + "2 2 1\n1 1 1e60\n", {":3: value \"1e60\""}},
        {head + "2 2 1\n1 1 0,5\n", {":3: value \"0,5\""}},
        {head + "2 2 1\n1 1 0.5 0.5\n", {":3: \"0.5\" after the value"}},
        {head + "2 2 2\n1 1 0.5\n1 1 0.5\n", {":4: the entry of line 3 again"}},
    };
    const Folder folder;
    for (const Bad& bad : table) {
        INFO(bad.text);
        const auto path = folder.write("a.mtx", bad.text);
        require_parts(message_of<InputError>([&] { (void)io::read_mtx(path); }), bad.parts);
    }
}

TEST_CASE("CSV triples: what is wrong is named with its line, its value and what would be right", "[io]") {
    const std::vector<Bad> table{
        {"", {"a.csv:1: \"\"; must be the header \"i,j,F\""}},
        {"0,1,0.5\n", {"a.csv:1: \"0,1,0.5\"; must be the header"}},
        {"i,j,F\n", {"a.csv: no entries"}},
        {"i,j,F\n0,1\n", {":2: \"0,1\"; must be three fields"}},
        {"i,j,F\n0,1,0.5,1\n", {":2:", "must be three fields"}},
        {"i,j,F\n0,1,\n", {":2: value \"\""}},
        {"i,j,F\n\n0,x,1\n", {":3: column \"x\"; must be a whole number from 0"}},
        {"i,j,F\n-1,0,1\n", {":2: row \"-1\""}},
        {"i,j,F\n4000000000,0,1\n", {":2: row \"4000000000\"; must be a whole number from 0 to 10000"}},
        {"i,j,F\n0,1,-1e-9\n", {":2: value \"-1e-9\"; a form factor must be finite and not negative"}},
        {"i,j,F\n0,1,inf\n", {":2: value \"inf\""}},
        {"i,j,F\n0,1,1\n0,1,1\n", {":3: the entry of line 2 again"}},
    };
    const Folder folder;
    for (const Bad& bad : table) {
        INFO(bad.text);
        const auto path = folder.write("a.csv", bad.text);
        require_parts(message_of<InputError>([&] { (void)io::read_csv(path); }), bad.parts);
    }
    REQUIRE(io::read_csv(folder.write("a.csv", "i,j,F\r\n 0 , 2 , 0.5 \r\n")).size() == 3);
}

TEST_CASE("NPZ: files cut short, flipped bits and other files are refused or read as sound matrices",
          "[io]") {
    const Folder folder;
    io::write_npz(folder / "a.npz", random_matrix(12, true));
    const std::string bytes = io::read_file(folder / "a.npz");
    for (std::size_t position = 0; position < bytes.size(); position += 7) {
        INFO("byte " << position);
        const auto cut = folder.write("cut.npz", bytes.substr(0, position));
        REQUIRE_THROWS_AS((void)io::read_npz(cut), InputError);
        std::string flipped = bytes;
        flipped[position] = static_cast<char>(flipped[position] ^ (1 << position % 8));
        const auto path = folder.write("flipped.npz", flipped);
        try {
            (void)io::read_npz(path); // some bits of a ZIP archive mean nothing: dates, attributes
        } catch (const InputError& error) {
            require_parts(error.what(), {"flipped.npz"});
        }
    }
    require_parts(message_of<InputError>([&] { (void)io::read_npz(folder.write("x.npz", "i,j,F\n")); }),
                  {"x.npz: cannot be read as a ZIP archive"});
    require_parts(message_of<InputError>([&] { (void)io::read_npz(folder / "no.npz"); }), {"No such file"});
}

TEST_CASE("NPZ: a lie about the compressed size costs no memory", "[io]") {
    // Found by fuzzing: 1.5 kB that say to hold 4 GB, and to expand to 1 TB.
    const std::string path = HEMI_TEST_DATA "/io/false-compressed-size.npz";
    require_parts(message_of<InputError>([&] { (void)io::read_npz(path); }),
                  {"false-compressed-size.npz: ",
                   "1099511627907 bytes from 4294967296 compressed ones; that cannot be"});
}

TEST_CASE("View3D factors: header, areas, rows and emissivities are where View3D's readers look", "[io]") {
    const Folder folder;
    FormFactors file;
    file.matrix = FormFactorMatrix(3);
    file.matrix.set_block(
        {0, {0, 1, 2, 2}, {1, 0}, {1.0f / 3.0f, 1e-7f}, {}, {0, 0, 0}, {0, 0, 0}, {1, 1, 1}});
    file.areas = {1.0, 2.0 / 3.0, 3e6};
    file.enclosure = Enclosure::closed;
    const std::vector<double> emissivity{0.5, 0.0, 1.0};
    io::write_view3d(folder / "a.txt", file, io::View3dFormat::text, emissivity);
    const std::string text = io::read_file(folder / "a.txt");
    REQUIRE(text.substr(0, 5) == "hemi ");
    REQUIRE(text.substr(0, 30).find(" 0 1 0 3 ") != std::string::npos);
    REQUIRE(text.substr(30) == "\n1 0.666666667 3000000\n0 0.333333343 0\n1.00000001e-07 0 0\n0 0 0\n"
                               "0.5 0.001 0.999\n");

    io::write_view3d(folder / "a.vf", file, io::View3dFormat::binary);
    const std::string binary = io::read_file(folder / "a.vf");
    REQUIRE(binary.size() == 32 + 4 * (3 + 9 + 3));
    REQUIRE(binary.substr(0, 30).find(" 1 1 0 3 ") != std::string::npos);
    REQUIRE(binary.substr(30, 2) == "\r\n");
    std::vector<float> numbers(15);
    std::memcpy(numbers.data(), binary.data() + 32, 60);
    REQUIRE(numbers == std::vector<float>{1.0f, 2.0f / 3.0f, 3e6f, 0, 1.0f / 3.0f, 0, 1e-7f, 0, 0, 0, 0, 0,
                                          0.999f, 0.999f, 0.999f});
}

TEST_CASE("View3D factors: every factor and every row sum reads back from text", "[io]") {
    const Folder folder;
    FormFactors file;
    file.matrix = random_matrix(150, true);
    file.areas.assign(150, 2.5);
    io::write_view3d(folder / "a.txt", file, io::View3dFormat::text);
    std::istringstream stream(io::read_file(folder / "a.txt"));
    std::string line;
    std::getline(stream, line);
    REQUIRE(line.size() == 30);
    std::getline(stream, line);
    for (std::uint32_t i = 0; i < 150; ++i) {
        const RowView row = file.matrix.row(i);
        double sum = 0.0;
        std::size_t entries = 0;
        for (std::uint32_t j = 0; j < 150; ++j) {
            float value = -1.0f;
            stream >> value;
            sum += static_cast<double>(value);
            if (entries < row.columns.size() && row.columns[entries] == j) {
                REQUIRE(value == row.values[entries++]);
            } else {
                REQUIRE(value == 0.0f);
            }
        }
        REQUIRE(sum == row.sum());
    }
    REQUIRE_THROWS_AS(io::write_view3d("/dev/full", file, io::View3dFormat::binary), IoError);
    file.areas.pop_back();
    REQUIRE_THROWS_AS(io::write_view3d(folder / "b.txt", file, io::View3dFormat::text), InvalidArgument);
    file.areas.push_back(1.0);
    file.matrix = FormFactorMatrix(150);
    require_parts(message_of<InvalidArgument>(
                      [&] { io::write_view3d(folder / "b.txt", file, io::View3dFormat::text); }),
                  {"not computed", "use .hff"});
    REQUIRE(folder.files() == 1);
}

} // namespace hemi::io_test
