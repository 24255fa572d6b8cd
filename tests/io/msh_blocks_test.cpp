#include "hemi/io/scene_reader.hpp"

#include "io_fixtures.hpp"

#include <fmt/format.h>

#include <cstdint>
#include <cstring>

namespace hemi::io_test {

namespace {

/// Writes values as text, or as bytes of either order.
class Output {
public:
    enum class Kind { text, little, big };

    explicit Output(Kind kind) : kind_(kind) {}

    Output& line(const std::string& text) {
        if (kind_ == Kind::text && !text_.empty() && text_.back() != '\n') {
            text_ += '\n';
        }
        text_ += text + "\n";
        return *this;
    }
    Output& ints(const std::vector<std::int32_t>& values) { return put(values); }
    Output& sizes(const std::vector<std::uint64_t>& values) { return put(values); }
    Output& reals(const std::vector<double>& values) { return put(values); }
    [[nodiscard]] const std::string& text() const { return text_; }

private:
    template <class Value>
    Output& put(const std::vector<Value>& values) {
        for (const Value value : values) {
            if (kind_ == Kind::text) {
                text_ += fmt::format("{} ", value);
                continue;
            }
            char bytes[sizeof(Value)];
            std::memcpy(bytes, &value, sizeof value);
            if (kind_ == Kind::big) {
                std::reverse(std::begin(bytes), std::end(bytes));
            }
            text_.append(bytes, sizeof value);
        }
        return *this;
    }

