// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <map>

#include "base/disjoint_sets.hpp"
#include "cutting/polygons.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

/// One connected boundary of a part of a cell. Around a hollow it has a negative volume.
struct PartShell {
    double sixfold_volume = 0;
    spatial::Box box;

    /// Adds a polygon that turns counter-clockwise seen from outside (sign 1), or clockwise (-1).
    /// @param origin  of volumes: the same for all polygons, and near them
    /// @param at      gives the position of a node
    template <class Polygon, class At>
    void add(const Polygon& polygon, int sign, const Position& origin, const At& at) {
        const Position first = at(polygon[0]);
        for (std::size_t i = 0; i < polygon.size(); ++i) {
            box.include(at(polygon[i]));
            if (i < 2) continue;
            sixfold_volume +=
                sign * realmodel::sixfold_volume(origin, first, at(polygon[i - 1]), at(polygon[i]));
        }
    }
};

/// Those of a cell on one side of the cutter, by a set of what bounds it.
using Shells = std::map<std::int32_t, PartShell>;

/// The wall of a hollow bounds the part around it, and what rounding turned inside out goes with
/// the part beside it: joins the sets of shells without a positive volume with one that is larger,
/// the smallest whose box contains theirs, or else the smallest.
void join_hollows(const Shells& shells, DisjointSets& sets);

}  // namespace realmodel::cutting
