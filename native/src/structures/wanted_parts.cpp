// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/wanted_parts.hpp"

#include <cassert>

#include "base/algorithms.hpp"

namespace realmodel::structures {

using cutting::kAbove;
using cutting::kOn;
using cutting::NodeId;
using cutting::Position;

bool is_narrow(std::span<const std::vector<Position>> loops, double rounding) {
    // traces of a surface on a fault are apart by rounding over the sine of the angle between them
    constexpr double kTimes = 64;
    double border = 0, area = 0;
    for (const auto& corners : loops) {
        for (std::size_t i = 0; i < corners.size(); ++i)
            border += length(minus(corners[(i + 1) % corners.size()], corners[i]));
        const double size = length(polygon_normal(corners));
        area += &corners == &loops.front() ? size : -size;
        rounding = std::max(rounding, cutting::rounding_of(corners));
    }
    return area <= kTimes * rounding * border;
}

WantedParts::WantedParts(CutterOverlay& overlay, const CutterWinding& winding,
                         const StructureSides& sides, std::span<const std::int32_t> model_of_cell,
                         std::span<const Sides> model_sides, std::span<const std::uint8_t> acts)
    : PartSides(sides.near_cells()),
      overlay_(overlay),
      winding_(winding),
      sides_(sides),
      model_of_cell_(model_of_cell),
      acts_(acts) {
    assert(model_of_cell.size() == overlay.model().cell_count());
    for (std::size_t compartment = 0; compartment < sides.compartments(); ++compartment) {
        const Sides& of_compartment = sides.sides(compartment);
        const auto allows = [&of_compartment](const Sides& wanted) {
            return std::ranges::equal(
                wanted, of_compartment,
                [](std::int8_t asked, std::int8_t is) { return asked == 0 || asked == is; });
        };
        const auto model = std::ranges::find_if(model_sides, allows);
        model_of_compartment_.push_back(
            model == model_sides.end() ? -1
                                       : static_cast<std::int32_t>(model - model_sides.begin()));
    }
    faces_on_.resize(overlay.size());
    is_same_.assign(overlay.size(), 0);
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (overlay.of_cutter(r) || winding.coincident(r) < 0) continue;
        auto& on = faces_on_[index(winding.coincident(r))];
        const auto faces = overlay.faces_of(r);
        on.insert(on.end(), faces.begin(), faces.end());
    }
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (overlay.of_cutter(r) && winding.counts(r) && winding.touches_model(r))
            is_same_[r] = are_same(r, true) ? 1 : 0;
    }
    for (std::size_t component = 0; component < overlay.undivided().components(); ++component) {
        const auto region = index(winding.borders(component)[0].region);
        is_same_undivided_.push_back(winding.touches_model(region) && are_same(region, false) ? 1
                                                                                              : 0);
    }
}

std::int8_t WantedParts::of_item(std::size_t item, std::size_t face) const {
    assert(sides_.compartment_of(item) < model_of_compartment_.size());
    const std::int32_t model = model_of_cell_[index(overlay_.model().cell(face, 0))];
    return model_of_compartment_[sides_.compartment_of(item)] == model ? kAbove : kOn;
}

std::int8_t WantedParts::of_face(std::size_t face) const {
    return of_item(overlay_.size() + face, face);
}

std::int8_t WantedParts::of_cut_face(std::size_t region, std::size_t side,
                                     std::int32_t cell) const {
    return model_of_compartment_[sides_.compartment_at(region, side)] == model_of_cell_[index(cell)]
               ? kAbove
               : kOn;
}

bool WantedParts::does_act(std::int32_t structure, std::int32_t cell) const {
    const std::size_t blocks = overlay_.model().blocks;
    return cell >= 0 && acts_[index(structure) * blocks + index(overlay_.model().block(cell))] != 0;
}

/// Whether a cell at one side of a region of the cutter ends there without the cutter, too.
bool WantedParts::cell_ends_at(std::int32_t cell, std::size_t region) const {
    const auto is_at = [&](std::size_t side) {
        return std::ranges::any_of(winding_.around(region, side),
                                   [cell](const auto& one) { return one.first == cell; });
    };
    return cell < 0 || !is_at(0) || !is_at(1);
}

/// The last structure that acts between two cells, -1 none. It must part their sides. What is cut
/// off against no rock lies against what is below the oldest surface: a fault displaces that, too,
/// and what fills a void from a base elevation may have it beside it. Where a body was protected,
/// what came later may end at its border, and within it at a fault that displaced what protects.
std::int32_t WantedParts::last_active_structure(std::size_t region, std::int32_t low,
                                                std::int32_t high) const {
    assert(low >= 0 || high >= 0);
    const ComplexView& model = overlay_.model();
    const bool differs = low < 0 || high < 0 || model.block(low) != model.block(high);
    const bool is_cut_off = differs && !(cell_ends_at(low, region) && cell_ends_at(high, region));
    const bool may_end_here =
        is_cut_off && (low < 0 || high < 0 || is_in_body(region, 0) || is_in_body(region, 1));
    std::int32_t last_active = -1, last = -1;
    for (const RegionOf& of : sides_.structures_at(region)) {
        if (!of.is_structure || !divides_at(of.structure, region)) continue;
        if (does_act(of.structure, low) || does_act(of.structure, high)) last_active = of.structure;
        if (may_end_here) last = of.structure;
    }
    return last_active >= 0 ? last_active : last;
}

/// Whether what is at one side of a region lies in one of the bodies.
bool WantedParts::is_in_body(std::size_t region, std::size_t side) const {
    const Sides& sides = sides_.sides(sides_.compartment_at(region, side));
    for (std::size_t s = 0; s < sides.size(); ++s) {
        if (sides[s] < 0 && sides_.is_body(static_cast<std::int32_t>(s))) return true;
    }
    return false;
}

