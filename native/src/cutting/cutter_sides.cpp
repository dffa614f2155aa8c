// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_sides.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

CutterSides::CutterSides(SurfaceOverlay& overlay, const CutterWinding& winding, Progress* progress)
    : PartSides(cells_near_surface(overlay, winding)),
      overlay_(overlay),
      winding_(winding),
      parts_(overlay, winding, cells_reaching(), rules(), progress),
      sides_(parts_.size()) {
    refuse_borders();
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        poll(progress, r);
        if (!overlay.of_cutter(r) || parts_.of(r) < 0) continue;
        const auto part = index(parts_.of(r));
        if (!sides_[part]) settle(part, side_at(r, true));
        if (overlay.surface().is_closed || sides_[part] == kBelow) continue;
        const auto outline = overlay.loops(r)[0];
        refuse("two_sides",
               "a point of the model is above one part of the surface and below another",
               {outline[0], outline[1]});
    }
    for (std::size_t part = 0; part < sides_.size(); ++part) {
        if (!sides_[part]) sides_[part] = side_at(parts_.first_side(part).first, false);
    }
}

/// Sectors outside of the model count where an open surface does not end; of a closed one nothing
/// need be said of them.
SurfaceCells::Rules CutterSides::rules() const {
    return {[this](std::span<const EdgeUse> uses) {
                return overlay_.surface().is_closed || own_uses(uses) % 2 == 1;
            },
            [this](std::size_t region) { return !winding_.touches_model(region); }};
}

/// Takes the side of a part to all that can be reached from it.
void CutterSides::settle(std::size_t part, std::int8_t side) {
    sides_[part] = side;
    parts_.cells().spread(
        part, sides_,
        [](const auto&, std::int8_t of) { return std::optional(static_cast<std::int8_t>(-of)); },
        [this](const auto& way) {
            const auto outline = overlay_.loops(index(way.facet))[0];
            refuse("ends_inside", "the surface does not part the model: a way leads round it",
                   {outline[0], outline[1]});
        });
}

void CutterSides::refuse(const char* kind, const char* text,
                         const std::array<NodeId, 2>& edge) const {
    const Position p = overlay_.position(edge[0]), q = overlay_.position(edge[1]);
    Position middle;
    for (std::size_t k = 0; k < 3; ++k)
        middle[k] = p[k] + (q[k] - p[k]) / 2;
    throw InputError(kind, text, -1, {}, middle);
}

/// How many of the uses of an edge are the surface's.
std::ptrdiff_t CutterSides::own_uses(std::span<const EdgeUse> uses) const {
    return std::ranges::count_if(
        uses, [this](const EdgeUse& use) { return overlay_.of_cutter(index(use.item)); });
}

/// An edge in the model at which an odd number of regions meet: the surface ends there.
void CutterSides::refuse_borders() const {
    for (std::size_t e = 0; e < winding_.edge_count(); ++e) {
        const auto uses = winding_.edge(e);
        const auto windings = winding_.sectors(e).windings;
        if (own_uses(uses) % 2 == 0 || std::count(windings.begin(), windings.end(), 0) > 0)
            continue;
        refuse("ends_inside", "the surface does not part the model: it ends inside of it",
               uses[0].edge);
    }
}

/// The side of something that is not joined with the surface, or of one of its regions.
std::int8_t CutterSides::side_at(std::size_t item, bool of_cutter) {
    if (of_cutter && !overlay_.surface().is_closed) return kBelow;
    if (!nearest_) nearest_.emplace(overlay_.surface());
    const bool is_region = item < overlay_.size();
    if (!overlay_.surface().is_closed) {
        const auto face =
            overlay_.model().face(is_region ? overlay_.face_of(item) : item - overlay_.size());
        return (*nearest_)(overlay_.middle_of(face));
    }
    if (!is_region)
        return nearest_->within(overlay_.points(),
                                overlay_.exact(overlay_.model().face(item - overlay_.size())[0]), 2,
                                false);
    const auto [axis, facing] = overlay_.view_of(item);
    return nearest_->within(overlay_.points(), overlay_.inner_point(item), axis,
                            of_cutter && facing > 0);
}

}  // namespace realmodel::cutting
