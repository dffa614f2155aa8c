// SPDX-License-Identifier: GPL-3.0-or-later
// A triangulation in arrays that vertices can be added to. Private.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// A side of a triangle: side i runs from corner i to corner (i + 1) % 3. Packed as
/// 4 * triangle + i, so that neighbours find one another's sides without a search.
class Side {
public:
    Side() = default;
    Side(std::int32_t triangle, int number) : packed_(4 * triangle + number) {}
    static Side outside() { return {}; }

    bool is_outside() const { return packed_ < 0; }
    std::int32_t triangle() const { return packed_ >> 2; }
    int number() const { return packed_ & 3; }
    Side next() const { return {triangle(), number() == 2 ? 0 : number() + 1}; }
    Side previous() const { return {triangle(), number() == 0 ? 2 : number() - 1}; }
    bool operator==(const Side&) const = default;

private:
    std::int32_t packed_ = -1;
};

/// The most triangles whose sides can be packed.
inline constexpr double most_flat_triangles = 536'870'911;

/// Triangles, counter-clockwise, of a part of the plan. Its border, and the constraints inside, are
/// fixed sides: nothing flips them. Some triangles may be dead (removed, not yet reused).
class FlatMesh {
public:
    std::vector<PlanPoint> points;
    std::vector<std::array<std::int32_t, 3>> corners;  ///< of each triangle; -1 first: it is dead
    std::vector<std::array<Side, 3>> across;           ///< what lies behind each side
    std::vector<std::uint8_t> fixed;                   ///< bit i: side i may not be flipped

    std::int32_t from(Side side) const { return corners[side.triangle()][side.number()]; }
    std::int32_t to(Side side) const { return from(side.next()); }
    std::int32_t apex(Side side) const { return from(side.previous()); }
    const PlanPoint& point_from(Side side) const { return points[from(side)]; }
    const PlanPoint& point_to(Side side) const { return points[to(side)]; }
    const PlanPoint& point_apex(Side side) const { return points[apex(side)]; }
    Side behind(Side side) const { return across[side.triangle()][side.number()]; }
    bool is_border(Side side) const { return behind(side).is_outside(); }
    bool is_fixed(Side side) const { return (fixed[side.triangle()] >> side.number() & 1) != 0; }
    bool is_dead(std::int32_t triangle) const { return corners[triangle][0] < 0; }

    std::int32_t add_triangle(const std::array<std::int32_t, 3>& corner);
    /// Makes two sides one another's neighbours; the second may be outside.
    void join(Side a, Side b);
    void fix(Side side, bool value = true);

    /// The side from the same vertex that comes next counter-clockwise; outside at the border.
    Side turn_left(Side side) const { return behind(side.previous()); }
    /// The same clockwise.
    Side turn_right(Side side) const {
        const Side other = behind(side);
        return other.is_outside() ? other : other.next();
    }

    /// Swaps the diagonal of the two triangles beside a side that is not on the border. The two
    /// triangles keep their numbers; returns the new diagonal in the first.
    Side flip(Side side);
    /// Whether a side is no longer Delaunay, so that flipping it helps.
    bool should_flip(Side side) const;

    /// Adds a vertex inside a triangle; returns a side that leaves it. The triangles around it are
    /// made Delaunay by flips (Lawson 1977) as far as fixed sides allow.
    Side insert_inside(std::int32_t triangle, const PlanPoint& p);
    /// Adds a vertex on a side, which stays fixed in both parts if it was; else as insert_inside.
    Side insert_on(Side side, const PlanPoint& p);
    /// Makes sides Delaunay, and those that flips make doubtful.
    void legalise(std::vector<Side>& doubtful);

    /// Moves the vertex that an unfixed side leaves, which must be inside, to the side's other end;
    /// the two triangles beside the side die. Returns the two sides that now lie where those
    /// triangles were, both leaving the merged vertex or ending at it. The caller has made sure
    /// that nothing turns over.
    std::array<Side, 2> collapse(Side side);
    /// Takes the vertex that a side on the border leaves, which must have two triangles, out of the
    /// border: one triangle takes their place, the other dies. Returns the side of the border that
    /// runs past it now. The caller has made sure that the triangle is not turned over.
    Side pass_by(Side side);
    /// Forgets dead triangles; those before the first of them keep their numbers.
    void compact();

private:
    Side legalise_around(std::int32_t vertex, std::int32_t triangle);
    std::vector<Side> doubtful_;
};

}  // namespace realmodel::meshing
