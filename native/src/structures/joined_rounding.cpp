// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/joined_rounding.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "cutting/rounding/part_rounding.hpp"
#include "structures/wanted_parts.hpp"

namespace realmodel::structures {

using cutting::CutPiece;
using cutting::CutPieces;
using cutting::NodeId;
using cutting::Position;
using cutting::RoundedParts;

void merge_needles(RoundedParts& parts, double least_rounding) {
    const double allowed = std::max(cutting::rounding_of(parts.vertices), least_rounding);
    const auto is_needle = [&](std::int32_t part) {
        return parts.has_far_faces[index(part)] == 0 &&
               std::ranges::all_of(parts.pieces_of[index(part)], [&](std::int32_t piece) {
                   const std::vector corners =
                       transformed(parts.pieces.polygons[index(piece)],
                                   [&parts](NodeId node) { return parts.at(node); });
                   return is_narrow({&corners, 1}, allowed);
               });
    };
    std::vector<std::int32_t> into(parts.half_cells.size());
    std::iota(into.begin(), into.end(), 0);
    const auto find = [&into](std::int32_t part) {
        while (part >= 0 && into[index(part)] != part)
            part = into[index(part)];
        return part;
    };
    bool any = false;
    for (const CutPiece& piece : parts.pieces.origins) {
        if (piece.face >= 0 || WantedParts::surface_of_cut_face(piece.face) != kWall) continue;
        const std::int32_t one = find(piece.parts[0]), other = find(piece.parts[1]);
        if (one < 0 || other < 0 || one == other) continue;
        for (const auto& [needle, rest] : {std::pair(one, other), std::pair(other, one)}) {
            if (!is_needle(needle)) continue;
            into[index(needle)] = rest;
            any = true;
            break;
        }
    }
    if (!any) return;
    for (CutPiece& piece : parts.pieces.origins) {
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t part = find(piece.parts[k]);
            if (part == piece.parts[k]) continue;
            piece.parts[k] = part;
            piece.cells[k] = parts.half_cells[index(part)].cell;
            piece.sides[k] = parts.half_cells[index(part)].side;
        }
        if (piece.parts[0] == piece.parts[1]) piece.parts = {-1, -1};
    }
    parts.update();
}

void cancel_facing(cutting::RoundedParts& parts) {
    CutPieces& pieces = parts.pieces;
    std::vector<std::uint8_t> is_gone(pieces.size(), 0);
    CutPieces fresh;
    bool any = false;
    for (const auto& equal : cutting::equal_pieces(parts)) {
        std::map<std::int32_t, int> facing;  // of parts: how often a polygon faces away from each
        std::size_t before = 0;
        for (const std::size_t p : equal) {
            const int winding = cutting::winding_of(pieces.polygons[p]);
            for (std::size_t k = 0; k < 2; ++k) {
                if (pieces[p].parts[k] < 0) continue;
                facing[pieces[p].parts[k]] += k == 0 ? winding : -winding;
                ++before;
            }
        }
        std::array<std::vector<std::int32_t>, 2> left;  // parts that it faces away from, and faces
        for (const auto& [part, times] : facing) {
            auto& of_side = left[times > 0 ? 0 : 1];
            of_side.insert(of_side.end(), index(std::abs(times)), part);
        }
        assert(left[0].size() + left[1].size() <= before);
        if (left[0].size() + left[1].size() == before) continue;
        any = true;
        // what ends at no rock is what ended there before, not what was between two parts
        const bool ends = left[0].size() != left[1].size();
        const auto alike = std::ranges::find_if(equal, [&](std::size_t p) {
            return (pieces[p].parts[0] < 0 || pieces[p].parts[1] < 0) == ends;
        });
        const CutPiece& named = pieces[alike == equal.end() ? equal[0] : *alike];
        const auto first = pieces.polygons[equal[0]];
        std::vector<NodeId> nodes(first.begin(), first.end());
        if (cutting::winding_of(nodes) < 0) std::ranges::reverse(nodes);
        for (std::size_t i = 0; i < std::max(left[0].size(), left[1].size()); ++i) {
            CutPiece piece = named;
            for (std::size_t k = 0; k < 2; ++k) {
                const bool has_part = i < left[k].size();
                piece.parts[k] = has_part ? left[k][i] : -1;
                piece.cells[k] = has_part ? parts.half_cells[index(left[k][i])].cell : -1;
                piece.sides[k] = has_part ? parts.half_cells[index(left[k][i])].side : cutting::kOn;
            }
            fresh.add(nodes, piece);
        }
        for (const std::size_t p : equal)
            is_gone[p] = 1;
    }
    if (any) {
        for (std::size_t p = 0; p < pieces.size(); ++p) {
            if (is_gone[p] == 0) fresh.add(pieces.polygons[p], pieces[p]);
        }
        parts.replace_pieces(std::move(fresh));
    }
    cutting::drop_hollow(parts);
}

