// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "arrangement/space_cells.hpp"
#include "base/counting_sort.hpp"
#include "cutting/cutter_overlay.hpp"
#include "cutting/nearest_side.hpp"

namespace realmodel::cutting {

using arrangement::EdgeFan;
using arrangement::EdgeUse;

/// How often the boundary of each cell goes round a point: once around what is within the cell.
/// Where rounding has put faces through each other, cells may overlap (two are there), be inside
/// out (-1 times), or leave gaps. Cells that do not go round it are left out.
using Winding = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// An edge at which a region of the cutter meets triangles that are left undivided. What is on
/// each side of the region there, is so all along those (UndividedTriangles).
struct UndividedBorder {
    std::int32_t region;
    EdgeUse use;  ///< as the undivided triangle has the edge
};

/// Which regions of a cutter count, which regions of faces lie on them, and how often each cell
/// goes round either side of them.
///
/// That is decided exactly and without asking that the cells fit together: known on one side of one
/// region, it changes around each edge by the faces that are crossed.
class CutterWinding {
public:
    CutterWinding(CutterOverlay& overlay, Progress* progress);

    /// Regions of the cutter that are boundaries: of several that coincide one is, or none where a
    /// closed cutter is there an even number of times.
    bool counts(std::size_t region) const { return counts_[region] != 0; }
    /// The region of the cutter that counts where this one is, of a face or of the cutter: -1
    /// none; and whether both face the same way (1) or not (-1).
    std::int32_t coincident(std::size_t region) const { return coincident_[region]; }
    std::int8_t coincident_facing(std::size_t region) const { return coincident_facing_[region]; }
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
    /// Uses of an edge in the order of their fan, by their indices in edge(); where each half-plane
    /// begins in it, and the last one ends.
    class Fan {
    public:
        Fan(std::span<const std::uint32_t> order, const std::uint32_t* begins,
            std::size_t half_planes)
            : order_(order), begins_(begins), half_plane_counts_(half_planes) {}
        std::size_t half_planes() const { return half_plane_counts_; }
        std::span<const std::uint32_t> half_plane(std::size_t i) const {
            return order_.subspan(begins_[i], begins_[i + 1] - begins_[i]);
        }

    private:
        std::span<const std::uint32_t> order_;
        const std::uint32_t* begins_;
        std::size_t half_plane_counts_;
    };
    /// The fan of an edge, and for each of its half-planes what is between it and the next.
    struct Sectors {
        Fan fan;
        std::span<const std::int32_t> windings;  ///< numbers; 0: no cell is there
    };
    Sectors sectors(std::size_t edge) const {
        const std::size_t begin = edges_.begins[edge], uses = edges_[edge].size();
        const std::size_t half_planes = half_plane_counts_[edge];
        return {Fan({order_.data() + begin, uses}, half_plane_begins_.data() + begin + edge,
                    half_planes),
                {windings_.data() + begin, is_known_[edge] != 0 ? half_planes : 0}};
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

    CutterOverlay& overlay_;
    std::optional<arrangement::RayBoxes> face_boxes_;  ///< once a ray is cast
    std::vector<std::uint8_t> counts_;
    std::vector<std::int32_t> coincident_;
    std::vector<std::int8_t> coincident_facing_;
    arrangement::EdgeUses edges_;
    /// Of nodes: the first edge of which they are the lesser node, and at the end how many edges.
    std::vector<std::uint32_t> first_edge_;
    // of edges: fans as Fan has them, one half-plane's end more than uses, and windings of sectors
    std::vector<std::uint32_t> order_, half_plane_begins_, half_plane_counts_;
    std::vector<std::int32_t> windings_;
    std::vector<std::uint8_t> is_known_;
    std::vector<std::int32_t> winding_;  ///< of both sides of regions, -1 not yet known
    std::vector<Winding> known_;
    KeyTable number_;                      ///< of windings in `known_`
    Buckets<std::int32_t> lying_on_;       ///< faces' regions on each of the cutter's
    Buckets<std::int32_t> edges_of_;       ///< of regions that count
    Buckets<UndividedBorder> borders_;     ///< of components of undivided triangles
    std::vector<std::uint8_t> is_border_;  ///< of edges
};

/// Of cells: 1 for those that have a face near the cutter or contain part of it. Each of the
/// others is on one side as a whole. (A cell that rounding has flattened away where the cutter
/// passes may have faces on both sides and none that meets the cutter.)
std::vector<std::uint8_t> cells_near_cutter(const CutterOverlay& overlay,
                                            const CutterWinding& winding);

/// The compartments that a cutter leaves where the model is, as cells (SpaceCells) whose facets
/// are regions of the cutter. Regions of faces that do not lie on it, and faces that have no
/// regions, are in one compartment each: they bound cells of the model, and no compartments. Going
/// round the edges of the cutter the compartment changes with every region crossed, and with
/// nothing else.
class CutterCompartments {
public:
    /// What is not said of the outside of the model.
    struct Rules {
        /// Whether around an edge compartments are known in the model alone: by its uses.
        std::function<bool(std::span<const EdgeUse>)> in_model_alone;
        /// Regions of the cutter that are left out around edges.
        std::function<bool(std::size_t)> is_left_out;
    };
    /// @param reaches  of cells (cells_near_cutter)
    CutterCompartments(CutterOverlay& overlay, const CutterWinding& winding,
                       std::span<const std::uint8_t> reaches, const Rules& rules,
                       Progress* progress);