    Kind kind_;
    std::string text_;
};

const std::string names = "$PhysicalNames\n2\n1 4 \"edge\"\n2 9 \"walls\"\n$EndPhysicalNames";

/// Two surfaces of the geometry: 3 in "walls", of two quadrilaterals; 5 in no group, of a triangle of second
/// order. Nodes are parametric; their numbers have gaps. A line is left out.
std::string version_4(Output::Kind kind) {
    Output out(kind);
    out.line("$MeshFormat").line(kind == Output::Kind::text ? "4.1 0 8" : "4.1 1 8");
    if (kind != Output::Kind::text) {
        out.ints({1});
    }
    out.line("").line("$EndMeshFormat").line(names).line("$Entities").sizes({1, 1, 2, 0});
    out.ints({1}).reals({0, 0, 0}).sizes({0});
    out.ints({2}).reals({0, 0, 0, 1, 0, 0}).sizes({1}).ints({4}).sizes({2}).ints({1, -1});
    out.ints({3}).reals({0, 0, 0, 2, 1, 0}).sizes({2}).ints({9, 7}).sizes({1}).ints({2});
    out.ints({5}).reals({0, 0, 0, 1, 1, 1}).sizes({0}).sizes({0});
    out.line("").line("$EndEntities").line("$Nodes").sizes({2, 9, 1, 20});
    out.ints({2, 3, 1}).sizes({6, 1, 2, 3, 4, 5, 20});
    for (const std::vector<double>& p : std::vector<std::vector<double>>{{0, 0, 0, 0.1, 0.2},
                                                                         {1, 0, 0, 0, 0},
                                                                         {1, 1, 0, 0, 0},
                                                                         {0, 1, 0, 0, 0},
                                                                         {2, 0, 0, 0, 0},
                                                                         {2, 1, 0, 0, 0}}) {
        out.reals(p);
    }
    out.ints({2, 5, 0}).sizes({3, 11, 12, 13}).reals({0, 0, 1}).reals({0.5, 0, 0.5}).reals({0.5, 0.5, 0.5});
    out.line("").line("$EndNodes").line("$Elements").sizes({3, 4, 1, 4});
    out.ints({1, 2, 1}).sizes({1, 1, 1, 2});
    out.ints({2, 3, 3}).sizes({2, 2, 1, 2, 3, 4}).sizes({3, 2, 5, 20, 3});
    out.ints({2, 5, 9}).sizes({1, 4, 1, 2, 11, 12, 13, 4});
    out.line("").line("$EndElements");
    return out.text();
}

/// The same without the second physical surface.
std::string binary_version_2(Output::Kind kind) {
    Output out(kind);
    out.line("$MeshFormat").line("2.2 1 8").ints({1}).line("").line("$EndMeshFormat").line(names);
    out.line("$Nodes").line("9");
    const std::vector<std::vector<double>> points{{1, 0, 0, 0},  {2, 1, 0, 0},      {3, 1, 1, 0},
                                                  {4, 0, 1, 0},  {5, 2, 0, 0},      {20, 2, 1, 0},
                                                  {11, 0, 0, 1}, {12, 0.5, 0, 0.5}, {13, 0.5, 0.5, 0.5}};
    for (const std::vector<double>& p : points) {
        out.ints({static_cast<std::int32_t>(p[0])}).reals({p[1], p[2], p[3]});
    }
    out.line("").line("$EndNodes").line("$Elements").line("4");
    out.ints({1, 1, 2, 1, 4, 2, 1, 2});
    out.ints({3, 2, 2, 2, 9, 3, 1, 2, 3, 4, 3, 9, 3, 2, 5, 20, 3});
    out.ints({9, 1, 2, 4, 0, 5, 1, 2, 11, 12, 13, 4});
    out.line("").line("$EndElements");
    return out.text();
}

Scene read(const Folder& folder, const std::string& text, Diagnostics& diagnostics) {
    return io::read_scene(folder.write("room.msh", text), {}, diagnostics);
}

void check_scene(const Scene& scene) {
    REQUIRE(scene.surfaces.size() == 3);
    CHECK(scene.groups == std::vector<std::string>{"walls", "surface_5"});
    CHECK(scene.surfaces[0].vertex_count == 4);
    CHECK(scene.surfaces[1].vertices[2] == Vec3(2, 1, 0));
    CHECK(scene.surfaces[1].group == 0);
    CHECK(scene.surfaces[2].vertex_count == 3);
    CHECK(scene.surfaces[2].vertices[2] == Vec3(0, 0, 1));
    CHECK(scene.surfaces[2].group == 1);
    CHECK(scene.materials[0].name == "walls");
}

void check_warnings(const Diagnostics& diagnostics, const std::vector<std::string>& parts) {
    REQUIRE(diagnostics.warnings().size() == parts.size());
    for (std::size_t k = 0; k < parts.size(); ++k) {
        require_parts(diagnostics.warnings()[k], {parts[k]});
    }
}

} // namespace

TEST_CASE("Gmsh reader: version 4.1 as text and in both byte orders, and binary version 2.2, say the same",
          "[io]") {
    const Folder folder;
    {
        Diagnostics diagnostics;
        check_scene(read(folder, version_4(Output::Kind::text), diagnostics));
        check_warnings(diagnostics,
                       {"room.msh: 1 surface of the geometry is in several physical surfaces",
                        "room.msh:19: 1 line left out, the first one here",
                        "1 6-node triangle taken as plane between the corners, the first one here"});
    }
    for (const auto kind : {Output::Kind::little, Output::Kind::big}) {
        Diagnostics diagnostics;
        check_scene(read(folder, version_4(kind), diagnostics));
        check_warnings(diagnostics,
                       {"is in several physical surfaces; the first one of each counts",
                        "room.msh: 1 line left out, the first one is element 1",
                        "1 6-node triangle taken as plane between the corners, the first one is element 4"});
        Diagnostics of_old;
        check_scene(read(folder, binary_version_2(kind), of_old));
        CHECK(of_old.warnings().size() == 2);
    }
}

TEST_CASE("Gmsh reader: parametric nodes of version 2.2, and second order read by its corners", "[io]") {
    const Folder folder;
    Diagnostics diagnostics;
    const Scene scene = read(
        folder,
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$ParametricNodes\n6\n1 0 0 0 2 1 0.5 0.5\n2 2 0 0 1 1 0.3\n"
        "3 0 2 0 0 1\n4 1 0 0 3 1\n5 1 1 0 3 1\n6 0 1 0 3 1\n$EndParametricNodes\n$Elements\n1\n"
        "7 9 2 1 1 1 2 3 4 5 6\n$EndElements\n",
        diagnostics);
    REQUIRE(scene.surfaces.size() == 1);
    CHECK(glm::length(area_vector(scene.surfaces[0].polygon())) == Approx(2.0));
    check_warnings(diagnostics, {"room.msh:15: 1 6-node triangle taken as plane"});
}

TEST_CASE("Gmsh reader: a physical surface below 0, of a surface turned round, is that of its number",
          "[io]") {
    const Folder folder;
    const auto text = [](const std::string& physical) {
        return "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n" + names + "\n$Entities\n0 0 1 0\n1 0 0 0 1 1 0 1 " +
               physical +
               " 0\n$EndEntities\n$Nodes\n1 4 1 4\n2 1 0 4\n1\n2\n3\n4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
               "$EndNodes\n$Elements\n1 1 1 1\n2 1 3 1\n1 1 2 3 4\n$EndElements\n";
    };
    const auto read = [&](const std::string& content) {
        Diagnostics diagnostics;
        return io::read_scene(folder.write("a.msh", content), {}, diagnostics);
    };
    CHECK(read(text("-9")).groups == std::vector<std::string>{"walls"});
    CHECK(read("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n" + names +
               "\n$Nodes\n3\n1 0 0 0\n2 1 0 0\n3 1 1 0\n$EndNodes\n$Elements\n1\n1 2 2 -9 1 1 2 3\n"
               "$EndElements\n")
              .groups == std::vector<std::string>{"walls"});
    require_parts(message_of<ParseError>([&] { (void)read(text("-9223372036854775808")); }),
                  {"a.msh:11: physical group \"-9223372036854775808\"; must be a whole number of 32 bits"});
}

TEST_CASE("Gmsh reader: what is wrong in blocks is named with its line or byte", "[io]") {
    const Folder folder;
    const std::string sound = version_4(Output::Kind::text);
    const auto message = [&](const std::string& from, const std::string& to) {
        std::string text = sound;
        const std::size_t at = text.find(from);
        REQUIRE(at != std::string::npos);
        text.replace(at, from.size(), to);
        Diagnostics unused;
        return message_of<InputError>([&] { (void)read(folder, text, unused); });
    };
    require_parts(message("$Nodes\n2 9", "$Nodes\nx 9"),
                  {"room.msh:15: blocks of nodes \"x\"; must be a whole number"});
    require_parts(message("$Nodes\n2 9", "$Nodes\n99999999 9"),
                  {":15: 99999999 blocks of nodes in a file of"});
    require_parts(message("2 3 1 6", "4 3 1 6"),
                  {":15: a block of dimension 4, parametric 1; must be 0 to 3"});
    require_parts(message("6 1 2 3 4 5 20", "6 1 2 3 4 5 1"), {"node 1 is there twice"});
    require_parts(message("2 2 1 2 3 4", "2 2 1 2 3 44"),
                  {"element 2: node 44; must be the number of one of the 9 nodes"});
    require_parts(message("2 3 3 2 2", "2 3 77 2 2"), {"elements of type 77 are not supported"});
    require_parts(message("$EndNodes", "$EndNode"), {"\"$EndNode\"; must be $EndNodes, the count says"});
    require_parts(message("$Elements", "$Comments"), {"cut short: the end of $Comments"});
    require_parts(message("3 2 5 20 3", "3 1 2 3 4"), {"room.msh:19: the face of line 19 again"});
    Diagnostics unused;
    std::string binary = version_4(Output::Kind::little);
    binary.resize(binary.size() - 40);
    require_parts(message_of<InputError>([&] { (void)read(folder, binary, unused); }),
                  {"room.msh: byte ", "1 elements in a file of 1128 bytes; that cannot be"});
}

TEST_CASE("Gmsh reader: blocks cut anywhere, and with any byte changed, are read or refused by name",
          "[io]") {
    const Folder folder;
    for (const std::string& text : {version_4(Output::Kind::text), version_4(Output::Kind::little),
                                    binary_version_2(Output::Kind::big)}) {
        for (std::size_t at = 0; at < text.size(); at += 23) {
            for (const std::string& bad :
                 {text.substr(0, at), text.substr(0, at) + "\377" + text.substr(at + 1),
                  text.substr(0, at) + "9" + text.substr(at + 1)}) {
                try {
                    Diagnostics unused;
                    (void)read(folder, bad, unused);
                } catch (const InputError& error) {
                    require_parts(error.what(), {"room.msh"});
                }
            }
        }
    }
}

} // namespace hemi::io_test
