// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "arrangement/space_cells.hpp"
#include "cutting/cutter_winding.hpp"

namespace realmodel::cutting {

/// Of cells: 1 with a face near the surface, and those that it lies in. Of the others each is on
/// one side as a whole; of a cell that rounding has flattened away where the surface passes it no
/// face need meet the surface, though it has faces on both sides.
std::vector<std::uint8_t> cells_near_surface(const SurfaceOverlay& overlay,
                                             const CutterWinding& winding);

/// The parts of space that a surface leaves where the model is, as cells (SpaceCells) whose facets
/// are regions of the surface. Regions of faces that do not lie on it, and faces that have no
/// regions, are in one part each: they bound cells of the model, and not parts. Going round the
/// edges of the surface the part changes with every region crossed, and with nothing else.
class SurfaceCells {
public:
    /// What is not said of the outside of the model.
    struct Rules {
        /// Whether around an edge parts are known in the model alone: by its uses.
        std::function<bool(std::span<const EdgeUse>)> in_model_alone;
        /// Regions of the surface that are left out around edges.
        std::function<bool(std::size_t)> is_left_out;
    };
    /// @param reaches  of cells (cells_near_surface)
    SurfaceCells(SurfaceOverlay& overlay, const CutterWinding& winding,
                 std::span<const std::uint8_t> reaches, const Rules& rules, Progress* progress);

    std::size_t size() const { return cells_.size(); }
    /// The part that a face's region or a face (counted after all regions) is in, or that is below
    /// a region of the surface; -1 where it has none.
    std::int32_t of(std::size_t item) const { return cells_.of(item); }
    /// The part at side 0 or 1 of a region of the surface.
    std::int32_t at(std::size_t region, std::size_t side) const {
        return cells_.of(side == 0 ? region : items_ + region);
    }
    /// The first of what bounds a part, of faces where there are some: an item, and its side.
    std::pair<std::size_t, std::size_t> first_side(std::size_t part) const {
        const std::size_t side = first_[part];
        return side < items_ ? std::pair(side, std::size_t{0})
                             : std::pair(side - items_, std::size_t{1});
    }
    /// SpaceCells::spread, between parts.
    const arrangement::SpaceCells& cells() const { return cells_; }

private:
    std::int32_t side_of_region(std::size_t region, std::size_t side) const {
        return static_cast<std::int32_t>(side == 0 ? region : items_ + region);
    }
    void join_sectors(const CutterWinding& winding, const Rules& rules, Progress* progress);
    void join_beside(const CutterWinding& winding, std::span<const std::uint8_t> reaches,
                     Progress* progress);
    void join_undivided(const CutterWinding& winding, const Rules& rules);

    SurfaceOverlay& overlay_;
    std::size_t items_;  ///< regions and faces; sides 1 of regions come after them, and
                         ///< then both sides of components of undivided triangles
    arrangement::SpaceCells cells_;
    std::vector<std::size_t> first_;  ///< of parts: a side
};

}  // namespace realmodel::cutting