namespace {

using NodeEdge = std::array<NodeId, 2>;

/// A polygon that has an edge, and which way it goes along it; between two parts, -1 none.
struct EdgeOfPiece {
    NodeEdge edge;
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
std::vector<NodeEdge> touching_edges(const RoundedParts& parts) {
    auto edges = collect_ranges<NodeEdge>(
        parts.half_cells.size(), 1 << 6, parts.execution,
        [&](std::size_t begin, std::size_t end, std::vector<NodeEdge>& in_range) {
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
                    if (uses[i] == uses[i - 2]) in_range.push_back(unpacked_pair(uses[i]));
                }
            }
        },
        0.02);
    sort_unique(edges);
    return edges;
}

/// A new node between the ends of an edge.
NodeId add_between(RoundedParts& parts, const NodeEdge& edge) {
    cutting::Position middle;
    for (std::size_t k = 0; k < 3; ++k)
        middle[k] = parts.at(edge[0])[k] + (parts.at(edge[1])[k] - parts.at(edge[0])[k]) / 2;
    return parts.add_node(middle, parts.freedom_of(edge));
}

}  // namespace

void set_touching_apart(RoundedParts& parts) {
    const std::vector<NodeEdge> touching = touching_edges(parts);
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
    std::map<std::size_t, std::vector<std::pair<NodeEdge, NodeId>>> nodes_on;
    for (const auto of_edge : groups_of(uses, &EdgeOfPiece::edge)) {
        if (of_edge.size() <= 2) continue;
        const NodeEdge edge = of_edge[0].edge;
        std::vector<EdgeOfPiece> left(of_edge.begin(), of_edge.end());
        for (;;) {
            std::vector<std::size_t> way = shortest_way_back(left);
            if (way.empty()) break;
            std::ranges::sort(way, std::greater<>{});  // each is erased without moving the next
            assert(way.size() > 1);                    // the parts on it close around the edge
            const NodeId middle = add_between(parts, edge);
            for (const std::size_t use : way) {
                nodes_on[left[use].piece].push_back({edge, middle});
                left.erase(left.begin() + static_cast<std::ptrdiff_t>(use));
            }
        }
    }
    if (nodes_on.empty()) return;
    CutPieces apart;
    std::vector<NodeId> loop;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        loop.clear();
        const auto nodes = pieces.polygons[p];
        const auto of_piece = nodes_on.find(p);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            loop.push_back(nodes[i]);
            if (of_piece == nodes_on.end()) continue;
            const NodeEdge edge = unordered(nodes[i], nodes[(i + 1) % nodes.size()]);
            for (const auto& [at, middle] : of_piece->second) {
                if (at == edge) loop.push_back(middle);
            }
        }
        apart.add(loop, pieces[p]);
    }
    parts.replace_pieces(std::move(apart));
}

namespace {

/// Whether corners do not lie in the plane that fits them, by more than the rounding of their
/// coordinates.
bool is_warped(std::span<const Position> corners) {
    constexpr double kUnits = 8;  // in the last place, by which coordinates may be off
    const Position normal = polygon_normal(corners);
    double allowed = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        double largest = 0;
        for (const Position& p : corners)
            largest = std::max(largest, std::abs(p[axis]));
        allowed += kUnits * std::abs(normal[axis]) * (std::nextafter(largest, HUGE_VAL) - largest);
    }
    return !std::ranges::all_of(corners, [&](const Position& p) {
        return std::abs(dot(normal, minus(p, corners[0]))) <= allowed;
    });
}

}  // namespace

void round_joined_parts(cutting::RoundedParts&& parts, const std::array<bool, 2>& touches,
                        double least_rounding) {
    assert(parts.are_joined && parts.are_closed());
    // The order of cutting::round_parts(). Short edges come after nodes in one position, for each
    // is weighed by what the parts are like without these, and what faces each other then cancels
    // before nodes are set apart. Nodes in the middle of polygons may make others the same once
    // more. Where a part touches itself is only known at the end.
    merge_needles(parts, least_rounding);
    cutting::drop_hollow(parts);
    cutting::level_base(parts);
    cutting::join_coincident(parts, touches, true);
    join_short_edges(parts, least_rounding);
    cancel_facing(parts);
    cutting::separate_coincident_nodes(parts);
    cutting::widen_flat_parts(parts);
    cutting::triangulate_nonplanar(parts, cutting::merge_coincident_faces(parts), is_warped);
    parts.update();
    cancel_facing(parts);
    set_touching_apart(parts);
    cutting::drop_empty(parts);
    assert(parts.are_closed() && parts.are_apart());
}

}  // namespace realmodel::structures
