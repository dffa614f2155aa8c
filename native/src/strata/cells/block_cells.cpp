// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/block_cells.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

#include "base/algorithms.hpp"
#include "base/disjoint_sets.hpp"
#include "base/parallel_counts.hpp"
#include "strata/conform/walls.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::SpaceId;

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
        const auto for_each_end = [&](const auto& visit) {
            for (const WallStretch& s : stretches) {
                for (std::size_t i = 0; i < 2; ++i) {
                    if (s.lower[i] != s.upper[i]) visit(WallEnd{s.lower[i], s.upper[i], s.line});
                }
            }
        };
        for_each_end([&](const WallEnd& end) {
            std::int32_t& line = line_[conformed.plan_vertex_of(end.lower)];
            line = line == kNone || line == end.line ? end.line : kSeveral;
        });
        for_each_end([&](const WallEnd& end) {
            if (line_[conformed.plan_vertex_of(end.lower)] == kSeveral) ends_.push_back(end);
        });
        std::ranges::sort(ends_, {}, &WallEnd::lower);
    }
    /// Whether a wall of another line has some of a vertical edge.
    bool end_at(std::int32_t lower, std::int32_t upper, std::int32_t line) const {
        const std::size_t plan_vertex = conformed_.plan_vertex_of(lower);
        if (line_[plan_vertex] != kSeveral) return false;
        const std::int32_t first = conformed_.vertex_offsets[plan_vertex];
        const std::span ends(std::ranges::lower_bound(ends_, first, {}, &WallEnd::lower),
                             std::ranges::lower_bound(ends_, upper, {}, &WallEnd::lower));
        return std::ranges::any_of(
            ends, [&](const WallEnd& end) { return end.upper > lower && end.line != line; });
    }

