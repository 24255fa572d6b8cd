#pragma once

#include "engine/hemicube/gl_rows.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <type_traits>

namespace hemi {

// What a program and its workers say to each other. Both must be of the same build, which the worker checks,
// and are on the same machine, so structures travel as they lie in memory. Items and draw ids: see
// draw_list.hpp.
//
// A worker finds three descriptors: a packet socket, the geometry (read-only), and its result buffer. The
// program sends jobs; the worker answers each with one or more chunks of rows, in order, which lie in one of
// the two slots of the result buffer until the program releases the slot.

inline constexpr int worker_socket_fd = 3;
inline constexpr int worker_geometry_fd = 4;
inline constexpr int worker_results_fd = 5;
inline constexpr std::uint32_t result_slots = 2;

struct ToWorker {
    enum class Kind : std::uint32_t { job, release };
    Kind kind = Kind::job;
    std::uint32_t count = 0; ///< job: patches; release: the slot
    std::array<std::uint32_t, FormFactorMatrix::block_rows> patches{};
};

struct FromWorker {
    enum class Kind : std::uint32_t { ready, chunk, failed };
    Kind kind = Kind::ready;
    std::uint32_t slot = 0;
    std::uint32_t rows = 0;
    std::uint32_t job_done = 0;    ///< 1 with the last chunk of a job
    std::uint32_t software = 0;    ///< ready: whether the context rasterises on the CPU
    std::uint32_t no_device = 0;   ///< failed: whether it is for lack of a device
    std::array<char, 1024> text{}; ///< ready: the renderer; failed: the message

    void set_text(const std::string& message) { std::strncpy(text.data(), message.c_str(), text.size() - 1); }
};
static_assert(std::is_trivially_copyable_v<ToWorker> && std::is_trivially_copyable_v<FromWorker>);

/// Head of one row in a result slot.
struct RowHead {
    std::uint32_t patch;
    std::uint32_t entries;
    double environment;
    double blocked;
};

/// Where things lie in a result slot.
class ResultSlot {
public:
    ResultSlot(std::uint32_t patches, const HemicubeSettings& settings, RowQuantity quantity);

    /// Most rows in a chunk: few enough that a chunk takes a fraction of a second.
    [[nodiscard]] std::uint32_t rows() const noexcept { return rows_; }
    [[nodiscard]] std::size_t bytes() const noexcept { return bytes_; }
    [[nodiscard]] RowHead* heads(std::byte* buffer, std::uint32_t slot) const {
        return reinterpret_cast<RowHead*>(buffer + slot * bytes_);
    }
    [[nodiscard]] std::uint32_t* columns(std::byte* buffer, std::uint32_t slot) const {
        return reinterpret_cast<std::uint32_t*>(buffer + slot * bytes_ + rows_ * sizeof(RowHead));
    }
    [[nodiscard]] float* values(std::byte* buffer, std::uint32_t slot) const {
        return reinterpret_cast<float*>(columns(buffer, slot) + rows_ * row_entries_);
    }
    /// Null where rows have none.
    [[nodiscard]] std::uint8_t* visibility(std::byte* buffer, std::uint32_t slot) const {
        return with_visibility_ ? reinterpret_cast<std::uint8_t*>(values(buffer, slot) + rows_ * row_entries_)
                                : nullptr;
    }

private:
    std::uint32_t rows_;
    std::size_t row_entries_; ///< most entries of a row
    bool with_visibility_;
    std::size_t bytes_;
};

/// Version of this library and a hash of the layout of all that travels: what must be equal in a program and
/// its workers.
[[nodiscard]] std::string worker_build();

/// A program and a worker are of different builds.
class OtherBuild : public Error {
public:
    using Error::Error;
};
/// @param program,worker  worker_build() of each
/// @throws OtherBuild that names both if they differ
void check_same_build(const std::string& program, const std::string& worker);

/// The packet by which a worker refuses a program of another build. Not a FromWorker, whose layout may be
/// what differs: eight letters and the reason. No later build may change it.
[[nodiscard]] std::string refusal_packet(const OtherBuild& reason);
/// The reason, if the packet is a refusal.
[[nodiscard]] std::optional<std::string> refusal_reason(std::span<const char> packet);

/// Geometry and settings as bytes, and back. `device` is what the worker opens.
[[nodiscard]] std::string pack(const EngineGeometry& geometry, const HemicubeSettings& settings,
                               RowQuantity quantity, const std::string& device);
struct UnpackedGeometry {
    EngineGeometry geometry;
    HemicubeSettings settings;
    RowQuantity quantity = RowQuantity::form_factors;
    std::string device;
};
/// @throws OtherBuild if another build made the bytes; Error if they are not what pack() made.
[[nodiscard]] UnpackedGeometry unpack(std::span<const std::byte> bytes);

} // namespace hemi
