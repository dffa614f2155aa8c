// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_winding.hpp"

#include <algorithm>
#include <cassert>

#include "base/parallel.hpp"

namespace realmodel::cutting {

using arrangement::each_edge;

namespace {

std::uint32_t hash_of(const Winding& winding) {
    std::uint32_t hash = 0;
    for (const auto& [cell, times] : winding)
        hash = KeyTable::hash(KeyTable::Key{static_cast<std::int32_t>(hash), cell, times, 0});
    return hash;
}

constexpr auto to_number = [](std::size_t i) { return static_cast<std::uint32_t>(i); };

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
    find_coinciding(progress);
    collect_uses(progress);
    find_borders();
    find_fans(progress);
    winding_.assign(2 * overlay.size(), -1);
    std::vector<std::int32_t> open;
    // regions that reach beyond the model first: there is nothing around them
    for (const bool beyond : {true, false}) {
        for (std::size_t r = 0; r < overlay.size(); ++r) {
            poll(progress, r);
            if (!counts(r) || winding_[2 * r] >= 0) continue;
            if (beyond) {
                const auto outline = overlay.loops(r)[0];
                if (std::all_of(outline.begin(), outline.end(), [&](NodeId node) {
                        return overlay.model_box().contains(overlay.position(node));
                    }))
                    continue;
                winding_[2 * r] = winding_[2 * r + 1] = 0;
            } else {
                winding_[2 * r] = number(cast(r, progress));
                Winding above = around(r, 0);
                for (const std::int32_t face_region : lying_on_[r])
                    cross(above, index(face_region), level_facing(index(face_region)) > 0 ? 1 : 0);
                winding_[2 * r + 1] = number(above);
            }
            open.assign(edges_of_[r].begin(), edges_of_[r].end());
            while (!open.empty()) {
                const auto edge = index(open.back());
                open.pop_back();
                if (is_known_[edge] != 0) continue;
                spread(edge, progress);
                for (const EdgeUse& use : this->edge(edge)) {
                    if (!overlay.of_cutter(index(use.item))) continue;
                    for (const std::int32_t other : edges_of_[index(use.item)]) {
                        if (is_known_[index(other)] == 0) open.push_back(other);
                    }
                }
            }
        }
    }
}

/// The number of an edge of the regions that count, -1 where it is none.
std::int32_t CutterWinding::edge_number(const std::array<NodeId, 2>& edge) const {
    for (std::size_t e = first_edge_[index(edge[0])]; e < first_edge_[index(edge[0]) + 1]; ++e) {
        if (edges_.ends(e)[1] == edge[1]) return static_cast<std::int32_t>(e);
    }
    return -1;
}

/// Where undivided triangles end nothing meets them, so that one region is there, which is as long.
void CutterWinding::find_borders() {
    const UndividedTriangles& undivided = overlay_.undivided();
    is_border_.assign(edge_count(), 0);
    borders_ = bucketize<UndividedBorder>(undivided.components(), [&](const auto& put) {
        for (std::size_t component = 0; component < undivided.components(); ++component) {
            for (const auto& border : undivided.borders(component)) {
                const NodeId a = overlay_.surface_node(border.edge[0]),
                             b = overlay_.surface_node(border.edge[1]);
                const auto e = index(edge_number(unordered(a, b)));
                assert(edge(e).size() == 1 && overlay_.of_cutter(index(edge(e)[0].item)));
                is_border_[e] = 1;
                put(component,
                    UndividedBorder{edge(e)[0].item,
                                    {unordered(a, b), overlay_.undivided_item(border.triangle),
                                     static_cast<std::int8_t>(a < b ? 1 : -1)}});
            }
        }
    });
}

void CutterWinding::find_coinciding(Progress* progress) {
    const std::size_t count = overlay_.size();
    counts_.assign(count, 0);
    level_.assign(count, -1);
    level_facing_.assign(count, 0);
    const auto outline = [this](std::size_t r) -> std::span<const NodeId> {
        return overlay_.loops(r)[0];
    };
    KeyTable first;  // of the regions of the surface with one outline
    for (std::size_t r = 0; r < count; ++r) {
        if (!overlay_.of_cutter(r)) continue;
        const auto found = first.find_or_add(arrangement::loop_hash(outline(r)),
                                             static_cast<std::int32_t>(r), [&](std::int32_t other) {
                                                 return arrangement::facing_of(
                                                            outline(r), outline(index(other))) != 0;
                                             });
        auto& counts = counts_[index(found.number)];
        if (found.is_new) {
            counts = 1;
        } else if (overlay_.surface().is_closed) {
            counts ^= 1;
        }
    }
    parallel_ranges(
        count, 1 << 12, {overlay_.threads(), progress}, [&](std::size_t begin, std::size_t end) {
            for (std::size_t r = begin; r < end; ++r) {
                std::int8_t facing = 0;
                const std::int32_t found =
                    first.find(arrangement::loop_hash(outline(r)), [&](std::int32_t other) {
                        facing = arrangement::facing_of(outline(r), outline(index(other)));
                        return facing != 0;
                    });
                if (found < 0 || counts_[index(found)] == 0) continue;
                level_[r] = found;
                level_facing_[r] = facing;
            }
        });
    lying_on_ = bucketize<std::int32_t>(count, [&](const auto& put) {
        for (std::size_t r = 0; r < count; ++r) {
            if (level_[r] >= 0 && !overlay_.of_cutter(r))
                put(index(level_[r]), static_cast<std::int32_t>(r));
        }
    });
}

void CutterWinding::collect_uses(Progress* progress) {
    const std::size_t count = overlay_.size(), nodes = overlay_.node_count();
    std::vector<std::uint8_t> is_on_surface(nodes, 0);
    for (std::size_t r = 0; r < count; ++r) {
        if (!counts(r)) continue;
        for (const auto& loop : overlay_.loops(r)) {
            for (const NodeId node : loop)
                is_on_surface[index(node)] = 1;
        }
    }
    // of each edge that may be one of the surface's: all uses
    constexpr std::size_t kChunk = 1 << 12;
    auto found = sorted_in_buckets<EdgeUse>(
        nodes, (count + kChunk - 1) / kChunk,
        [&](std::size_t chunk, const auto& put) {
            for (std::size_t r = chunk * kChunk; r < std::min(count, (chunk + 1) * kChunk); ++r) {
                if (overlay_.of_cutter(r) && !counts(r)) continue;
                each_edge(overlay_.loops(r), static_cast<std::int32_t>(r), [&](const EdgeUse& use) {
                    if (is_on_surface[index(use.edge[0])] != 0 &&
                        is_on_surface[index(use.edge[1])] != 0)
                        put(index(use.edge[0]), use);
                });
            }
        },
        {overlay_.threads(), progress});
    auto& uses = edges_.uses;
    uses = std::move(found.values);
    first_edge_.assign(nodes + 1, 0);
    std::size_t kept = 0;
    for (std::size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
        bool is_own = false;
        for (; end < uses.size() && uses[end].key() == uses[begin].key(); ++end)
            is_own = is_own || counts(index(uses[end].item));
        if (!is_own) continue;
        ++first_edge_[index(uses[begin].edge[0]) + 1];
        for (std::size_t i = begin; i < end; ++i)
            uses[kept++] = uses[i];
        edges_.begins.push_back(kept);
    }
    uses.resize(kept);
    for (std::size_t node = 0; node < nodes; ++node)
        first_edge_[node + 1] += first_edge_[node];
    edges_of_ = bucketize<std::int32_t>(count, [this](const auto& put) {
        for (std::size_t e = 0; e < edge_count(); ++e) {
            for (const EdgeUse& use : edge(e)) {
                if (counts(index(use.item))) put(index(use.item), static_cast<std::int32_t>(e));
            }
        }
    });
}

void CutterWinding::find_fans(Progress* progress) {
    order_.resize(edges_.uses.size());
    windings_.assign(edges_.uses.size(), 0);
    blade_begins_.resize(edges_.uses.size() + edge_count());
    blades_.resize(edge_count());
    is_known_.assign(edge_count(), 0);
    [[maybe_unused]] const std::size_t points = overlay_.points().size();
    parallel_ranges(
        edge_count(), 1 << 8, {overlay_.threads(), progress},
        [this](std::size_t begin, std::size_t end) {
            std::vector<arrangement::HalfPlane> scratch;
            EdgeFan fan;
            for (std::size_t e = begin; e < end; ++e) {
                overlay_.find_fan(edge(e), scratch, fan);
                std::ranges::transform(fan.order, order_.data() + edges_.begins[e], to_number);
                std::ranges::transform(fan.blade_begins,
                                       blade_begins_.data() + edges_.begins[e] + e, to_number);
                blades_[e] = to_number(fan.blades());
            }
        });
    assert(overlay_.points().size() == points);  // all are known, so threads add none
}

std::int32_t CutterWinding::number(const Winding& winding) {
    const auto [found, is_new] =
        number_.find_or_add(hash_of(winding), static_cast<std::int32_t>(known_.size()),
                            [&](std::int32_t other) { return known_[index(other)] == winding; });
    if (is_new) known_.push_back(winding);
    return found;
}

/// What changes where a face's region is crossed to its side `entered`.
void CutterWinding::cross(Winding& winding, std::size_t region, std::size_t entered) const {
    for (const std::int32_t face : overlay_.faces_of(region)) {
        add(winding, overlay_.model().cell(index(face), 1 - entered), -1);
        add(winding, overlay_.model().cell(index(face), entered), 1);
    }
}

/// Finds the sectors and regions around an edge, of which one region is known.
void CutterWinding::spread(std::size_t e, Progress* progress) {
    if (progress != nullptr && (e & 0xff) == 0) progress->check();
    const auto uses = edge(e);
    const Fan fan = sectors(e).fan;
    const std::size_t blades = fan.blades();
    is_known_[e] = 1;
    // the blade of a region that is known; a region may come to the edge from both sides
    std::size_t start = blades;
    std::int32_t behind = 0;
    for (std::size_t b = 0; b < blades && start == blades; ++b) {
        for (const std::size_t i : fan.blade(b)) {
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
        for (const std::size_t i : fan.blade(b))
            faces = faces || !overlay_.of_cutter(index(uses[i].item));
        if (faces) {
            Winding winding = known_[index(behind)];
            for (const std::size_t i : fan.blade(b)) {
                if (!overlay_.of_cutter(index(uses[i].item)))
                    cross(winding, index(uses[i].item), uses[i].ahead());
            }
            ahead = number(winding);
        }
        for (const std::size_t i : fan.blade(b)) {
            const auto region = index(uses[i].item);
            if (!overlay_.of_cutter(region) || winding_[2 * region] >= 0) continue;
            winding_[2 * region + uses[i].behind()] = behind;
            winding_[2 * region + uses[i].ahead()] = ahead;
        }
        windings_[edges_.begins[e] + b] = behind = ahead;
    }
}

/// What is just below a region, by the triangles that a ray from there crosses.
Winding CutterWinding::cast(std::size_t region, Progress* progress) {
    const SpacePointId p = overlay_.inner_point(region);
    const auto view = overlay_.view_of(region);
    const auto axis = view.first;
    const bool faces_ray = view.second > 0;
    exact::SpacePoints& points = overlay_.points();
    Winding winding;
    if (!face_boxes_) face_boxes_.emplace(overlay_.face_boxes());
    for (const std::int32_t f :
         face_boxes_->find(arrangement::ray_box(points, p, axis), progress)) {
        const auto [cells, triangles] = overlay_.boxed_face(index(f));
        for (const auto& t : triangles) {
            const int side = exact::ray_crosses(points, axis, p, t, faces_ray);
            if (side == 0) continue;
            add(winding, cells[0], side);
            add(winding, cells[1], -side);
        }
    }
    return winding;
}

}  // namespace realmodel::cutting
