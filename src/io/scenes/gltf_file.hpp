#pragma once

#include "hemi/core/geometry.hpp"
#include "io/formats/json_node.hpp"
#include "io/scenes/scene_folder.hpp"

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace hemi::io {

/// A glTF accessor whose elements are all inside its buffer. Refers to the GltfFile it came from.
class GltfAccessor {
public:
    enum class Component : std::uint32_t {
        i8 = 5120,
        u8 = 5121,
        i16 = 5122,
        u16 = 5123,
        u32 = 5125,
        f32 = 5126
    };

    /// Elements one behind the other, `stride` bytes apart.
    struct Elements {
        const char* data = nullptr; ///< null: all are zero
        std::size_t stride = 0;
    };
    /// What stands instead of the elements of some indices, which ascend.
    struct Sparse {
        std::size_t count = 0;
        Elements indices;
        Component index_component = Component::u32;
        Elements values;
    };

    GltfAccessor(Elements elements, std::size_t count, std::uint32_t components, Component component,
                 bool normalized, Sparse sparse)
        : elements_(elements), count_(count), components_(components), component_(component),
          normalized_(normalized), sparse_(sparse) {}

    [[nodiscard]] std::size_t count() const noexcept { return count_; }
    /// Numbers in one element: 1 for SCALAR to 4 for VEC4.
    [[nodiscard]] std::uint32_t components() const noexcept { return components_; }
    [[nodiscard]] Component component() const noexcept { return component_; }
    /// Whether integers stand for numbers from -1, or 0, to 1.
    [[nodiscard]] bool normalized() const noexcept { return normalized_; }

    /// Element `i` of unsigned integers. `i` must be below count().
    [[nodiscard]] std::uint32_t integer(std::size_t i) const;
    /// Component `c` of element `i`, of integers their value, or the share that they stand for.
    [[nodiscard]] double number(std::size_t i, std::uint32_t c) const;
    [[nodiscard]] Vec3 point(std::size_t i) const { return {number(i, 0), number(i, 1), number(i, 2)}; }

private:
    [[nodiscard]] const char* element(std::size_t i) const;

    Elements elements_;
    std::size_t count_;
    std::uint32_t components_;
    Component component_;
    bool normalized_;
    Sparse sparse_;
};

[[nodiscard]] bool is_unsigned(GltfAccessor::Component component) noexcept;

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

    /// Whether the document says that it uses an extension.
    [[nodiscard]] bool uses(std::string_view extension) const;

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
    [[nodiscard]] GltfAccessor::Elements elements(const JsonNode& owner, std::uint64_t count,
                                                  std::uint64_t element, bool can_have_stride) const;
    [[nodiscard]] GltfAccessor::Sparse sparse(const JsonNode& node, std::uint64_t accessor,
                                              std::uint64_t count, std::uint64_t element) const;
    [[noreturn]] void fail(const std::string& message) const;

    std::string file_;
    SceneFolder folder_;
    std::string binary_; ///< the BIN chunk of a .glb
    bool has_binary_ = false;
    Json document_;
    JsonNode root_;
    std::vector<std::string> buffers_;
    mutable std::set<std::uint64_t> ascending_; ///< sparse accessors whose indices are known to be sound
};

} // namespace hemi::io
