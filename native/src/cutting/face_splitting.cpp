// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/face_splitting.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace realmodel::cutting {

namespace {

/// A part of a triangle on one side of the plane. Its edges are those of the triangle, or the cut.
struct TrianglePart {
    std::vector<NodeId> nodes;
    std::int8_t side = kOn;
};

/// One edge of a part, and the edge against it of the part beyond, if that is on the same side.
struct HalfEdge {
    NodeId from = 0, to = 0;
    std::int32_t part = 0, next = 0, twin = -1;
};

}  // namespace

void FaceSplitter::split(std::span<const NodeId> face, FaceParts& parts) {
    if (!split_in_two(face, parts)) split_by_triangles(face, parts);
}

bool FaceSplitter::split_in_two(std::span<const NodeId> face, FaceParts& parts) {
    cycle_.clear();
    std::array<std::size_t, 2> on{};
    std::size_t found = 0;
    for (std::size_t i = 0; i < face.size(); ++i) {
        const NodeId a = face[i], b = face[i + 1 < face.size() ? i + 1 : 0];
        if (side(a) == kOn) {
            if (found == 2) return false;
            on[found++] = cycle_.size();
        }
        cycle_.push_back(a);
        if (side(a) * side(b) < 0) {
            if (found == 2) return false;
            on[found++] = cycle_.size();
            cycle_.push_back(cuts_.node(a, b));
        }
    }
    if (found != 2 || on[1] - on[0] < 2 || on[0] + cycle_.size() - on[1] < 2) return false;
    const auto side_after = [&](std::size_t i) { return side(cycle_[(i + 1) % cycle_.size()]); };
    for (const auto& [from, to] : {std::pair(on[0], on[1]), std::pair(on[1], on[0])}) {
        parts.sides.push_back(side_after(from));
        for (std::size_t i = from;; i = (i + 1) % cycle_.size()) {
            parts.polygons.nodes.push_back(cycle_[i]);
            if (i == to) break;
        }
        parts.polygons.close();
    }
    return true;
}

void FaceSplitter::split_by_triangles(std::span<const NodeId> face, FaceParts& parts) {
    std::vector<Position> corners;
    for (const NodeId v : face)
        corners.push_back(model_.vertex(v));
    const View view(polygon_normal(corners));
    Loop loop;
    for (std::size_t i = 0; i < face.size(); ++i)
        loop.push_back({face[i], view(corners[i])});
    std::vector<std::array<LoopCorner, 3>> triangles;
    triangulate(std::span(&loop, 1), view.rounding(corners), triangles);

    // parts of triangles; those in the plane take the side of a neighbour further down. Crossings
    // of diagonals are named by negative numbers, for no one else knows them.
    std::vector<std::array<NodeId, 2>> diagonals;
    for (const auto& t : triangles) {
        for (std::size_t i = 0; i < 3; ++i) {
            const NodeId a = t[i].node, b = t[(i + 1) % 3].node;
            diagonals.push_back({std::min(a, b), std::max(a, b)});
        }
    }
    std::vector<std::array<NodeId, 2>> border;
    for (std::size_t i = 0; i < face.size(); ++i) {
        const NodeId a = face[i], b = face[(i + 1) % face.size()];
        border.push_back({std::min(a, b), std::max(a, b)});
    }
    std::sort(border.begin(), border.end());
    std::sort(diagonals.begin(), diagonals.end());
    diagonals.erase(std::unique(diagonals.begin(), diagonals.end()), diagonals.end());
    const auto crossing = [&](NodeId a, NodeId b) {
        const std::array<NodeId, 2> edge{std::min(a, b), std::max(a, b)};
        if (std::binary_search(border.begin(), border.end(), edge)) return cuts_.node(a, b);
        const auto at = std::lower_bound(diagonals.begin(), diagonals.end(), edge);
        return static_cast<NodeId>(-1 - (at - diagonals.begin()));
    };
    std::vector<TrianglePart> pieces;
    for (const auto& t : triangles) {
        TrianglePart above{{}, kAbove}, below{{}, kBelow}, level{{}, kOn};
        bool has_above = false, has_below = false;
        for (std::size_t i = 0; i < 3; ++i) {
            const NodeId a = t[i].node, b = t[(i + 1) % 3].node;
            level.nodes.push_back(a);
            if (side(a) >= 0) above.nodes.push_back(a);
            if (side(a) <= 0) below.nodes.push_back(a);
            has_above = has_above || side(a) > 0;
            has_below = has_below || side(a) < 0;
            if (side(a) * side(b) < 0) {
                const NodeId c = crossing(a, b);
                above.nodes.push_back(c);
                below.nodes.push_back(c);
            }
        }
        if (has_above) pieces.push_back(std::move(above));
        if (has_below) pieces.push_back(std::move(below));
        if (!has_above && !has_below) pieces.push_back(std::move(level));
    }

    std::vector<HalfEdge> edges;
    for (std::size_t p = 0; p < pieces.size(); ++p) {
        const auto& nodes = pieces[p].nodes;
        const auto first = static_cast<std::int32_t>(edges.size());
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            const auto next = static_cast<std::int32_t>((i + 1) % nodes.size());
            edges.push_back(
                {nodes[i], nodes[index(next)], static_cast<std::int32_t>(p), first + next, -1});
        }
    }
    // the edge against each, whatever the sides
    std::vector<std::size_t> order(edges.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        order[i] = i;
    const auto key = [&](std::size_t i) {
        const HalfEdge& e = edges[i];
        return std::array{std::min(e.from, e.to), std::max(e.from, e.to)};
    };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::pair(key(a), a) < std::pair(key(b), b);
    });
    for (std::size_t begin = 0; begin < order.size();) {
        std::size_t end = begin + 1;
        while (end < order.size() && key(order[end]) == key(order[begin]))
            ++end;
        for (std::size_t i = begin; i < end; ++i) {  // cuts lie between two sides of one triangle
            HalfEdge& e = edges[order[i]];
            for (std::size_t j = begin; j < end && e.twin < 0; ++j) {
                HalfEdge& f = edges[order[j]];
                if (f.from != e.to || f.to != e.from || f.twin >= 0) continue;
                if (pieces[index(e.part)].side * pieces[index(f.part)].side < 0) continue;
                e.twin = static_cast<std::int32_t>(order[j]);
                f.twin = static_cast<std::int32_t>(order[i]);
            }
        }
        begin = end;
    }
    for (bool changed = true; changed;) {
        changed = false;
        for (const HalfEdge& e : edges) {
            if (e.twin < 0) continue;
            auto& own = pieces[index(e.part)].side;
            const auto other = pieces[index(edges[index(e.twin)].part)].side;
            if (own == kOn && other != kOn) {
                own = other;
                changed = true;
            }
        }
    }
    for (HalfEdge& e : edges) {
        if (e.twin >= 0 &&
            pieces[index(e.part)].side != pieces[index(edges[index(e.twin)].part)].side) {
            edges[index(e.twin)].twin = -1;
            e.twin = -1;
        }
    }
    std::vector<bool> done(edges.size(), false);
    for (std::size_t start = 0; start < edges.size(); ++start) {
        if (done[start] || edges[start].twin >= 0) continue;
        std::size_t e = start;
        do {
            done[e] = true;
            if (edges[e].from >= 0) parts.polygons.nodes.push_back(edges[e].from);
            e = index(edges[e].next);
            while (edges[e].twin >= 0)
                e = index(edges[index(edges[e].twin)].next);
        } while (e != start);
        parts.polygons.close();
        parts.sides.push_back(pieces[index(edges[start].part)].side);
    }
}

}  // namespace realmodel::cutting
