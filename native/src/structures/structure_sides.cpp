// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/structure_sides.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"
#include "structures/branch_sides.hpp"

namespace realmodel::structures {

using cutting::kAbove;
using cutting::kBelow;
using cutting::minus;

namespace {

constexpr std::int32_t kUnknown = INT32_MIN;

}  // namespace

StructureSides::StructureSides(SurfaceOverlay& overlay, const CutterWinding& winding,
                               const StructureSurface& surface,
                               std::span<const Structure> structures, Progress* progress)
    : overlay_(overlay),
      winding_(winding),
      surface_(surface),
      structures_(structures),
      items_(overlay.size() + overlay.model().face_count()),
      near_(cutting::cells_near_surface(overlay, winding)),
      joined_(items_ + overlay.size()) {
    checked_number(items_ + overlay.size(), "faces and their parts");
    name_structures();
    join_sectors(progress);
    number_parts();
    find_neighbors();
    sides_.assign(item_.size(), Sides(structures.size(), 0));
    kept_.resize(structures.size());
    for (const cutting::CutterSurface& single : surface.single)
        nearest_.emplace_back(single);
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
            find_kept_sides(static_cast<std::int32_t>(s));
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
    const auto outline = overlay_.loops(region)[0];
    Position middle{0, 0, 0};
    for (const NodeId node : outline) {
        for (std::size_t k = 0; k < 3; ++k)
            middle[k] += overlay_.position(node)[k] / static_cast<double>(outline.size());
    }
    return middle;
}

/// Which structures each region that counts is of, by all that coincide with it.
void StructureSides::name_structures() {
    of_.resize(overlay_.size());
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (!overlay_.of_cutter(r) || winding_.level(r) < 0) continue;
        const auto triangle = index(overlay_.cutter_triangle(r));
        const std::int32_t s = surface_.structure[triangle];
        const bool is_own = surface_.is_continuation[triangle] == 0;
        auto& own = of_[index(winding_.level(r))];
        auto known = std::ranges::find(own, s, &RegionOf::structure);
        if (known == own.end()) known = own.insert(own.end(), {s, 0, false});
        if (structures_[index(s)].is_body) {
            known->change ^= 1;
        } else {
            known->change += winding_.level_facing(r);
        }
        known->is_own = known->is_own || is_own;
    }
    for (auto& own : of_) {
        std::erase_if(own, [](const RegionOf& of) { return of.change == 0; });
        std::ranges::sort(own, {}, &RegionOf::structure);
    }
}

/// Whether sides around an edge are known in rock alone: a fault ends there, or no rock is near, so
/// that structures may cross unnoticed.
bool StructureSides::is_known_in_rock_alone(std::span<const EdgeUse> uses) const {
    std::map<std::int32_t, std::size_t> count;
    bool has_faces = false;
    for (const EdgeUse& use : uses) {
        const auto item = index(use.item);
        if (item >= overlay_.size() || !overlay_.of_cutter(item)) {
            has_faces = true;
            continue;
        }
        for (const RegionOf& of : of_[item])
            count[of.structure] += static_cast<std::size_t>(std::abs(of.change));
    }
    return !has_faces ||
           std::ranges::any_of(count, [](const auto& one) { return one.second % 2 == 1; });
}

/// Of regions: those of the surface that reach away from the rock. There structures may end without
/// crossing one another.
std::vector<std::uint8_t> StructureSides::regions_beyond() const {
    std::vector<std::uint8_t> found(overlay_.size(), 0);
    for (std::size_t r = 0; r < found.size(); ++r) {
        if (!overlay_.of_cutter(r) || !winding_.counts(r) || winding_.touches_model(r)) continue;
        found[r] = std::ranges::any_of(overlay_.loops(r), [this](const auto& loop) {
            return std::ranges::any_of(loop, [this](NodeId node) {
                return !overlay_.model_box().contains(overlay_.position(node));
            });
        });
    }
    return found;
}

