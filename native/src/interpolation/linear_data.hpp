// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "interpolation/data_points.hpp"
#include "interpolation/drift_basis.hpp"
#include "realmodel/interpolation/dips.hpp"
#include "realmodel/interpolation/sheets.hpp"
#include "spatial/nearest_points.hpp"

namespace realmodel::interpolation {

/// The difference of the heights at two positions, times a scale.
struct Difference {
    PlanPosition to, from;
    double scale;
    double value;
    std::int32_t sheet = 0;

    /// Of what is known at both ends: everywhere in this order, for the same bytes.
    double of(double at_to, double at_from) const { return scale * (at_to - at_from); }
};

/// A kernel of two positions, or of two positions on sheets.
template <class Kernel>
double of_two(const Kernel& kernel, const PlanPosition& a, std::int32_t on_a, const PlanPosition& b,
              std::int32_t on_b) {
    if constexpr (requires { kernel(a, on_a, b, on_b); }) {
        return kernel(a, on_a, b, on_b);
    } else {
        return kernel(a, b);
    }
}

/// @throws InputError kind "not_finite" (items: the dip), "option", "too_large"
void check_dips(const Dips& dips);

/// @throws InputError kind "option" where sheets do not fit so many points and dips, or kinds of
/// check_variogram
void check_sheets(const Sheets& sheets, std::size_t points, std::size_t dips);

/// What is known of a surface: linear functionals of it. They are numbered: first come the heights
/// of points, then two differences for each dip, along x and along y.
class LinearData {
public:
    /// @param points  must outlive this
    /// @param scales  of the differences along x and along y
    /// @param units   of heights, one for each sheet: in them each has the variance 1. Empty: there
    /// is
    ///                one sheet, whose unit is 1
    /// @param of_dips the sheet of each dip; with units
    /// @throws InputError kind "not_finite" (items: the dip), "option", "too_large"
    LinearData(const DataPoints& points, const Dips& dips,
               std::span<const std::array<double, 2>> scales, std::vector<double> units = {},
               std::span<const std::int32_t> of_dips = {});
    LinearData(const DataPoints& points, const Dips& dips, const std::array<double, 2>& scales)
        : LinearData(points, dips, std::span(&scales, 1)) {}
    /// Without dips.
    explicit LinearData(const DataPoints& points)
        : LinearData(points, {}, std::array<double, 2>{1, 1}) {}

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
    const PlanPosition& position(std::int32_t i) const {
        return is_point(i) ? points_.local[i] : dips_[(i - point_count()) / 2];
    }
    bool has_sheets() const { return !units_.empty(); }
    std::size_t sheet_count() const { return has_sheets() ? units_.size() : 1; }
    std::int32_t sheet(std::int32_t i) const {
        return !has_sheets() ? 0 : is_point(i) ? points_.sheets[i] : difference(i).sheet;
    }
    /// Of heights of a sheet.
    double unit(std::int32_t sheet) const { return has_sheets() ? units_[sheet] : 1; }
    /// The known value, in the unit of its sheet; of a point less a base.
    double value(std::int32_t i, double base) const {
        if (!is_point(i)) return difference(i).value;
        const double value = points_.values[i] - base;
        return has_sheets() ? value / unit(sheet(i)) : value;
    }

    /// Of a datum and the height at a position, by a kernel of two positions.
    template <class Kernel>
    double with_height(const PlanPosition& at, std::int32_t i, const Kernel& kernel,
                       std::int32_t on = 0) const {
        if (is_point(i)) return of_two(kernel, at, on, points_.local[i], sheet(i));
        const Difference& d = difference(i);
        return d.of(of_two(kernel, at, on, d.to, d.sheet), of_two(kernel, at, on, d.from, d.sheet));
    }
    /// Of two data.
    template <class Kernel>
    double between(std::int32_t i, std::int32_t j, const Kernel& kernel) const {
        if (i < j) std::swap(i, j);  // one order, for the same bytes
        if (is_point(i)) return with_height(points_.local[i], j, kernel, sheet(i));
        const Difference& d = difference(i);
        return d.of(with_height(d.to, j, kernel, d.sheet), with_height(d.from, j, kernel, d.sheet));
    }
    /// The terms of a drift, which all sheets share.
    DriftFrame::Terms terms(std::int32_t i, const DriftFrame& frame) const {
        if (is_point(i)) return terms(points_.local[i], sheet(i), frame);
        const Difference& d = difference(i);
        return d.scale * (frame.terms(d.to) - frame.terms(d.from));
    }

    /// At a height.
    DriftFrame::Terms terms(const PlanPosition& at, std::int32_t on,
                            const DriftFrame& frame) const {
        return has_sheets() ? frame.terms(at) / unit(on) : frame.terms(at);
    }

private:
    const DataPoints& points_;
    std::vector<double> units_;
    std::vector<PlanPosition> dips_;  // in local coordinates
    std::vector<Difference> differences_;
    std::size_t dips_at_node_ = 0;
    std::optional<spatial::NearestPoints> dip_tree_;
};

}  // namespace realmodel::interpolation