bool WantedParts::ends_at_outer_face(std::size_t region, std::int32_t cell) const {
    return last_active_structure(region, cell, -1) < 0;
}

/// Where nothing acts it is what the cells have there without the structures. In slivers that
/// rounding left there is a wall between cells of one block, and between blocks the surface that
/// they meet at.
std::int32_t WantedParts::cut_face_number(std::size_t region, std::int32_t low,
                                          std::int32_t high) const {
    const std::int32_t structure = last_active_structure(region, low, high);
    const ComplexView& model = overlay_.model();
    if (structure >= 0) return -2 - (model.surfaces + structure);
    for (const std::int32_t face : faces_on_[region]) {
        const std::int32_t surface = model.face_surface[index(face)];
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int32_t cell = model.cell(index(face), k);
            if (cell >= 0 && (cell == low || cell == high) && surface != kBase) return -2 - surface;
        }
    }
    if (model.block(low) == model.block(high)) return -2 - kWall;
    const std::int32_t fault = first_dividing(region);
    if (fault >= 0 && is_tall(region)) return -2 - (model.surfaces + fault);
    std::int32_t surface = std::max(model.block(low), model.block(high));
    if (low >= 0 && high >= 0) surface = std::min(model.block(low), model.block(high));
    // bodies have a block for each rock mass
    const auto count = static_cast<std::int32_t>(acts_.size() / model.blocks);
    if (surface >= model.surfaces) surface = model.surfaces + (surface - model.surfaces) % count;
    return -2 - surface;
}

/// Whether a structure has what is below and above a region on two sides.
bool WantedParts::divides_at(std::int32_t structure, std::size_t region) const {
    const auto side = [&](std::size_t k) {
        return sides_.sides(sides_.compartment_at(region, k))[index(structure)];
    };
    return side(0) != side(1);
}

/// The first structure that does, -1 none.
std::int32_t WantedParts::first_dividing(std::size_t region) const {
    const auto& structures = sides_.structures_at(region);
    const auto first = std::ranges::find_if(
        structures, [&](const RegionOf& of) { return divides_at(of.structure, region); });
    return first == structures.end() ? -1 : first->structure;
}

/// Whether a region extends farther in height than in plan.
bool WantedParts::is_tall(std::size_t region) const {
    spatial::Box box;
    for (const NodeId node : overlay_.loops(region)[0])
        box.include(overlay_.position(node));
    const Position extent = minus(box.high, box.low);
    return extent[2] > std::max(extent[0], extent[1]);
}

/// The cell that is wanted on one side of a region, -1 none.
std::int32_t WantedParts::wanted_at(std::size_t region, std::size_t side) const {
    for (const auto& [cell, times] : winding_.around(region, side)) {
        if (times > 0 && of_cut_face(region, side, cell) == kAbove) return cell;
    }
    return -1;
}

/// Whether the models on both sides of a region have the same blocks there, each by itself.
bool WantedParts::exists_without_structures(std::size_t region, std::int32_t low,
                                            std::int32_t high) const {
    const auto has = [&](std::size_t side, std::int32_t cell) {
        const std::int32_t model = model_of_compartment_[sides_.compartment_at(region, 1 - side)];
        return std::ranges::any_of(winding_.around(region, side), [&](const auto& one) {
            return one.second > 0 && model_of_cell_[index(one.first)] == model &&
                   overlay_.model().block(one.first) == overlay_.model().block(cell);
        });
    };
    return has(0, low) && has(1, high);
}

/// Whether a region of the cutter is narrower than rounding may have made it.
bool WantedParts::is_sliver(std::size_t region) const {
    std::vector<std::vector<Position>> loops;
    for (const auto& loop : overlay_.loops(region))
        loops.push_back(transformed(loop, [this](NodeId node) { return overlay_.position(node); }));
    return is_narrow(loops);
}

/// Refuses a fault that is continued through rock that it displaces, unless it says that it dies
/// out there.
void WantedParts::refuse_undeclared_tip(std::size_t region, std::int32_t cell) const {
    for (const RegionOf& of : sides_.structures_at(region)) {
        if (!of.is_structure && divides_at(of.structure, region) &&
            !sides_.dies_out(of.structure) && does_act(of.structure, cell))
            sides_.refuse("ends_inside", "the fault ends in rock that it displaces", of.structure,
                          region);
    }
}

/// Cells of one block that meet where nothing acts are one there: what a fault parts is connected
/// beyond its tip, but not what lies elsewhere in the same cells. Where nothing acts but the rock
/// differs by more than slivers, a fault ends in it.
bool WantedParts::are_same(std::size_t region, bool may_be_sliver) const {
    const std::int32_t low = wanted_at(region, 0), high = wanted_at(region, 1);
    if ((low < 0 && high < 0) || last_active_structure(region, low, high) >= 0 ||
        (may_be_sliver && is_sliver(region)))
        return false;
    const ComplexView& model = overlay_.model();
    if (model.block(low) == model.block(high)) {
        refuse_undeclared_tip(region, low);
        return true;
    }
    // beyond its tip, surfaces that are torn are displaced still, but for walls of both models
    const bool is_beyond_tip =
        low >= 0 && high >= 0 &&
        std::ranges::any_of(sides_.structures_at(region), [&](const RegionOf& of) {
            return !of.is_structure && sides_.dies_out(of.structure) &&
                   divides_at(of.structure, region);
        });
    if (cell_ends_at(low, region) && cell_ends_at(high, region) &&
        (!is_beyond_tip || exists_without_structures(region, low, high)))
        return false;
    sides_.refuse("ends_inside",
                  "the fault ends in the rock: what is beyond differs on its two sides",
                  first_dividing(region), region);
}

}  // namespace realmodel::structures