/// What bounds one sector around an edge is in one part. This is said of sectors beside the rock,
/// too, for the sake of cells that rounding flattened away.
void StructureSides::join_sectors(Progress* progress) {
    const std::vector<std::uint8_t> is_beyond = regions_beyond();
    cutting::join_beside_surface(overlay_, winding_, near_, progress,
                                 [this](std::int32_t a, std::int32_t b) { joined_.join(a, b); });
    const auto item_at = [this](const EdgeUse& use, std::size_t side) {
        const auto item = index(use.item);
        if (item >= overlay_.size() || !overlay_.of_cutter(item)) return use.item;
        return static_cast<std::int32_t>(side == 0 ? item : items_ + item);
    };
    const auto join_around = [&](std::size_t e) {
        const auto uses = winding_.edge(e);
        const auto& fan = winding_.sectors(e).fan;
        const auto& windings = winding_.sectors(e).windings;
        const bool in_rock_alone = is_known_in_rock_alone(uses);
        for (std::size_t b = 0; b < fan.blades(); ++b) {
            if (in_rock_alone && windings[b] == 0) continue;
            std::int32_t first = -1;
            const auto join_all = [&](std::size_t blade, bool ahead) {
                for (const std::size_t i : fan.blade(blade)) {
                    const EdgeUse& use = uses[i];
                    const auto item = index(use.item);
                    const bool is_face = item >= overlay_.size() || !overlay_.of_cutter(item);
                    if (is_face && item < overlay_.size() && winding_.level(item) >= 0) continue;
                    if (!is_face && is_beyond[item] != 0) continue;
                    const std::int32_t at = item_at(use, ahead ? use.ahead() : use.behind());
                    if (first < 0) {
                        first = at;
                    } else {
                        joined_.join(first, at);
                    }
                }
            };
            join_all(b, true);
            join_all((b + 1) % fan.blades(), false);
        }
    };
    parallel_ranges(winding_.edge_count(), 1 << 10, {overlay_.threads(), progress},
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t e = begin; e < end; ++e)
                            join_around(e);
                    });
}

void StructureSides::number_parts() {
    part_.assign(items_ + overlay_.size(), -1);
    std::vector<std::int32_t> number(part_.size(), -1);
    for (std::size_t i = 0; i < part_.size(); ++i) {
        const bool is_region = i < overlay_.size() || i >= items_;
        const std::size_t own = i >= items_ ? i - items_ : i;
        const bool of_cutter = is_region && overlay_.of_cutter(own);
        if (is_region ? of_cutter ? !winding_.counts(own) || !winding_.touches_model(own)
                                  : i >= items_ || winding_.level(own) >= 0
                      : overlay_.is_active(i - overlay_.size()))
            continue;
        auto& known = number[index(joined_.find(static_cast<std::int32_t>(i)))];
        if (known < 0) {
            known = static_cast<std::int32_t>(item_.size());
            item_.push_back(static_cast<std::int32_t>(i));
        }
        part_[i] = known;
    }
}

void StructureSides::find_neighbors() {
    neighbors_.resize(item_.size());
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (!overlay_.of_cutter(r) || part_[r] < 0) continue;
        const auto region = static_cast<std::int32_t>(r);
        neighbors_[part_at(r, 0)].push_back({part_[items_ + r], region, 1});
        neighbors_[part_at(r, 1)].push_back({part_[r], region, -1});
    }
}

/// Whether a part is beyond one of the faults that a fault ends at.
bool StructureSides::is_beyond(std::int32_t s, std::size_t part) const {
    const auto& ends_at = structures_[index(s)].ends_at;
    for (std::size_t i = 0; i < ends_at.size(); ++i) {
        const std::int8_t side = sides_[part][index(ends_at[i])];
        if (side != 0 && side != kept_[index(s)][i]) return true;
    }
    return false;
}

/// Of a fault that ends at others: on which side of each the larger part of its area lies.
void StructureSides::find_kept_sides(std::int32_t s) {
    if (!surface_.kept.empty()) {
        kept_[index(s)] = surface_.kept[index(s)];
        return;
    }
    for (const std::int32_t other : structures_[index(s)].ends_at)
        kept_[index(s)].push_back(kept_side(surface_, s, other));
}