    std::size_t size() const { return cells_.size(); }
    /// The compartment that a face's region or a face (counted after all regions) is in, or that is
    /// below a region of the cutter; -1 where it has none.
    std::int32_t of(std::size_t item) const { return cells_.of(item); }
    /// The compartment at side 0 or 1 of a region of the cutter.
    std::int32_t at(std::size_t region, std::size_t side) const {
        return cells_.of(side == 0 ? region : items_ + region);
    }
    /// The first of what bounds a compartment, of faces where there are some: an item, and its
    /// side.
    std::pair<std::size_t, std::size_t> first_side(std::size_t compartment) const {
        const std::size_t side = first_[compartment];
        return side < items_ ? std::pair(side, std::size_t{0})
                             : std::pair(side - items_, std::size_t{1});
    }
    /// SpaceCells::spread, between compartments.
    const arrangement::SpaceCells& cells() const { return cells_; }

private:
    std::int32_t side_of_region(std::size_t region, std::size_t side) const {
        return static_cast<std::int32_t>(side == 0 ? region : items_ + region);
    }
    void join_sectors(const CutterWinding& winding, const Rules& rules, Progress* progress);
    void join_beside(const CutterWinding& winding, std::span<const std::uint8_t> reaches,
                     Progress* progress);
    void join_undivided(const CutterWinding& winding, const Rules& rules);

    CutterOverlay& overlay_;
    std::size_t items_;  ///< regions and faces; sides 1 of regions come after them, and
                         ///< then both sides of components of undivided triangles
    arrangement::SpaceCells cells_;
    std::vector<std::size_t> first_;  ///< of compartments: a side
};

/// Which parts of the cells that a cutter divides are wanted.
class PartSides {
public:
    virtual ~PartSides() = default;

    /// The part of its cells that a region of a face bounds which does not lie on the cutter:
    /// kAbove or kBelow, kOn where it is left out.
    virtual std::int8_t of_region(std::size_t region, std::size_t face) const = 0;
    /// The same of a face that has no regions.
    virtual std::int8_t of_face(std::size_t face) const = 0;
    /// The same of a cell at side 0 or 1 of a region of the cutter.
    virtual std::int8_t of_cut_face(std::size_t region, std::size_t side,
                                    std::int32_t cell) const = 0;
    /// Whether a region of the cutter is a face between the parts of cells on its two sides; where
    /// it is not, they are one.
    virtual bool separates(std::size_t /*region*/) const { return true; }
    /// The same of a component of undivided triangles; of these the region at the first of their
    /// borders tells the rest.
    virtual bool separates_undivided(std::size_t /*component*/) const { return true; }
    /// What stands for a model's face in pieces of a region of the cutter, less than 0. Either
    /// cell may be -1.
    virtual std::int32_t cut_face_number(std::size_t /*region*/, std::int32_t /*low*/,
                                         std::int32_t /*high*/) const {
        return -1;
    }
    /// Whether where a cell ends at a region of the cutter it ends at the outer face there, if the
    /// model has one.
    virtual bool ends_at_outer_face(std::size_t /*region*/, std::int32_t /*cell*/) const {
        return true;
    }
    /// Whether a cell reaches the cutter, so that it may be divided.
    bool reaches(std::int32_t cell) const { return reaches_[index(cell)] != 0; }

protected:
    /// @param reaches  of cells (cells_near_cutter)
    explicit PartSides(std::vector<std::uint8_t> reaches) : reaches_(std::move(reaches)) {}
    std::span<const std::uint8_t> cells_reaching() const { return reaches_; }

private:
    std::vector<std::uint8_t> reaches_;
};

/// On which side of a cutter everything is. Going round its edges, the side changes with every
/// region of it that is crossed, and with nothing else; faces away from it have the side of those
/// beside them. A point is inside a closed cutter if a ray from it crosses the cutter an odd
/// number of times; below an open one is what its regions have below them, and all must agree.
class CutterSides : public PartSides {
public:
    /// @throws InputError kinds ends_inside, two_sides
    CutterSides(CutterOverlay& overlay, const CutterWinding& winding, Progress* progress);

    std::int8_t of_region(std::size_t region, std::size_t) const override { return side(region); }
    std::int8_t of_face(std::size_t face) const override { return side(overlay_.size() + face); }
    std::int8_t of_cut_face(std::size_t region, std::size_t side, std::int32_t) const override {
        return static_cast<std::int8_t>(side == 0 ? below(region) : -below(region));
    }
    /// Of what is at side 0 of a region of the cutter; at side 1 it is the other.
    std::int8_t below(std::size_t region) const { return side(region); }

private:
    std::ptrdiff_t count_cutter_uses(std::span<const EdgeUse> uses) const;
    CutterCompartments::Rules rules() const;
    void refuse_borders() const;
    void settle(std::size_t compartment, std::int8_t side);
    std::int8_t side_at(std::size_t item, bool of_cutter);
    std::int8_t side(std::size_t item) const {
        const std::int32_t compartment = compartments_.of(item);
        return compartment < 0 ? kOn : *sides_[index(compartment)];
    }
    [[noreturn]] void refuse(const char* kind, const char* text,
                             const std::array<NodeId, 2>& edge) const;

    CutterOverlay& overlay_;
    const CutterWinding& winding_;
    CutterCompartments compartments_;
    std::vector<std::optional<std::int8_t>> sides_;  ///< of compartments
    std::optional<NearestSide> nearest_;             ///< once it is asked for
};

}  // namespace realmodel::cutting
