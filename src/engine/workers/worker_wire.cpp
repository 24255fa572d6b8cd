#include "engine/workers/worker_wire.hpp"

#include "hemi/core/error.hpp"

#include <algorithm>
#include <vector>

namespace hemi {

namespace {

// "HEMI", and the sizes of what travels, so that another build is noticed.
constexpr std::uint64_t magic = 0x494D4548u | (std::uint64_t{sizeof(DrawPolygon)} << 32) |
                                (std::uint64_t{sizeof(EyePoint)} << 44) |
                                (std::uint64_t{sizeof(FromWorker)} << 52);

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
    // Visibility is pooled: patches without a texel of their own have some.
    row_entries_ = with_visibility_ ? patches : std::min<std::uint64_t>(patches, row_texels);
    constexpr std::size_t page = 4096;
    bytes_ = rows_ * (sizeof(RowHead) +
                      row_entries_ * (sizeof(std::uint32_t) + sizeof(float) + (with_visibility_ ? 1 : 0)));
    bytes_ = (bytes_ + page - 1) / page * page;
}

std::string pack(const EngineGeometry& geometry, const HemicubeSettings& settings, RowQuantity quantity,
                 const std::string& device) {
    std::string bytes;
    append(bytes, magic);
    append(bytes, settings);
    append(bytes, quantity);
    append(bytes, std::span<const char>(device));
    const DrawList& list = geometry.list;
    append(bytes, std::span<const Vec3>(list.vertices));
    append(bytes, std::span<const DrawPolygon>(list.polygons));
    append(bytes, std::span<const OutlineCorner>(list.corners));
    append(bytes, std::span<const std::array<std::uint32_t, 3>>(list.triangles));
    append(bytes, std::span<const std::uint32_t>(list.item_of_id));
    append(bytes, std::span<const std::uint32_t>(list.polygon_of_surface));
    append(bytes, list.tolerance);
    append(bytes, std::span<const EyePoint>(geometry.eyes.points));
    append(bytes, std::span<const std::uint32_t>(geometry.eyes.first));
    return bytes;
}

UnpackedGeometry unpack(std::span<const std::byte> bytes) {
    Unpacker from(bytes);
    if (from.value<std::uint64_t>() != magic) {
        throw Error("worker: the geometry is of another version of the program");
    }
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
    list.polygon_of_surface = from.array<std::uint32_t>();
    list.tolerance = from.value<double>();
    result.geometry.eyes.points = from.array<EyePoint>();
    result.geometry.eyes.first = from.array<std::uint32_t>();
    return result;
}

} // namespace hemi
