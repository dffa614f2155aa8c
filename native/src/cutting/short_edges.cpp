// SPDX-License-Identifier: GPL-3.0-or-later
// Nodes of joined models that are as near as rounding become one.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "base/parallel.hpp"
#include "cutting/part_rounding.hpp"

namespace realmodel::cutting {

/// Contracts edges one after another. What a contraction does to a part is known from the polygons
/// around it: of parts with many polygons only those are looked at that share nodes with one at
/// either end. The others stay as they are.
class PartRounding::ShortEdges {
public:
    ShortEdges(PartRounding& of, double allowed) : of_(of), allowed_(allowed) {
        pieces_at_ = bucketize<std::int32_t>(of.becomes_.size(), [&of](const auto& put) {
            for (std::size_t p = 0; p < of.pieces_.size(); ++p) {
                for (const NodeId node : of.pieces_.polygons[p])
                    put(index(node), static_cast<std::int32_t>(p));
            }
        });
    }

    /// Finds on all threads what parts around edges are like now.
    void look_at(const std::set<std::array<NodeId, 2>>& edges) {
        std::vector<std::int32_t> parts;
        for (const auto& edge : edges) {
            for (const std::int32_t p : pieces_at_[index(edge[1])]) {
                for (const std::int32_t part : of_.pieces_[index(p)].parts) {
                    if (part >= 0) parts.push_back(part);
                }
            }
        }
        std::ranges::sort(parts);
        parts.erase(std::unique(parts.begin(), parts.end()), parts.end());
        std::vector<std::optional<Around>> found(parts.size());
        of_.each_of_parts(
            parts, [&](std::size_t i, Memory& memory) { found[i] = of_.around(parts[i], memory); });
        for (std::size_t i = 0; i < parts.size(); ++i)
            now_.emplace(parts[i], found[i]);
    }

    /// Makes the greater node the lesser one where no part comes to touch itself for it.
    bool contract(NodeId to, NodeId from) {
        std::map<std::int32_t, std::optional<Around>> after;
        for (const NodeId node : nodes_of(from)) {
            for (const std::int32_t p : pieces_at_[index(node)]) {
                for (const std::int32_t part : of_.pieces_[index(p)].parts) {
                    if (part >= 0) after[part];
                }
            }
        }
        if (std::ranges::any_of(after, [this](const auto& own) { return !now(own.first); }))
            return false;
        for (auto& [part, found] : after) {
            found = contracted(part, to, from);
            if (!found || found->touches > now(part)->touches) return false;
        }
        become(from, to);
        auto& nodes = nodes_[to] = nodes_of(to);
        const std::vector<NodeId> added = nodes_of(from);
        nodes.insert(nodes.end(), added.begin(), added.end());
        nodes_.erase(from);
        for (auto& [part, found] : after)
            now_[part] = found;
        return true;
    }

private:
    static constexpr std::size_t kMany = 200;

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
    const std::optional<Around>& now(std::int32_t part) {
        const auto [at, is_new] = now_.try_emplace(part);
        if (is_new) at->second = of_.around(part, memory_);
        return at->second;
    }
    /// What a part, which is sound, would be like.
    std::optional<Around> contracted(std::int32_t part, NodeId to, NodeId from) {
        if (of_.pieces_of_[index(part)].size() > kMany) {
            const std::vector<std::int32_t> pieces = pieces_near(part, to, from);
            const auto before = of_.around(pieces, part, memory_);
            become(from, to);
            const auto found = of_.around(pieces, part, memory_);
            become(from, from);
            if (!before || !found) return std::nullopt;
            Around known = *now(part);
            known.touches += found->touches - before->touches;
            known.count += found->count - before->count;
            if (keeps_extent(known.box, found->box))
                return known.count < 4 ? std::nullopt : std::optional(known);
        }
        become(from, to);
        auto found = of_.around(part, memory_);
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
    std::unordered_map<NodeId, std::vector<NodeId>> nodes_;
    std::unordered_map<std::int32_t, std::optional<Around>> now_;  ///< of parts
    Memory memory_;
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
    const double allowed = rounding_of(vertices_);
    constexpr std::size_t kPieces = 1 << 12;  // at a time
    std::vector<std::vector<std::array<NodeId, 2>>> found((pieces_.size() + kPieces - 1) / kPieces);
    parallel_ranges(
        pieces_.size(), kPieces, threads_, progress_,
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
    ShortEdges short_edges(*this, allowed);
    short_edges.look_at(edges);
    bool any = false;
    for (const auto& edge : edges) {
        const NodeId a = becomes_[index(edge[0])], b = becomes_[index(edge[1])];
        const NodeId to = std::min(a, b), from = std::max(a, b);
        if (a == b || !is_new(from) || leaves_wall(from, to)) continue;
        if (!short_edges.contract(to, from)) continue;
        any = true;
        on_wall_[index(to)] |= on_wall_[index(from)];
    }
    return any;
}

}  // namespace realmodel::cutting
