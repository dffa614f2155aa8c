// SPDX-License-Identifier: GPL-3.0-or-later
// What bounds the parts of cells, and which of it belongs together.
#include "cutting/surface_parts.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <stdexcept>

#include "base/disjoint_sets.hpp"
#include "base/parallel_sort.hpp"

namespace realmodel::cutting {

using arrangement::each_edge;

using spatial::Box;

namespace {

/// A half edge of a face's regions.
struct Half {
    NodeId from, to;
    std::int32_t region, next, twin;
};

}  // namespace

SurfaceParts::SurfaceParts(SurfaceOverlay& overlay, const CutterWinding& winding,
                           const CutterSides& sides, Progress* progress)
    : overlay_(overlay), winding_(winding), sides_(sides) {
    make_patches(progress);
    if (progress != nullptr) progress->begin(0.68, 0.75, "joining what bounds a part");
    make_caps();
    owner_.resize(slots_.size());
    std::iota(owner_.begin(), owner_.end(), 0);
    join_parts(progress);
    attach_hollows();
    number_parts();
    if (progress != nullptr) progress->begin(0.77, 0.85, "dividing faces into polygons");
    write_patches(progress);
    write_caps();
    find_touches(progress);
}

std::int32_t SurfaceParts::find(std::int32_t slot) {
    while (owner_[index(slot)] != slot)
        slot = owner_[index(slot)] = owner_[index(owner_[index(slot)])];
    return slot;
}

std::int32_t SurfaceParts::add_slot(std::int32_t cell, std::int8_t half, std::int8_t sign) {
    if (cell < 0) return -1;
    slots_.push_back({cell, half, sign});
    return static_cast<std::int32_t>(slots_.size()) - 1;
}

void SurfaceParts::use_edge(std::int32_t slot, const EdgeUse& use) {
    if (slot < 0) return;
    const Slot& own = slots_[index(slot)];
    if (sides_.reaches(own.cell)) uses_.push_back({own.cell, own.half, use, slot});
}

void SurfaceParts::make_patches(Progress* progress) {
    const ComplexView& model = overlay_.model();
    std::vector<std::vector<std::int32_t>> of_face(model.face_count());
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (!overlay_.of_cutter(r) && winding_.level(r) < 0)
            of_face[overlay_.face_of(r)].push_back(static_cast<std::int32_t>(r));
    }
    constexpr std::size_t kCounted = 1 << 10;  // faces
    CountedLoop counted(progress, model.face_count() / kCounted, 1.0);
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        poll(progress, f);
        if (f % kCounted == kCounted - 1) counted.count();
        if (overlay_.is_active(f)) {
            divide_face(f, of_face[f]);
            continue;
        }
        const std::int8_t half = sides_.of_face(f);
        Patch& patch = patches_.emplace_back(Patch{static_cast<std::int32_t>(f), {}, half, {}});
        for (std::size_t k = 0; k < 2; ++k) {
            patch.slots[k] = add_slot(model.cell(f, k), half, k == 0 ? 1 : -1);
            each_edge(std::array{model.face(f)}, static_cast<std::int32_t>(overlay_.size() + f),
                      [&](const EdgeUse& use) { use_edge(patch.slots[k], use); });
        }
    }
}

