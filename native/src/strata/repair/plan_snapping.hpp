// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "realmodel/strata/stack.hpp"

namespace realmodel::strata {

/// Values of one coordinate that stand for others: from -> to, ascending.
class AxisSnapping {
public:
    AxisSnapping() = default;
    explicit AxisSnapping(std::vector<std::pair<double, double>> changes)
        : changes_(std::move(changes)) {}

    double operator()(double value) const { return empty() ? value : changed(value); }
    bool empty() const { return changes_.empty(); }
    std::size_t size() const { return changes_.size(); }

private:
    double changed(double value) const;

    std::vector<std::pair<double, double>> changes_;
};

/// Borders that two programs wrote differ in the last digits of their doubles, and would leave
/// slivers of rounding size all along them. So x (and y) values of the input that differ by no more
/// than a few units in the last place of the largest coordinate are taken as one: the value that
/// most vertices have. Only where every triangle keeps the way it turns: a needle as thin as that
/// stays a needle.
struct PlanSnapping {
    AxisSnapping x, y;
    bool empty() const { return x.empty() && y.empty(); }
};

/// One mesh of the input, of a surface (three columns) or a region (two).
struct PlanMesh {
    std::span<const double> vertices;
    std::span<const std::int32_t> triangles;
    std::size_t columns;

    std::size_t vertex_count() const { return vertices.size() / columns; }
};
std::vector<PlanMesh> meshes_of(std::span<const StackInput> rocks);

/// Whether all surfaces and regions have the same plan vertices: then no border lies beside
/// another, and there is nothing to join.
bool share_one_plan(std::span<const StackInput> rocks);

/// @param at_once  of the values of a coordinate that are in memory
PlanSnapping find_snapping(std::span<const StackInput> rocks, const Execution& execution = {},
                           std::size_t at_once = std::size_t{1} << 22);

}  // namespace realmodel::strata
