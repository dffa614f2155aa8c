// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/structure_sides.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace realmodel::structures {

using cutting::kAbove;
using cutting::kBelow;

StructureSides::StructureSides(CutterOverlay& overlay, const CutterWinding& winding,
                               const StructureCutter& cutter, std::span<const Structure> structures,
                               std::span<const cutting::NearestSide> nearest, Progress* progress)
    : overlay_(overlay),
      winding_(winding),
      cutter_(cutter),
      structures_(structures),
      near_(cutting::cells_near_cutter(overlay, winding)),
      of_(named_structures()),
      compartments_(overlay, winding, near_, rules(), progress),
      sides_(compartments_.size(), Sides(structures.size(), 0)),
      end_sides_(structures.size()),
      nearest_(nearest) {
    // a fault that others end at comes before these
    std::vector<std::uint8_t> done(structures.size(), 0);
    for (std::size_t round = 0; round < structures.size(); ++round) {
        for (std::size_t s = 0; s < structures.size(); ++s) {
            if (progress != nullptr) progress->check();
            const auto& ends_at = structures[s].ends_at;
            if (done[s] != 0 || !std::ranges::all_of(ends_at, [&](std::int32_t other) {
                    return done[index(other)] != 0;
                }))
                continue;
            find_end_sides(static_cast<std::int32_t>(s));
            find_sides(static_cast<std::int32_t>(s));
            done[s] = 1;
        }
    }
    const auto left = std::ranges::find(done, 0);
    if (left != done.end())
        throw InputError("ends_at_itself", "the fault ends at faults that end at it",
                         static_cast<int>(left - done.begin()));
}

void StructureSides::refuse(const char* kind, const char* text, std::int32_t structure,
                            std::size_t region) const {
    throw InputError(kind, text, structure, {}, middle_of(region));
}

Position StructureSides::middle_of(std::size_t region) const {
    return overlay_.middle_of(overlay_.loops(region)[0]);
}

/// Which structures each region that counts is of, by all that coincide with it.
std::vector<std::vector<RegionOf>> StructureSides::named_structures() const {
    std::vector<std::vector<RegionOf>> named(overlay_.size());
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (!overlay_.of_cutter(r) || winding_.coincident(r) < 0) continue;
        const auto triangle = index(overlay_.cutter_triangle(r));
        const std::int32_t s = cutter_.structure[triangle];
        const bool is_structure = cutter_.is_continuation[triangle] == 0;
        auto& of_region = named[index(winding_.coincident(r))];
        auto known = std::ranges::find(of_region, s, &RegionOf::structure);
        if (known == of_region.end()) known = of_region.insert(of_region.end(), {s, 0, false});
        if (structures_[index(s)].is_body) {
            known->change ^= 1;
        } else {
            known->change += winding_.coincident_facing(r);
        }
        known->is_structure = known->is_structure || is_structure;
    }
    for (auto& of_region : named) {
        std::erase_if(of_region, [](const RegionOf& of) { return of.change == 0; });
        std::ranges::sort(of_region, {}, &RegionOf::structure);
    }
    return named;
}

/// Whether sides around an edge are known in rock alone: a fault ends there, or no rock is near, so
/// that structures may cross unnoticed.
bool StructureSides::is_known_in_rock_alone(std::span<const EdgeUse> uses) const {
    std::map<std::int32_t, std::size_t> count;
    bool has_faces = false;
    for (const EdgeUse& use : uses) {
        const auto item = index(use.item);
        if (!overlay_.of_cutter(item)) {
            has_faces = true;
            continue;
        }
        for (const RegionOf& of : of_[item])
            count[of.structure] += static_cast<std::size_t>(std::abs(of.change));
    }
    return !has_faces ||
           std::ranges::any_of(count, [](const auto& one) { return one.second % 2 == 1; });
}

/// Of regions: those of the cutter that reach away from the rock. There structures may end without
/// crossing one another.
std::vector<std::uint8_t> StructureSides::regions_beyond() const {
    std::vector<std::uint8_t> are_beyond(overlay_.size(), 0);
    for (std::size_t r = 0; r < are_beyond.size(); ++r) {
        if (!overlay_.of_cutter(r) || !winding_.counts(r) || winding_.touches_model(r)) continue;
        are_beyond[r] = std::ranges::any_of(overlay_.loops(r), [this](const auto& loop) {
            return std::ranges::any_of(loop, [this](NodeId node) {
                return !overlay_.model_box().contains(overlay_.position(node));
            });
        });
    }
    return are_beyond;
}