/// Takes what is known of a part to all that can be reached from it.
void StructureSides::spread(std::int32_t s, std::size_t start, std::vector<std::int32_t>& known) {
    const bool is_body = structures_[index(s)].is_body;
    std::vector<std::size_t> open{start};
    while (!open.empty()) {
        const std::size_t part = open.back();
        open.pop_back();
        for (const Neighbor& way : neighbors_[part]) {
            if (is_beyond(s, index(way.part))) continue;
            std::int32_t change = 0;
            for (const RegionOf& of : of_[index(way.region)]) {
                if (of.structure == s) change = is_body ? of.change : way.direction * of.change;
            }
            const std::int32_t next = is_body ? known[part] ^ change : known[part] + change;
            auto& other = known[index(way.part)];
            if (other == kUnknown) {
                other = next;
                open.push_back(index(way.part));
            } else if (other != next) {
                refuse("ends_inside", "the fault ends in the rock", s, index(way.region));
            }
        }
    }
}

/// By the rays that leave the body.
bool StructureSides::is_inside(std::int32_t s, std::size_t part) {
    const auto item = index(item_[part]);
    const bool is_region = item < overlay_.size() || item >= items_;
    const std::size_t own = item >= items_ ? item - items_ : item;
    exact::SpacePoints& points = overlay_.points();
    const std::pair<std::size_t, int> seen =
        is_region ? overlay_.view_of(own) : std::pair<std::size_t, int>{2, 1};
    const auto p = is_region ? overlay_.inner_point(own)
                             : overlay_.exact(overlay_.model().face(item - overlay_.size())[0]);
    // the ray goes down: a part on the upper side of a region crosses that region too
    const bool is_below =
        is_region && overlay_.of_cutter(own) && (item < items_) == (seen.second > 0);
    bool inside = false;
    const auto& body = surface_.single[index(s)];
    for (const auto& t : body.triangles) {
        std::array<exact::SpacePointId, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = points.add(body.vertices[index(t[i])]);
        if (exact::ray_crosses(points, seen.first, p, corners, is_below) != 0) inside = !inside;
    }
    return inside;
}

void StructureSides::find_sides(std::int32_t s) {
    const bool is_body = structures_[index(s)].is_body;
    std::vector<std::int32_t> known(item_.size(), kUnknown);
    // where a fault itself is between rock on both sides, below is 0 and above is 1
    if (!is_body) {
        for (std::size_t r = 0; r < overlay_.size(); ++r) {
            if (!overlay_.of_cutter(r) || part_[r] < 0) continue;
            for (const RegionOf& of : of_[r]) {
                if (of.structure != s || !of.is_own || std::abs(of.change) != 1) continue;
                const std::size_t low = part_at(r, of.change > 0 ? 0 : 1);
                const std::size_t high = part_at(r, of.change > 0 ? 1 : 0);
                if (is_beyond(s, low) || is_beyond(s, high)) continue;
                if (known[low] != kUnknown || known[high] != kUnknown) continue;
                known[low] = 0;
                spread(s, low, known);
            }
        }
    }
    for (std::size_t part = 0; part < item_.size(); ++part) {
        if (is_beyond(s, part)) continue;
        if (known[part] == kUnknown) {
            if (is_body) {
                known[part] = is_inside(s, part) ? 1 : 0;
            } else {
                const auto item = index(item_[part]);
                const bool is_face = item >= overlay_.size() && item < items_;
                const Position p =
                    is_face ? overlay_.position(overlay_.model().face(item - overlay_.size())[0])
                            : middle_of(item >= items_ ? item - items_ : item);
                known[part] = nearest_[index(s)](p) == kAbove;
            }
            spread(s, part, known);
        }
        const bool below = is_body ? known[part] == 1 : known[part] < 1;
        sides_[part][index(s)] = below ? kBelow : kAbove;
    }
}

}  // namespace realmodel::structures
