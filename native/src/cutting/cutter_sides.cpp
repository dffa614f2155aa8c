// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_sides.hpp"

#include <algorithm>

#include "base/counting_sort.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

using arrangement::each_edge;

CutterSides::CutterSides(SurfaceOverlay& overlay, const CutterWinding& winding, Progress* progress)
    : PartSides(cells_near_surface(overlay, winding)),
      overlay_(overlay),
      winding_(winding),
      sides_(2 * (overlay.size() + overlay.model().face_count())) {
    checked_number(2 * (overlay.size() + overlay.model().face_count()), "faces and their parts");
    refuse_borders();
    join_beside_surface(overlay, winding, cells_reaching(), progress,
                        [this](std::int32_t a, std::int32_t b) { join(a, b, false); });
    for (std::size_t e = 0; e < winding.edge_count(); ++e) {
        poll(progress, e);
        go_round(e);
    }
    settle();
}

std::vector<std::uint8_t> cells_near_surface(const SurfaceOverlay& overlay,
                                             const CutterWinding& winding) {
    std::vector<std::uint8_t> reaches(overlay.model().cell_block.size(), 0);
    const auto reach = [&reaches](std::int32_t cell) {
        if (cell >= 0) reaches[index(cell)] = 1;
    };
    for (const std::int32_t f : overlay.active_faces()) {
        for (std::size_t k = 0; k < 2; ++k)
            reach(overlay.model().cell(index(f), k));
    }
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        if (!winding.counts(r)) continue;
        for (std::size_t k = 0; k < 2; ++k) {
            for (const auto& [cell, times] : winding.around(r, k))
                reach(cell);
        }
    }
    return reaches;
}

void join_beside_surface(SurfaceOverlay& overlay, const CutterWinding& winding,
                         std::span<const std::uint8_t> reaches, Progress* progress,
                         const std::function<void(std::int32_t, std::int32_t)>& join) {
    const ComplexView& model = overlay.model();
    const auto regions = static_cast<std::int32_t>(overlay.size());
    const std::size_t items = overlay.size() + model.face_count();
    // of an item, -1 where it is none: its face
    const auto face_of = [&](std::size_t item) {
        if (item >= overlay.size())
            return overlay.is_active(item - overlay.size())
                       ? -1
                       : static_cast<std::int32_t>(item) - regions;
        if (overlay.of_cutter(item) || winding.level(item) >= 0) return -1;
        return static_cast<std::int32_t>(overlay.face_of(item));
    };
    std::vector<std::int32_t> first(model.cell_block.size(), -1);
    for (std::size_t i = 0; i < items; ++i) {
        const std::int32_t face = face_of(i);
        for (std::size_t k = 0; face >= 0 && k < 2; ++k) {
            const std::int32_t cell = model.cell(index(face), k);
            if (cell < 0 || reaches[index(cell)] != 0) continue;
            auto& known = first[index(cell)];
            if (known < 0) known = static_cast<std::int32_t>(i);
            join(known, static_cast<std::int32_t>(i));
        }
    }
    constexpr std::size_t kChunk = 1 << 12;
    const auto uses = sorted_in_buckets<EdgeUse>(
        overlay.node_count(), (items + kChunk - 1) / kChunk,
        [&](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kChunk; i < std::min(items, (chunk + 1) * kChunk); ++i) {
                const std::int32_t face = face_of(i);
                if (face < 0) continue;
                const std::array own{model.cell(index(face), 0), model.cell(index(face), 1)};
                if (std::ranges::none_of(own, [&](std::int32_t cell) {
                        return cell >= 0 && reaches[index(cell)] != 0;
                    }))
                    continue;
                const auto add = [&](const EdgeUse& use) { put(index(use.edge[0]), use); };
                if (i < overlay.size()) {
                    each_edge(overlay.loops(i), static_cast<std::int32_t>(i), add);
                } else {
                    each_edge(std::array{model.face(index(face))}, static_cast<std::int32_t>(i),
                              add);
                }
            }
        },
        {overlay.threads(), progress});
    parallel_ranges(overlay.node_count(), kChunk, {overlay.threads(), progress},
                    [&](std::size_t first_node, std::size_t end_node) {
                        for (std::size_t node = first_node; node < end_node; ++node) {
                            const auto own = uses[node];
                            for (std::size_t begin = 0, end = 0; begin < own.size(); begin = end) {
                                for (end = begin + 1;
                                     end < own.size() && own[end].edge == own[begin].edge;)
                                    ++end;
                                if (end == begin + 1 || winding.is_edge(own[begin].edge)) continue;
                                for (std::size_t i = begin + 1; i < end; ++i)
                                    join(own[begin].item, own[i].item);
                            }
                        }
                    });
}

