// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "base/key_table.hpp"

namespace realmodel::spatial {

/// Points that come one by one, in plan or in space, kept in square or cubic cells, of which a hash
/// table has those that are not empty: finds the points near a position.
template <std::size_t N>
class HashGrid {
public:
    using GridPosition = std::array<double, N>;

    /// @param cell_size  of a cell; searches that reach half as far or less look into 2^N cells at
    ///                   most
    explicit HashGrid(double cell_size) : cell_size_(cell_size) {}

    /// In the order in which they came.
    const std::vector<GridPosition>& points() const { return points_; }
    void add(const GridPosition& p) {
        const auto cell = index(cells_.add(cell_of(p, 0)));
        last_.resize(cells_.size(), -1);
        before_.push_back(std::exchange(last_[cell], static_cast<std::int32_t>(points_.size())));
        points_.push_back(p);
    }
    /// Whether holds(number) is true of a point: asked of all that are no farther than `reach`, and
    /// of others near them, until it is.
    template <class Holds>
    bool any(const GridPosition& around, double reach, const Holds& holds) const {
        const CellKey first = cell_of(around, -reach), last = cell_of(around, reach);
        for (CellKey at = first;;) {
            const std::int32_t cell = cells_.find(at);
            for (std::int32_t i = cell < 0 ? -1 : last_[index(cell)]; i >= 0; i = before_[index(i)])
                if (holds(index(i))) return true;
            std::size_t axis = 0;
            for (; axis < N && at[axis]++ == last[axis]; ++axis)
                at[axis] = first[axis];
            if (axis == N) return false;
        }
    }

private:
    using CellKey = std::array<std::int64_t, N>;
    CellKey cell_of(const GridPosition& p, double off) const {
        CellKey cell;
        for (std::size_t k = 0; k < N; ++k)
            cell[k] = static_cast<std::int64_t>(std::floor((p[k] + off) / cell_size_));
        return cell;
    }

    double cell_size_;
    KeyNumbers<CellKey> cells_;
    std::vector<std::int32_t> last_;    ///< of each cell: the last point in it
    std::vector<std::int32_t> before_;  ///< of each point: the one before it in its cell, or -1
    std::vector<GridPosition> points_;
};

}  // namespace realmodel::spatial
