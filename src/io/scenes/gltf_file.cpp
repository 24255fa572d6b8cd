#include "io/scenes/gltf_file.hpp"

#include "hemi/core/error.hpp"
#include "hemi/io/output_file.hpp"
#include "io/formats/base64.hpp"
#include "io/formats/text_scan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>

namespace hemi::io {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view glb_magic = "glTF";

/// Whatever these say is read, or has no part in diffuse reflection.
constexpr std::array known_extensions{"KHR_materials_emissive_strength", "KHR_materials_unlit",
                                      "KHR_texture_transform", "KHR_lights_punctual",
                                      "KHR_mesh_quantization"};

template <class T>
T read_as(const char* data) {
    T value;
    std::memcpy(&value, data, sizeof value);
    return value;
}

using Component = GltfAccessor::Component;

std::uint32_t size_of(Component component) {
    switch (component) {
    case Component::i8:
    case Component::u8:
        return 1;
    case Component::i16:
    case Component::u16:
        return 2;
    case Component::u32:
    case Component::f32:
        break;
    }
    return 4;
}

Component component_of(const JsonNode& node) {
    const std::uint64_t type = node.integer(1'000'000);
    for (const auto known :
         {Component::i8, Component::u8, Component::i16, Component::u16, Component::u32, Component::f32}) {
        if (type == static_cast<std::uint64_t>(known)) {
            return known;
        }
    }
    node.fail(fmt::format("{}; must be 5120 to 5123, 5125 (integers) or 5126 (float)", type));
}

std::uint32_t unsigned_at(const char* data, Component component) {
    switch (component) {
    case Component::i8:
    case Component::u8:
        return read_as<std::uint8_t>(data);
    case Component::i16:
    case Component::u16:
        return read_as<std::uint16_t>(data);
    case Component::u32:
    case Component::f32:
        break;
    }
    return read_as<std::uint32_t>(data);
}

std::uint32_t components_of(const JsonNode& node) {
    constexpr std::array<std::string_view, 4> types{"SCALAR", "VEC2", "VEC3", "VEC4"};
    const auto* const found = std::find(types.begin(), types.end(), node.text());
    if (found == types.end()) {
        node.expect("SCALAR, VEC2, VEC3 or VEC4");
    }
    return static_cast<std::uint32_t>(found - types.begin()) + 1;
}

/// Value of member `key`, or `otherwise` if there is none.
std::uint64_t integer_or(const JsonNode& node, std::string_view key, std::uint64_t most,
                         std::uint64_t otherwise) {
    return node.has(key) ? node.member(key).integer(most) : otherwise;
}

/// A URI's %-codes as the bytes they stand for.
std::string decode_percent(const JsonNode& node, std::string_view uri) {
    std::string path;
    for (std::size_t k = 0; k < uri.size(); ++k) {
        if (uri[k] != '%') {
            path += uri[k];
            continue;
        }
        unsigned code = 0;
        const char* const begin = uri.data() + k + 1;
        const bool whole = k + 2 < uri.size();
        if (!whole || std::from_chars(begin, begin + 2, code, 16).ptr != begin + 2 || code == 0) {
            node.fail(fmt::format("{}; % must be followed by two hexadecimal digits", in_quotes(uri)));
        }
        path += static_cast<char>(code);
        k += 2;
    }
    return path;
}

} // namespace

bool is_unsigned(GltfAccessor::Component component) noexcept {
    return component == Component::u8 || component == Component::u16 || component == Component::u32;
}

const char* GltfAccessor::element(std::size_t i) const {
    const auto index = [&](std::size_t k) {
        return unsigned_at(sparse_.indices.data + k * sparse_.indices.stride, sparse_.index_component);
    };
    std::size_t first = 0;
    for (std::size_t end = sparse_.count; first < end;) {
        const std::size_t middle = first + (end - first) / 2;
        (index(middle) < i ? first : end) = index(middle) < i ? middle + 1 : middle;
    }
    if (first < sparse_.count && index(first) == i) {
        return sparse_.values.data + first * sparse_.values.stride;
    }
    static constexpr std::array<char, 16> zero{};
    return elements_.data == nullptr ? zero.data() : elements_.data + i * elements_.stride;
}

std::uint32_t GltfAccessor::integer(std::size_t i) const {
    return unsigned_at(element(i), component_);
}

double GltfAccessor::number(std::size_t i, std::uint32_t c) const {
    const char* const data = element(i) + std::size_t{c} * size_of(component_);
    const auto share = [this](double value, double most) {
        return normalized_ ? std::max(value / most, -1.0) : value;
    };
    switch (component_) {
    case Component::i8:
        return share(read_as<std::int8_t>(data), 127.0);
    case Component::u8:
        return share(read_as<std::uint8_t>(data), 255.0);
    case Component::i16:
        return share(read_as<std::int16_t>(data), 32767.0);
    case Component::u16:
        return share(read_as<std::uint16_t>(data), 65535.0);
    case Component::u32:
        return read_as<std::uint32_t>(data);
    case Component::f32:
        break;
    }
    return read_as<float>(data);
}

