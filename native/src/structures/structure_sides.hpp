// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "cutting/cutter_sides.hpp"
#include "realmodel/base/errors.hpp"
#include "structures/structure_cutter.hpp"

namespace realmodel::structures {

using arrangement::EdgeUse;
using cutting::CutterOverlay;
using cutting::CutterWinding;
using cutting::NodeId;
using cutting::Position;
using cutting::Winding;

/// What a region of the cutter is of one structure.
struct RegionOf {
    std::int32_t structure;
    std::int32_t change;  ///< of a fault: how far its side goes up from side 0 of the region to 1;
                          ///< of a body: 1 where its inside ends there
    bool is_structure;    ///< not only its continuation
};

/// The compartments that structures leave where rock is, and on which side of each structure they
/// are. Going round the edges of their regions, the compartment changes with every region crossed
/// and with nothing else. Sides are known at one region of each structure and change only with its
/// regions.
class StructureSides {
public:
    /// @param nearest  of the cutters of single structures
    /// @throws InputError kinds does_not_meet, equal_halves, ends_inside
    StructureSides(CutterOverlay& overlay, const CutterWinding& winding,
                   const StructureCutter& cutter, std::span<const Structure> structures,
                   std::span<const cutting::NearestSide> nearest, Progress* progress);

    std::size_t compartments() const { return compartments_.size(); }
    const Sides& sides(std::size_t compartment) const { return sides_[compartment]; }
    /// The compartment that a region of a face or a face without regions (counted after all
    /// regions) is in.
    std::size_t compartment_of(std::size_t item) const {
        return checked_compartment(compartments_.of(item));
    }
    /// The compartment at side 0 or 1 of a region of the cutter that counts and touches rock.
    std::size_t compartment_at(std::size_t region, std::size_t side) const {
        return checked_compartment(compartments_.at(region, side));
    }
    /// Of a region of the cutter that counts.
    const std::vector<RegionOf>& structures_at(std::size_t region) const { return of_[region]; }
    const std::vector<std::uint8_t>& near_cells() const { return near_; }
    bool is_body(std::int32_t structure) const { return structures_[index(structure)].is_body; }
    bool dies_out(std::int32_t structure) const { return structures_[index(structure)].dies_out; }
    [[noreturn]] void refuse(const char* kind, const char* text, std::int32_t structure,
                             std::size_t region) const;

private:
    using Known = std::vector<std::optional<std::int32_t>>;  ///< of compartments: on which side

    static std::size_t checked_compartment(std::int32_t compartment) {
        if (compartment < 0) throw InternalError("what bounds rock is in a part of space");
        return index(compartment);
    }
    cutting::CutterCompartments::Rules rules() const;
    std::vector<std::vector<RegionOf>> named_structures() const;
    bool is_known_in_rock_alone(std::span<const EdgeUse> uses) const;
    std::vector<std::uint8_t> regions_beyond() const;
    void find_sides(std::int32_t s);
    void spread(std::int32_t s, std::size_t start, Known& known) const;
    bool is_beyond(std::int32_t s, std::size_t compartment) const;
    void find_end_sides(std::int32_t s);
    Position middle_of(std::size_t region) const;
    bool is_inside(std::int32_t s, std::size_t compartment);

    CutterOverlay& overlay_;
    const CutterWinding& winding_;
    const StructureCutter& cutter_;
    std::span<const Structure> structures_;
    std::vector<std::uint8_t> near_;
    std::vector<std::vector<RegionOf>> of_;
    cutting::CutterCompartments compartments_;
    std::vector<Sides> sides_;
    std::vector<std::vector<std::int8_t>> end_sides_;  ///< of structures: side of each it ends at
    std::span<const cutting::NearestSide> nearest_;    ///< of structures
};

}  // namespace realmodel::structures
