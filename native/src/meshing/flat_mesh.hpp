// SPDX-License-Identifier: GPL-3.0-or-later
// A triangulation in arrays that vertices can be added to.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// An edge of one triangle: half-edge i runs from corner i to corner (i + 1) % 3. Packed as
/// 4 * triangle + i, so that twins find one another without a search.
class HalfEdge {
public:
    HalfEdge() = default;
    HalfEdge(std::int32_t triangle, int index) : packed_(4 * triangle + index) {}
    static HalfEdge none() { return {}; }

    bool is_none() const { return packed_ < 0; }
    std::int32_t triangle() const { return packed_ >> 2; }
    int index() const { return packed_ & 3; }
    HalfEdge next() const { return {triangle(), index() == 2 ? 0 : index() + 1}; }
    HalfEdge prev() const { return {triangle(), index() == 0 ? 2 : index() - 1}; }
    bool operator==(const HalfEdge&) const = default;

private:
    std::int32_t packed_ = -1;
};

/// The most triangles whose half-edges can be packed.
inline constexpr double kMostFlatTriangles = 536'870'911;

/// Triangles, counter-clockwise, of a part of the plan. Its border, and the constraints inside, are
/// fixed edges: nothing flips them. Of these some are locked: nothing cuts or moves them either.
/// Some triangles may be dead (removed, not yet reused).
class FlatMesh {
public:
    FlatMesh() = default;
    explicit FlatMesh(PlanarMesh mesh);

    std::vector<PlanPoint> points;
    std::vector<std::array<std::int32_t, 3>> corners;  ///< of each triangle; -1 first: it is dead
    std::vector<std::array<HalfEdge, 3>> twins;        ///< none: on the border
    std::vector<std::uint8_t> marks;                   ///< bit i: fixed; bit 3 + i: locked

    [[gnu::always_inline]] std::int32_t from(HalfEdge edge) const {
        return corners[edge.triangle()][edge.index()];
    }
    [[gnu::always_inline]] std::int32_t to(HalfEdge edge) const { return from(edge.next()); }
    [[gnu::always_inline]] std::int32_t apex(HalfEdge edge) const { return from(edge.prev()); }
    const PlanPoint& origin_point(HalfEdge edge) const { return points[from(edge)]; }
    const PlanPoint& target_point(HalfEdge edge) const { return points[to(edge)]; }
    const PlanPoint& apex_point(HalfEdge edge) const { return points[apex(edge)]; }
    [[gnu::always_inline]] HalfEdge twin(HalfEdge edge) const {
        return twins[edge.triangle()][edge.index()];
    }
    bool is_border(HalfEdge edge) const { return twin(edge).is_none(); }
    bool is_fixed(HalfEdge edge) const { return (marks[edge.triangle()] >> edge.index() & 1) != 0; }
    bool is_locked(HalfEdge edge) const {
        return (marks[edge.triangle()] >> (3 + edge.index()) & 1) != 0;
    }
    bool is_dead(std::int32_t triangle) const { return corners[triangle][0] < 0; }

    /// Visits the half-edges of all triangles that are not dead, from one of them on.
    template <class Visit>
    void for_each_edge(const Visit& visit, std::int32_t first = 0) const {
        for (auto t = static_cast<std::size_t>(first); t < corners.size(); ++t) {
            const auto triangle = static_cast<std::int32_t>(t);
            for (int i = 0; i < 3 && !is_dead(triangle); ++i)
                visit(HalfEdge(triangle, i));
        }
    }

    std::int32_t add_triangle(const std::array<std::int32_t, 3>& corner);
    /// Makes half-edges that run between the same vertices twins; all others are on the border.
    void link();
    /// Makes two half-edges twins; the second may be none.
    void join(HalfEdge a, HalfEdge b);
    /// Sets or takes away the marks of a half-edge; those of its twin are its own.
    void fix(HalfEdge edge, bool is_fixed = true, bool is_locked = false);

