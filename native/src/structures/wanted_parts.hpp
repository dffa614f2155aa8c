// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "structures/structure_sides.hpp"

namespace realmodel::structures {

/// Whether a polygon, its outline and then its holes, is narrower than rounding may have made it.
/// @param rounding  how coarse that is at least
bool is_narrow(std::span<const std::vector<cutting::Position>> loops, double rounding = 0);

/// Of the cells of several models those parts that lie in their model's compartment.
class WantedParts : public cutting::PartSides {
public:
    /// @param model_of_cell  of the cells of all models together
    /// @param model_sides    the sides of each model
    /// @param acts           S x B
    /// @throws InputError kind ends_inside
    WantedParts(CutterOverlay& overlay, const CutterWinding& winding, const StructureSides& sides,
                std::span<const std::int32_t> model_of_cell, std::span<const Sides> model_sides,
                std::span<const std::uint8_t> acts);

    std::int8_t of_region(std::size_t region, std::size_t face) const override {
        return of_item(region, face);
    }
    std::int8_t of_face(std::size_t face) const override;
    std::int8_t of_cut_face(std::size_t region, std::size_t side, std::int32_t cell) const override;
    bool separates(std::size_t region) const override { return is_same_[region] == 0; }
    bool separates_undivided(std::size_t component) const override {
        return is_same_undivided_[component] == 0;
    }
    bool ends_at_outer_face(std::size_t region, std::int32_t cell) const override;
    std::int32_t cut_face_number(std::size_t region, std::int32_t low,
                                 std::int32_t high) const override;

    /// The number of a face's surface from that of a piece (cut_face_number).
    static std::int32_t surface_of_cut_face(std::int32_t face) { return -2 - face; }

private:
    std::int8_t of_item(std::size_t item, std::size_t face) const;
    std::int32_t last_active_structure(std::size_t region, std::int32_t low,
                                       std::int32_t high) const;
    bool does_act(std::int32_t structure, std::int32_t cell) const;
    bool is_in_body(std::size_t region, std::size_t side) const;
    bool exists_without_structures(std::size_t region, std::int32_t low, std::int32_t high) const;
    bool divides_at(std::int32_t structure, std::size_t region) const;
    std::int32_t first_dividing(std::size_t region) const;
    bool is_tall(std::size_t region) const;
    bool is_sliver(std::size_t region) const;
    void refuse_undeclared_tip(std::size_t region, std::int32_t cell) const;
    bool are_same(std::size_t region, bool may_be_sliver) const;
    std::int32_t wanted_at(std::size_t region, std::size_t side) const;
    bool cell_ends_at(std::int32_t cell, std::size_t region) const;

    CutterOverlay& overlay_;
    const CutterWinding& winding_;
    const StructureSides& sides_;
    std::span<const std::int32_t> model_of_cell_;
    std::span<const std::uint8_t> acts_;
    std::vector<std::int32_t> model_of_compartment_;   ///< -1 none
    std::vector<std::vector<std::int32_t>> faces_on_;  ///< faces that lie on each region
    std::vector<std::uint8_t> is_same_;  ///< of regions: the cells below and above are one there
    std::vector<std::uint8_t> is_same_undivided_;  ///< likewise of components
};

}  // namespace realmodel::structures
