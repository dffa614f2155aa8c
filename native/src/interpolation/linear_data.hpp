// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/drift_basis.hpp"
#include "realmodel/interpolation/dips.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// The difference of the heights at two positions, times a scale.
struct Difference {
    Position to, from;
    double scale;
    double value;

    /// Of what is known at both ends: everywhere in this order, for the same bytes.
    double of(double at_to, double at_from) const { return scale * (at_to - at_from); }
};

/// @throws InputError kind "not_finite" (items: the dip), "option", "too_large"
void check_dips(const Dips& dips);

/// What is known of a surface: linear functionals of it. They are numbered: first come the heights
/// of points, then two differences for each dip, along x and along y.
class LinearData {
public:
    /// @param points  must outlive this
    /// @param scales  of the differences along x and along y
    /// @throws InputError kind "not_finite" (items: the dip), "option", "too_large"
    LinearData(const DataPoints& points, const Dips& dips, const std::array<double, 2>& scales);
    /// Without dips.
    explicit LinearData(const DataPoints& points) : LinearData(points, {}, {1, 1}) {}

    const DataPoints& points() const { return points_; }
    std::size_t point_count() const { return points_.local.size(); }
    std::size_t size() const { return point_count() + differences_.size(); }
    std::size_t dip_count() const { return dips_.size(); }
    /// How many dips count at a node.
    std::size_t dips_at_node() const { return dips_at_node_; }
    /// Whether all data count at every node that has all points.
    bool uses_all_dips() const { return dips_at_node_ == dips_.size(); }
    /// Of the positions of the dips; only where there are some.
    const spatial::NearestPoints& dip_tree() const { return *dip_tree_; }

    /// The number of the first of the two differences of a dip.
    std::int32_t first_of_dip(std::int32_t dip) const {
        return static_cast<std::int32_t>(point_count()) + 2 * dip;
    }
    bool is_point(std::int32_t i) const { return i < static_cast<std::int32_t>(point_count()); }
    const Difference& difference(std::int32_t i) const { return differences_[i - point_count()]; }
    const Position& position(std::int32_t i) const {
        return is_point(i) ? points_.local[i] : dips_[(i - point_count()) / 2];
    }
    /// The known value; of a point less a base.
    double value(std::int32_t i, double base) const {
        return is_point(i) ? points_.values[i] - base : difference(i).value;
    }

    /// Of a datum and the height at a position, by a kernel of two positions.
    template <class Kernel>
    double with_height(const Position& at, std::int32_t i, const Kernel& kernel) const {
        if (is_point(i)) return kernel(at, points_.local[i]);
        const Difference& d = difference(i);
        return d.of(kernel(at, d.to), kernel(at, d.from));
    }
    /// Of two data.
    template <class Kernel>
    double between(std::int32_t i, std::int32_t j, const Kernel& kernel) const {
        if (i < j) std::swap(i, j);  // one order, for the same bytes
        if (is_point(i)) return with_height(points_.local[i], j, kernel);
        const Difference& d = difference(i);
        return d.of(with_height(d.to, j, kernel), with_height(d.from, j, kernel));
    }
    /// The terms of a drift.
    DriftFrame::Terms terms(std::int32_t i, const DriftFrame& frame) const {
        if (is_point(i)) return frame.terms(points_.local[i]);
        const Difference& d = difference(i);
        return d.scale * (frame.terms(d.to) - frame.terms(d.from));
    }

private:
    const DataPoints& points_;
    std::vector<Position> dips_;  // in local coordinates
    std::vector<Difference> differences_;
    std::size_t dips_at_node_ = 0;
    std::optional<spatial::NearestPoints> dip_tree_;
};

}  // namespace realmodel::interpolation
