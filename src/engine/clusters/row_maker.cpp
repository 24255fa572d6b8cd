#include "engine/clusters/row_maker.hpp"

#include "engine/visibility_weighted/pair_visibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace hemi {

namespace {

std::uint8_t code_of(double visibility, bool clear) {
    return clear ? PairVisibility::clear().stored() : PairVisibility::from(visibility).stored();
}

} // namespace

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

ClusteredRow RowMaker::make(const SeenRow& seen, const SetPlaces* places) {
    places_ = places;
    stand_at(seen.patch);
    for (std::size_t k = 0; k < seen.columns.size(); ++k) {
        add_patch(seen.columns[k], {static_cast<double>(seen.shares[k]), seen.texels[k] == visibility_clear});
    }
    for (const JointVisibility& joint : seen.joint) {
        add_set(joint.set, {static_cast<double>(joint.share), joint.texels == visibility_clear});
    }
    const double mean = known_ == 0 ? 1.0 : shares_ / static_cast<double>(known_);
    for (std::uint32_t part = 0; part < parts_.size(); ++part) {
        if (parts_[part].far) {
            add_far(part, mean);
        } else if (sums_[part].known == 0) {
            const std::uint32_t patch = tree_.clusters()->order()[begins_[part]];
            if (patch != patch_ && may_face_part(part)) {
                add_near(patch, {mean, false});
            }
        }
    }
    const auto by_column = [](const ClusterEntry& a, const ClusterEntry& b) { return a.column < b.column; };
    std::sort(near_.begin(), near_.end(), by_column);
    std::sort(far_.begin(), far_.end(), by_column);
    return {EntryList(near_), EntryList(far_), seen.environment, seen.blocked, hides_};
}

void RowMaker::stand_at(std::uint32_t patch) {
    patch_ = patch;
    area_ = mesh_.areas()[patch];
    shares_ = 0.0;
    known_ = 0;
    hides_ = false;
    near_.clear();
    far_.clear();
    tree_.seen_from(patch, opening_, parts_);
    begins_.clear();
    sums_.assign(parts_.size(), {});
    strata_.clear();
    for (std::size_t part = 0; part < parts_.size(); ++part) {
        begins_.push_back(tree_.clusters()->nodes()[parts_[part].node].begin);
        sums_[part].first_stratum = static_cast<std::uint32_t>(strata_.size());
        if (parts_[part].far) {
            add_strata(parts_[part].node, 0);
        }
        sums_[part].strata = static_cast<std::uint32_t>(strata_.size()) - sums_[part].first_stratum;
    }
}

void RowMaker::add_strata(std::uint32_t node, std::uint32_t depth) {
    const SourceClusters::Node& here = tree_.clusters()->nodes()[node];
    if (depth == strata_depth || here.child == 0) {
        strata_.push_back({.node = node, .begin = here.begin});
        return;
    }
    add_strata(here.child, depth + 1);
    add_strata(here.child + 1, depth + 1);
}

/// The part that holds a position in the tree.
/// @param not_before  a part before which it is not
std::uint32_t RowMaker::part_at(std::uint32_t position, std::uint32_t not_before) const {
    const auto after = std::upper_bound(begins_.begin() + not_before, begins_.end(), position);
    return static_cast<std::uint32_t>(after - begins_.begin()) - 1;
}

/// The stratum of a far part that holds a position.
std::uint32_t RowMaker::stratum_at(std::uint32_t part, std::uint32_t position) const {
    const Sum& sum = sums_[part];
    std::uint32_t stratum = sum.first_stratum + sum.strata - 1;
    while (strata_[stratum].begin > position) {
        --stratum;
    }
    return stratum;
}

