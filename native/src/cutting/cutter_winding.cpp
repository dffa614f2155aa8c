// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_winding.hpp"

#include <algorithm>

#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"

namespace realmodel::cutting {

using arrangement::each_edge;

namespace {

/// A loop from its least node on; of several such beginnings the least.
std::vector<NodeId> from_least(const std::vector<NodeId>& loop) {
    const NodeId least = *std::min_element(loop.begin(), loop.end());
    std::vector<NodeId> best;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        if (loop[i] != least) continue;
        std::vector<NodeId> rotated(loop);
        std::rotate(rotated.begin(), rotated.begin() + static_cast<std::ptrdiff_t>(i),
                    rotated.end());
        if (best.empty() || rotated < best) best = std::move(rotated);
    }
    return best;
}

void add(Winding& winding, std::int32_t cell, std::int32_t times) {
    if (cell < 0) return;
    const auto at = std::lower_bound(winding.begin(), winding.end(), std::pair(cell, INT32_MIN));
    if (at == winding.end() || at->first != cell) {
        winding.insert(at, {cell, times});
    } else if ((at->second += times) == 0) {
        winding.erase(at);
    }
}

}  // namespace

CutterWinding::CutterWinding(SurfaceOverlay& overlay, Progress* progress) : overlay_(overlay) {
    number({});
    find_coinciding();
    collect_uses(progress);
    find_fans(progress);
    winding_.assign(2 * overlay.size(), -1);
    // regions that reach beyond the model first: there is nothing around them
    for (const bool beyond : {true, false}) {
        for (std::size_t r = 0; r < overlay.size(); ++r) {
            poll(progress, r);
            if (!counts(r) || winding_[2 * r] >= 0) continue;
            if (beyond) {
                const auto& outline = overlay.loops(r)[0];
                if (std::all_of(outline.begin(), outline.end(), [&](NodeId node) {
                        return overlay.model_box().contains(overlay.position(node));
                    }))
                    continue;
                winding_[2 * r] = winding_[2 * r + 1] = 0;
            } else {
                winding_[2 * r] = number(cast(r));
                Winding above = around(r, 0);
                for (const std::int32_t face_region : lying_on_[r])
                    cross(above, index(face_region), level_facing(index(face_region)) > 0 ? 1 : 0);
                winding_[2 * r + 1] = number(std::move(above));
            }
            std::vector<std::int32_t> open(edges_of_[r]);
            while (!open.empty()) {
                const auto edge = index(open.back());
                open.pop_back();
                if (!sectors_[edge].windings.empty()) continue;
                spread(edge, progress);
                for (const EdgeUse& use : this->edge(edge)) {
                    if (!overlay.of_cutter(index(use.item))) continue;
                    for (const std::int32_t other : edges_of_[index(use.item)]) {
                        if (sectors_[index(other)].windings.empty()) open.push_back(other);
                    }
                }
            }
        }
    }
}

