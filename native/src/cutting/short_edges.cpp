// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes of joined models that are as near as rounding become one.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "base/disjoint_sets.hpp"
#include "base/parallel.hpp"
#include "cutting/part_rounding.hpp"

namespace realmodel::cutting {

/// Contracts edges one after another. What a contraction does to a part is known from the polygons
/// around it: of parts with many polygons only those are looked at that share nodes with one at
/// either end. The others stay as they are.
class PartRounding::ShortEdges {
public:
    using Edge = std::array<NodeId, 2>;

    ShortEdges(PartRounding& of, double allowed, const std::set<Edge>& edges)
        : of_(of), allowed_(allowed) {
        pieces_at_ = bucketize<std::int32_t>(of.becomes_.size(), [&of](const auto& put) {
            for (std::size_t p = 0; p < of.pieces_.size(); ++p) {
                for (const NodeId node : of.pieces_.polygons[p])
                    put(index(node), static_cast<std::int32_t>(p));
            }
        });
        find_rounds(edges);
    }

    /// @return whether any was contracted
    bool contract_all() {
        std::atomic<bool> any = false;
        for (const std::vector<Edge>& round : rounds_) {
            constexpr std::size_t kAtOnce = 1 << 3;
            parallel_workers((round.size() + kAtOnce - 1) / kAtOnce, of_.execution_,
                             [&] {
                                 return [&, memory = Memory()](std::size_t chunk) mutable {
                                     const std::size_t begin = chunk * kAtOnce;
                                     for (const Edge& edge : std::span(round).subspan(
                                              begin, std::min(kAtOnce, round.size() - begin))) {
                                         if (contract(edge, memory)) any = true;
                                     }
                                 };
                             },
                             0.01);
        }
        return any;
    }

private:
    static constexpr std::size_t kMany = 200;

    /// Divides the edges into rounds. Two of one round have no part in common around them, nor
    /// around what their nodes may become one with; of others the first comes in an earlier round.
    void find_rounds(const std::set<Edge>& edges) {
        std::vector<NodeId> nodes;
        for (const Edge& edge : edges)
            nodes.insert(nodes.end(), edge.begin(), edge.end());
        std::ranges::sort(nodes);
        nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
        const auto number = [&nodes](NodeId node) {
            return static_cast<std::int32_t>(std::ranges::lower_bound(nodes, node) - nodes.begin());
        };
        DisjointSets clusters(nodes.size());
        for (const Edge& edge : edges)
            clusters.join(number(edge[0]), number(edge[1]));
        std::vector<std::vector<std::int32_t>> parts(nodes.size());  // around each cluster
        for (const NodeId node : nodes) {
            auto& around = parts[index(clusters.find(number(node)))];
            for (const std::int32_t p : pieces_at_[index(node)]) {
                for (const std::int32_t part : of_.pieces_[index(p)].parts) {
                    if (part >= 0) around.push_back(part);
                }
            }
            nodes_[node] = {node};
        }
        for (auto& around : parts) {
            std::ranges::sort(around);
            around.erase(std::unique(around.begin(), around.end()), around.end());
            for (const std::int32_t part : around)
                now_.try_emplace(part);
        }
        std::vector<std::size_t> rounds(of_.half_cells_.size(), 0);  // of a part's edges
        for (const Edge& edge : edges) {
            const auto& around = parts[index(clusters.find(number(edge[0])))];
            std::size_t round = 0;
            for (const std::int32_t part : around)
                round = std::max(round, rounds[index(part)]);
            for (const std::int32_t part : around)
                rounds[index(part)] = round + 1;
            if (rounds_.size() <= round) rounds_.resize(round + 1);
            rounds_[round].push_back(edge);
        }
    }

    /// Makes the greater of the nodes that its ends became the lesser one where no part comes to
    /// touch itself for it.
    bool contract(const Edge& edge, Memory& memory) {
        const NodeId a = of_.becomes_[index(edge[0])], b = of_.becomes_[index(edge[1])];
        const NodeId to = std::min(a, b), from = std::max(a, b);
        if (a == b || !of_.is_new(from) || of_.leaves_wall(from, to)) return false;
        std::map<std::int32_t, std::optional<Around>> after;
        for (const NodeId node : nodes_of(from)) {
            for (const std::int32_t p : pieces_at_[index(node)]) {
                for (const std::int32_t part : of_.pieces_[index(p)].parts) {
                    if (part >= 0) after[part];
                }
            }
        }
        if (std::ranges::any_of(after, [&](const auto& own) { return !now(own.first, memory); }))
            return false;
        for (auto& [part, found] : after) {
            found = contracted(part, to, from, memory);
            if (!found || found->touches > now(part, memory)->touches) return false;
        }
        become(from, to);
        auto& nodes = nodes_.at(to);
        auto& added = nodes_.at(from);
        nodes.insert(nodes.end(), added.begin(), added.end());
        added.clear();
        for (auto& [part, found] : after)
            now_.at(part) = found;
        of_.on_wall_[index(to)] |= of_.on_wall_[index(from)];
        return true;
    }

