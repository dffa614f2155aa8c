// SPDX-License-Identifier: GPL-3.0-or-later
// How long edges should be at each place.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "meshing/check.hpp"
#include "realmodel/meshing/triangulation.hpp"

namespace realmodel::meshing {

/// A segment (or a point: both ends equal) near which edges are short: `least` at it, growing as
/// `start` + growth * distance where that is more.
struct SizeSource {
    PlanPoint a, b;
    double start;
    double least;
    /// No more than the field's gradation, which holds where nothing else is said.
    double growth = std::numeric_limits<double>::infinity();
};

/// The least of what sources ask for, and of a largest length. No length differs from another by
/// more than gradation * distance. Kept in a quadtree whose leaves are no larger than edges are
/// there, each with the lengths at its corners.
class SizeField {
public:
    /// The same length everywhere.
    explicit SizeField(double length) : largest_(length), smallest_(length) {}

    /// Between `low` and `high`, beyond them what is at their border. @throws InputError
    /// "too_large" where it would need more than `most_leaves`.
    SizeField(double largest, double gradation, std::span<const SizeSource> sources,
              const PlanPoint& low, const PlanPoint& high, double most_leaves, const Check& check);

    bool is_uniform() const { return nodes_.empty(); }
    double largest() const { return largest_; }
    double smallest() const { return smallest_; }
    double at(const PlanPoint& p) const { return nodes_.empty() ? largest_ : look_up(p); }

private:
    struct Node {
        std::int32_t children;  // the first of four, or -1 - leaf
    };
    struct Cell {
        double x, y, width;
        std::int32_t depth;
    };
    double look_up(const PlanPoint& p) const;
    void build(std::int32_t node, const Cell& cell, std::span<const SizeSource> sources,
               std::span<const std::int32_t> candidates, const Check& check);

    double largest_, smallest_, gradation_ = 0, most_leaves_ = 0;
    PlanPoint low_{};
    double width_ = 0;
    std::vector<Node> nodes_;
    std::vector<std::array<float, 4>> leaves_;  // shares of the largest length
};

}  // namespace realmodel::meshing
