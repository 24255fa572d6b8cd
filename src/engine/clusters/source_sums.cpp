#include "engine/clusters/source_sums.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hemi {

SetPlaces::SetPlaces(const PatchSets& sets, const ClusterTree& tree, const PatchMesh& mesh) {
    first_.reserve(std::size_t{sets.size()} + 1);
    first_.push_back(0);
    const auto add = [&](std::uint32_t set) {
        for (const std::uint32_t patch : sets.patches_of(set)) {
            positions_.push_back(tree.position(patch));
        }
    };
    for (std::uint32_t set = 0; set < sets.size(); ++set) {
        add(set);
        for (const std::uint32_t member : sets.members_of(set)) {
            add(member);
        }
        std::sort(positions_.begin() + static_cast<std::ptrdiff_t>(first_.back()), positions_.end());
        double area = 0.0;
        area_before_.push_back(area);
        for (std::size_t k = first_.back(); k < positions_.size(); ++k) {
            area += mesh.areas()[tree.clusters()->order()[positions_[k]]];
            area_before_.push_back(area);
        }
        first_.push_back(positions_.size());
    }
}

void SourceSums::SlotsOfPositions::clear(std::uint32_t positions) {
    blocks_.resize((positions + block - 1) / block);
    mixed_count_ = 0;
    end_ = 0;
}

void SourceSums::SlotsOfPositions::add(std::uint32_t slot, std::uint32_t end) {
    while (end_ < end) {
        const std::uint32_t within = end_ % block;
        if (within == 0 && end - end_ >= block) {
            blocks_[end_ / block] = slot;
            end_ += block;
            continue;
        }
        if (within == 0) {
            blocks_[end_ / block] = mixed_count_ | is_mixed;
            mixed_.resize(std::max<std::size_t>(mixed_.size(), mixed_count_ + block));
        }
        const std::uint32_t count = std::min(end - end_, block - within);
        std::fill_n(&mixed_[mixed_count_], count, slot);
        mixed_count_ += count;
        end_ += count;
    }
}

void SourceSums::start(const RowReceiver& receiver, std::span<const ClusterTree::Part> parts,
                       bool hidden_near) {
    receiver_ = receiver;
    hidden_near_ = hidden_near;
    shares_ = 0.0;
    known_ = 0;
    hides_ = false;
    near_.clear();
    far_.clear();
    parts_.assign(parts.begin(), parts.end());
    part_slots_.clear();
    slots_.clear();
    slot_at_.clear(mesh_.size());
    const std::span<const SourceClusters::Node> nodes = tree_.clusters()->nodes();
    for (std::uint32_t part = 0; part < parts_.size(); ++part) {
        ClusterStrata strata{{parts_[part].node}, 1};
        if (parts_[part].far && !parts_[part].away) {
            strata = tree_.strata(parts_[part].node);
        }
        part_slots_.push_back({.first = static_cast<std::uint32_t>(slots_.size()), .count = strata.count});
        for (const std::uint32_t node : std::span(strata.nodes).first(strata.count)) {
            slot_at_.add(static_cast<std::uint32_t>(slots_.size()), nodes[node].end);
            slots_.push_back({.part = part, .node = node});
        }
    }
}

void SourceSums::finish() {
    const std::span<const SourceClusters::Node> nodes = tree_.clusters()->nodes();
    const double mean = known_ == 0 ? 1.0 : shares_ / static_cast<double>(known_);
    for (std::uint32_t part = 0; part < parts_.size(); ++part) {
        if (parts_[part].away) {
            continue;
        }
        if (parts_[part].far) {
            add_far(part, mean);
        } else if (slots_[part_slots_[part].first].known == 0) {
            const std::uint32_t patch = tree_.clusters()->order()[nodes[parts_[part].node].begin];
            if (patch != receiver_.patch && may_face_part(part)) {
                add_near(patch, {mean, 0.0, false});
            }
        }
    }
    const auto by_column = [](const Source& a, const Source& b) { return a.column < b.column; };
    std::sort(near_.begin(), near_.end(), by_column);
    std::sort(far_.begin(), far_.end(), by_column);
}

void SourceSums::add_patch(std::uint32_t patch, SeenShare share) {
    const std::uint32_t k = slot_at_[tree_.position(patch)];
    Slot& slot = slots_[k];
    const ClusterTree::Part& part = parts_[slot.part];
    if (part.away) {
        return;
    }
    ++slot.known;
    slot.shares += share.value;
    shares_ += share.value;
    ++known_;
    hides_ = hides_ || !(share.value > 0.0);
    if (part.far) {
        add_to_strata(k, k, mesh_.areas()[patch], share);
    } else {
        add_near(patch, share);
    }
}

/// Part by part: those of a far one together.
void SourceSums::add_set(const SetPlaces& places, std::uint32_t set, SeenShare share) {
    const std::span<const std::uint32_t> positions = places.of(set);
    for (std::size_t begin = 0; begin < positions.size();) {
        const std::uint32_t first = slot_at_[positions[begin]];
        const std::uint32_t part = slots_[first].part;
        const std::uint32_t part_end = tree_.clusters()->nodes()[parts_[part].node].end;
        const std::size_t end =
            positions.back() < part_end
                ? positions.size()
                : static_cast<std::size_t>(
                      std::lower_bound(positions.begin() + static_cast<std::ptrdiff_t>(begin),
                                       positions.end(), part_end) -
                      positions.begin());
        if (parts_[part].away) {
            begin = end;
            continue;
        }
        const auto count = static_cast<double>(end - begin);
        slots_[first].known += static_cast<std::uint32_t>(end - begin);
        slots_[first].shares += count * share.value;
        if (may_face_part(part)) { // of what is hidden, backs are told, too
            shares_ += count * share.value;
            known_ += end - begin;
            hides_ = hides_ || !(share.value > 0.0);
        }
        if (parts_[part].far) {
            add_to_strata(first, slot_at_[positions[end - 1]], places.area(set, begin, end), share);
        } else {
            add_near(tree_.clusters()->order()[positions[begin]], share);
        }
        begin = end;
    }
}