    /// The nodes that became one.
    std::vector<NodeId> nodes_of(NodeId node) const {
        const auto found = nodes_.find(node);
        return found == nodes_.end() ? std::vector{node} : found->second;
    }
    void become(NodeId from, NodeId to) {
        for (const NodeId node : nodes_of(from))
            of_.becomes_[index(node)] = to;
    }
    /// What a part is like now.
    const std::optional<Around>& now(std::int32_t part, Memory& memory) {
        auto& known = now_.at(part);
        if (!known) known.emplace(of_.around(part, memory));
        return *known;
    }
    /// What a part, which is sound, would be like.
    std::optional<Around> contracted(std::int32_t part, NodeId to, NodeId from, Memory& memory) {
        if (of_.pieces_of_[index(part)].size() > kMany) {
            const std::vector<std::int32_t> pieces = pieces_near(part, to, from);
            const auto before = of_.around(pieces, part, memory);
            become(from, to);
            const auto found = of_.around(pieces, part, memory);
            become(from, from);
            if (!before || !found) return std::nullopt;
            Around known = *now(part, memory);
            known.touches += found->touches - before->touches;
            known.count += found->count - before->count;
            if (keeps_extent(known.box, found->box))
                return known.count < 4 ? std::nullopt : std::optional(known);
        }
        become(from, to);
        auto found = of_.around(part, memory);
        become(from, from);
        return found;
    }
    /// Whether a part surely has an extent in all directions: it is large, or what is near has one.
    bool keeps_extent(const spatial::Box& part, const spatial::Box& near) const {
        for (std::size_t k = 0; k < 3; ++k) {
            if (part.high[k] - part.low[k] <= 1000 * allowed_ && near.high[k] <= near.low[k])
                return false;
        }
        return true;
    }
    /// The polygons of a part that share nodes with those at one of two nodes.
    std::vector<std::int32_t> pieces_near(std::int32_t part, NodeId to, NodeId from) const {
        std::set<std::int32_t> found;
        std::set<NodeId> around;
        const auto visit = [&](NodeId node, const auto& visit_piece) {
            for (const NodeId own : nodes_of(node)) {
                for (const std::int32_t p : pieces_at_[index(own)]) {
                    if (std::ranges::count(of_.pieces_[index(p)].parts, part) > 0) visit_piece(p);
                }
            }
        };
        for (const NodeId end : {to, from}) {
            visit(end, [&](std::int32_t p) {
                for (const NodeId node : of_.pieces_.polygons[index(p)])
                    around.insert(of_.becomes_[index(node)]);
            });
        }
        for (const NodeId node : around)
            visit(node, [&found](std::int32_t p) { found.insert(p); });
        std::vector<std::int32_t> pieces;
        for (const std::int32_t p : found) {
            pieces.insert(pieces.end(),
                          index(std::ranges::count(of_.pieces_[index(p)].parts, part)), p);
        }
        return pieces;
    }

    PartRounding& of_;
    double allowed_;
    Buckets<std::int32_t> pieces_at_;  ///< of nodes
    std::vector<std::vector<Edge>> rounds_;
    std::unordered_map<NodeId, std::vector<NodeId>> nodes_;  ///< that became one, of ends of edges
    /// What the parts around are like: nothing where nobody has asked yet.
    std::unordered_map<std::int32_t, std::optional<std::optional<Around>>> now_;
};

/// Whether a node on a wall would go off it, if it moved to another one: near 0 on an axis walls
/// are as precise as their small coordinates.
bool PartRounding::leaves_wall(NodeId from, NodeId to) const {
    if (on_wall_[index(from)] == 0) return false;
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const double x = at(from)[axis], y = at(to)[axis];
        const double own = std::max(std::abs(x), std::abs(y));
        if (std::abs(x - y) > 4 * (std::nextafter(own, HUGE_VAL) - own)) return true;
    }
    return false;
}

/// Contracts edges of new nodes that are as short as rounding, one after another, where no part
/// comes to touch itself for it: what two models have in common was rounded in each by itself.
bool PartRounding::join_short_edges() {
    const double allowed = std::max(rounding_of(vertices_), least_rounding_);
    constexpr std::size_t kPieces = 1 << 12;  // at a time
    std::vector<std::vector<std::array<NodeId, 2>>> found((pieces_.size() + kPieces - 1) / kPieces);
    parallel_ranges(
        pieces_.size(), kPieces, execution_,
        [&](std::size_t begin, std::size_t end) {
            for (std::size_t p = begin; p < end; ++p) {
                const auto nodes = pieces_.polygons[p];
                for (std::size_t i = 0; i < nodes.size(); ++i) {
                    const auto edge = unordered(nodes[i], nodes[i + 1 < nodes.size() ? i + 1 : 0]);
                    if (!is_new(edge[1])) continue;
                    const Position away = minus(at(edge[0]), at(edge[1]));
                    if (std::ranges::all_of(away,
                                            [allowed](double x) { return std::abs(x) <= allowed; }))
                        found[begin / kPieces].push_back(edge);
                }
            }
        },
        0.05);
    std::set<std::array<NodeId, 2>> edges;
    for (const auto& chunk : found)
        edges.insert(chunk.begin(), chunk.end());
    if (edges.empty()) return false;
    return ShortEdges(*this, allowed, edges).contract_all();
}

}  // namespace realmodel::cutting
