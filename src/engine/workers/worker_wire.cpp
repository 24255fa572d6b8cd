#include "engine/workers/worker_wire.hpp"

#include "engine/hemicube/eye.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace hemi {

namespace {

/// What the geometry and a refusal begin with. No later build may change these, nor that the first array of
/// the geometry is worker_build() in characters.
constexpr std::string_view geometry_magic = "HEMIGEOM";
constexpr std::string_view refusal_magic = "HEMIREFU";

/// Of the sizes of all that travels, and what else both sides must agree on. FNV-1a.
constexpr std::uint32_t layout_hash() {
    constexpr std::array<std::size_t, 13> sizes{
        sizeof(ToWorker),        sizeof(FromWorker), sizeof(RowHead),     sizeof(HemicubeSettings),
        sizeof(RowQuantity),     sizeof(Vec3),       sizeof(DrawPolygon), sizeof(OutlineCorner),
        sizeof(EyePoint),        sizeof(double),     result_slots,        FormFactorMatrix::block_rows,
        sizeof(DirectionMeasure)};
    std::uint32_t hash = 2166136261u;
    for (const std::size_t size : sizes) {
        hash = (hash ^ static_cast<std::uint32_t>(size)) * 16777619u;
    }
    return hash;
}

template <typename T>
void append(std::string& bytes, std::span<const T> values) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::uint64_t count = values.size();
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
    bytes.resize((bytes.size() + 7) / 8 * 8);
}

template <typename T>
void append(std::string& bytes, const T& value) {
    append(bytes, std::span(&value, 1));
}

class Unpacker {
public:
    explicit Unpacker(std::span<const std::byte> bytes) : bytes_(bytes) {}

    template <typename T>
    std::vector<T> array() {
        std::uint64_t count = 0;
        copy(&count, sizeof count);
        if (count > (bytes_.size() - at_) / sizeof(T)) {
            throw Error("worker: the geometry is cut off");
        }
        std::vector<T> values(count);
        copy(values.data(), count * sizeof(T));
        at_ = (at_ + 7) / 8 * 8;
        if (at_ > bytes_.size()) {
            throw Error("worker: the geometry is cut off");
        }
        return values;
    }
    template <typename T>
    T value() {
        const auto values = array<T>();
        if (values.size() != 1) {
            throw Error("worker: the geometry is malformed");
        }
        return values[0];
    }

private:
    void copy(void* to, std::size_t count) {
        if (count > bytes_.size() - at_) {
            throw Error("worker: the geometry is cut off");
        }
        if (count > 0) {
            std::memcpy(to, bytes_.data() + at_, count);
        }
        at_ += count;
    }

    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

} // namespace

ResultSlot::ResultSlot(std::uint32_t patches, const HemicubeSettings& settings, RowQuantity quantity)
    : with_visibility_(quantity == RowQuantity::visibility) {
    constexpr std::uint64_t texels_a_chunk = 1u << 19;
    const std::uint64_t texels = std::uint64_t{3} * settings.resolution * settings.resolution;
    const std::uint64_t row_texels = texels * std::max(settings.eye_points, settings.near_eye_points);
    rows_ = static_cast<std::uint32_t>(
        std::clamp<std::uint64_t>(texels_a_chunk / row_texels, 1, FormFactorMatrix::block_rows));
    // Visibility is pooled: patches without a texel of their own have some. Long patches have more eye
    // points.
    const std::uint32_t more = settings.eye_points > 1 ? max_more_eye_points : 1;
    row_entries_ = with_visibility_ ? patches : std::min<std::uint64_t>(patches, more * row_texels);
    constexpr std::size_t page = 4096;
    bytes_ = rows_ * (sizeof(RowHead) +
                      row_entries_ * (sizeof(std::uint32_t) + sizeof(float) + (with_visibility_ ? 1 : 0)));
    bytes_ = (bytes_ + page - 1) / page * page;
}

std::string worker_build() {
    return fmt::format(HEMI_VERSION " (layout {:08x})", layout_hash());
}

void check_same_build(const std::string& program, const std::string& worker) {
    if (program != worker) {
        throw OtherBuild(
            fmt::format("the worker program is of hemi {}, and hemi {} started it; install both from "
                        "one build, or let HEMI_WORKER name the worker program that belongs to "
                        "the library",
                        worker, program));
    }
}

std::string refusal_packet(const OtherBuild& reason) {
    std::string packet(refusal_magic);
    packet += reason.what();
    packet.resize(std::min(packet.size(), sizeof(FromWorker))); // what a program has room for
    return packet;
}

std::optional<std::string> refusal_reason(std::span<const char> packet) {
    const std::string_view text(packet.data(), packet.size());
    if (!text.starts_with(refusal_magic)) {
        return std::nullopt;
    }
    return std::string(text.substr(refusal_magic.size()));
}

std::string pack(const EngineGeometry& geometry, const HemicubeSettings& settings, RowQuantity quantity,
                 const std::string& device) {
    std::string bytes;
    bytes.append(geometry_magic);
    append(bytes, std::span<const char>(worker_build()));
    append(bytes, settings);
    append(bytes, quantity);
    append(bytes, std::span<const char>(device));
    const DrawList& list = geometry.list;
    append(bytes, std::span<const Vec3>(list.vertices));
    append(bytes, std::span<const DrawPolygon>(list.polygons));
    append(bytes, std::span<const OutlineCorner>(list.corners));
    append(bytes, std::span<const std::array<std::uint32_t, 3>>(list.triangles));
    append(bytes, std::span<const std::uint32_t>(list.item_of_id));
    append(bytes, std::span<const PolygonRange>(list.polygons_of_surface));
    append(bytes, list.tolerance);
    append(bytes, std::span<const EyePoint>(geometry.eyes.points));
    append(bytes, std::span<const std::uint32_t>(geometry.eyes.first));
    append(bytes, geometry.patches);
    append(bytes, geometry.measure);
    return bytes;
}

UnpackedGeometry unpack(std::span<const std::byte> bytes) {
    if (bytes.size() < geometry_magic.size() ||
        std::memcmp(bytes.data(), geometry_magic.data(), geometry_magic.size()) != 0) {
        throw OtherBuild(
            fmt::format("the worker program is of hemi {}, and another version of hemi started it; "
                        "install both from one build",
                        worker_build()));
    }
    Unpacker from(bytes.subspan(geometry_magic.size()));
    const auto program = from.array<char>();
    check_same_build({program.begin(), program.end()}, worker_build());
    UnpackedGeometry result;
    result.settings = from.value<HemicubeSettings>();
    result.quantity = from.value<RowQuantity>();
    const auto device = from.array<char>();
    result.device.assign(device.begin(), device.end());
    DrawList& list = result.geometry.list;
    list.vertices = from.array<Vec3>();
    list.polygons = from.array<DrawPolygon>();
    list.corners = from.array<OutlineCorner>();
    list.triangles = from.array<std::array<std::uint32_t, 3>>();
    list.item_of_id = from.array<std::uint32_t>();
    list.polygons_of_surface = from.array<PolygonRange>();
    list.tolerance = from.value<double>();
    result.geometry.eyes.points = from.array<EyePoint>();
    result.geometry.eyes.first = from.array<std::uint32_t>();
    result.geometry.patches = from.value<std::uint32_t>();
    result.geometry.measure = from.value<DirectionMeasure>();
    return result;
}

} // namespace hemi
