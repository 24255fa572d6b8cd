#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace hemi {

/// Clusters of patches that stand for one source of light to receivers far away: the nodes of a binary tree
/// over all patches, down to single ones. Node k is column N + k of a FormFactorMatrix with clusters; what
/// leaves it is the mean of what leaves its patches, by weights: their areas as far as others can see them,
/// so that what lies buried does not count. Memory: about 52 bytes a patch.
class SourceClusters {
public:
    /// A node: the patches order[begin] … order[end - 1].
    struct Node {
        std::uint32_t begin = 0; ///< position of the first in order()
        std::uint32_t end = 0;   ///< begin + 1 in a leaf
        std::uint32_t child = 0; ///< the first of two that stand side by side, after their parent; 0: a leaf
    };

    /// @param order  every patch once, N
    /// @param nodes  the root first; the ranges of two children make up that of their parent
    /// @param weights  of the patches, N, not negative
    /// @throws InvalidArgument if they do not fit, or add up to more than a number can be
    SourceClusters(std::vector<std::uint32_t> order, std::vector<Node> nodes,
                   std::span<const double> weights);
    /// The same clusters by other weights.
    /// @throws InvalidArgument if there are not N
    [[nodiscard]] SourceClusters with_weights(std::span<const double> weights) const;

    /// N, the number of patches.
    [[nodiscard]] std::uint32_t size() const noexcept { return static_cast<std::uint32_t>(order_.size()); }
    /// All nodes, the root first.
    [[nodiscard]] std::span<const Node> nodes() const noexcept { return nodes_; }
    /// Patches of all nodes, side by side, see Node.
    [[nodiscard]] std::span<const std::uint32_t> order() const noexcept { return order_; }
    /// Patches of a node.
    [[nodiscard]] std::span<const std::uint32_t> patches(std::uint32_t node) const {
        return std::span(order_).subspan(nodes_[node].begin, nodes_[node].end - nodes_[node].begin);
    }
    /// Sum of the weights of a node's patches.
    [[nodiscard]] double weight(std::uint32_t node) const { return weights_[node]; }
    /// Share of the weight of a node that one of its patches has; of all alike where nothing has any.
    [[nodiscard]] double share(std::uint32_t patch, std::uint32_t node) const {
        return weights_[node] > 0.0 ? weights_[leaf_of_[patch]] / weights_[node]
                                    : 1.0 / (nodes_[node].end - nodes_[node].begin);
    }

    /// Share of the first child in the means of a node that has children; by patches where nothing has any
    /// weight.
    [[nodiscard]] double first_share(std::uint32_t node) const {
        if (weights_[node] > 0.0) {
            return weights_[nodes_[node].child] / weights_[node];
        }
        const Node& first = nodes_[nodes_[node].child];
        return static_cast<double>(first.end - first.begin) / (nodes_[node].end - nodes_[node].begin);
    }

    /// Writes the means of the nodes behind the values of the patches.
    /// @param values  (N + nodes)·stride, value c of column k at [k·stride + c]
    /// @param stride  values a patch
    /// @throws InvalidArgument if there are not as many
    void fill(std::span<double> values, std::size_t stride) const;
    /// Adds what stands at the nodes to the values of their patches, by shares: the transpose of fill(). Of
    /// the nodes' values nothing is to be used afterwards.
    /// @param values  as in fill()
    /// @param stride  values a patch
    /// @throws InvalidArgument if there are not as many
    void share_out(std::span<double> values, std::size_t stride) const;

private:
    void check_values(std::span<const double> values, std::size_t stride) const;
    void add_weights(std::span<const double> weights);

    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
    std::vector<double> weights_;        ///< of nodes
    std::vector<std::uint32_t> leaf_of_; ///< of patches
};

} // namespace hemi
