// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <vector>

#include "base/vectors.hpp"
#include "exact/space_points.hpp"
#include "realmodel/fields/level_sets.hpp"

namespace realmodel::fields {

/// The corners of a tetrahedron, of positive volume.
using LatticeTetrahedron = std::array<std::int64_t, 4>;
/// The corners of the tetrahedron that a position is in, and their weights there, which sum to 1.
struct Located {
    LatticeTetrahedron corners;
    std::array<double, 4> weights;
};
/// The lowest corner of a cell, by its steps along x, y, z from the lattice's first node.
using CellIndex = std::array<std::int32_t, 3>;

/// The corners of a cell's tetrahedra by their steps from its lowest corner.
inline constexpr std::array<std::array<CellIndex, 4>, 6> kTetrahedraOfCell{{
    {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}},
    {{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {1, 1, 1}}},
    {{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}}},
    {{{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 1, 1}}},
    {{{0, 0, 0}, {0, 1, 1}, {0, 0, 1}, {1, 1, 1}}},
    {{{0, 0, 0}, {1, 0, 1}, {1, 0, 0}, {1, 1, 1}}},
}};

/// The tetrahedra of a field. Corners are the nodes of the lattice, as LatticeField has them, then
/// the points. A point in a tetrahedron, in a face or on an edge divides all tetrahedra that have
/// these in common; one in a node gives it its value.
class RefinedLattice {
public:
    /// Of the box of the lattice: where the coordinate of an axis is least, or 3 + the axis where
    /// it is greatest.
    using BoxFace = std::uint8_t;

    /// @param positions  only points in cells of these, 3 N coordinates, divide tetrahedra; none:
    /// all
    /// @throws InputError  as level_sets does
    RefinedLattice(const LatticeField& field, std::span<const double> levels,
                   std::optional<std::span<const double>> positions = {});

    std::int32_t cells(std::size_t axis) const { return counts_[axis] - 1; }
    std::int64_t node(const CellIndex& at) const {
        return at[0] + stride_[1] * at[1] + stride_[2] * at[2];
    }
    double value(std::int64_t corner) const {
        return corner < nodes_ ? values_[static_cast<std::size_t>(corner)]
                               : point_values_[static_cast<std::size_t>(corner - nodes_)];
    }
    Vec3 position(std::int64_t corner) const;
    /// A bit for each side that a corner lies in.
    unsigned box_faces(std::int64_t corner) const;
    /// A point beyond the middle of a side.
    Vec3 beyond(BoxFace box_face) const;
    /// The tetrahedra of a cell that points divide, nullptr for any other cell.
    const std::vector<LatticeTetrahedron>* divided(const CellIndex& cell) const {
        const auto entry = divided_.find(node(cell));
        return entry == divided_.end() ? nullptr : &entry->second;
    }
    /// The corners of all tetrahedra that points divide others into, rising.
    std::vector<std::int64_t> divided_corners() const;
    /// The corner that a point is.
    std::int64_t corner_of(std::size_t point) const { return corner_of_point_[point]; }
    /// Calls `look` with each tetrahedron that has a corner.
    template <class Look>
    void for_each_around(std::int64_t corner, const Look& look) const {
        const auto look_at = [&](const LatticeTetrahedron& tetrahedron) {
            if (std::ranges::find(tetrahedron, corner) != tetrahedron.end()) look(tetrahedron);
        };
        for (const CellIndex& cell : cells_at(position(corner))) {
            if (const auto* tetrahedra = divided(cell)) {
                std::ranges::for_each(*tetrahedra, look_at);
                continue;
            }
            const auto all = corners(cell);
            for (std::size_t number = 0; number < kTetrahedraOfCell.size(); ++number)
                look_at(tetrahedron(all, number));
        }
    }
    /// Whether beside a corner there are corners with lesser and with greater values: then the
    /// level set of its value passes through it.
    template <class Value>
    bool is_between(std::int64_t corner, const Value& value_of) const {
        bool lesser = false, greater = false;
        for_each_around(corner, [&](const LatticeTetrahedron& tetrahedron) {
            for (const std::int64_t other : tetrahedron) {
                lesser |= value_of(other) < value_of(corner);
                greater |= value_of(other) > value_of(corner);
            }
        });
        return lesser && greater;
    }
    static LatticeTetrahedron tetrahedron(const std::array<std::int64_t, 8>& corners,
                                          std::size_t number);
    /// The corners of a cell: number x + 2 y + 4 z of those at steps x, y, z.
    std::array<std::int64_t, 8> corners(const CellIndex& cell) const;
    /// The tetrahedron that a position of the lattice is in, but for rounding; nothing outside.
    std::optional<Located> located(const Vec3& p) const;
    /// The function at a position of the lattice; NaN outside.
    double at(const Vec3& p) const;
    /// The same of a point, with the function's own values.
    bool is_between(std::size_t point) const;

private:
    double coordinate(std::size_t axis, std::int32_t step) const {
        return origin_[axis] + spacing_[axis] * step;
    }
    void add_point(std::size_t point, const Vec3& p);
    /// The cells whose boxes contain a position of the lattice.
    std::vector<CellIndex> cells_at(const Vec3& p) const;
    std::vector<LatticeTetrahedron>& make_divided(const CellIndex& cell);
    std::optional<std::vector<std::int64_t>> carrier(const LatticeTetrahedron& tetrahedron,
                                                     exact::SpacePointId p);
    Located in_tetrahedra(const std::vector<LatticeTetrahedron>& tetrahedra, const Vec3& p) const;

    std::array<double, 3> origin_, spacing_;
    std::array<std::int32_t, 3> counts_;
    std::array<std::int64_t, 3> stride_;
    std::int64_t nodes_;
    std::vector<double> values_;
    std::vector<Vec3> points_;
    std::vector<double> point_values_;
    std::vector<std::int64_t> corner_of_point_;
    std::map<std::int64_t, std::size_t> point_at_node_;
    std::map<std::int64_t, std::vector<LatticeTetrahedron>>
        divided_;                                         ///< by the cell's lowest corner
    std::optional<std::set<std::int64_t>> wanted_cells_;  ///< by their lowest corners; none: all
    exact::SpacePoints exact_;
};

}  // namespace realmodel::fields