GltfFile::GltfFile(const fs::path& path, bool allow_outside)
    : file_(path.string()), folder_(path, allow_outside), document_(read_document(path)),
      root_(document_, file_) {
    root_.check_object();
    check_version();
    check_extensions();
    read_buffers(path);
}

Json GltfFile::read_document(const fs::path& path) {
    const std::string bytes = read_file(path);
    return parse_json(bytes.starts_with(glb_magic) ? split_glb(bytes) : std::string_view(bytes), file_);
}

std::string_view GltfFile::split_glb(std::string_view bytes) {
    constexpr std::uint32_t json_chunk = 0x4E4F534A;
    constexpr std::uint32_t binary_chunk = 0x004E4942;
    const auto word = [&](std::size_t at) { return read_as<std::uint32_t>(bytes.data() + at); };
    if (bytes.size() < 20) {
        fail(fmt::format("cut short: {} bytes; a .glb has at least 20", bytes.size()));
    }
    if (word(4) != 2) {
        fail(fmt::format("glTF version {}; must be 2", word(4)));
    }
    if (word(8) > bytes.size()) {
        fail(fmt::format("cut short: {} bytes; its header says {}", bytes.size(), word(8)));
    }
    const std::size_t end = word(8);
    std::string_view json;
    for (std::size_t at = 12; at < end;) {
        const std::size_t length = end - at >= 8 ? word(at) : 0;
        if (end - at < 8 || length > end - at - 8) {
            fail(fmt::format("byte {}: a chunk of {} bytes; {} are left", at, length, end - at));
        }
        const std::string_view chunk = bytes.substr(at + 8, length);
        if (at == 12 && word(at + 4) != json_chunk) {
            fail("byte 12: the first chunk must be JSON");
        }
        if (at == 12) {
            json = chunk;
        } else if (word(at + 4) == binary_chunk && !has_binary_) {
            binary_ = chunk;
            has_binary_ = true;
        }
        at += 8 + length;
    }
    if (json.empty()) {
        fail("no JSON chunk");
    }
    return json;
}

void GltfFile::check_version() const {
    const JsonNode asset = root_.member("asset");
    const JsonNode version = asset.member("version");
    if (version.text().substr(0, 2) != "2.") {
        version.expect("\"2.0\", the version of glTF that is supported");
    }
}

void GltfFile::check_extensions() const {
    if (!root_.has("extensionsRequired")) {
        return;
    }
    const JsonNode required = root_.member("extensionsRequired");
    for (std::size_t k = 0; k < required.size(); ++k) {
        const JsonNode name = required.element(k);
        if (std::find(known_extensions.begin(), known_extensions.end(), name.text()) ==
            known_extensions.end()) {
            name.fail(fmt::format("{} is not supported; export without it", name.text()));
        }
    }
}

void GltfFile::read_buffers(const fs::path& path) {
    if (!root_.has("buffers")) {
        return;
    }
    const JsonNode all = root_.member("buffers");
    for (std::size_t k = 0; k < all.size(); ++k) {
        const JsonNode buffer = all.element(k);
        const std::uint64_t length = buffer.member("byteLength").integer(most);
        if (buffer.has("uri")) {
            const JsonNode uri = buffer.member("uri");
            buffers_.push_back(read_buffer(uri, path.parent_path()));
        } else if (k == 0 && has_binary_) {
            buffers_.push_back(std::move(binary_));
        } else {
            buffer.fail("no \"uri\", and it is not the first buffer of a .glb with a BIN chunk");
        }
        if (buffers_.back().size() < length) {
            buffer.fail(
                fmt::format("cut short: {} bytes; byteLength says {}", buffers_.back().size(), length));
        }
        buffers_.back().resize(length);
    }
}

std::string GltfFile::read_buffer(const JsonNode& uri, const fs::path& folder) const {
    const std::string text = uri.text();
    if (text.starts_with("data:")) {
        const std::size_t comma = text.find(',');
        if (comma == std::string::npos || !text.substr(0, comma).ends_with(";base64")) {
            uri.fail("a data URI without \";base64,\"");
        }
        auto bytes = decode_base64(std::string_view(text).substr(comma + 1));
        if (!bytes) {
            uri.fail("the data URI is no base64 text");
        }
        return std::move(*bytes);
    }
    const fs::path name = decode_percent(uri, text);
    if (text.find("://") != std::string::npos) {
        uri.fail(fmt::format("{}; must be a data URI or a file in the scene's folder", in_quotes(text)));
    }
    if (!folder_.allows(folder / name)) {
        uri.fail(SceneFolder::refusal(text));
    }
    try {
        return read_file(folder / name);
    } catch (const InputError& error) {
        uri.fail(error.what());
    }
}

bool GltfFile::uses(std::string_view extension) const {
    for (const char* key : {"extensionsUsed", "extensionsRequired"}) {
        if (root_.has(key)) {
            const std::vector<std::string> names = root_.member(key).texts();
            if (std::find(names.begin(), names.end(), extension) != names.end()) {
                return true;
            }
        }
    }
    return false;
}

