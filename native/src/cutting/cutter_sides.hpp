// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "cutting/cutter_winding.hpp"
#include "cutting/plane_edges.hpp"

namespace realmodel::cutting {

/// On which side of a surface everything is. Going round its edges, the side changes with every
/// region of it that is passed, and with nothing else; faces away from it hand their side on. Of a
/// closed surface that is inside which a way out leaves through an odd number of times; of an open
/// one that is below which its regions have below them, and all must agree.
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
    /// Sets of items that are on the same side, or on opposite sides.
    class Sets {
    public:
        explicit Sets(std::size_t count);
        /// The representative of an item, and whether the item is on the other side of it.
        std::pair<std::int32_t, bool> find(std::int32_t i);
        /// False where they are known to be otherwise.
        bool join(std::int32_t a, std::int32_t b, bool opposite);

    private:
        std::vector<std::int32_t> parent_;
        std::vector<std::uint8_t> opposite_;
    };

    void find_reached_cells();
    void hand_on(const Progress* progress);
    void go_round(std::size_t edge);
    void refuse_borders() const;
    void settle();
    std::int8_t side_at(std::size_t item, bool of_cutter);
    [[noreturn]] void refuse(const char* kind, const char* text,
                             const std::array<NodeId, 2>& edge) const;

    SurfaceOverlay& overlay_;
    const CutterWinding& winding_;
    Sets sets_;
    std::vector<std::uint8_t> reaches_;
    std::vector<std::int8_t> side_;
};

}  // namespace realmodel::cutting