/// Joins the regions of a face along edges that are none of the surface's.
void SurfaceParts::divide_face(std::size_t face, std::span<const std::int32_t> regions) {
    std::vector<Half> halves;
    std::map<std::array<NodeId, 2>, std::vector<std::int32_t>> by_ends;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        for (const auto& loop : overlay_.loops(index(regions[i]))) {
            const auto first = static_cast<std::int32_t>(halves.size());
            const auto size = static_cast<std::int32_t>(loop.size());
            for (std::int32_t k = 0; k < size; ++k) {
                by_ends[{loop[index(k)], loop[index((k + 1) % size)]}].push_back(first + k);
                halves.push_back({loop[index(k)], loop[index((k + 1) % size)],
                                  static_cast<std::int32_t>(i), first + (k + 1) % size, -1});
            }
        }
    }
    DisjointSets joined(regions.size());
    for (auto& [ends, users] : by_ends) {
        if (ends[0] > ends[1] || winding_.is_edge(ends)) continue;
        const auto against = by_ends.find({ends[1], ends[0]});
        if (against == by_ends.end()) continue;
        for (std::size_t i = 0; i < std::min(users.size(), against->second.size()); ++i) {
            Half &h = halves[index(users[i])], &g = halves[index(against->second[i])];
            h.twin = against->second[i];
            g.twin = users[i];
            joined.join(h.region, g.region);
        }
    }
    std::map<std::int32_t, std::size_t> patch_of;  // by the first region of each
    std::vector<bool> done(halves.size(), false);
    for (std::size_t start = 0; start < halves.size(); ++start) {
        if (done[start] || halves[start].twin >= 0) continue;
        const std::int32_t first = joined.find(halves[start].region);
        const auto [at, is_new] = patch_of.try_emplace(first, patches_.size());
        if (is_new) {
            const std::int32_t region = regions[index(first)];
            const std::int8_t half = sides_.of_region(index(region));
            Patch& patch =
                patches_.emplace_back(Patch{static_cast<std::int32_t>(face), {}, half, {}});
            for (std::size_t k = 0; k < 2; ++k)
                patch.slots[k] = add_slot(overlay_.model().cell(face, k), half, k == 0 ? 1 : -1);
        }
        Patch& patch = patches_[at->second];
        auto& loop = patch.loops.emplace_back();
        std::size_t h = start;
        do {
            done[h] = true;
            const Half& half = halves[h];
            loop.push_back(half.from);
            const EdgeUse use{{std::min(half.from, half.to), std::max(half.from, half.to)},
                              regions[index(half.region)],
                              static_cast<std::int8_t>(half.from < half.to ? 1 : -1)};
            for (const std::int32_t slot : patch.slots)
                use_edge(slot, use);
            h = index(half.next);
            while (halves[h].twin >= 0)
                h = index(halves[index(halves[h].twin)].next);
        } while (h != start);
    }
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const auto at = patch_of.find(joined.find(static_cast<std::int32_t>(i)));
        if (at != patch_of.end()) patches_[at->second].regions.push_back(regions[i]);
    }
}

void SurfaceParts::make_caps() {
    for (std::size_t r = 0; r < overlay_.size(); ++r) {
        if (!winding_.counts(r) || !winding_.touches_model(r)) continue;
        Caps& caps = caps_.emplace_back(Caps{static_cast<std::int32_t>(r), {}});
        for (std::size_t k = 0; k < 2; ++k) {
            const std::int8_t below = sides_.below(r);
            const auto half = static_cast<std::int8_t>(k == 0 ? below : -below);
            for (const auto& [cell, times] : winding_.around(r, k)) {
                for (int i = 0; i < std::abs(times); ++i)
                    caps.slots[k].push_back(add_slot(cell, half, (times > 0) == (k == 0) ? 1 : -1));
            }
            each_edge(overlay_.loops(r), caps.region, [&](const EdgeUse& use) {
                for (const std::int32_t slot : caps.slots[k])
                    use_edge(slot, use);
            });
        }
    }
}

void SurfaceParts::join_parts(Progress* progress) {
    const auto join = [this](std::int32_t a, std::int32_t b) {
        a = find(a);
        b = find(b);
        owner_[index(std::max(a, b))] = std::min(a, b);
    };
    // cells that are on one side stay whole
    const std::size_t cells = overlay_.model().cell_block.size();
    std::vector<std::uint8_t> halves(cells, 0);
    const auto bit = [](std::int8_t half) { return static_cast<std::uint8_t>(half > 0 ? 2 : 1); };
    for (const Slot& slot : slots_)
        halves[index(slot.cell)] |= bit(slot.half);
    std::vector<std::int32_t> first(cells, -1);
    for (std::size_t s = 0; s < slots_.size(); ++s) {
        const auto cell = index(slots_[s].cell);
        if (halves[cell] == 3) continue;
        if (first[cell] < 0) first[cell] = static_cast<std::int32_t>(s);
        join(first[cell], static_cast<std::int32_t>(s));
    }
    parallel_sort(uses_, std::less<>(), overlay_.threads(), progress);
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
        poll(progress, begin);
        while (end < uses_.size() && uses_[end].cell == uses_[begin].cell &&
               uses_[end].half == uses_[begin].half && uses_[end].use.edge == uses_[begin].use.edge)
            ++end;
        if (halves[index(uses_[begin].cell)] != 3) continue;
        if (end - begin == 2) {
            join(uses_[begin].slot, uses_[begin + 1].slot);
        } else {
            join_round_edge({uses_.data() + begin, end - begin});
        }
    }
}

