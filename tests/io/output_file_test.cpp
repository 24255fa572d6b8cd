#include "hemi/io/output_file.hpp"

#include "hemi/io/image_file.hpp"
#include "io_fixtures.hpp"

#include <csignal>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>

namespace hemi::io_test {

namespace {

namespace fs = std::filesystem;

/// Lets no file grow beyond a size while it lives: what a full disk does.
class SmallDisk {
public:
    explicit SmallDisk(rlim_t bytes) : signal_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~SmallDisk() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, signal_);
    }
    SmallDisk(const SmallDisk&) = delete;
    SmallDisk& operator=(const SmallDisk&) = delete;

private:
    rlimit before_{};
    void (*signal_)(int);
};

void write_all(const fs::path& path, const std::string& text) {
    io::OutputFile file(path);
    file.write(text);
    file.commit();
}

} // namespace

TEST_CASE("OutputFile: the file appears under its name when it is complete, not before", "[io]") {
    const Folder folder;
    {
        io::OutputFile file(folder / "a.txt");
        REQUIRE(folder.files() == 1); // beside it
        file.write("one ");
        file.write("two", 3);
        REQUIRE_FALSE(fs::exists(folder / "a.txt"));
        file.commit();
    }
    REQUIRE(io::read_file(folder / "a.txt") == "one two");
    REQUIRE(folder.files() == 1);
}

TEST_CASE("OutputFile: without commit nothing is left and the old file stays", "[io]") {
    const Folder folder;
    folder.write("a.txt", "old");
    {
        io::OutputFile file(folder / "a.txt");
        file.write("new");
    }
    REQUIRE(io::read_file(folder / "a.txt") == "old");
    REQUIRE(folder.files() == 1);
}

TEST_CASE("OutputFile: two writers of one name do not disturb each other, the last one counts", "[io]") {
    const Folder folder;
    io::OutputFile first(folder / "a.txt");
    io::OutputFile second(folder / "a.txt");
    first.write("first");
    second.write("second");
    second.commit();
    first.commit();
    REQUIRE(io::read_file(folder / "a.txt") == "first");
    REQUIRE(folder.files() == 1);
}

TEST_CASE("OutputFile: what a killed writer left goes, what others are writing or have written stays",
          "[io]") {
    const Folder folder;
    io::OutputFile other(folder / "a.txt");
    folder.write(".a.txt.999999.tmp", "left behind");
    folder.write(".a.txt.999999.1.tmp", "left behind");
    folder.write(".a.txt.mine.tmp", "no number");
    folder.write(".b.txt.999999.tmp", "of another file");
    write_all(folder / "a.txt", "one");
    REQUIRE_FALSE(fs::exists(folder / ".a.txt.999999.tmp"));
    REQUIRE_FALSE(fs::exists(folder / ".a.txt.999999.1.tmp"));
    REQUIRE(folder.files() == 4); // with that of the other
    other.write("two");
    other.commit();
    REQUIRE(io::read_file(folder / "a.txt") == "two");
}

