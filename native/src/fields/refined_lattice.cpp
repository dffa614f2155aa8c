// SPDX-License-Identifier: GPL-3.0-or-later
#include "fields/refined_lattice.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <string>

#include "base/algorithms.hpp"
#include "exact/space_points.hpp"
#include "fields/lattice_values.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::fields {

namespace {

constexpr std::int32_t kMostNodes = 1 << 20;  // along an axis: numbers of edges fit in 64 bits

[[noreturn]] void refuse_lattice(const char* what) {
    throw InputError("bad_lattice", what);
}

void check_finite(std::span<const double> numbers, const char* what, std::size_t apart) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        if (!std::isfinite(numbers[i]))
            throw InputError("not_finite", std::string(what) + " are not finite", -1,
                             {static_cast<std::int64_t>(i / apart)});
    }
}

void check_field(const LatticeField& field, std::span<const double> levels) {
    const auto& [origin, spacing, counts] = field.lattice;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double last = origin[axis] + spacing[axis] * counts[axis];
        if (counts[axis] < 2 || counts[axis] > kMostNodes)
            refuse_lattice("a lattice needs 2 to 1048576 nodes along each axis");
        if (!(spacing[axis] > 0) || !std::isfinite(origin[axis]) || !std::isfinite(last))
            refuse_lattice("a lattice needs finite coordinates, and spacings above 0");
    }
    if (field.values.size() != field.lattice.nodes()) refuse_lattice("values: one for each node");
    if (field.points.size() != 3 * field.point_values.size())
        refuse_lattice("points: a position and a value for each");
    check_finite(field.values, "values", 1);
    check_finite(field.points, "points", 3);
    check_finite(field.point_values, "values of points", 1);
    check_finite(levels, "levels", 1);
    if (!std::ranges::is_sorted(levels)) refuse_lattice("levels: ascending");
}

}  // namespace

RefinedLattice::RefinedLattice(const LatticeField& field, std::span<const double> levels,
                               std::optional<std::span<const double>> positions)
    : origin_(field.lattice.origin),
      spacing_(field.lattice.spacing),
      counts_(field.lattice.counts) {
    check_field(field, levels);
    stride_ = {1, counts_[0], std::int64_t{counts_[0]} * counts_[1]};
    nodes_ = stride_[2] * counts_[2];
    values_.assign(field.values.begin(), field.values.end());
    if (positions) {
        wanted_cells_.emplace();
        for (std::size_t i = 0; i + 2 < positions->size(); i += 3) {
            for (const CellIndex& cell :
                 cells_at({(*positions)[i], (*positions)[i + 1], (*positions)[i + 2]}))
                wanted_cells_->insert(node(cell));
        }
    }
    for (std::size_t p = 0; p < field.point_values.size(); ++p) {
        points_.push_back({field.points[3 * p], field.points[3 * p + 1], field.points[3 * p + 2]});
        point_values_.push_back(field.point_values[p]);
        add_point(p, points_.back());
    }
}

Vec3 RefinedLattice::position(std::int64_t corner) const {
    if (corner >= nodes_) return points_[static_cast<std::size_t>(corner - nodes_)];
    const auto x = static_cast<std::int32_t>(corner % stride_[1]);
    const auto y = static_cast<std::int32_t>(corner % stride_[2] / stride_[1]);
    const auto z = static_cast<std::int32_t>(corner / stride_[2]);
    return {coordinate(0, x), coordinate(1, y), coordinate(2, z)};
}

unsigned RefinedLattice::box_faces(std::int64_t corner) const {
    const Vec3 p = position(corner);
    unsigned bits = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (p[axis] == coordinate(axis, 0)) bits |= 1U << axis;
        if (p[axis] == coordinate(axis, counts_[axis] - 1)) bits |= 8U << axis;
    }
    return bits;
}

Vec3 RefinedLattice::beyond(BoxFace box_face) const {
    Vec3 p{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        p[axis] = origin_[axis] + spacing_[axis] * (counts_[axis] - 1) / 2;
    const std::size_t axis = box_face % 3;
    p[axis] = coordinate(axis, box_face < 3 ? -1 : counts_[axis]);
    return p;
}

std::array<std::int64_t, 8> RefinedLattice::corners(const CellIndex& cell) const {
    std::array<std::int64_t, 8> nodes{};
    for (std::size_t c = 0; c < 8; ++c)
        nodes[c] = node(cell) + static_cast<std::int64_t>(c & 1) +
                   stride_[1] * static_cast<std::int64_t>(c >> 1 & 1) +
                   stride_[2] * static_cast<std::int64_t>(c >> 2);
    return nodes;
}

LatticeTetrahedron RefinedLattice::tetrahedron(const std::array<std::int64_t, 8>& corners,
                                               std::size_t number) {
    LatticeTetrahedron vertices{};
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& step = kTetrahedraOfCell[number][i];
        vertices[i] = corners[static_cast<std::size_t>(step[0] + 2 * step[1] + 4 * step[2])];
    }
    return vertices;
}

