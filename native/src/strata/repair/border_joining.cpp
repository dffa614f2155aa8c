// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/border_joining.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "base/algorithms.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/vectors.hpp"
#include "exact/orientation.hpp"
#include "spatial/plan_tiles.hpp"
#include "strata/tiling/plan_links.hpp"

namespace realmodel::strata {

namespace {

using spatial::PlanPosition;
using PlanEdge = std::pair<PlanPosition, PlanPosition>;  ///< the lesser end first

PlanEdge edge_between(const PlanPosition& a, const PlanPosition& b) {
    return a < b ? PlanEdge{a, b} : PlanEdge{b, a};
}

/// A mesh with snapped positions.
struct SnappedMesh {
    PlanMesh mesh;
    const PlanSnapping& snapping;

    PlanPosition position(std::int32_t v) const {
        const auto [x, y] = mesh.position(index(v));
        return {snapping.x(x), snapping.y(y)};
    }
    /// The corners' numbers; none where they are refused later or the triangle has no area.
    std::optional<std::array<std::int32_t, 3>> corners(std::size_t t) const {
        const auto v = mesh.corners(t);
        if (v && exact::orient2d(position((*v)[0]), position((*v)[1]), position((*v)[2])) == 0)
            return std::nullopt;
        return v;
    }
};

/// The edges that one triangle only has, by vertex numbers, the lower first.
std::vector<std::array<std::int32_t, 2>> single_edges(const SnappedMesh& snapped,
                                                      Progress* progress) {
    const std::size_t count = snapped.mesh.view.triangle_count();
    check_triangle_count(count);
    std::vector<std::array<std::int32_t, 3>> triangles;
    triangles.reserve(count);
    for (std::size_t t = 0; t < count; ++t) {
        poll(progress, t);
        if (const auto v = snapped.corners(t)) triangles.push_back(*v);
    }
    const std::size_t vertices = snapped.mesh.vertex_count();
    const auto higher = bucketize<std::int32_t>(vertices, [&](const auto& put) {
        for (std::size_t t = 0; t < triangles.size(); ++t) {
            poll(progress, t);
            for (std::size_t i = 0; i < 3; ++i) {
                const auto [low, high] = std::minmax({triangles[t][i], triangles[t][(i + 1) % 3]});
                put(index(low), high);
            }
        }
    });
    std::vector<std::array<std::int32_t, 2>> single;
    std::vector<std::int32_t> of_vertex;
    for (std::size_t i = 0; i < vertices; ++i) {
        poll(progress, i);
        of_vertex.assign(higher[i].begin(), higher[i].end());
        std::sort(of_vertex.begin(), of_vertex.end());
        keep_single(of_vertex);
        for (const std::int32_t other : of_vertex)
            single.push_back({static_cast<std::int32_t>(i), other});
    }
    return single;
}

/// The edges that one triangle only has in plan, ascending.
std::vector<PlanEdge> border_of(const SnappedMesh& mesh, Progress* progress) {
    // first by number, which leaves few; then by position, for vertices that are given several
    // times
    const auto once = single_edges(mesh, progress);
    std::vector<PlanEdge> edges;
    for (const auto& [a, b] : once)
        edges.push_back(edge_between(mesh.position(a), mesh.position(b)));
    std::sort(edges.begin(), edges.end());
    keep_single(edges);
    return edges;
}

/// The vertices within rounding of the inside of an edge, from its first end; none where all of
/// them lie exactly on its line.
/// @param reach  what rounding is taken for
std::vector<PlanPosition> vertices_along(const PlanEdge& edge, const spatial::PointBins& vertices,
                                         double reach) {
    const PlanPosition &p = edge.first, &q = edge.second;
    const PlanPosition way = minus(q, p);
    const double length = distance(p, q);
    std::vector<std::pair<double, PlanPosition>> near_vertices;
    bool beside = false;
    const spatial::PlanBox box = spatial::box_around(std::array{p, q}).widened(2 * reach);
    vertices.within(box, [&](std::size_t, const PlanPosition& v) {
        const PlanPosition off = minus(v, p);
        if (std::abs(cross(off, way)) > reach * length) return;
        const double along = dot(off, way) / length;
        if (along <= 2 * reach || along >= length - 2 * reach) return;
        near_vertices.emplace_back(along, v);
        beside |= exact::orient2d(p, q, v) != 0;
    });
    // An edge that is bent anywhere has to run through those on its line by name, too.
    if (!beside) return {};
    std::sort(near_vertices.begin(), near_vertices.end());
    std::vector<PlanPosition> chain;
    double last = 0;
    for (const auto& [along, v] : near_vertices) {
        if (!chain.empty() && along - last <= 2 * reach) continue;
        chain.push_back(v);
        last = along;
    }
    return chain;
}

/// A mesh with the divided triangles' pieces.
class DividedMesh {
public:
    DividedMesh(const SnappedMesh& snapped, const BorderChains& chains, Progress* progress)
        : columns_(snapped.mesh.columns) {
        const auto& [input_vertices, input_triangles] = snapped.mesh.view;
        vertices.assign(input_vertices.begin(), input_vertices.end());
        for (std::size_t row = 0; row + columns_ <= vertices.size(); row += columns_) {
            vertices[row] = snapped.snapping.x(vertices[row]);
            vertices[row + 1] = snapped.snapping.y(vertices[row + 1]);
        }
        triangles.assign(input_triangles.begin(), input_triangles.end());
        if (chains.empty()) return;
        find_divisions(snapped, chains, progress);
        for (const Division& division : divisions_)
            divide(division);
    }

    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;

private:
    using Corners = std::array<std::int32_t, 3>;
    /// Vertices still to be inserted into the edges 0-1, 1-2 and 2-0 of a piece, in that direction.
    using Waiting = std::array<std::vector<std::int32_t>, 3>;

