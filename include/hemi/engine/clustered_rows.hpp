#pragma once

#include "hemi/core/enclosure.hpp"
#include "hemi/core/progress.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"
#include "hemi/matrix/provenance.hpp"
#include "hemi/scene/patch_mesh.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace hemi {

/// How far sources are taken together.
struct ClusterSettings {
    ExchangeRule rule = ExchangeRule::standard; ///< of F0
    /// A cluster is far where its radius is below this share of its distance from the receivers.
    double opening = 0.2;
    std::uint64_t max_memory = ~std::uint64_t{0}; ///< bytes that the rows may take
    /// Patches that stand in no cluster with others than theirs, such as lamps: 1 each, of N. Empty: none.
    std::vector<std::uint8_t> apart = {};
};

/// Keeps the rows of clusters that a run has made, before they balance, for another run to go on from.
class ClusteredRowKeeper {
public:
    ClusteredRowKeeper() = default;
    virtual ~ClusteredRowKeeper() = default;
    ClusteredRowKeeper(const ClusteredRowKeeper&) = delete;
    ClusteredRowKeeper& operator=(const ClusteredRowKeeper&) = delete;

    /// Takes a patch, its row, which is valid during the call only (columns are those of a matrix with
    /// clusters), and whether that sees nothing of some patch which faces it.
    using EachRow = std::function<void(std::uint32_t, const RowView&, bool)>;
    /// Gives the rows that were kept before. Called once, before keep().
    /// @param clusters  that columns from N on are
    /// @param wanted    patches, ascending: rows of others are left out
    /// @param each      takes the rows, in any order
    /// @throws what `each` throws; InputError if they are those of another run
    virtual void resume(const std::shared_ptr<const SourceClusters>& clusters,
                        std::span<const std::uint32_t> wanted, const EachRow& each) = 0;
    /// Takes a finished block.
    /// @param rows   known are those that were not kept before
    /// @param hides  of each row: 1 if it sees nothing of some patch which faces it, else 0
    virtual void keep(const RowBlock& rows, std::span<const std::uint8_t> hides) = 0;
};

/// The opening with which clusters change the light that rows gather by about so much, relative, rms, where
/// patches near each other differ most: lamps strewn over a city, 1.2e-2 with 0.66 and 2.5e-2 with 1.1. Under
/// a bright sky it is a tenth of that.
/// @param error  above 0
[[nodiscard]] double cluster_opening(double error);

/// Form factors as unoccluded factors times visibility in scenes where not all pairs fit into memory.
///
/// F(i, j) = F0(i, j) V(i, j) as in compute_visibility_weighted(). Pairs near each other are found both ways,
/// so that they are reciprocal. What is far is found one way, and stands together in clusters of patches that
/// look about the same way (SourceClusters): a row has some hundred entries more or less however many patches
/// there are. Patches that no texel covers are as visible as the others of their cluster. Rows balance: where
/// they see the environment of an open scene (as compute_visibility_weighted() has it), it gets what is left
/// of 1; else all factors are changed as little as makes up for it, by their variances (Repair::closure, of
/// the near pairs); of rows without anything far that may be one way only.
/// @param visibility   computes rows of visibility: of several ranks (hemi::Ranks) each computes a share of
///   them by its own, and gives all what became of them
/// @param mesh         its N patches
/// @param patches      whose rows are wanted, ascending; all others stay unknown
/// @param settings     how
/// @param enclosure    as the scene says
/// @param progress     called after every row of this rank; may be empty
/// @param keeper       of the rows of this rank: gives those that are not computed again, and gets all
///   others; may be null
/// @throws Cancelled; OutOfMemory if the rows do not fit; InvalidArgument for settings that do not fit; what
///   the keeper throws
[[nodiscard]] FormFactorMatrix compute_clustered(VisibilityProvider& visibility, const PatchMesh& mesh,
                                                 std::span<const std::uint32_t> patches,
                                                 const ClusterSettings& settings, Enclosure enclosure,
                                                 const Progress& progress = {},
                                                 ClusteredRowKeeper* keeper = nullptr);

/// Bytes that compute_clustered() needs, with 20 % on top.
/// @param sample   of it, some rows
/// @param sampled  number of these, above 0
/// @param rows     that are wanted
[[nodiscard]] std::uint64_t clustered_memory(const FormFactorMatrix& sample, std::size_t sampled,
                                             std::size_t rows);

} // namespace hemi
