#pragma once

#include "hemi/core/geometry.hpp"
#include "io/formats/json_node.hpp"
#include "io/scenes/scene_folder.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// A glTF accessor whose elements are all inside its buffer. Refers to the GltfFile it came from.
class GltfAccessor {
public:
    enum class Component : std::uint32_t { u8 = 5121, u16 = 5123, u32 = 5125, f32 = 5126 };

    GltfAccessor(const char* data, std::size_t count, std::size_t stride, std::uint32_t components,
                 Component component)
        : data_(data), count_(count), stride_(stride), components_(components), component_(component) {}

    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    /// Numbers in one element: 1 for SCALAR to 4 for VEC4.
    [[nodiscard]] std::uint32_t components() const noexcept { return components_; }
    [[nodiscard]] Component component() const noexcept { return component_; }

    /// Element `i` of unsigned integers. `i` must be below count().
    [[nodiscard]] std::uint32_t integer(std::size_t i) const;
    /// Component `c` of element `i` of floats.
    [[nodiscard]] float number(std::size_t i, std::uint32_t c) const;
    [[nodiscard]] Vec3 point(std::size_t i) const { return {number(i, 0), number(i, 1), number(i, 2)}; }

private:
    const char* data_;
    std::size_t count_;
    std::size_t stride_;
    std::uint32_t components_;
    Component component_;
};

/// A glTF 2.0 document with its buffers: .gltf with data URIs or files beside it, or .glb.
class GltfFile {
public:
    /// @throws ParseError or InputError for anything that is not sound up to the buffers, for extensions that
    ///   are required and not known here, and, unless allowed, for buffers outside the file's folder.
    GltfFile(const std::filesystem::path& path, bool allow_outside);
    GltfFile(const GltfFile&) = delete;
    GltfFile& operator=(const GltfFile&) = delete;

    [[nodiscard]] const JsonNode& root() const noexcept { return root_; }

    /// The accessor whose index is the value of `reference`, every element of which is in its buffer.
    /// @throws InputError at the accessor or its view for anything else, and for what is not supported.
    [[nodiscard]] GltfAccessor accessor(const JsonNode& reference) const;

    /// The value of `reference` as an index below `size`. @throws InputError at `reference`.
    [[nodiscard]] static std::size_t index(const JsonNode& reference, std::size_t size, std::string_view of);

private:
    static constexpr std::uint64_t most = std::uint64_t{1} << 40; ///< above any offset, far from overflow

    [[nodiscard]] Json read_document(const std::filesystem::path& path);
    [[nodiscard]] std::string_view split_glb(std::string_view bytes);
    void check_version() const;
    void check_extensions() const;
    void read_buffers(const std::filesystem::path& path);
    [[nodiscard]] std::string read_buffer(const JsonNode& uri, const std::filesystem::path& folder) const;
    [[noreturn]] void fail(const std::string& message) const;

    std::string file_;
    SceneFolder folder_;
    std::string binary_; ///< the BIN chunk of a .glb
    bool has_binary_ = false;
    Json document_;
    JsonNode root_;
    std::vector<std::string> buffers_;
};

} // namespace hemi::io
