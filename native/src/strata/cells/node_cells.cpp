// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/node_cells.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "base/disjoint_sets.hpp"
#include "base/parallel_counts.hpp"
#include "strata/conform/interval_curves.hpp"

namespace realmodel::strata {

namespace {

/// Whether walls beside each other at a vertical edge make one face: where the edge is much longer
/// than what rounding moves positions by, for rounded ones are not quite on one line.
bool is_high(const std::array<double, 3>& lower, const std::array<double, 3>& upper) {
    return upper[2] - lower[2] > 0x1p-26 * std::max(std::abs(lower[0]), std::abs(lower[1]));
}

/// Where walls of several lines meet. A cell may touch itself there along a vertical edge that
/// walls of one of the lines pass: another cell, or the outside, has an edge there. They end at it
/// then, so that whoever divides the cell finds what the edge parts.
class MeetingWalls {
public:
    MeetingWalls(std::span<const WallStretch> stretches, const ConformedFaces& conformed)
        : conformed_(conformed), line_(conformed.vertex_offsets.size(), kNone) {
        const auto each_end = [&](const auto& visit) {
            for (const WallStretch& s : stretches) {
                for (std::size_t i = 0; i < 2; ++i) {
                    if (s.lower[i] != s.upper[i]) visit(End{s.lower[i], s.upper[i], s.line});
                }
            }
        };
        each_end([&](const End& end) {
            std::int32_t& line = line_[conformed.plan_vertex_of(end.lower)];
            line = line == kNone || line == end.line ? end.line : kSeveral;
        });
        each_end([&](const End& end) {
            if (line_[conformed.plan_vertex_of(end.lower)] == kSeveral) ends_.push_back(end);
        });
        std::ranges::sort(ends_, {}, &End::lower);
    }
    /// Whether a wall of another line has some of a vertical edge.
    bool end_at(std::int32_t lower, std::int32_t upper, std::int32_t line) const {
        const std::size_t plan_vertex = conformed_.plan_vertex_of(lower);
        if (line_[plan_vertex] != kSeveral) return false;
        const std::int32_t first = conformed_.vertex_offsets[plan_vertex];
        const std::span there(std::ranges::lower_bound(ends_, first, {}, &End::lower),
                              std::ranges::lower_bound(ends_, upper, {}, &End::lower));
        return std::ranges::any_of(
            there, [&](const End& end) { return end.upper > lower && end.line != line; });
    }

private:
    static constexpr std::int32_t kNone = -1, kSeveral = -2;
    /// Vertices of one plan vertex have ascending numbers from below.
    struct End {
        std::int32_t lower, upper, line;
    };