std::vector<std::int64_t> RefinedLattice::divided_corners() const {
    std::vector<std::int64_t> corners;
    for (const auto& [cell, tetrahedra] : divided_) {
        for (const LatticeTetrahedron& tetrahedron : tetrahedra)
            corners.insert(corners.end(), tetrahedron.begin(), tetrahedron.end());
    }
    sort_unique(corners);
    return corners;
}

std::vector<CellIndex> RefinedLattice::cells_at(const Vec3& p) const {
    std::array<std::vector<std::int32_t>, 3> along;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto last = counts_[axis] - 2;
        if (!(p[axis] >= coordinate(axis, 0) && p[axis] <= coordinate(axis, last + 1))) return {};
        // rounding may be off by one
        const auto near = static_cast<std::int32_t>((p[axis] - origin_[axis]) / spacing_[axis]);
        for (std::int32_t i = std::max(near - 2, 0); i <= std::min(near + 2, last); ++i) {
            if (p[axis] >= coordinate(axis, i) && p[axis] <= coordinate(axis, i + 1))
                along[axis].push_back(i);
        }
    }
    std::vector<CellIndex> cells;
    for (const std::int32_t k : along[2]) {
        for (const std::int32_t j : along[1]) {
            for (const std::int32_t i : along[0])
                cells.push_back({i, j, k});
        }
    }
    return cells;
}

std::vector<LatticeTetrahedron>& RefinedLattice::make_divided(const CellIndex& cell) {
    const auto [place, is_new] = divided_.try_emplace(node(cell));
    if (is_new) {
        const auto all = corners(cell);
        for (std::size_t number = 0; number < kTetrahedraOfCell.size(); ++number)
            place->second.push_back(tetrahedron(all, number));
    }
    return place->second;
}

/// The corners of the vertex, edge, face or tetrahedron in which p lies; nothing if it is outside.
std::optional<std::vector<std::int64_t>> RefinedLattice::carrier(
    const LatticeTetrahedron& tetrahedron, exact::SpacePointId p) {
    std::array<exact::SpacePointId, 4> corners;
    for (std::size_t i = 0; i < 4; ++i)
        corners[i] = exact_.add(position(tetrahedron[i]));
    // the side of the volume of the tetrahedron itself, however orient3d counts
    const int inside = orient3d(exact_, corners[0], corners[1], corners[2], corners[3]);
    if (inside == 0) return std::nullopt;  // nodes at one place: coordinates are too coarse
    std::vector<std::int64_t> simplex;
    for (std::size_t i = 0; i < 4; ++i) {
        auto with = corners;
        with[i] = p;
        const int side = orient3d(exact_, with[0], with[1], with[2], with[3]) * inside;
        if (side < 0) return std::nullopt;
        if (side > 0) simplex.push_back(tetrahedron[i]);
    }
    return simplex;
}