TEST_CASE("OutputFile: a full disk is an error with path and reason, and leaves nothing behind", "[io]") {
    const Folder folder;
    const SmallDisk disk(10'000);
    // One fails on writing, the other only when buffers are flushed.
    for (const std::size_t size : {1'000'000u, 10'001u}) {
        const auto path = folder / "big.bin";
        const std::string message = message_of<IoError>([&] { write_all(path, std::string(size, 'x')); });
        require_parts(message, {path.string(), "cannot be written", "File too large"});
        REQUIRE(folder.files() == 0);
    }
}

TEST_CASE("OutputFile: a device that is full is an error", "[io]") {
    require_parts(message_of<IoError>([] { write_all("/dev/full", "x"); }), {"/dev/full", "No space left"});
}

TEST_CASE("OutputFile: a device is written to, not replaced", "[io]") {
    write_all("/dev/null", "x");
    REQUIRE(fs::is_character_file("/dev/null"));
}

TEST_CASE("OutputFile: directories, missing directories and empty names are refused", "[io]") {
    const Folder folder;
    const auto refusal = [](const fs::path& path) {
        return message_of<IoError>([&] { io::OutputFile file(path); });
    };
    require_parts(refusal(folder / ""), {"Is a directory"});
    require_parts(refusal((folder / "x").parent_path()), {"Is a directory"});
    require_parts(refusal(folder / "no/such.txt"), {"no/such.txt", "No such file or directory"});
    require_parts(refusal(""), {"No such file"});
    REQUIRE(folder.files() == 0);
}

TEST_CASE("OutputFile: a name that a directory took meanwhile is an error, and nothing is left behind",
          "[io]") {
    const Folder folder;
    {
        io::OutputFile file(folder / "a");
        fs::create_directory(folder / "a");
        require_parts(message_of<IoError>([&] { file.commit(); }), {"Is a directory"});
    }
    REQUIRE(folder.files() == 1);
}

TEST_CASE("OutputFile: links and access rights of an existing file are kept", "[io]") {
    const Folder folder;
    folder.write("real", "old");
    fs::create_symlink("real", folder / "link");
    fs::permissions(folder / "real", fs::perms::owner_read | fs::perms::owner_write);
    write_all(folder / "link", "new");
    REQUIRE(fs::is_symlink(folder / "link"));
    REQUIRE(io::read_file(folder / "real") == "new");
    REQUIRE(fs::status(folder / "real").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
}

TEST_CASE("OutputFile: names of 255 bytes are written", "[io]") {
    const Folder folder;
    write_all(folder / std::string(255, 'n'), "x");
    REQUIRE(folder.files() == 1);
}

TEST_CASE("read_file: says what is wrong with missing files and directories", "[io]") {
    const Folder folder;
    require_parts(message_of<InputError>([&] { (void)io::read_file(folder / "no"); }),
                  {"/no:", "No such file"});
    require_parts(message_of<InputError>([&] { (void)io::read_file(folder / ""); }), {"Is a directory"});
}

TEST_CASE("read_file: a file larger than the machine's memory is refused before memory is asked for",
          "[io]") {
    const Folder folder;
    const auto path = folder.write("huge.obj", "");
    std::filesystem::resize_file(path, std::uint64_t{1} << 42); // takes no space
    require_parts(message_of<InputError>([&] { (void)io::read_file(path); }),
                  {"huge.obj: 4398046511104 bytes; this machine has"});
}

TEST_CASE("Pictures: PNG and HDR are written with the right size", "[io]") {
    const Folder folder;
    io::write_png(folder / "a.png", 3, 2, std::vector<std::uint8_t>(18, 200));
    const std::string png = io::read_file(folder / "a.png");
    REQUIRE(png.substr(1, 3) == "PNG");
    REQUIRE(png.substr(16, 8) == std::string("\0\0\0\3\0\0\0\2", 8));
    io::write_hdr(folder / "a.hdr", 3, 2, std::vector<float>(18, 2.5f));
    const std::string hdr = io::read_file(folder / "a.hdr");
    REQUIRE(hdr.starts_with("#?RADIANCE\n"));
    REQUIRE(hdr.find("-Y 2 +X 3\n") != std::string::npos);
}

TEST_CASE("Pictures: wrong sizes and values are refused, what cannot be written is an error", "[io]") {
    const Folder folder;
    const std::vector<std::uint8_t> bytes(17);
    REQUIRE_THROWS_AS(io::write_png(folder / "a.png", 3, 2, bytes), InvalidArgument);
    REQUIRE_THROWS_AS(io::write_png(folder / "a.png", 0, 2, {}), InvalidArgument);
    REQUIRE_THROWS_AS(io::write_png(folder / "a.png", 4'000'000'000u, 2, {}), InvalidArgument);
    const std::vector<float> values(3, std::nanf(""));
    REQUIRE_THROWS_AS(io::write_hdr(folder / "a.hdr", 1, 1, values), InvalidArgument);
    REQUIRE_THROWS_AS(io::write_png("/dev/full", 1, 1, std::vector<std::uint8_t>(3)), IoError);
    REQUIRE_THROWS_AS(io::write_hdr(folder / "no/a.hdr", 1, 1, std::vector<float>(3)), IoError);
    REQUIRE(folder.files() == 0);
}

} // namespace hemi::io_test
