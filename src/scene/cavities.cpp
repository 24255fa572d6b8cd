#include "scene/cavities.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>

namespace hemi {

namespace {

bool is_left(std::span<const CutFace> faces, const PieceSide& side) {
    const Piece& piece = faces[side.face].pieces[side.piece];
    return side.back ? piece.back : piece.front;
}

std::vector<PieceSide> once_each(std::vector<PieceSide> sides) {
    std::sort(sides.begin(), sides.end());
    sides.erase(std::unique(sides.begin(), sides.end()), sides.end());
    return sides;
}

/// Which sides see which, as a graph: nodes are indices of `sides`.
class Sights {
public:
    Sights(std::span<const EnclosedSide> sides, std::span<const CutFace> faces)
        : closed_(sides.size(), true), beside_(sides.size()) {
        for (std::uint32_t k = 0; k < sides.size(); ++k) {
            index_.emplace(sides[k].side, k);
        }
        std::vector<std::vector<std::uint32_t>> seen_by(sides.size());
        std::vector<std::uint32_t> open;
        for (std::uint32_t k = 0; k < sides.size(); ++k) {
            for (const PieceSide& seen : once_each(sides[k].sight.sides)) {
                if (!is_left(faces, seen)) {
                    continue; // no longer
                }
                const auto at = index_.find(seen);
                if (at != index_.end()) {
                    seen_by[at->second].push_back(k);
                    beside_[k].push_back(at->second);
                    beside_[at->second].push_back(k);
                } else if (closed_[k]) {
                    closed_[k] = false;
                    open.push_back(k);
                }
            }
        }
        while (!open.empty()) { // what sees an open side is open
            const std::uint32_t at = open.back();
            open.pop_back();
            for (const std::uint32_t k : seen_by[at]) {
                if (closed_[k]) {
                    closed_[k] = false;
                    open.push_back(k);
                }
            }
        }
    }

    [[nodiscard]] bool is_closed(const PieceSide& side) const {
        const auto at = index_.find(side);
        return at != index_.end() && closed_[at->second];
    }

    /// Closed sides that see one another.
    [[nodiscard]] std::vector<std::vector<std::uint32_t>> cavities() const {
        std::vector<std::vector<std::uint32_t>> result;
        std::vector<bool> taken(closed_.size(), false);
        for (std::uint32_t first = 0; first < closed_.size(); ++first) {
            if (!closed_[first] || taken[first]) {
                continue;
            }
            std::vector<std::uint32_t>& cavity = result.emplace_back(1, first);
            taken[first] = true;
            for (std::size_t at = 0; at < cavity.size(); ++at) {
                for (const std::uint32_t k : beside_[cavity[at]]) {
                    if (closed_[k] && !taken[k]) {
                        taken[k] = true;
                        cavity.push_back(k);
                    }
                }
            }
        }
        return result;
    }

private:
    std::map<PieceSide, std::uint32_t> index_;
    std::vector<bool> closed_; ///< sees backs and closed sides alone
    std::vector<std::vector<std::uint32_t>> beside_;
};

/// Faces with sides that may be in closed cavities, and with pieces that have none there.
std::set<std::uint32_t> reaching_out(std::span<const EnclosedSide> sides, std::span<const CutFace> faces,
                                     const Sights& sights) {
    std::set<std::uint32_t> result;
    std::set<std::uint32_t> looked_at;
    for (const EnclosedSide& one : sides) {
        const std::uint32_t face = one.side.face;
        if (!looked_at.insert(face).second) {
            continue;
        }
        for (std::uint32_t k = 0; k < faces[face].pieces.size(); ++k) {
            const Piece& piece = faces[face].pieces[k];
            if (piece.is_left() && !sights.is_closed({face, k, false}) &&
                !sights.is_closed({face, k, true})) {
                result.insert(face);
                break;
            }
        }
    }
    return result;
}

} // namespace

std::vector<PieceSide> sides_in_bodies(std::span<const EnclosedSide> sides, std::span<const CutFace> faces) {
    const Sights sights(sides, faces);
    const std::set<std::uint32_t> outside = reaching_out(sides, faces, sights);
    std::vector<PieceSide> result;
    for (const std::vector<std::uint32_t>& cavity : sights.cavities()) {
        double all = 0.0;
        double inside = 0.0;
        double backs = 0.0;
        double passing = 0.0;
        for (const std::uint32_t k : cavity) {
            const EnclosedSide& one = sides[k];
            const auto count =
                std::count_if(one.sight.sides.begin(), one.sight.sides.end(),
                              [&](const PieceSide& seen) { return outside.contains(seen.face); });
            all += one.area * one.sight.directions();
            inside += one.area * one.sight.inside;
            backs += one.area * one.sight.backs;
            passing += one.area * static_cast<double>(count);
        }
        const bool lets_light_go = backs >= 0.125 * (all - passing) || backs + passing >= 0.5 * all;
        if (inside >= 0.4 * all && lets_light_go) {
            for (const std::uint32_t k : cavity) {
                result.push_back(sides[k].side);
            }
        }
    }
    return result;
}

} // namespace hemi
