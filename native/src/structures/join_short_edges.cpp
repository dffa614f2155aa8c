// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "base/algorithms.hpp"
#include "base/floating_point.hpp"
#include "base/parallel.hpp"
#include "cutting/rounding/rounded_parts.hpp"
#include "structures/joined_rounding.hpp"

namespace realmodel::structures {

using cutting::Contraction;
using cutting::NodeId;
using cutting::Position;
using cutting::RoundedParts;

namespace {

using NodeEdge = std::array<NodeId, 2>;

/// Contracts edges one after another. What a contraction does to a part is known from the polygons
/// around it: of parts with many polygons only those are looked at that share nodes with one at
/// either end. The others stay as they are.
class ShortEdges {
public:
    ShortEdges(RoundedParts& parts, double allowed)
        : parts_(parts), allowed_(allowed), contraction_(parts, true) {
        pieces_at_ =
            bucketize<std::int32_t>(contraction_.becomes.size(), [&parts](const auto& put) {
                for (std::size_t p = 0; p < parts.pieces.size(); ++p) {
                    for (const NodeId node : parts.pieces.polygons[p])
                        put(index(node), static_cast<std::int32_t>(p));
                }
            });
    }

    void contract_all(const std::set<NodeEdge>& edges) {
        ShapeScratch scratch;
        bool any = false;
        for (const NodeEdge& edge : edges) {
            poll(parts_.execution.progress, static_cast<std::size_t>(edge[0]));
            any = contract(edge, scratch) || any;
        }
        if (any) contraction_.apply();
    }

private:
    using ShapeScratch = Contraction::ShapeScratch;
    using PartShape = Contraction::PartShape;
    static constexpr std::size_t kMany = 200;

    template <class Visit>
    void for_each_part_at(NodeId node, const Visit& visit) const {
        for (const std::int32_t p : pieces_at_[index(node)]) {
            for (const std::int32_t part : parts_.pieces[index(p)].parts) {
                if (part >= 0) visit(part);
            }
        }
    }

    /// Makes the nodes that its ends became one, the lesser one if walls allow it, where no part
    /// comes to touch itself for it.
    bool contract(const NodeEdge& edge, ShapeScratch& scratch) {
        const NodeId a = contraction_.becomes[index(edge[0])];
        const NodeId b = contraction_.becomes[index(edge[1])];
        const NodeId to = std::min(a, b), from = std::max(a, b);
        return a != b && (become_one(to, from, scratch) || become_one(from, to, scratch));
    }
    bool become_one(NodeId to, NodeId from, ShapeScratch& scratch) {
        if (!parts_.is_new(from) || leaves_wall(from, to)) return false;
        std::map<std::int32_t, std::optional<PartShape>> after;
        for (const NodeId node : nodes_of(from))
            for_each_part_at(node, [&after](std::int32_t part) { after[part]; });
        if (std::ranges::any_of(
                after, [&](const auto& part_after) { return !now(part_after.first, scratch); }))
            return false;
        for (auto& [part, shape] : after) {
            shape = contracted(part, to, from, scratch);
            const PartShape& before = *now(part, scratch);
            if (!shape || shape->touches > before.touches ||
                (!contraction_.is_sound(*shape, part) && contraction_.is_sound(before, part)))
                return false;
        }
        assert(contraction_.becomes[index(to)] == to);
        become(from, to);
        std::vector<NodeId> nodes = nodes_of(to), added = nodes_of(from);
        nodes.insert(nodes.end(), added.begin(), added.end());
        nodes_[to] = std::move(nodes);
        nodes_.erase(from);
        for (auto& [part, shape] : after)
            now_[part] = shape;
        return true;
    }

    /// Whether some of the nodes that became one would go off a wall that they are on, if these
    /// moved to another one. Along it they may: near 0 on an axis walls are as precise as their
    /// small coordinates.
    bool leaves_wall(NodeId from, NodeId to) const {
        return std::ranges::any_of(nodes_of(from), [&](NodeId node) {
            return parts_.on_wall[index(node)] != 0 &&
                   std::ranges::any_of(pieces_at_[index(node)], [&](std::int32_t p) {
                       return parts_.surface_of(index(p), kCutFace) == kWall &&
                              goes_off(node, to, index(p));
                   });
        });
    }
    /// Whether a node of a wall would go off it, by more than rounding of its coordinates.
    bool goes_off(NodeId node, NodeId to, std::size_t wall) const {
        const Position &old = parts_.at(node), &now = parts_.at(to), by = minus(now, old);
        const auto size = [](const Position& p) {
            return std::max(std::abs(p[0]), std::abs(p[1]));
        };
        Position way{0, 0, 0};  // along the wall
        for (const NodeId corner : parts_.pieces.polygons[wall]) {
            const Position along = minus(parts_.at(corner), old);
            if (size(along) > size(way)) way = along;
        }
        double allowed = 0;
        for (std::size_t axis = 0; axis < 2; ++axis) {
            allowed += 4 * ulp(std::max(std::abs(old[axis]), std::abs(now[axis]))) *
                       std::abs(way[1 - axis]);
        }
        return std::abs(by[0] * way[1] - by[1] * way[0]) > allowed;
    }