    const ConformedFaces& conformed_;
    std::vector<std::int32_t> line_;  ///< of plan vertices
    std::vector<End> ends_;           ///< where several lines meet
};

/// Calls emit(wall) with the walls between cells.
template <class Emit>
void for_each_wall(std::span<const WallStretch> stretches,
                   const std::vector<std::int32_t>& cell_of_node, const ConformedFaces& conformed,
                   const MeetingWalls& meeting, const Emit& emit) {
    const auto position = [&](std::int32_t v) -> const std::array<double, 3>& {
        return conformed.positions[static_cast<std::size_t>(v)];
    };
    const auto cell = [&](std::int32_t node) {
        return node < 0 ? kOutsideCell : cell_of_node[static_cast<std::size_t>(node)];
    };
    WallJoining joining;
    for (std::size_t i = 0; i < stretches.size(); ++i) {
        const WallStretch& s = stretches[i];
        assert(cell(s.left) != cell(s.right));
        joining.add(s.lower, s.upper, cell(s.left), cell(s.right),
                    is_high(position(s.lower[0]), position(s.upper[0])) &&
                        !meeting.end_at(s.lower[0], s.upper[0], s.line));
        const bool is_last = i + 1 == stretches.size();
        if (!is_last && stretches[i + 1].line == s.line && stretches[i + 1].interval == s.interval)
            continue;
        joining.end_interval(emit);
        if (is_last || stretches[i + 1].line != s.line ||
            stretches[i + 1].interval != s.interval + 1)
            joining.end_line(emit);
    }
}

/// Keeps some of the vertices.
/// @return the new number of each, -1 of those that are gone
std::vector<std::int32_t> keep_vertices(const std::vector<std::uint8_t>& is_needed,
                                        ConformedFaces& conformed, const Execution& execution) {
    std::vector<std::int32_t> number(is_needed.size(), -1);
    std::int32_t count = 0;
    for (std::size_t v = 0; v < is_needed.size(); ++v) {
        if (is_needed[v] == 0) continue;
        conformed.positions[static_cast<std::size_t>(count)] = conformed.positions[v];
        number[v] = count++;
    }
    conformed.positions.resize(static_cast<std::size_t>(count));
    parallel_each(conformed.vertices.size(), execution, [&](std::size_t e) {
        conformed.vertices[e] = number[static_cast<std::size_t>(conformed.vertices[e])];
    });
    return number;
}

}  // namespace

std::vector<std::int32_t> cells_of_nodes(const Construction& construction,
                                         const TriangleLinks& links, const WholeTriangles& wholes,
                                         Array<std::int32_t>& cell_block,
                                         const Execution& execution) {
    const auto block = [&](std::int32_t node) {
        return construction.node_block[static_cast<std::size_t>(node)];
    };
    DisjointSets sets(construction.node_block.size());
    parallel_each(construction.links.size(), execution, [&](std::size_t i) {
        const auto [a, b] = construction.links[i];
        assert(block(a) == block(b));
        sets.join(a, b);
    });
    const auto join = [&](std::int32_t a, std::int32_t b) {
        if (a >= 0 && b >= 0 && block(a) == block(b)) sets.join(a, b);
    };
    parallel_each(links.neighbor.size(), execution, [&](std::size_t p) {
        const WholeFace& face = wholes.face[p];
        if (!face.is_set()) return;
        for (const PlaneId n : links.neighbor[p]) {
            if (n <= static_cast<PlaneId>(p) || !wholes.of(n).is_set()) continue;
            join(face.above, wholes.of(n).above);
            join(face.below, wholes.of(n).below);
        }
    });
    std::vector<std::int32_t> cell_of_node(construction.node_block.size());
    for (std::size_t n = 0; n < cell_of_node.size(); ++n) {
        poll(execution.progress, n);
        const auto root = static_cast<std::size_t>(sets.find(static_cast<std::int32_t>(n)));
        if (root == n) {
            cell_of_node[n] = static_cast<std::int32_t>(cell_block.size());
            cell_block.push_back(construction.node_block[n]);
        } else {
            cell_of_node[n] = cell_of_node[root];
        }
    }
    return cell_of_node;
}

JoinedWalls join_stretches(std::span<const WallStretch> stretches,
                           const std::vector<std::int32_t>& cell_of_node, const FaceList& faces,
                           std::span<const ExtraPoint> crossings, const PlanVertices& plan_vertices,
                           ConformedFaces& conformed, const Execution& execution) {
    std::vector<std::uint8_t> is_needed(conformed.positions.size(), 0), may_bend(is_needed);
    for (std::size_t c = 0; c < faces.polygons.points.size(); ++c)
        is_needed[static_cast<std::size_t>(conformed.vertices[conformed.entries.first(c)])] = 1;
    for (const ExtraPoint& e : crossings) {
        const auto vertex = index(plan_vertices.of_point[index(e.point)]);
        std::fill(may_bend.begin() + conformed.vertex_offsets[vertex],
                  may_bend.begin() + conformed.vertex_offsets[vertex + 1], std::uint8_t{1});
    }
    for (const WallStretch& s : stretches) {
        for (const std::int32_t v : {s.lower[0], s.lower[1], s.upper[0], s.upper[1]})
            is_needed[static_cast<std::size_t>(v)] |= may_bend[static_cast<std::size_t>(v)];
    }
    const MeetingWalls meeting(stretches, conformed);
    const auto for_all = [&](const auto& emit) {
        for_each_wall(stretches, cell_of_node, conformed, meeting, emit);
    };
    for_all([&](const OpenWall& wall) {
        for (const std::int32_t v :
             {wall.lower.front(), wall.lower.back(), wall.upper.front(), wall.upper.back()})
            is_needed[static_cast<std::size_t>(v)] = 1;
    });
    WallBatch walls;
    for_all([&](const OpenWall& wall) {
        walls.add(wall.lower, wall.upper, {wall.left, wall.right},
                  [&](std::int32_t v) { return is_needed[static_cast<std::size_t>(v)] != 0; });
    });
    auto number = keep_vertices(is_needed, conformed, execution);
    for (std::int32_t& v : walls.vertices)
        v = number[static_cast<std::size_t>(v)];
    return {std::move(walls), std::move(number)};
}

}  // namespace realmodel::strata