    /// The half-edge from the same vertex that comes next counter-clockwise; none at the border.
    HalfEdge rotate_ccw(HalfEdge edge) const { return twin(edge.prev()); }
    /// The same clockwise.
    HalfEdge rotate_cw(HalfEdge edge) const {
        const HalfEdge other = twin(edge);
        return other.is_none() ? other : other.next();
    }
    /// Visits the half-edges from the origin of one, from that counter-clockwise, and where the
    /// border ends that the others, too, clockwise from it.
    template <class Visit>
    void visit_star(HalfEdge start, Visit&& visit) const {
        HalfEdge edge = start;
        do {
            visit(edge);
            edge = rotate_ccw(edge);
        } while (!edge.is_none() && edge != start);
        if (!edge.is_none()) return;
        for (edge = rotate_cw(start); !edge.is_none(); edge = rotate_cw(edge))
            visit(edge);
    }

    /// Swaps the diagonal of the two triangles beside an edge that is not on the border; they form
    /// a strictly convex quadrilateral and keep their numbers. Returns the new diagonal in the
    /// first.
    HalfEdge flip(HalfEdge edge);
    /// Whether an edge is no longer Delaunay, so that flipping it helps.
    bool should_flip(HalfEdge edge) const;

    /// Makes another corner of a triangle its first.
    void rotate(std::int32_t triangle, int first);

    /// Divides a triangle at a vertex inside, which no triangle has yet; two are added.
    void divide(std::int32_t triangle, std::int32_t vertex);
    /// Divides the triangles beside an edge at a vertex on it, which no triangle has yet: one is
    /// added for each. The edge keeps its marks in both parts.
    void divide(HalfEdge edge, std::int32_t vertex);

    /// Adds a vertex inside a triangle; returns a half-edge that leaves it. The triangles around it
    /// are made Delaunay by flips (Lawson 1977) as far as fixed edges allow.
    HalfEdge insert_inside(std::int32_t triangle, const PlanPoint& p);
    /// Adds a vertex on an edge; else as insert_inside.
    HalfEdge insert_on(HalfEdge edge, const PlanPoint& p);
    /// The same with a point that is there already and no triangle has yet.
    HalfEdge insert_on(HalfEdge edge, std::int32_t vertex);
    /// Makes edges Delaunay, and those that flips make doubtful (Lawson 1977).
    /// @param flip_edge  flips one of this mesh and returns the diagonal
    template <class Flip>
    void legalize(std::vector<HalfEdge>& open, const Flip& flip_edge) const {
        while (!open.empty()) {
            const HalfEdge edge = open.back();
            open.pop_back();
            if (!should_flip(edge)) continue;
            const HalfEdge diagonal = flip_edge(edge), other = twin(diagonal);
            for (const HalfEdge e : {diagonal.next(), diagonal.prev(), other.next(), other.prev()})
                open.push_back(e);
        }
    }
    void legalize(std::vector<HalfEdge>& open) {
        legalize(open, [this](HalfEdge edge) { return flip(edge); });
    }

    /// Moves the origin of an unfixed edge, which must be inside, to the edge's other end; the two
    /// triangles beside the edge die. Returns the two half-edges that are now where those triangles
    /// were, both leaving the merged vertex or ending at it. The caller has made sure that all
    /// triangles stay counter-clockwise.
    std::array<HalfEdge, 2> collapse(HalfEdge edge);
    /// Takes the origin of an edge on the border, which must have two triangles, out of the border:
    /// one triangle replaces them, the other dies. Returns the edge of the border that runs past it
    /// now. The caller has made sure that the triangle is counter-clockwise.
    HalfEdge remove_from_border(HalfEdge edge);
    /// Removes dead triangles; those before the first of them keep their numbers.
    void compact();

private:
    /// What lies beyond an edge of a triangle that is being replaced, and the edge's marks.
    struct OuterEdge {
        HalfEdge twin;
        bool is_fixed, is_locked;
    };
    OuterEdge outer(HalfEdge edge) const { return {twin(edge), is_fixed(edge), is_locked(edge)}; }
    void attach(HalfEdge edge, const OuterEdge& outer);
    void kill(std::int32_t triangle);
    HalfEdge legalize_around(std::int32_t vertex, std::int32_t triangle);
    std::vector<HalfEdge> open_;
};

}  // namespace realmodel::meshing