/// @param owner            that names a bufferView, and may name a byteOffset in it
/// @param element          bytes
/// @param can_have_stride  whether the bufferView may tell how far elements are apart
GltfAccessor::Elements GltfFile::elements(const JsonNode& owner, std::uint64_t count, std::uint64_t element,
                                          bool can_have_stride) const {
    static const Json none = Json::array();
    const std::uint64_t offset = integer_or(owner, "byteOffset", most, 0);
    const JsonNode views = root_.has("bufferViews") ? root_.member("bufferViews") : JsonNode(none, file_);
    const JsonNode view_reference = owner.member("bufferView");
    const JsonNode view = views.element(index(view_reference, views.size(), "bufferViews"));
    const JsonNode buffer_reference = view.member("buffer");
    const std::string& buffer = buffers_[index(buffer_reference, buffers_.size(), "buffers")];
    const std::uint64_t view_offset = integer_or(view, "byteOffset", most, 0);
    const std::uint64_t view_length = view.member("byteLength").integer(most);
    if (view_offset + view_length > buffer.size()) {
        view.fail(fmt::format("bytes {} to {}; its buffer has {}", view_offset, view_offset + view_length,
                              buffer.size()));
    }
    const std::uint64_t stride = can_have_stride ? integer_or(view, "byteStride", 252, element) : element;
    if (stride < element) {
        view.fail(fmt::format("byteStride {}; must be at least {}, the size of an element", stride, element));
    }
    // Written so that no product overflows, whatever the count.
    if (offset + element > view_length || (count - 1) > (view_length - offset - element) / stride) {
        owner.fail(fmt::format("{} elements of {} bytes from byte {} on, every {} bytes; its bufferView has "
                               "{} bytes",
                               count, element, offset, stride, view_length));
    }
    return {buffer.data() + view_offset + offset, stride};
}

/// @param accessor  index of the accessor, which has `count` elements of `element` bytes
GltfAccessor::Sparse GltfFile::sparse(const JsonNode& node, std::uint64_t accessor, std::uint64_t count,
                                      std::uint64_t element) const {
    node.check_object();
    GltfAccessor::Sparse result;
    const JsonNode number = node.member("count");
    result.count = number.integer(count);
    if (result.count == 0) {
        number.fail("0; must be at least 1");
    }
    const JsonNode indices = node.member("indices");
    const JsonNode type = indices.member("componentType");
    result.index_component = component_of(type);
    if (!is_unsigned(result.index_component)) {
        type.fail("must be unsigned (5121, 5123 or 5125)");
    }
    result.indices = elements(indices, result.count, size_of(result.index_component), false);
    result.values = elements(node.member("values"), result.count, element, false);
    if (!ascending_.contains(accessor)) {
        std::uint64_t least = 0;
        for (std::size_t k = 0; k < result.count; ++k) {
            const std::uint32_t index =
                unsigned_at(result.indices.data + k * result.indices.stride, result.index_component);
            if (index < least || index >= count) {
                indices.fail(fmt::format("index {} is {}; must ascend, and be below {}", k, index, count));
            }
            least = std::uint64_t{index} + 1;
        }
        ascending_.insert(accessor);
    }
    return result;
}

GltfAccessor GltfFile::accessor(const JsonNode& reference) const {
    static const Json none = Json::array();
    const JsonNode accessors = root_.has("accessors") ? root_.member("accessors") : JsonNode(none, file_);
    const std::size_t number = index(reference, accessors.size(), "accessors");
    const JsonNode accessor = accessors.element(number);
    const JsonNode type = accessor.member("componentType");
    const auto component = component_of(type);
    const JsonNode shape = accessor.member("type");
    const std::uint32_t components = components_of(shape);
    const std::uint64_t count = accessor.member("count").integer(most);
    const bool normalized = accessor.has("normalized") && accessor.member("normalized").boolean();
    if (count == 0) {
        accessor.fail("count 0; must be at least 1");
    }
    const std::uint64_t element = std::uint64_t{size_of(component)} * components;
    const bool is_sparse = accessor.has("sparse");
    GltfAccessor::Elements data;
    if (!is_sparse || accessor.has("bufferView")) {
        data = elements(accessor, count, element, true);
    }
    GltfAccessor::Sparse changes;
    if (is_sparse) {
        changes = sparse(accessor.member("sparse"), number, count, element);
    }
    return {data, count, components, component, normalized, changes};
}

std::size_t GltfFile::index(const JsonNode& reference, std::size_t size, std::string_view of) {
    const std::uint64_t value = reference.integer(most);
    if (value >= size) {
        reference.fail(fmt::format("{}; there are {} {}", value, size, of));
    }
    return value;
}

void GltfFile::fail(const std::string& message) const {
    throw InputError(fmt::format("{}: {}", file_, message));
}

} // namespace hemi::io
