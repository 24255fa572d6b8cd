#include "engine/clusters/row_maker.hpp"

#include "engine/visibility_weighted/pair_visibility.hpp"

namespace hemi {

namespace {

SeenShare seen_share(float share, std::uint8_t texels) {
    return {static_cast<double>(share), static_cast<double>(texels), texels == visibility_clear};
}

ClusterEntry entry_of(const Source& source) {
    const PairVisibility visibility =
        source.clear ? PairVisibility::clear() : PairVisibility::from(source.visibility);
    return {source.column, static_cast<float>(source.unoccluded * source.visibility), visibility.stored()};
}

} // namespace

ClusteredRow RowMaker::make(const SeenRow& seen, const SetPlaces* places) {
    tree_.seen_from(seen.patch, opening_, parts_);
    sums_.start({.at = mesh_.centres()[seen.patch],
                 .normal = mesh_.normal(seen.patch),
                 .radius = tree_.radius_of(seen.patch),
                 .patch = seen.patch,
                 .area = mesh_.areas()[seen.patch]},
                parts_, false);
    for (std::size_t k = 0; k < seen.columns.size(); ++k) {
        sums_.add_patch(seen.columns[k], seen_share(seen.shares[k], seen.texels[k]));
    }
    for (const JointVisibility& joint : seen.joint) {
        sums_.add_set(*places, joint.set, seen_share(joint.share, joint.texels));
    }
    sums_.finish();
    entries_.clear();
    for (const Source& source : sums_.near()) {
        entries_.push_back(entry_of(source));
    }
    far_.clear();
    for (const Source& source : sums_.far()) {
        far_.add(entry_of(source));
    }
    return {EntryList(entries_), far_.packed(), seen.environment, seen.blocked, sums_.hides()};
}

} // namespace hemi