    /// A triangle and what divides its edges, or null.
    struct Division {
        std::size_t triangle;
        Corners corners;
        std::array<const BorderChains::value_type*, 3> chains;
    };

    /// An edge is divided in all triangles that have it or in none: else one would reach over what
    /// the other still has.
    void find_divisions(const SnappedMesh& snapped, const BorderChains& chains,
                        Progress* progress) {
        for (std::size_t t = 0; t < snapped.mesh.view.triangle_count(); ++t) {
            poll(progress, t);
            const auto corners = snapped.corners(t);
            if (!corners) continue;
            Division division{t, *corners, {}};
            for (std::size_t i = 0; i < 3; ++i) {
                const auto chain = chains.find(
                    edge_between(position((*corners)[i]), position((*corners)[(i + 1) % 3])));
                if (chain != chains.end()) division.chains[i] = &*chain;
            }
            if (has_chain(division)) divisions_.push_back(division);
        }
        std::set<const BorderChains::value_type*> refused;
        std::size_t before = 0;
        do {
            before = refused.size();
            for (Division& division : divisions_) {
                for (auto& chain : division.chains) {
                    if (refused.contains(chain)) chain = nullptr;
                }
                if (!keeps_turn(division))
                    refused.insert(division.chains.begin(), division.chains.end());
                refused.erase(nullptr);
            }
        } while (refused.size() != before);
    }

    static bool has_chain(const Division& division) {
        return division.chains != std::array<const BorderChains::value_type*, 3>{};
    }

    /// Whether all pieces turn as the triangle does.
    bool keeps_turn(const Division& division) {
        const std::size_t vertices_before = vertices.size();
        const std::vector<Corners> pieces = pieces_of(division);
        const int turn = turn_of(division.corners);
        const bool keeps =
            std::ranges::all_of(pieces, [&](const Corners& p) { return turn_of(p) == turn; });
        vertices.resize(vertices_before);
        return keeps;
    }

    void divide(const Division& division) {
        if (!has_chain(division)) return;
        const std::vector<Corners> pieces = pieces_of(division);
        std::copy(pieces[0].begin(), pieces[0].end(),
                  triangles.begin() + static_cast<std::ptrdiff_t>(3 * division.triangle));
        for (std::size_t i = 1; i < pieces.size(); ++i)
            triangles.insert(triangles.end(), pieces[i].begin(), pieces[i].end());
    }

    /// The pieces of a triangle, whose new vertices are added.
    std::vector<Corners> pieces_of(const Division& division) {
        Waiting waiting;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto* chain = division.chains[i];
            if (chain == nullptr) continue;
            const std::int32_t a = division.corners[i], b = division.corners[(i + 1) % 3];
            const bool ahead = position(a) == chain->first.first;
            for (const PlanPosition& p : chain->second)
                waiting[i].push_back(insert(p, ahead ? a : b, ahead ? b : a));
            if (!ahead) std::reverse(waiting[i].begin(), waiting[i].end());
        }
        std::vector<Corners> pieces;
        divide(division.corners, waiting, pieces);
        return pieces;
    }