/// Of several slots of one cell around an edge those belong together that bound one sector of it:
/// each that the cell begins at, going round, with the one where it ends.
void SurfaceParts::join_round_edge(std::span<const SlotUse> uses) {
    std::vector<EdgeUse> group;
    for (const SlotUse& use : uses)
        group.push_back(use.use);
    const EdgeFan fan = overlay_.fan_of(group);
    struct Step {
        std::int32_t slot;
        int change;  ///< 1 the cell begins, -1 it ends
    };
    std::vector<Step> steps;
    for (std::size_t b = 0; b < fan.blades(); ++b) {
        for (const int change : {-1, 1}) {
            for (const std::size_t i : fan.blade(b)) {
                const std::size_t own = slots_[index(uses[i].slot)].sign > 0 ? 0 : 1;
                if ((uses[i].use.ahead() == own) == (change > 0))
                    steps.push_back({uses[i].slot, change});
            }
        }
    }
    int sum = 0, least = 0;
    std::size_t start = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        sum += steps[i].change;
        if (sum < least) {
            least = sum;
            start = i + 1;
        }
    }
    if (sum != 0) throw std::logic_error("a part of a cell is not closed");
    std::vector<std::int32_t> begun;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const Step& step = steps[(start + i) % steps.size()];
        if (step.change > 0) {
            begun.push_back(step.slot);
            continue;
        }
        const std::int32_t a = find(begun.back()), b = find(step.slot);
        owner_[index(std::max(a, b))] = std::min(a, b);
        begun.pop_back();
    }
}

/// The wall of a hollow that the surface cuts out of a cell bounds the part around it; what
/// rounding turned inside out goes with the part beside it.
void SurfaceParts::attach_hollows() {
    struct Shell {
        double volume = 0;
        Box box;
    };
    std::map<std::pair<std::int32_t, std::int8_t>, std::map<std::int32_t, Shell>> shells;
    std::vector<Position> origin(overlay_.model().cell_block.size());
    std::vector<std::uint8_t> has_origin(origin.size(), 0);
    const auto take = [&](std::int32_t slot, const auto& loops) {
        if (slot < 0 || !sides_.reaches(slots_[index(slot)].cell)) return;
        const Slot& own = slots_[index(slot)];
        Shell& shell = shells[{own.cell, own.half}][find(slot)];
        if (has_origin[index(own.cell)] == 0) {
            has_origin[index(own.cell)] = 1;
            origin[index(own.cell)] = overlay_.position(loops[0][0]);
        }
        for (const auto& loop : loops) {
            const Position first = overlay_.position(loop[0]);
            for (std::size_t i = 0; i < loop.size(); ++i) {
                shell.box.include(overlay_.position(loop[i]));
                if (i < 2) continue;
                shell.volume += own.sign * sixfold_volume(origin[index(own.cell)], first,
                                                          overlay_.position(loop[i - 1]),
                                                          overlay_.position(loop[i]));
            }
        }
    };
    for (const Patch& patch : patches_) {
        for (const std::int32_t slot : patch.slots) {
            if (patch.regions.empty()) {
                take(slot, std::array{overlay_.model().face(index(patch.face))});
            } else {
                take(slot, patch.loops);
            }
        }
    }
    for (const Caps& caps : caps_) {
        for (const auto& own : caps.slots) {
            for (const std::int32_t slot : own)
                take(slot, overlay_.loops(index(caps.region)));
        }
    }
    for (const auto& [cell, of_cell] : shells) {
        for (const auto& [root, hollow] : of_cell) {
            if (hollow.volume > 0) continue;
            const std::pair<const std::int32_t, Shell>* around = nullptr;
            for (const auto& other : of_cell) {
                const Shell& shell = other.second;
                if (other.first == root || shell.volume <= -hollow.volume) continue;
                const bool better =
                    around == nullptr ||
                    std::pair(!shell.box.contains(hollow.box), shell.volume) <
                        std::pair(!around->second.box.contains(hollow.box), around->second.volume);
                if (better) around = &other;
            }
            if (around == nullptr) continue;
            const std::int32_t a = find(around->first), b = find(root);
            owner_[index(std::max(a, b))] = std::min(a, b);
        }
    }
}

}  // namespace realmodel::cutting