void RefinedLattice::add_point(std::size_t point, const Vec3& p) {
    const auto cells = cells_at(p);
    if (cells.empty())
        throw InputError("outside", "a point is outside of the lattice", -1,
                         {static_cast<std::int64_t>(point)}, p);
    if (wanted_cells_ && std::ranges::none_of(cells, [&](const CellIndex& cell) {
            return wanted_cells_->contains(node(cell));
        })) {
        corner_of_point_.push_back(nodes_ + static_cast<std::int64_t>(point));
        return;
    }
    const exact::SpacePointId at = exact_.add(p);
    std::optional<std::vector<std::int64_t>> simplex;
    for (const CellIndex& cell : cells) {
        for (const LatticeTetrahedron& tetrahedron : make_divided(cell)) {
            simplex = carrier(tetrahedron, at);
            if (simplex) break;
        }
        if (simplex) break;
    }
    if (!simplex) refuse_lattice("its coordinates are too coarse for its spacing");
    assert(!simplex->empty() && corner_of_point_.size() == point);
    if (simplex->size() == 1) {
        const std::int64_t corner = simplex->front();
        const auto known = corner < nodes_ ? point_at_node_.find(corner) : point_at_node_.end();
        const bool is_known = corner >= nodes_ || known != point_at_node_.end();
        const double value = point_values_[point];
        if (is_known && this->value(corner) != value) {
            const auto other =
                corner >= nodes_ ? corner - nodes_ : static_cast<std::int64_t>(known->second);
            throw InputError("two_values", "two points in one position have different values", -1,
                             {other, static_cast<std::int64_t>(point)}, p);
        }
        if (corner < nodes_) {
            values_[static_cast<std::size_t>(corner)] = value;
            point_at_node_.emplace(corner, point);
        }
        corner_of_point_.push_back(corner);
        return;
    }
    const std::int64_t new_corner = nodes_ + static_cast<std::int64_t>(point);
    corner_of_point_.push_back(new_corner);
    [[maybe_unused]] std::size_t replaced = 0;
    for (const CellIndex& cell : cells) {
        std::vector<LatticeTetrahedron> divided;
        for (const LatticeTetrahedron& tetrahedron : make_divided(cell)) {
            const auto place = [&](std::int64_t corner) {
                return std::ranges::find(tetrahedron, corner) - tetrahedron.begin();
            };
            const bool has_all = std::ranges::all_of(
                *simplex, [&](std::int64_t corner) { return place(corner) < 4; });
            if (!has_all) {
                divided.push_back(tetrahedron);
                continue;
            }
            ++replaced;
            for (const std::int64_t corner : *simplex) {
                divided.push_back(tetrahedron);
                divided.back()[static_cast<std::size_t>(place(corner))] = new_corner;
            }
        }
        make_divided(cell) = std::move(divided);
    }
    // its own tetrahedron, the two beside its face but in a side, or those around its edge
    assert(simplex->size() == 4 ? replaced == 1 : replaced > 0);
}

/// Of those that are flat but for rounding their neighbors have the same values.
Located RefinedLattice::in_tetrahedra(const std::vector<LatticeTetrahedron>& tetrahedra,
                                      const Vec3& p) const {
    const double least_whole = 1e-9 * spacing_[0] * spacing_[1] * spacing_[2];
    double best = -HUGE_VAL;
    Located nearest{};
    for (const LatticeTetrahedron& tetrahedron : tetrahedra) {
        std::array<Vec3, 4> at{};
        Located candidate{tetrahedron, {}};
        for (std::size_t i = 0; i < 4; ++i) {
            at[i] = position(tetrahedron[i]);
            if (at[i] != p) continue;
            candidate.weights[i] = 1;
            return candidate;
        }
        const double whole = sixfold_volume(at[0], at[1], at[2], at[3]);
        if (whole < least_whole) continue;
        double least = HUGE_VAL;
        for (std::size_t i = 0; i < 4; ++i) {
            auto with = at;
            with[i] = p;
            candidate.weights[i] = sixfold_volume(with[0], with[1], with[2], with[3]) / whole;
            least = std::min(least, candidate.weights[i]);
        }
        if (least > best) {
            best = least;
            nearest = candidate;
        }
    }
    return nearest;
}

std::optional<Located> RefinedLattice::located(const Vec3& p) const {
    const auto cells = cells_at(p);
    if (cells.empty()) return std::nullopt;
    const CellIndex& cell = cells.front();
    if (const auto* tetrahedra = divided(cell)) return in_tetrahedra(*tetrahedra, p);
    Vec3 shares{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        shares[axis] =
            std::clamp((p[axis] - coordinate(axis, cell[axis])) / spacing_[axis], 0.0, 1.0);
    const Walk walk = walk_to(shares);
    Located tetrahedron{{node(cell)}, walk.weights};
    for (std::size_t i = 0; i < 3; ++i)
        tetrahedron.corners[i + 1] = tetrahedron.corners[i] + stride_[walk.axes[i]];
    return tetrahedron;
}

double RefinedLattice::at(const Vec3& p) const {
    const auto tetrahedron = located(p);
    if (!tetrahedron) return std::numeric_limits<double>::quiet_NaN();
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i)
        sum += value(tetrahedron->corners[i]) * tetrahedron->weights[i];
    return sum;
}

bool RefinedLattice::is_between(std::size_t point) const {
    return is_between(corner_of_point_[point],
                      [this](std::int64_t corner) { return value(corner); });
}

}  // namespace realmodel::fields