    /// Splits along a fan from the corner opposite of the first edge that has vertices waiting.
    void divide(const Corners& c, const Waiting& waiting, std::vector<Corners>& pieces) const {
        std::size_t k = 0;
        while (k < 3 && waiting[k].empty())
            ++k;
        if (k == 3) {
            pieces.push_back(c);
            return;
        }
        std::vector<std::int32_t> along{c[k]};
        along.insert(along.end(), waiting[k].begin(), waiting[k].end());
        along.push_back(c[(k + 1) % 3]);
        for (std::size_t i = 0; i + 1 < along.size(); ++i) {
            Waiting rest;
            if (i + 2 == along.size()) rest[1] = waiting[(k + 1) % 3];
            if (i == 0) rest[2] = waiting[(k + 2) % 3];
            divide({along[i], along[i + 1], c[(k + 2) % 3]}, rest, pieces);
        }
    }

    /// A new vertex on the edge from a to b; its height is the same whichever triangle asks.
    std::int32_t insert(const PlanPosition& p, std::int32_t a, std::int32_t b) {
        const auto row = [&](std::int32_t v) { return static_cast<std::size_t>(v) * columns_; };
        const PlanPosition from = position(a), to = position(b);
        vertices.push_back(p[0]);
        vertices.push_back(p[1]);
        if (columns_ == 3) {
            const PlanPosition way = minus(to, from);
            const double share = dot(minus(p, from), way) / dot(way, way);
            const double za = vertices[row(a) + 2], zb = vertices[row(b) + 2];
            vertices.push_back(za + share * (zb - za));
        }
        return static_cast<std::int32_t>(vertices.size() / columns_) - 1;
    }

    PlanPosition position(std::int32_t v) const {
        const std::size_t row = static_cast<std::size_t>(v) * columns_;
        return {vertices[row], vertices[row + 1]};
    }
    int turn_of(const Corners& c) const {
        return exact::orient2d(position(c[0]), position(c[1]), position(c[2]));
    }

    std::size_t columns_;
    std::vector<Division> divisions_;
};

}  // namespace

BorderChains find_chains(std::span<const StackInput> rocks, const PlanSnapping& snapping,
                         const Execution& execution) {
    const std::vector<PlanMesh> meshes = meshes_of(rocks);
    std::vector<std::vector<PlanEdge>> borders(meshes.size());
    parallel_chunks(meshes.size(), execution, [&](std::size_t m) {
        borders[m] = border_of({meshes[m], snapping}, execution.progress);
    });
    std::vector<PlanEdge> edges = concatenated(borders);
    sort_unique(edges);
    BorderChains chains;
    if (edges.empty()) return chains;
    std::vector<PlanPosition> ends;
    double largest = 0;
    for (const auto& [a, b] : edges) {
        for (const PlanPosition& p : {a, b}) {
            ends.push_back(p);
            largest = std::max({largest, std::abs(p[0]), std::abs(p[1])});
        }
    }
    sort_unique(ends);

    const double reach = largest * 0x1p-50;  // four to eight units in the last place
    const spatial::PointBins vertices(ends);
    for (std::size_t i = 0; i < edges.size(); ++i) {
        poll(execution.progress, i);
        auto chain = vertices_along(edges[i], vertices, reach);
        if (!chain.empty()) chains.emplace(edges[i], std::move(chain));
    }
    return chains;
}

JoinedMesh joined_mesh(const PlanMesh& mesh, const PlanSnapping& snapping,
                       const BorderChains& chains, Progress* progress) {
    DividedMesh pieces({mesh, snapping}, chains, progress);
    return {std::move(pieces.vertices), std::move(pieces.triangles)};
}

JoinedBorders join_borders(std::span<const StackInput> rocks, const PlanSnapping& snapping,
                           const BorderChains& chains, Progress* progress) {
    JoinedBorders joined;
    const auto replace = [&](auto& view, std::size_t columns) {
        const JoinedMesh& mesh =
            joined.meshes.emplace_back(joined_mesh({view, columns}, snapping, chains, progress));
        view = {mesh.vertices, mesh.triangles};
    };
    for (const StackInput& rock : rocks) {
        StackInput& copy = joined.rocks.emplace_back(rock);
        for (TriangleView& s : copy.surfaces)
            replace(s, 3);
        if (copy.region) replace(*copy.region, 2);
    }
    return joined;
}

Warning joined_by_rounding(const PlanSnapping& snapping, const BorderChains& chains) {
    const std::size_t coordinates = snapping.x.size() + snapping.y.size();
    std::string text;
    if (coordinates > 0) {
        text =
            "plan coordinates merged that differ only by rounding: " + std::to_string(coordinates);
    }
    if (!chains.empty()) {
        text += (text.empty() ? "" : "; ") +
                ("border edges split at vertices that lie on them up to rounding: " +
                 std::to_string(chains.size()));
    }
    return {"joined", -1, {}, text + "; no action is needed"};
}

}  // namespace realmodel::strata