    /// The nodes that became one.
    std::vector<NodeId> nodes_of(NodeId node) const {
        const auto known = nodes_.find(node);
        return known == nodes_.end() ? std::vector{node} : known->second;
    }
    void become(NodeId from, NodeId to) {
        for (const NodeId node : nodes_of(from))
            contraction_.becomes[index(node)] = to;
    }
    /// What a part is like now.
    const std::optional<PartShape>& now(std::int32_t part, ShapeScratch& scratch) {
        auto& known = now_[part];
        if (!known) known.emplace(contraction_.shape(part, scratch));
        return *known;
    }
    /// What a part would be like.
    std::optional<PartShape> contracted(std::int32_t part, NodeId to, NodeId from,
                                        ShapeScratch& scratch) {
        if (parts_.pieces_of[index(part)].size() > kMany) {
            const std::vector<std::int32_t> pieces = pieces_near(part, to, from);
            const auto before = contraction_.shape(pieces, part, scratch);
            become(from, to);
            const auto contracted_shape = contraction_.shape(pieces, part, scratch);
            become(from, from);
            if (!before || !contracted_shape) return std::nullopt;
            PartShape known = *now(part, scratch);
            known.touches += contracted_shape->touches - before->touches;
            known.count += contracted_shape->count - before->count;
            if (keeps_extent(known.box, contracted_shape->box))
                return known.count < 4 ? std::nullopt : std::optional(known);
        }
        become(from, to);
        auto shape = contraction_.shape(part, scratch);
        become(from, from);
        return shape;
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
        std::set<std::int32_t> near_pieces;
        std::set<NodeId> around;
        const auto visit = [&](NodeId node, const auto& visit_piece) {
            for (const NodeId one : nodes_of(node)) {
                for (const std::int32_t p : pieces_at_[index(one)]) {
                    if (std::ranges::count(parts_.pieces[index(p)].parts, part) > 0) visit_piece(p);
                }
            }
        };
        for (const NodeId end : {to, from}) {
            visit(end, [&](std::int32_t p) {
                for (const NodeId node : parts_.pieces.polygons[index(p)])
                    around.insert(contraction_.becomes[index(node)]);
            });
        }
        for (const NodeId node : around)
            visit(node, [&near_pieces](std::int32_t p) { near_pieces.insert(p); });
        std::vector<std::int32_t> pieces;
        for (const std::int32_t p : near_pieces) {
            pieces.insert(pieces.end(),
                          index(std::ranges::count(parts_.pieces[index(p)].parts, part)), p);
        }
        return pieces;
    }

    RoundedParts& parts_;
    double allowed_;
    Contraction contraction_;
    Buckets<std::int32_t> pieces_at_;                        ///< of nodes
    std::unordered_map<NodeId, std::vector<NodeId>> nodes_;  ///< that became one
    /// What the parts around are like: nothing where nobody has asked yet.
    std::unordered_map<std::int32_t, std::optional<std::optional<PartShape>>> now_;
};

}  // namespace

void join_short_edges(RoundedParts& parts, double least_rounding) {
    const double allowed = std::max(cutting::rounding_of(parts.vertices), least_rounding);
    const cutting::CutPieces& pieces = parts.pieces;
    constexpr std::size_t kPieces = 1 << 12;  // at a time
    const auto short_edges = collect_ranges<NodeEdge>(
        pieces.size(), kPieces, parts.execution,
        [&](std::size_t begin, std::size_t end, std::vector<NodeEdge>& in_range) {
            for (std::size_t p = begin; p < end; ++p) {
                const auto nodes = pieces.polygons[p];
                for (std::size_t i = 0; i < nodes.size(); ++i) {
                    const NodeEdge edge =
                        unordered(nodes[i], nodes[i + 1 < nodes.size() ? i + 1 : 0]);
                    if (!parts.is_new(edge[1])) continue;
                    const Position away = minus(parts.at(edge[0]), parts.at(edge[1]));
                    if (std::ranges::all_of(away,
                                            [allowed](double x) { return std::abs(x) <= allowed; }))
                        in_range.push_back(edge);
                }
            }
        },
        0.05);
    const std::set<NodeEdge> edges(short_edges.begin(), short_edges.end());
    if (!edges.empty()) ShortEdges(parts, allowed).contract_all(edges);
}

}  // namespace realmodel::structures