/// Structures may end unnoticed outside of the rock: there the outside gets no label at such edges.
cutting::CutterCompartments::Rules StructureSides::rules() const {
    return {[this](std::span<const EdgeUse> uses) { return is_known_in_rock_alone(uses); },
            [is_beyond = regions_beyond()](std::size_t region) { return is_beyond[region] != 0; }};
}

/// Whether a compartment is beyond one of the faults that a fault ends at.
bool StructureSides::is_beyond(std::int32_t s, std::size_t compartment) const {
    const auto& ends_at = structures_[index(s)].ends_at;
    for (std::size_t i = 0; i < ends_at.size(); ++i) {
        const std::int8_t side = sides_[compartment][index(ends_at[i])];
        if (side != 0 && side != end_sides_[index(s)][i]) return true;
    }
    return false;
}

/// Of a fault that ends at others: on which side of each the larger part of its area lies.
void StructureSides::find_end_sides(std::int32_t s) {
    if (!cutter_.end_sides.empty()) {
        end_sides_[index(s)] = cutter_.end_sides[index(s)];
        return;
    }
    for (const std::int32_t other : structures_[index(s)].ends_at)
        end_sides_[index(s)].push_back(larger_side(cutter_, s, other));
}

/// Takes what is known of a compartment to all that can be reached from it.
void StructureSides::spread(std::int32_t s, std::size_t start, Known& known) const {
    using Way = arrangement::SpaceCells::Way;
    const bool is_body = structures_[index(s)].is_body;
    const auto beyond = [&](const Way& way, std::int32_t side) -> std::optional<std::int32_t> {
        if (is_beyond(s, index(way.to))) return std::nullopt;
        for (const RegionOf& of : of_[index(way.facet)]) {
            if (of.structure == s)
                return is_body ? side ^ of.change : side + way.direction * of.change;
        }
        return side;
    };
    compartments_.cells().spread(start, known, beyond, [&](const Way& way) {
        refuse("ends_inside", "the fault ends in the rock", s, index(way.facet));
    });
}

/// By the rays that leave the body.
bool StructureSides::is_inside(std::int32_t s, std::size_t compartment) {
    const auto [item, side] = compartments_.first_side(compartment);
    const auto& body = nearest_[index(s)];
    if (item >= overlay_.size()) {
        const auto face = overlay_.model().face(item - overlay_.size());
        return body.within(overlay_.points(), overlay_.exact(face[0]), 2, false) == kBelow;
    }
    const auto [axis, facing] = overlay_.view_of(item);
    // of a region of the cutter that is crossed, too, by a ray from where it is seen from behind
    const bool is_below = overlay_.of_cutter(item) && (side == 0) == (facing > 0);
    return body.within(overlay_.points(), overlay_.inner_point(item), axis, is_below) == kBelow;
}

void StructureSides::find_sides(std::int32_t s) {
    const bool is_body = structures_[index(s)].is_body;
    Known known(compartments_.size());
    // where a fault itself is between rock on both sides, below is 0 and above is 1
    if (!is_body) {
        for (std::size_t r = 0; r < overlay_.size(); ++r) {
            if (!overlay_.of_cutter(r) || compartments_.of(r) < 0) continue;
            for (const RegionOf& of : of_[r]) {
                if (of.structure != s || !of.is_structure || std::abs(of.change) != 1) continue;
                const std::size_t low = compartment_at(r, of.change > 0 ? 0 : 1);
                const std::size_t high = compartment_at(r, of.change > 0 ? 1 : 0);
                if (is_beyond(s, low) || is_beyond(s, high)) continue;
                if (known[low] || known[high]) continue;
                known[low] = 0;
                spread(s, low, known);
            }
        }
    }
    for (std::size_t compartment = 0; compartment < compartments_.size(); ++compartment) {
        if (is_beyond(s, compartment)) continue;
        if (!known[compartment]) {
            if (is_body) {
                known[compartment] = is_inside(s, compartment) ? 1 : 0;
            } else {
                const std::size_t item = compartments_.first_side(compartment).first;
                const Position p =
                    item < overlay_.size()
                        ? middle_of(item)
                        : overlay_.position(overlay_.model().face(item - overlay_.size())[0]);
                known[compartment] = nearest_[index(s)](p) == kAbove;
            }
            spread(s, compartment, known);
        }
        const bool below = is_body ? *known[compartment] == 1 : *known[compartment] < 1;
        sides_[compartment][index(s)] = below ? kBelow : kAbove;
    }
}

}  // namespace realmodel::structures
