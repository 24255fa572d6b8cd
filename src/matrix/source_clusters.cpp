#include "hemi/matrix/source_clusters.hpp"

#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hemi {

namespace {

/// @throws InvalidArgument unless `order` has every patch once
void check_order(std::span<const std::uint32_t> order) {
    std::vector<bool> seen(order.size());
    for (const std::uint32_t patch : order) {
        if (patch >= order.size() || seen[patch]) {
            throw InvalidArgument(fmt::format("clusters of sources: patch {} of {} comes twice, or is none",
                                              patch, order.size()));
        }
        seen[patch] = true;
    }
}

void check_nodes(std::span<const SourceClusters::Node> nodes, std::size_t patches) {
    const auto refuse = [](std::size_t node) {
        throw InvalidArgument(
            fmt::format("clusters of sources: node {} is not what its children make up", node));
    };
    std::size_t next_child = 1;
    for (std::size_t k = 0; k < nodes.size(); ++k) {
        const SourceClusters::Node& node = nodes[k];
        if (node.begin >= node.end || node.end > patches ||
            (node.child == 0) != (node.end == node.begin + 1)) {
            refuse(k);
        }
        if (node.child == 0) {
            continue;
        }
        if (node.child <= k || node.child + std::size_t{1} >= nodes.size()) {
            refuse(k);
        }
        const SourceClusters::Node& first = nodes[node.child];
        const SourceClusters::Node& second = nodes[node.child + 1];
        if (first.begin != node.begin || first.end != second.begin || second.end != node.end) {
            refuse(k);
        }
        next_child += 2;
    }
    const bool whole = !nodes.empty() && nodes.front().begin == 0 && nodes.front().end == patches;
    if (patches > 0 && (!whole || next_child != nodes.size())) {
        throw InvalidArgument("clusters of sources: the nodes are no tree of all patches");
    }
}

} // namespace

SourceClusters::SourceClusters(std::vector<std::uint32_t> order, std::vector<Node> nodes,
                               std::span<const double> weights)
    : order_(std::move(order)), nodes_(std::move(nodes)), leaf_of_(order_.size()) {
    check_order(order_);
    check_nodes(nodes_, order_.size());
    for (std::uint32_t k = 0; k < nodes_.size(); ++k) {
        if (nodes_[k].child == 0) {
            leaf_of_[order_[nodes_[k].begin]] = k;
        }
    }
    add_weights(weights);
}

SourceClusters SourceClusters::with_weights(std::span<const double> weights) const {
    SourceClusters result = *this;
    result.add_weights(weights);
    return result;
}

void SourceClusters::add_weights(std::span<const double> weights) {
    if (weights.size() != order_.size()) {
        throw InvalidArgument(fmt::format("clusters of {} patches and {} weights; it must be as many",
                                          order_.size(), weights.size()));
    }
    weights_.resize(nodes_.size());
    for (std::size_t k = nodes_.size(); k-- > 0;) {
        const Node& node = nodes_[k];
        weights_[k] =
            node.child == 0 ? weights[order_[node.begin]] : weights_[node.child] + weights_[node.child + 1];
    }
    if (!weights_.empty() && !std::isfinite(weights_.front())) {
        throw InvalidArgument("clusters of sources: their weights add up to more than a number can be");
    }
}

void SourceClusters::check_values(std::span<const double> values, std::size_t stride) const {
    if (values.size() != (order_.size() + nodes_.size()) * stride) {
        throw InvalidArgument(fmt::format("{} values for {} patches and {} clusters, {} each", values.size(),
                                          order_.size(), nodes_.size(), stride));
    }
}

void SourceClusters::fill(std::span<double> values, std::size_t stride) const {
    check_values(values, stride);
    double* const means = values.data() + order_.size() * stride;
    for (std::size_t k = nodes_.size(); k-- > 0;) { // children come after their parents
        const Node& node = nodes_[k];
        double* const mean = means + k * stride;
        if (node.child == 0) {
            std::copy_n(values.data() + order_[node.begin] * stride, stride, mean);
            continue;
        }
        const double* const first = means + node.child * stride;
        const double share = first_share(static_cast<std::uint32_t>(k));
        for (std::size_t c = 0; c < stride; ++c) {
            mean[c] = share * first[c] + (1.0 - share) * first[stride + c];
        }
    }
}

void SourceClusters::share_out(std::span<double> values, std::size_t stride) const {
    check_values(values, stride);
    double* const sums = values.data() + order_.size() * stride;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
        const Node& node = nodes_[k];
        const double* const sum = sums + k * stride;
        if (node.child == 0) {
            double* const patch = values.data() + order_[node.begin] * stride;
            for (std::size_t c = 0; c < stride; ++c) {
                patch[c] += sum[c];
            }
            continue;
        }
        double* const first = sums + node.child * stride;
        const double share = first_share(static_cast<std::uint32_t>(k));
        for (std::size_t c = 0; c < stride; ++c) {
            first[c] += share * sum[c];
            first[stride + c] += (1.0 - share) * sum[c];
        }
    }
}

} // namespace hemi
