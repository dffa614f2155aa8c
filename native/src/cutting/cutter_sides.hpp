// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "base/disjoint_sets.hpp"
#include "cutting/cutter_winding.hpp"
#include "cutting/plane_edges.hpp"

namespace realmodel::cutting {

/// On which side of a surface everything is. Going round its edges, the side changes with every
/// region of it that is crossed, and with nothing else; faces away from it have the side of those
/// beside them. Inside of a closed surface is what a ray leaves through it an odd number of times;
/// below an open one is what its regions have below them, and all must agree.
class CutterSides {
public:
    /// @throws InputError kinds ends_inside, two_sides
    CutterSides(SurfaceOverlay& overlay, const CutterWinding& winding, Progress* progress);

    /// kAbove or kBelow: of a face's region that does not lie on the surface.
    std::int8_t of_region(std::size_t region) const { return side_[region]; }
    /// Of a face that has no regions.
    std::int8_t of_face(std::size_t face) const { return side_[overlay_.size() + face]; }
    /// Of what is at side 0 of a region of the surface; at side 1 it is the other.
    std::int8_t below(std::size_t region) const { return side_[region]; }
    /// Whether a cell reaches the surface, so that it may be divided.
    bool reaches(std::int32_t cell) const { return reaches_[index(cell)] != 0; }

private:
    /// Notes that two items are on the same side or on opposite ones; false where they are known to
    /// be otherwise.
    bool join(std::int32_t a, std::int32_t b, bool opposite);
    std::ptrdiff_t own_uses(std::span<const EdgeUse> uses) const;
    template <class Side>
    std::int8_t settled(std::int32_t item, const Side& if_unknown);
    void find_reached_cells();
    void join_beside_surface(const Progress* progress);
    void go_round(std::size_t edge);
    void refuse_borders() const;
    void settle();
    std::int8_t side_at(std::size_t item, bool of_cutter);
    [[noreturn]] void refuse(const char* kind, const char* text,
                             const std::array<NodeId, 2>& edge) const;

    SurfaceOverlay& overlay_;
    const CutterWinding& winding_;
    /// Of each item i: 2 i its side, 2 i + 1 the other one; those that are the same are joined.
    DisjointSets sides_;
    std::vector<std::int8_t> of_set_;  ///< of the least member of each set, kOn not yet known
    std::vector<std::uint8_t> reaches_;
    std::vector<std::int8_t> side_;
};

}  // namespace realmodel::cutting
