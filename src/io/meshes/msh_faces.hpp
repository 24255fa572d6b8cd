#pragma once

#include "hemi/core/diagnostics.hpp"
#include "io/meshes/face_builder.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace hemi::io {

/// A type of Gmsh's elements.
struct MshElementType {
    enum class Kind { point, line, triangle, quadrilateral, volume };

    std::uint32_t number; ///< Gmsh's own
    Kind kind;
    std::uint32_t nodes;
    const char* curved; ///< its name, if it is a surface of second order or more; else empty

    [[nodiscard]] bool is_face() const { return kind == Kind::triangle || kind == Kind::quadrilateral; }
};

/// Null for types that are not known.
[[nodiscard]] const MshElementType* find_msh_element_type(std::uint32_t number);

/// Collects what a Gmsh file has, of any version: nodes and names first, then elements, of which the surfaces
/// become faces. Faces of second order and more are read by their corners.
class MshFaces {
public:
    /// What an element belongs to, numbers of 32 bits; 0: nothing.
    struct Tags {
        std::int64_t physical = 0;
        std::int64_t elementary = 0;
        auto operator<=>(const Tags&) const = default;
    };

    MshFaces(const std::filesystem::path& path, const SceneReaderOptions& options);

    /// A line of $PhysicalNames; those of points, lines and volumes are passed over.
    /// @return what is wrong with it
    [[nodiscard]] std::optional<std::string> add_name(std::string_view line);

    void reserve_nodes(std::uint64_t count) { nodes_.reserve(count); }
    /// False if the number is taken.
    [[nodiscard]] bool add_node(std::uint64_t number, const Vec3& point);
    [[nodiscard]] std::size_t nodes() const noexcept { return nodes_.size(); }
    /// Index of the node of that number, if there is one.
    [[nodiscard]] std::optional<std::uint32_t> find_node(std::uint64_t number) const;

    void reserve_faces(std::uint64_t count, std::uint64_t most) { faces_.reserve(count, most); }
    /// An element that is a surface. @param corners  3 or 4 indices of nodes
    void add_face(const MshElementType& type, Tags tags, std::span<const std::uint32_t> corners,
                  FacePlace place);
    /// Any other element.
    void leave_out(const MshElementType& type, FacePlace place);

    /// @throws ParseError or InputError if there are no faces, or one is there twice
    [[nodiscard]] FaceMesh finish(Diagnostics& diagnostics);

private:
    /// What of a kind was met, for one warning.
    struct Met {
        std::uint64_t count = 0;
        FacePlace first;

        void add(FacePlace place);
    };
    /// Nodes of a face, the lowest first, to find faces that are there twice.
    struct Twin {
        std::array<std::uint32_t, 4> nodes;
        std::size_t line;
        std::uint64_t number;
        auto operator<=>(const Twin&) const = default;
    };
    struct Group {
        std::uint32_t group;
        std::uint32_t material;
    };

    const Group& group_of(Tags tags);
    void refuse_twins();
    void warn_of(const Met& met, const std::string& noun, const char* what, Diagnostics& diagnostics) const;

    std::string file_;
    FaceBuilder faces_;
    std::map<std::int64_t, std::string> names_;
    std::vector<Vec3> nodes_;
    std::unordered_map<std::uint64_t, std::uint32_t> numbers_; ///< empty while nodes count on from 1
    std::map<Tags, Group> groups_;
    std::vector<Twin> twins_;
    Met points_;
    Met edges_;
    Met volumes_;
    std::map<std::uint32_t, Met> curved_; ///< by type
};

} // namespace hemi::io