/// Patches of a far part, spread evenly over the strata from that of the first to that of the last one.
void SourceSums::add_to_strata(std::uint32_t first, std::uint32_t last, double area, SeenShare share) {
    area /= last - first + 1;
    for (std::uint32_t k = first; k <= last; ++k) {
        Slot& slot = slots_[k];
        slot.area += area;
        if (share.value > 0.0) {
            slot.seen += area;
            slot.lit += area * share.value;
            slot.clear = slot.clear && share.clear;
        }
    }
}

void SourceSums::add_near(std::uint32_t patch, SeenShare share) {
    if (!(share.value > 0.0) && !hidden_near_) {
        return;
    }
    if (const double unoccluded = factor_to(patch); unoccluded > 0.0) {
        near_.push_back({patch, unoccluded, share.value, share.texels, share.clear});
    }
}

/// Unoccluded factor from the receiver to a patch.
double SourceSums::factor_to(std::uint32_t patch) const {
    if (receiver_.patch) {
        return exchange_(*receiver_.patch, patch) / receiver_.area;
    }
    return receiver_.normal ? exchange_.at_point(receiver_.at, *receiver_.normal, patch)
                            : exchange_.solid_angle_at(receiver_.at, patch) / (4.0 * std::numbers::pi);
}

/// Unoccluded factor from the receiver to a small area, over this area.
double SourceSums::factor_of_point(const Vec3& at, const Vec3& normal) const {
    if (receiver_.patch) {
        return exchange_.at_point(at, normal, *receiver_.patch) / receiver_.area;
    }
    const Vec3 way = receiver_.at - at;
    const double squared = glm::dot(way, way);
    const double leaving = glm::dot(way, normal);
    const double arriving = receiver_.normal ? -glm::dot(way, *receiver_.normal) : 0.25 * std::sqrt(squared);
    return leaving > 0.0 && arriving > 0.0 ? leaving * arriving / (std::numbers::pi * squared * squared)
                                           : 0.0;
}

/// Unoccluded factor from the receiver to a stratum over the area of the stratum.
double SourceSums::factor_of_area(std::uint32_t part, std::uint32_t node) const {
    const ClusterMoments& own = tree_.moments(node);
    if (tree_.clusters()->nodes()[parts_[part].node].child != 0) {
        const ClusterMoments& whole = tree_.moments(parts_[part].node);
        const double projected = glm::length(own.normals);
        const double seen = factor_of_point(whole.centre + whole.spread * (own.centre - whole.centre),
                                            own.normals / projected);
        if (seen > 0.0) {
            return seen * projected / own.area;
        }
    }
    // A single patch, or one of several that together look away.
    const std::uint32_t first = tree_.clusters()->order()[tree_.clusters()->nodes()[node].begin];
    return factor_to(first) / mesh_.areas()[first];
}

/// @param mean  visibility of all patches that the row tells of
void SourceSums::add_far(std::uint32_t part, double mean) {
    const std::uint32_t k = parts_[part].node;
    const SourceClusters::Node& node = tree_.clusters()->nodes()[k];
    const auto strata =
        std::span<const Slot>(slots_).subspan(part_slots_[part].first, part_slots_[part].count);
    std::uint32_t known = 0;
    double shares = 0.0;
    bool clear = true;
    for (const Slot& stratum : strata) {
        known += stratum.known;
        shares += stratum.shares;
        clear = clear && stratum.clear;
    }
    const std::uint32_t count = node.end - node.begin;
    const double share = known == 0      ? (may_face_part(part) ? mean : 0.0)
                         : known < count ? shares / known
                                         : 0.0;
    if (!(shares > 0.0) && !(share > 0.0)) {
        return; // all of it is hidden, or looks away
    }
    double factor = 0.0;
    double unoccluded = 0.0;
    for (const Slot& stratum : strata) {
        const double left = std::max(0.0, tree_.moments(stratum.node).area - stratum.area);
        const double lit = stratum.lit + (known < count ? left * share : 0.0);
        if (!(lit > 0.0)) {
            continue;
        }
        const double of_area = factor_of_area(part, stratum.node);
        factor += of_area * lit;
        unoccluded += of_area * (stratum.seen + (share > 0.0 ? left : 0.0));
    }
    if (factor > 0.0) {
        far_.push_back({mesh_.size() + k, unoccluded, factor / unoccluded, 0.0, clear && known == count});
    }
}

/// Whether some patch of a part may have its front towards the receiver.
bool SourceSums::may_face_part(std::uint32_t part) {
    if (!receiver_.patch) {
        return true; // of a point, all else is away
    }
    PartSlots& slots = part_slots_[part];
    if (!slots.asked) {
        slots.asked = true;
        slots.may_face =
            may_face(tree_.shape(parts_[part].node), receiver_.at, receiver_.normal, receiver_.radius);
    }
    return slots.may_face;
}

} // namespace hemi