void RowMaker::add_patch(std::uint32_t patch, Share share) {
    const std::uint32_t position = tree_.position(patch);
    const std::uint32_t part = part_at(position);
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
void RowMaker::add_set(std::uint32_t set, Share share) {
    const std::span<const std::uint32_t> positions = places_->of(set);
    std::uint32_t part = 0;
    for (std::size_t begin = 0; begin < positions.size();) {
        part = part_at(positions[begin], part);
        const std::uint32_t part_end = tree_.clusters()->nodes()[parts_[part].node].end;
        const std::size_t end =
            positions.back() < part_end
                ? positions.size()
                : static_cast<std::size_t>(
                      std::lower_bound(positions.begin() + static_cast<std::ptrdiff_t>(begin),
                                       positions.end(), part_end) -
                      positions.begin());
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
            add_to_strata(part, positions[begin], positions[end - 1], places_->area(set, begin, end), share);
        } else {
            add_near(tree_.clusters()->order()[positions[begin]], share);
        }
        begin = end;
    }
}

/// Patches of a far part, spread evenly over the strata from that of the first to that of the last one.
void RowMaker::add_to_strata(std::uint32_t part, std::uint32_t low, std::uint32_t high, double area,
                             Share share) {
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

void RowMaker::add_near(std::uint32_t patch, Share share) {
    if (!(share.value > 0.0)) {
        return;
    }
    const double unoccluded = exchange_(patch_, patch) / area_;
    if (unoccluded > 0.0) {
        near_.push_back(
            {patch, static_cast<float>(unoccluded * share.value), code_of(share.value, share.clear)});
    }
}

/// By how much points of strata are farther from the middle of their cluster than the strata's middles, so
/// that they have the second moment of its area.
double RowMaker::spread(std::uint32_t part) const {
    const Sum& sum = sums_[part];
    const ClusterMoments& whole = tree_.moments(parts_[part].node);
    double of_middles = 0.0;
    for (std::uint32_t k = sum.first_stratum; k < sum.first_stratum + sum.strata; ++k) {
        const ClusterMoments& own = tree_.moments(strata_[k].node);
        const Vec3 offset = own.centre - whole.centre;
        of_middles += own.area * glm::dot(offset, offset);
    }
    return of_middles > 0.0 ? std::sqrt(whole.second / of_middles) : 1.0;
}

/// Unoccluded factor from the receiver to a stratum over the area of the stratum.
double RowMaker::factor_of_area(std::uint32_t part, const Stratum& stratum, double spread) const {
    const ClusterMoments& own = tree_.moments(stratum.node);
    const SourceClusters::Node& node = tree_.clusters()->nodes()[stratum.node];
    if (node.child != 0) {
        const Vec3& middle = tree_.moments(parts_[part].node).centre;
        const double projected = glm::length(own.normals);
        const double seen =
            exchange_.at_point(middle + spread * (own.centre - middle), own.normals / projected, patch_);
        if (seen > 0.0) {
            return seen * projected / (own.area * area_);
        }
    }
    // A single patch, or one of several that together look away.
    const std::uint32_t first = tree_.clusters()->order()[node.begin];
    return exchange_(patch_, first) / (mesh_.areas()[first] * area_);
}

/// @param mean  visibility of all patches that the row tells of
void RowMaker::add_far(std::uint32_t part, double mean) {
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
    const double apart = spread(part);
    double factor = 0.0;
    double unoccluded = 0.0;
    for (std::uint32_t s = 0; s < sum.strata; ++s) {
        const Stratum& stratum = strata_[sum.first_stratum + s];
        const double left = std::max(0.0, tree_.moments(stratum.node).area - stratum.known);
        const double lit = stratum.lit + (sum.known < count ? left * share : 0.0);
        if (!(lit > 0.0)) {
            continue;
        }
        const double of_area = factor_of_area(part, stratum, apart);
        factor += of_area * lit;
        unoccluded += of_area * (stratum.seen + (share > 0.0 ? left : 0.0));
    }
    if (factor > 0.0) {
        const bool clear = sum.clear && sum.known == count;
        far_.push_back({mesh_.size() + k, static_cast<float>(factor), code_of(factor / unoccluded, clear)});
    }
}

/// Whether some patch of a part may have its front towards this one's.
bool RowMaker::may_face_part(std::uint32_t part) {
    Sum& sum = sums_[part];
    if (!sum.asked) {
        sum.asked = true;
        sum.may_face = may_face(tree_.shape(parts_[part].node), mesh_.centres()[patch_], mesh_.normal(patch_),
                                tree_.radius_of(patch_));
    }
    return sum.may_face;
}

} // namespace hemi
