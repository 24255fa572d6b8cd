#pragma once

#include "hemi/core/diagnostics.hpp"
#include "hemi/core/geometry.hpp"
#include "io/formats/text_scan.hpp"
#include "io/meshes/face_mesh.hpp"

#include <cstddef>
#include <set>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// An OBJ file as the loader shall see it: line by line, each line checked first. The loader takes "1x" for 1
/// and "abc" for 0, rounds decimals loosely and does not know its line; so numbers are read here, exactly,
/// and only the lines with structure (faces, groups, materials) are passed on.
class ObjLines : public std::streambuf {
public:
    /// @param text  must outlive this.
    ObjLines(std::string file, std::string_view text, Diagnostics& diagnostics);

    /// Number of the line that was passed on last.
    [[nodiscard]] std::size_t line() const noexcept { return line_; }
    /// All `v` up to that line.
    [[nodiscard]] const std::vector<Vec3>& vertices() const noexcept { return vertices_; }
    [[nodiscard]] const std::vector<FaceMesh::Library>& libraries() const noexcept { return libraries_; }

protected:
    int_type underflow() override;

private:
    bool next_logical_line();
    [[nodiscard]] bool is_for_loader();
    void read_vertex(std::string_view rest);
    [[nodiscard]] std::string face_for_loader(std::string_view rest) const;
    [[noreturn]] void fail(const std::string& message) const;

    std::string file_;
    Lines lines_;
    Diagnostics& diagnostics_;
    std::string current_;
    std::size_t line_ = 0;
    std::vector<Vec3> vertices_;
    std::vector<FaceMesh::Library> libraries_;
    std::set<std::string, std::less<>> ignored_;
};

} // namespace hemi::io
