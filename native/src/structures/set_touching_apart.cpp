// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cassert>
#include <functional>
#include <map>

#include "base/keep_single.hpp"
#include "base/lists.hpp"
#include "base/packed_pair.hpp"
#include "base/parallel.hpp"
#include "structures/joined_rounding.hpp"

namespace realmodel::structures {

using cutting::CutPieces;
using cutting::NodeId;
using cutting::RoundedParts;

namespace {

using Edge = std::array<NodeId, 2>;

/// A polygon that has an edge, and which way it goes along it; between two parts, -1 none.
struct EdgeOfPiece {
    Edge edge;
    std::size_t piece;
    int direction;
    std::array<std::int32_t, 2> parts;

    bool is_of(std::int32_t part) const { return parts[0] == part || parts[1] == part; }
    std::int32_t beyond(std::int32_t part) const { return parts[parts[0] == part ? 1 : 0]; }
    int direction_of(std::int32_t part) const { return parts[0] == part ? direction : -direction; }
};

/// The fewest uses of an edge, as numbers, that lead from one of a part through other parts back to
/// it: each of these has two of them, which turn against each other. None where there is no such
/// way.
std::vector<std::size_t> way_back(std::span<const EdgeOfPiece> uses, std::size_t start,
                                  std::int32_t part) {
    constexpr std::size_t kNot = SIZE_MAX;
    std::vector<std::size_t> before(uses.size(), kNot);
    before[start] = start;
    struct At {
        std::size_t use;
        std::int32_t entered;
    };
    std::vector<At> open{{start, uses[start].beyond(part)}};
    for (std::size_t i = 0; i < open.size(); ++i) {
        const auto [use, entered] = open[i];
        for (std::size_t next = 0; next < uses.size(); ++next) {
            if (before[next] != kNot || !uses[next].is_of(entered) ||
                uses[next].direction_of(entered) != -uses[use].direction_of(entered))
                continue;
            const std::int32_t beyond = uses[next].beyond(entered);
            if (beyond != part) {
                before[next] = use;
                open.push_back({next, beyond});
            } else if (uses[next].direction_of(part) == -uses[start].direction_of(part)) {
                before[next] = use;
                std::vector<std::size_t> way{next};
                while (way.back() != start)
                    way.push_back(before[way.back()]);
                return way;
            }
        }
    }
    return {};
}

/// The shortest way back for a part that has an edge more than twice, of all that have it. None
/// where there is no such part, or no way.
std::vector<std::size_t> shortest_way_back(std::span<const EdgeOfPiece> uses) {
    std::map<std::int32_t, int> count;
    for (const EdgeOfPiece& use : uses) {
        for (const std::int32_t part : use.parts)
            ++count[part];
    }
    std::vector<std::size_t> best;
    for (const auto& [part, times] : count) {
        for (std::size_t start = 0; part >= 0 && times > 2 && start < uses.size(); ++start) {
            if (!uses[start].is_of(part)) continue;
            auto way = way_back(uses, start, part);
            if (!way.empty() && (best.empty() || way.size() < best.size())) best = std::move(way);
        }
    }
    return best;
}

/// The edges near structures that some part has more than twice, in order.
std::vector<Edge> touching_edges(const RoundedParts& parts) {
    auto found = found_in_ranges<Edge>(
        parts.half_cells.size(), 1 << 6, parts.execution,
        [&](std::size_t begin, std::size_t end, std::vector<Edge>& own) {
            std::vector<std::uint64_t> uses;
            for (std::size_t part = begin; part < end; ++part) {
                uses.clear();
                for (const std::int32_t p : parts.pieces_of[part]) {
                    const auto nodes = parts.pieces.polygons[index(p)];
                    for (std::size_t i = 0; i < nodes.size(); ++i) {
                        const auto [a, b] =
                            unordered(nodes[i], nodes[i + 1 < nodes.size() ? i + 1 : 0]);
                        if (parts.is_near[index(a)] != 0 && parts.is_near[index(b)] != 0)
                            uses.push_back(packed_pair(a, b));
                    }
                }
                std::ranges::sort(uses);
                for (std::size_t i = 2; i < uses.size(); ++i) {
                    if (uses[i] == uses[i - 2]) own.push_back(unpacked_pair(uses[i]));
                }
            }
        },
        0.02);
    sort_unique(found);
    return found;
}

/// A new node between the ends of an edge.
NodeId add_between(RoundedParts& parts, const Edge& edge) {
    cutting::Position middle;
    for (std::size_t k = 0; k < 3; ++k)
        middle[k] = parts.at(edge[0])[k] + (parts.at(edge[1])[k] - parts.at(edge[0])[k]) / 2;
    return parts.add_node(middle, parts.freedom_of(edge));
}

}  // namespace

void set_touching_apart(RoundedParts& parts) {
    const std::vector<Edge> touching = touching_edges(parts);
    if (touching.empty()) return;
    const CutPieces& pieces = parts.pieces;
    std::vector<EdgeOfPiece> uses;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        const auto nodes = pieces.polygons[p];
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const NodeId a = nodes[i], b = nodes[(i + 1) % nodes.size()];
            if (std::ranges::binary_search(touching, unordered(a, b)))
                uses.push_back({unordered(a, b), p, a < b ? 1 : -1, pieces[p].parts});
        }
    }
    std::ranges::stable_sort(uses, {}, &EdgeOfPiece::edge);
    std::map<std::size_t, std::vector<std::pair<Edge, NodeId>>> nodes_on;
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        while (end < uses.size() && uses[end].edge == uses[begin].edge)
            ++end;
        if (end - begin <= 2) continue;
        std::vector<EdgeOfPiece> own(uses.begin() + static_cast<std::ptrdiff_t>(begin),
                                     uses.begin() + static_cast<std::ptrdiff_t>(end));
        for (;;) {
            std::vector<std::size_t> way = shortest_way_back(own);
            if (way.empty()) break;
            std::ranges::sort(way, std::greater<>{});  // each is erased without moving the next
            assert(way.size() > 1);                    // the parts on it close around the edge
            const NodeId middle = add_between(parts, uses[begin].edge);
            for (const std::size_t use : way) {
                nodes_on[own[use].piece].push_back({uses[begin].edge, middle});
                own.erase(own.begin() + static_cast<std::ptrdiff_t>(use));
            }
        }
    }
    if (nodes_on.empty()) return;
    CutPieces apart;
    std::vector<NodeId> loop;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        loop.clear();
        const auto nodes = pieces.polygons[p];
        const auto found = nodes_on.find(p);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            loop.push_back(nodes[i]);
            if (found == nodes_on.end()) continue;
            const Edge edge = unordered(nodes[i], nodes[(i + 1) % nodes.size()]);
            for (const auto& [at, middle] : found->second) {
                if (at == edge) loop.push_back(middle);
            }
        }
        apart.add(loop, pieces[p]);
    }
    parts.replace_pieces(std::move(apart));
}

}  // namespace realmodel::structures