bool CutterSides::join(std::int32_t a, std::int32_t b, bool opposite) {
    for (const bool other : {false, true})
        sides_.join(2 * a + (other ? 1 : 0), 2 * b + (other != opposite ? 1 : 0));
    return sides_.find(2 * a) != sides_.find(2 * a + 1);
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

/// Around an edge of the surface what bounds one sector within the model is on one side. In sectors
/// outside of it this is said of an open surface that does not end there, for the sake of cells
/// that rounding flattened away; of a closed one it need not be said.
void CutterSides::go_round(std::size_t e) {
    const auto uses = winding_.edge(e);
    const auto sectors = winding_.sectors(e);
    const auto& fan = sectors.fan;
    const auto& windings = sectors.windings;
    /// Visits the items of a blade, each with whether it is seen from its side 1.
    const auto each = [&](std::size_t blade, bool ahead, const auto& visit) {
        for (const std::size_t i : fan.blade(blade)) {
            const EdgeUse& use = uses[i];
            const auto region = index(use.item);
            if (!overlay_.of_cutter(region)) {
                if (winding_.level(region) < 0) visit(use.item, false);
            } else if (winding_.touches_model(region)) {
                visit(use.item, (ahead ? use.ahead() : use.behind()) == 1);
            }
        }
    };
    const bool ends_here = own_uses(uses) % 2 == 1;
    for (std::size_t b = 0; b < fan.blades(); ++b) {
        if (windings[b] == 0 && (ends_here || overlay_.surface().is_closed)) continue;
        std::int32_t first = -1;
        bool first_opposite = false;
        const auto join_all = [&](std::int32_t item, bool opposite) {
            if (first < 0) {
                first = item;
                first_opposite = opposite;
            } else if (!join(first, item, first_opposite != opposite)) {
                refuse("ends_inside", "the surface does not part the model: a way leads round it",
                       uses[0].edge);
            }
        };
        each(b, true, join_all);
        each((b + 1) % fan.blades(), false, join_all);
    }
}

/// The side of something that is not joined with the surface, or of one of its regions.
std::int8_t CutterSides::side_at(std::size_t item, bool of_cutter) {
    const bool is_region = item < overlay_.size();
    if (!overlay_.surface().is_closed) {
        if (of_cutter) return kBelow;
        Position middle{0, 0, 0};
        const auto face =
            overlay_.model().face(is_region ? overlay_.face_of(item) : item - overlay_.size());
        for (const NodeId v : face) {
            for (std::size_t k = 0; k < 3; ++k)
                middle[k] += overlay_.position(v)[k] / static_cast<double>(face.size());
        }
        if (!nearest_) nearest_.emplace(overlay_.surface());
        return (*nearest_)(middle);
    }
    exact::SpacePoints& points = overlay_.points();
    const std::pair<std::size_t, int> seen =
        is_region ? overlay_.view_of(item) : std::pair<std::size_t, int>{2, 1};
    const SpacePointId p = is_region
                               ? overlay_.inner_point(item)
                               : overlay_.exact(overlay_.model().face(item - overlay_.size())[0]);
    const Position at = points.rounded(p);
    const auto& vertices = overlay_.surface().vertices;
    const double margin = std::max(rounding_of(std::array<Position, 1>{at}), rounding_of(vertices));
    /// Whether the line along the axis is away from a triangle.
    const auto is_aside = [&](const std::array<std::int32_t, 3>& t) {
        for (std::size_t k = 1; k < 3; ++k) {
            const std::size_t axis = (seen.first + k) % 3;
            const auto [low, high] =
                std::minmax({vertices[index(t[0])][axis], vertices[index(t[1])][axis],
                             vertices[index(t[2])][axis]});
            if (at[axis] < low - margin || at[axis] > high + margin) return true;
        }
        return false;
    };
    bool inside = false;
    for (const auto& t : overlay_.surface().triangles) {
        if (is_aside(t)) continue;
        std::array<SpacePointId, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = points.add(overlay_.surface().vertices[index(t[i])]);
        if (exact::ray_crosses(points, seen.first, p, corners, of_cutter && seen.second > 0) != 0)
            inside = !inside;
    }
    return inside ? kBelow : kAbove;
}

/// The side of an item: what its set is known to have, or else `if_unknown()`.
template <class Side>
std::int8_t CutterSides::settled(std::int32_t item, const Side& if_unknown) {
    std::int8_t& known = of_set_[index(sides_.find(2 * item))];
    if (known == kOn) {
        known = if_unknown();
        of_set_[index(sides_.find(2 * item + 1))] = static_cast<std::int8_t>(-known);
    }
    return known;
}

void CutterSides::settle() {
    const std::size_t count = overlay_.size() + overlay_.model().face_count();
    side_.assign(count, kOn);
    of_set_.assign(2 * count, kOn);
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (!winding_.counts(r) || !winding_.touches_model(r)) continue;
        const std::int8_t side =
            settled(static_cast<std::int32_t>(r), [&] { return side_at(r, true); });
        if (overlay_.surface().is_closed || side == kBelow) continue;
        const auto outline = overlay_.loops(r)[0];
        refuse("two_sides",
               "a point of the model is above one part of the surface and below another",
               {outline[0], outline[1]});
    }
    for (std::size_t i = 0; i < count; ++i) {
        const bool is_region = i < overlay_.size();
        const bool has_side = !is_region ? !overlay_.is_active(i - overlay_.size())
                              : overlay_.of_cutter(i)
                                  ? winding_.counts(i) && winding_.touches_model(i)
                                  : winding_.level(i) < 0;
        if (has_side)
            side_[i] = settled(static_cast<std::int32_t>(i), [&] { return side_at(i, false); });
    }
}

}  // namespace realmodel::cutting
