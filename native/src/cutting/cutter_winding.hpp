// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "arrangement/ray_boxes.hpp"
#include "base/counting_sort.hpp"
#include "cutting/surface_overlay.hpp"

namespace realmodel::cutting {

using arrangement::EdgeFan;
using arrangement::EdgeUse;

/// How often the boundary of each cell goes round a point: once around what is within the cell.
/// Where rounding has put faces through each other, cells may overlap (two are there), be inside
/// out (-1 times), or leave gaps. Cells that do not go round it are left out.
using Winding = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// An edge at which a region of the surface meets triangles that are left undivided. What is on
/// each side of the region there, is so all along those (UndividedTriangles).
struct UndividedBorder {
    std::int32_t region;
    EdgeUse use;  ///< as the undivided triangle has the edge
};

/// Which regions of a surface count, which regions of faces lie on them, and how often each cell
/// goes round either side of them.
///
/// That is decided exactly and without asking that the cells fit together: known on one side of one
/// region, it changes around each edge by the faces that are crossed.
class CutterWinding {
public:
    CutterWinding(SurfaceOverlay& overlay, Progress* progress);

    /// Regions of the surface that are boundaries: of several that coincide one is, or none where a
    /// closed surface is there an even number of times.
    bool counts(std::size_t region) const { return counts_[region] != 0; }
    /// The region of the surface that counts where this one is, of a face or of the surface: -1
    /// none; and whether both face the same way (1) or not (-1).
    std::int32_t level(std::size_t region) const { return level_[region]; }
    std::int8_t level_facing(std::size_t region) const { return level_facing_[region]; }
    /// What is just below (side 0, where it is seen clockwise from) or above a region that counts.
    const Winding& around(std::size_t region, std::size_t side) const {
        return known_[index(winding_[2 * region + side])];
    }
    bool touches_model(std::size_t region) const {
        return !around(region, 0).empty() || !around(region, 1).empty();
    }

    /// The edges of the regions that count, in order: all uses of each by these and by faces'
    /// regions.
    std::size_t edge_count() const { return edges_.size(); }
    std::span<const EdgeUse> edge(std::size_t i) const { return edges_[i]; }
    /// Uses of an edge in the order of their fan, by their places in edge(); where each blade
    /// begins in it, and the last one ends.
    class Fan {
    public:
        Fan(std::span<const std::uint32_t> order, const std::uint32_t* begins, std::size_t blades)
            : order_(order), begins_(begins), blades_(blades) {}
        std::size_t blades() const { return blades_; }
        std::span<const std::uint32_t> blade(std::size_t i) const {
            return order_.subspan(begins_[i], begins_[i + 1] - begins_[i]);
        }

    private:
        std::span<const std::uint32_t> order_;
        const std::uint32_t* begins_;
        std::size_t blades_;
    };
    /// The fan of an edge, and for each of its blades what is between it and the next.
    struct Sectors {
        Fan fan;
        std::span<const std::int32_t> windings;  ///< numbers; 0: no cell is there
    };
    Sectors sectors(std::size_t edge) const {
        const std::size_t begin = edges_.begins[edge], uses = edges_[edge].size();
        const std::size_t blades = blades_[edge];
        return {Fan({order_.data() + begin, uses}, blade_begins_.data() + begin + edge, blades),
                {windings_.data() + begin, is_known_[edge] != 0 ? blades : 0}};
    }
    /// Whether an edge is one of these.
    bool is_edge(const std::array<NodeId, 2>& edge) const { return edge_number(edge) >= 0; }
    /// Of a component of undivided triangles: where it ends; one at least.
    std::span<const UndividedBorder> borders(std::size_t component) const {
        return borders_[component];
    }
    /// Of edges: whether they are one of those.
    bool is_undivided_border(std::size_t edge) const { return is_border_[edge] != 0; }

private:
    void find_coinciding(Progress* progress);
    void collect_uses(Progress* progress);
    void find_fans(Progress* progress);
    void find_borders();
    std::int32_t edge_number(const std::array<NodeId, 2>& edge) const;
    void spread(std::size_t edge, Progress* progress);
    std::int32_t number(const Winding& winding);
    void cross(Winding& winding, std::size_t region, std::size_t entered) const;
    Winding cast(std::size_t region, Progress* progress);

    SurfaceOverlay& overlay_;
    std::optional<arrangement::RayBoxes> face_boxes_;  ///< once a ray is cast
    std::vector<std::uint8_t> counts_;
    std::vector<std::int32_t> level_;
    std::vector<std::int8_t> level_facing_;
    arrangement::EdgeUses edges_;
    /// Of nodes: the first edge of which they are the lesser node, and at the end how many edges.
    std::vector<std::uint32_t> first_edge_;
    // of edges: fans as Fan has them, one blade's end more than uses, and windings of sectors
    std::vector<std::uint32_t> order_, blade_begins_, blades_;
    std::vector<std::int32_t> windings_;
    std::vector<std::uint8_t> is_known_;
    std::vector<std::int32_t> winding_;  ///< of both sides of regions, -1 not yet known
    std::vector<Winding> known_;
    KeyTable number_;                      ///< of windings in `known_`
    Buckets<std::int32_t> lying_on_;       ///< faces' regions on each of the surface's
    Buckets<std::int32_t> edges_of_;       ///< of regions that count
    Buckets<UndividedBorder> borders_;     ///< of components of undivided triangles
    std::vector<std::uint8_t> is_border_;  ///< of edges
};

}  // namespace realmodel::cutting