bool CutterWinding::is_edge(const std::array<NodeId, 2>& edge) const {
    std::size_t low = 0, high = edge_count();
    while (low < high) {
        const std::size_t middle = (low + high) / 2;
        if (this->edge(middle)[0].edge < edge) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < edge_count() && this->edge(low)[0].edge == edge;
}

void CutterWinding::find_coinciding() {
    const std::size_t count = overlay_.size();
    counts_.assign(count, 0);
    level_.assign(count, -1);
    level_facing_.assign(count, 0);
    lying_on_.resize(count);
    std::map<std::vector<NodeId>, std::pair<std::int32_t, int>> outlines;  // first region, how many
    const auto find = [&outlines](std::vector<NodeId> outline, std::int8_t& facing) {
        auto found = outlines.find(from_least(outline));
        facing = 1;
        if (found != outlines.end()) return found;
        std::reverse(outline.begin(), outline.end());
        facing = -1;
        return outlines.find(from_least(outline));
    };
    std::int8_t facing = 1;
    for (std::size_t r = 0; r < count; ++r) {
        if (!overlay_.of_cutter(r)) continue;
        const auto& outline = overlay_.loops(r)[0];
        const auto found = find(outline, facing);
        if (found != outlines.end()) {
            ++found->second.second;
        } else {
            outlines[from_least(outline)] = {static_cast<std::int32_t>(r), 1};
        }
    }
    for (const auto& [outline, first] : outlines)
        counts_[index(first.first)] =
            overlay_.surface().is_closed ? static_cast<std::uint8_t>(first.second % 2) : 1;
    for (std::size_t r = 0; r < count; ++r) {
        const auto found = find(overlay_.loops(r)[0], facing);
        if (found == outlines.end() || counts_[index(found->second.first)] == 0) continue;
        level_[r] = found->second.first;
        level_facing_[r] = facing;
        if (!overlay_.of_cutter(r))
            lying_on_[index(level_[r])].push_back(static_cast<std::int32_t>(r));
    }
}

void CutterWinding::collect_uses(const Progress* progress) {
    const std::size_t count = overlay_.size();
    std::vector<std::array<NodeId, 2>> edges;
    for (std::size_t r = 0; r < count; ++r) {
        if (!counts(r)) continue;
        each_edge(overlay_.loops(r), 0, [&](const EdgeUse& use) { edges.push_back(use.edge); });
    }
    parallel_sort(edges, std::less<>(), overlay_.threads(), progress);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    for (std::size_t r = 0; r < count; ++r) {
        if (overlay_.of_cutter(r) && !counts(r)) continue;
        each_edge(overlay_.loops(r), static_cast<std::int32_t>(r), [&](const EdgeUse& use) {
            if (std::binary_search(edges.begin(), edges.end(), use.edge)) uses_.push_back(use);
        });
    }
    parallel_sort(uses_, std::less<>(), overlay_.threads(), progress);
    edges_of_.resize(count);
    for (std::size_t begin = 0, end = 0; begin < uses_.size(); begin = end) {
        for (; end < uses_.size() && uses_[end].edge == uses_[begin].edge; ++end) {
            if (counts(index(uses_[end].item)))
                edges_of_[index(uses_[end].item)].push_back(
                    static_cast<std::int32_t>(edge_count()));
        }
        edge_begins_.push_back(end);
    }
}

void CutterWinding::find_fans(const Progress* progress) {
    sectors_.resize(edge_count());
    parallel_ranges(sectors_.size(), 1 << 8, overlay_.threads(), progress,
                    [this](std::size_t begin, std::size_t end) {
                        for (std::size_t e = begin; e < end; ++e)
                            sectors_[e].fan = overlay_.fan_of(edge(e));
                    });
}

std::int32_t CutterWinding::number(Winding&& winding) {
    const auto [found, is_new] =
        number_.try_emplace(std::move(winding), static_cast<std::int32_t>(known_.size()));
    if (is_new) known_.push_back(found->first);
    return found->second;
}

/// What changes where a face's region is crossed to its side `entered`.
void CutterWinding::cross(Winding& winding, std::size_t region, std::size_t entered) const {
    const std::size_t face = overlay_.face_of(region);
    add(winding, overlay_.model().cell(face, 1 - entered), -1);
    add(winding, overlay_.model().cell(face, entered), 1);
}

/// Finds the sectors and regions around an edge, of which one region is known.
void CutterWinding::spread(std::size_t e, Progress* progress) {
    if (progress != nullptr && (e & 0xff) == 0) progress->check();
    const auto uses = edge(e);
    Sectors& sectors = sectors_[e];
    const std::size_t blades = sectors.fan.blades();
    sectors.windings.assign(blades, 0);
    // the blade of a region that is known; a region may come to the edge from both sides
    std::size_t start = blades;
    std::int32_t behind = 0;
    for (std::size_t b = 0; b < blades && start == blades; ++b) {
        for (const std::size_t i : sectors.fan.blade(b)) {
            const auto region = index(uses[i].item);
            if (!overlay_.of_cutter(region) || winding_[2 * region] < 0) continue;
            start = b;
            behind = winding_[2 * region + uses[i].behind()];
            break;
        }
    }
    for (std::size_t n = 0; n < blades; ++n) {
        const std::size_t b = (start + n) % blades;
        std::int32_t ahead = behind;
        bool faces = false;
        for (const std::size_t i : sectors.fan.blade(b))
            faces = faces || !overlay_.of_cutter(index(uses[i].item));
        if (faces) {
            Winding winding = known_[index(behind)];
            for (const std::size_t i : sectors.fan.blade(b)) {
                if (!overlay_.of_cutter(index(uses[i].item)))
                    cross(winding, index(uses[i].item), uses[i].ahead());
            }
            ahead = number(std::move(winding));
        }
        for (const std::size_t i : sectors.fan.blade(b)) {
            const auto region = index(uses[i].item);
            if (!overlay_.of_cutter(region) || winding_[2 * region] >= 0) continue;
            winding_[2 * region + uses[i].behind()] = behind;
            winding_[2 * region + uses[i].ahead()] = ahead;
        }
        sectors.windings[b] = behind = ahead;
    }
}

/// What is just below a region, by the triangles that a ray from there crosses.
Winding CutterWinding::cast(std::size_t region) {
    const SpacePointId p = overlay_.inner_point(region);
    const auto view = overlay_.view_of(region);
    const auto axis = view.first;
    const bool faces_ray = view.second > 0;
    exact::SpacePoints& points = overlay_.points();
    Winding winding;
    overlay_.each_triangle(axis, p, [&](std::size_t face, const auto& corners) {
        const int side = exact::ray_crosses(points, axis, p, corners, faces_ray);
        if (side == 0) return;
        add(winding, overlay_.model().cell(face, 0), side);
        add(winding, overlay_.model().cell(face, 1), -side);
    });
    return winding;
}

}  // namespace realmodel::cutting