private:
    static constexpr std::int32_t kNone = -1, kSeveral = -2;
    /// Vertices of one plan vertex have ascending numbers from below.
    struct WallEnd {
        std::int32_t lower, upper, line;
    };

    const ConformedFaces& conformed_;
    std::vector<std::int32_t> line_;  ///< of plan vertices
    std::vector<WallEnd> ends_;       ///< where several lines meet
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
    std::pair<std::int32_t, std::int32_t> next{-1, 0};  // the interval after the last one
    const auto interval_of = [](const WallStretch& s) { return std::pair(s.line, s.interval); };
    for (const auto of_interval : groups_of(stretches, interval_of)) {
        if (interval_of(of_interval[0]) != next) joining.end_line(emit);
        for (const WallStretch& s : of_interval) {
            assert(cell(s.left) != cell(s.right));
            joining.add(s.lower, s.upper, cell(s.left), cell(s.right),
                        is_high(position(s.lower[0]), position(s.upper[0])) &&
                            !meeting.end_at(s.lower[0], s.upper[0], s.line));
        }
        joining.end_interval(emit);
        next = {of_interval[0].line, of_interval[0].interval + 1};
    }
    joining.end_line(emit);
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
    parallel_for_each(conformed.vertices.size(), execution, [&](std::size_t e) {
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
    parallel_for_each(construction.links.size(), execution, [&](std::size_t i) {
        const auto [a, b] = construction.links[i];
        assert(block(a) == block(b));
        sets.join(a, b);
    });
    const auto join = [&](std::int32_t a, std::int32_t b) {
        if (a >= 0 && b >= 0 && block(a) == block(b)) sets.join(a, b);
    };
    parallel_for_each(links.neighbor.size(), execution, [&](std::size_t p) {
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

namespace {

std::int32_t cell(const std::vector<std::int32_t>& cell_of_node, std::int32_t node) {
    return node < 0 ? kOutsideCell : cell_of_node[static_cast<std::size_t>(node)];
}

/// The faces of a complex are seen from outside the cell below, or from below where there is none.
std::array<std::int32_t, 2> turn_outwards(std::int32_t* first, std::int32_t* last,
                                          std::int32_t above, std::int32_t below) {
    if (below >= 0) return {below, above};
    std::reverse(first, last);
    return {above, below};
}

}  // namespace

void add_touched_triangles(PlanArrangement& geometry, const TriangleLinks& links,
                           WholeTriangles& wholes, FaceList& faces, const Execution& execution) {
    std::vector<std::uint8_t> is_touched(links.neighbor.size(), 0);
    parallel_for_each(is_touched.size(), execution, [&](std::size_t p) {
        if (!wholes.face[p].is_set() || wholes.is_added[p] != 0) return;
        const auto& neighbors = links.neighbor[p];
        is_touched[p] =
            wholes.is_exact[p] != 0 ||
            std::any_of(neighbors.begin(), neighbors.end(), [&](PlaneId n) {
                return n != kNone && wholes.piece_state[index(n)] == PieceState::kInPieces;
            });
    });
    std::vector<PlaneId> planes;
    for (std::size_t p = 0; p < is_touched.size(); ++p) {
        poll(execution.progress, p);
        if (is_touched[p] == 0) continue;
        wholes.is_added[p] = 1;
        if (wholes.face[p].is_face()) planes.push_back(static_cast<PlaneId>(p));
    }
    PolygonPool outlines;
    add_outlines(
        geometry, planes.size(), [&](std::size_t i) { return geometry.plane(planes[i]).plan; },
        outlines, execution.progress);
    for (std::size_t i = 0; i < planes.size(); ++i) {
        const WholeFace& face = wholes.of(planes[i]);
        faces.add(outlines[i], planes[i], face.surface, face.above, face.below);
    }
    for (const auto& [plane, base, node] : wholes.on_base) {
        if (is_touched[index(plane)] == 0) continue;
        faces.add(triangle_outline(geometry, geometry.plane(plane).plan), base, -1, node,
                  kOutsideCell);
    }
}

UntouchedTriangles::UntouchedTriangles(const PlanArrangement& geometry,
                                       const WholeTriangles& wholes,
                                       const std::vector<std::int32_t>& surface_of_plane,
                                       const FaceList& faces, const ConformedFaces& conformed,
                                       const Execution& execution)
    : geometry_(geometry),
      wholes_(wholes),
      surface_of_plane_(surface_of_plane),
      execution_(execution),
      of_space_(static_cast<std::size_t>(geometry.space_count()), -1),
      of_base_(wholes.on_base.empty() ? 0 : geometry.vertex_count(), -1) {
    // Several threads may say so of one vertex at once; they all write the same, but for vertices
    // of several bases, which lie on borders and so on no untouched triangle.
    const auto set = [](std::int32_t& number, std::int32_t to) {
        std::atomic_ref(number).store(to, std::memory_order_relaxed);
    };
    parallel_for_each(faces.size(), execution, [&](std::size_t f) {
        const bool is_base = surface_of_plane[index(faces.plane[f])] < 0;
        for (auto c = faces.polygons.offsets[f]; c < faces.polygons.offsets[f + 1]; ++c) {
            const PointId point = faces.polygons.points[c];
            if (!geometry.is_vertex(point)) continue;
            const std::int32_t number = conformed.vertices[conformed.entries.first(c)];
            if (is_base) {
                if (!of_base_.empty()) set(of_base_[index(point)], number);
                continue;
            }
            const SpaceId s = geometry.plane(faces.plane[f]).above(geometry.vertex(point));
            if (s != kNone) set(of_space_[index(s)], number);
        }
    });
}

void UntouchedTriangles::add_to(CellComplex& complex,
                                const std::vector<std::int32_t>& cell_of_node) {
    number_vertices(complex);
    add_triangles(complex, cell_of_node);
    add_bases(complex, cell_of_node);
}

/// Numbers the input vertices that only untouched triangles have, in their order.
void UntouchedTriangles::number_vertices(CellComplex& complex) {
    auto is_new = zeros<std::uint8_t>(of_space_.size(), execution_);
    parallel_for_each(wholes_.face.size(), execution_, [&](std::size_t p) {
        if (!is_face(p)) return;
        for (const SpaceId s : geometry_.plane(static_cast<PlaneId>(p)).corner)
            atomic_set(is_new[index(s)]);
    });
    const std::size_t before = complex.vertices.size();
    number_in_order(
        of_space_.size(), execution_,
        [&](std::size_t s) { return is_new[s] != 0 && of_space_[s] < 0; },
        [&](std::size_t more) {
            check_total(before + more, INT32_MAX);
            complex.vertices.resize(before + more);
        },
        [&](std::size_t s, std::size_t number) {
            const auto& space = geometry_.space(static_cast<SpaceId>(s));
            const auto& at = geometry_.point(space.plan);
            complex.vertices[before + number] = {at.x, at.y, space.z};
            of_space_[s] = static_cast<std::int32_t>(before + number);
        });
}

void UntouchedTriangles::add_triangles(CellComplex& complex,
                                       const std::vector<std::int32_t>& cell_of_node) const {
    const std::size_t faces = complex.face_cells.size(), corners = complex.face_vertices.size();
    number_in_order(
        wholes_.face.size(), execution_, [&](std::size_t p) { return is_face(p); },
        [&](std::size_t count) {
            complex.face_vertices.resize(corners + 3 * count);
            complex.face_offsets.resize(faces + count + 1);
            complex.face_cells.resize(faces + count);
            complex.face_surface.resize(faces + count);
        },
        [&](std::size_t p, std::size_t number) {
            const auto& corner = geometry_.plane(static_cast<PlaneId>(p)).corner;
            std::int32_t* loop = complex.face_vertices.begin() + corners + 3 * number;
            std::transform(corner.begin(), corner.end(), loop,
                           [&](SpaceId s) { return of_space_[index(s)]; });
            complex.face_cells[faces + number] =
                turn_outwards(loop, loop + 3, cell(cell_of_node, wholes_.face[p].above),
                              cell(cell_of_node, wholes_.face[p].below));
            complex.face_surface[faces + number] = surface_of_plane_[p];
            complex.face_offsets[faces + number + 1] =
                static_cast<std::int64_t>(corners + 3 * (number + 1));
        });
}

void UntouchedTriangles::add_bases(CellComplex& complex,
                                   const std::vector<std::int32_t>& cell_of_node) {
    auto& loop = complex.face_vertices;
    for (const auto& [plane, base, node] : wholes_.on_base) {
        if (wholes_.is_added[index(plane)] != 0) continue;
        const double z = geometry_.space(geometry_.plane(base).corner[0]).z;
        for (const exact::VertexId v : geometry_.plane(plane).plan) {
            std::int32_t& number = of_base_[index(v)];
            if (number < 0) {
                number = static_cast<std::int32_t>(complex.vertices.size());
                check_total(complex.vertices.size() + 1, INT32_MAX);
                complex.vertices.push_back({geometry_.point(v).x, geometry_.point(v).y, z});
            }
            loop.push_back(number);
        }
        complex.face_cells.push_back(
            turn_outwards(loop.end() - 3, loop.end(), cell(cell_of_node, node), kOutsideCell));
        complex.face_offsets.push_back(static_cast<std::int64_t>(loop.size()));
        complex.face_surface.push_back(kBase);
    }
}

}  // namespace realmodel::strata
