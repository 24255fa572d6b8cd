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
    begins_.clear();
    sums_.assign(parts_.size(), {});
    strata_.clear();
    buckets_.clear();
    const std::span<const SourceClusters::Node> nodes = tree_.clusters()->nodes();
    for (std::size_t part = 0; part < parts_.size(); ++part) {
        begins_.push_back(nodes[parts_[part].node].begin);
        sums_[part].first_stratum = static_cast<std::uint32_t>(strata_.size());
        while (std::size_t{positions_a_bucket} * buckets_.size() < nodes[parts_[part].node].end) {
            buckets_.push_back(static_cast<std::uint32_t>(part));
        }
        if (parts_[part].far && !parts_[part].away) {
            const ClusterStrata strata = tree_.strata(parts_[part].node);
            sums_[part].strata = strata.count;
            for (const std::uint32_t node : std::span(strata.nodes).first(strata.count)) {
                strata_.push_back({.node = node, .begin = nodes[node].begin});
            }
        }
    }
}

void SourceSums::finish() {
    const double mean = known_ == 0 ? 1.0 : shares_ / static_cast<double>(known_);
    for (std::uint32_t part = 0; part < parts_.size(); ++part) {
        if (parts_[part].away) {
            continue;
        }
        if (parts_[part].far) {
            add_far(part, mean);
        } else if (sums_[part].known == 0) {
            const std::uint32_t patch = tree_.clusters()->order()[begins_[part]];
            if (patch != receiver_.patch && may_face_part(part)) {
                add_near(patch, {mean, 0.0, false});
            }
        }
    }
    const auto by_column = [](const Source& a, const Source& b) { return a.column < b.column; };
    std::sort(near_.begin(), near_.end(), by_column);
    std::sort(far_.begin(), far_.end(), by_column);
}

/// The part that holds a position in the tree.
std::uint32_t SourceSums::part_at(std::uint32_t position) const {
    const std::size_t bucket = position / positions_a_bucket;
    const auto first = begins_.begin() + buckets_[bucket];
    const auto last =
        bucket + 1 < buckets_.size() ? begins_.begin() + buckets_[bucket + 1] + 1 : begins_.end();
    return static_cast<std::uint32_t>(std::upper_bound(first, last, position) - begins_.begin()) - 1;
}

/// The stratum of a far part that holds a position.
std::uint32_t SourceSums::stratum_at(std::uint32_t part, std::uint32_t position) const {
    const Sum& sum = sums_[part];
    std::uint32_t stratum = sum.first_stratum + sum.strata - 1;
    while (strata_[stratum].begin > position) {
        --stratum;
    }
    return stratum;
}

void SourceSums::add_patch(std::uint32_t patch, SeenShare share) {
    const std::uint32_t position = tree_.position(patch);
    const std::uint32_t part = part_at(position);
    if (parts_[part].away) {
        return;
    }
    Sum& sum = sums_[part];
    ++sum.known;
    sum.shares += share.value;
    shares_ += share.value;
    ++known_;
    hides_ = hides_ || !(share.value > 0.0);
    if (parts_[part].far) {
        add_to_strata(part, position, position, mesh_.areas()[patch], share);
    } else {
        add_near(patch, share);
    }
}

/// Part by part: those of a far one together.
void SourceSums::add_set(const SetPlaces& places, std::uint32_t set, SeenShare share) {
    const std::span<const std::uint32_t> positions = places.of(set);
    for (std::size_t begin = 0; begin < positions.size();) {
        const std::uint32_t part = part_at(positions[begin]);
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
        Sum& sum = sums_[part];
        const auto count = static_cast<double>(end - begin);
        sum.known += static_cast<std::uint32_t>(end - begin);
        sum.shares += count * share.value;
        if (may_face_part(part)) { // of what is hidden, backs are told, too
            shares_ += count * share.value;
            known_ += end - begin;
            hides_ = hides_ || !(share.value > 0.0);
        }
        if (parts_[part].far) {
            add_to_strata(part, positions[begin], positions[end - 1], places.area(set, begin, end), share);
        } else {
            add_near(tree_.clusters()->order()[positions[begin]], share);
        }
        begin = end;
    }
}

/// Patches of a far part, spread evenly over the strata from that of the first to that of the last one.
void SourceSums::add_to_strata(std::uint32_t part, std::uint32_t low, std::uint32_t high, double area,
                               SeenShare share) {
    const std::uint32_t first = stratum_at(part, low);
    const std::uint32_t last = low == high ? first : stratum_at(part, high);
    area /= last - first + 1;
    for (std::uint32_t k = first; k <= last; ++k) {
        Stratum& stratum = strata_[k];
        stratum.known += area;
        if (share.value > 0.0) {
            stratum.seen += area;
            stratum.lit += area * share.value;
        }
    }
    sums_[part].clear = sums_[part].clear && (share.clear || !(share.value > 0.0));
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
double SourceSums::factor_of_area(std::uint32_t part, const Stratum& stratum) const {
    const ClusterMoments& own = tree_.moments(stratum.node);
    const SourceClusters::Node& node = tree_.clusters()->nodes()[stratum.node];
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
    const std::uint32_t first = tree_.clusters()->order()[node.begin];
    return factor_to(first) / mesh_.areas()[first];
}

/// @param mean  visibility of all patches that the row tells of
void SourceSums::add_far(std::uint32_t part, double mean) {
    const std::uint32_t k = parts_[part].node;
    const SourceClusters::Node& node = tree_.clusters()->nodes()[k];
    const Sum& sum = sums_[part];
    const std::uint32_t count = node.end - node.begin;
    const double share = sum.known == 0      ? (may_face_part(part) ? mean : 0.0)
                         : sum.known < count ? sum.shares / sum.known
                                             : 0.0;
    if (!(sum.shares > 0.0) && !(share > 0.0)) {
        return; // all of it is hidden, or looks away
    }
    double factor = 0.0;
    double unoccluded = 0.0;
    for (std::uint32_t s = 0; s < sum.strata; ++s) {
        const Stratum& stratum = strata_[sum.first_stratum + s];
        const double left = std::max(0.0, tree_.moments(stratum.node).area - stratum.known);
        const double lit = stratum.lit + (sum.known < count ? left * share : 0.0);
        if (!(lit > 0.0)) {
            continue;
        }
        const double of_area = factor_of_area(part, stratum);
        factor += of_area * lit;
        unoccluded += of_area * (stratum.seen + (share > 0.0 ? left : 0.0));
    }
    if (factor > 0.0) {
        const bool clear = sum.clear && sum.known == count;
        far_.push_back({mesh_.size() + k, unoccluded, factor / unoccluded, 0.0, clear});
    }
}

/// Whether some patch of a part may have its front towards this one's.
bool SourceSums::may_face_part(std::uint32_t part) {
    Sum& sum = sums_[part];
    if (!sum.asked) {
        sum.asked = true;
        sum.may_face =
            may_face(tree_.shape(parts_[part].node), receiver_.at, receiver_.normal, receiver_.radius);
    }
    return sum.may_face;
}

} // namespace hemi
