// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/cutter_sides.hpp"

#include <algorithm>
#include <cassert>

#include "base/algorithms.hpp"
#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::cutting {

using arrangement::for_each_edge;

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

CutterWinding::CutterWinding(CutterOverlay& overlay, Progress* progress) : overlay_(overlay) {
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
                    cross(above, index(face_region),
                          coincident_facing(index(face_region)) > 0 ? 1 : 0);
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
                const NodeId a = overlay_.cutter_node(border.edge[0]),
                             b = overlay_.cutter_node(border.edge[1]);
                const std::int32_t number = edge_number(unordered(a, b));
                if (number < 0)
                    throw InternalError("where undivided triangles end there is a region",
                                        overlay_.position(a));
                const auto e = index(number);
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
    coincident_.assign(count, -1);
    coincident_facing_.assign(count, 0);
    const auto outline = [this](std::size_t r) -> std::span<const NodeId> {
        return overlay_.loops(r)[0];
    };
    KeyTable first;  // of the regions of the cutter with one outline
    for (std::size_t r = 0; r < count; ++r) {
        if (!overlay_.of_cutter(r)) continue;
        const auto entry = first.find_or_add(arrangement::loop_hash(outline(r)),
                                             static_cast<std::int32_t>(r), [&](std::int32_t other) {
                                                 return arrangement::facing_of(
                                                            outline(r), outline(index(other))) != 0;
                                             });
        auto& counts = counts_[index(entry.number)];
        if (entry.is_new) {
            counts = 1;
        } else if (overlay_.cutter().is_closed) {
            counts ^= 1;
        }
    }
    parallel_ranges(
        count, 1 << 12, {overlay_.threads(), progress}, [&](std::size_t begin, std::size_t end) {
            for (std::size_t r = begin; r < end; ++r) {
                std::int8_t facing = 0;
                const std::int32_t cutter_region =
                    first.find(arrangement::loop_hash(outline(r)), [&](std::int32_t other) {
                        facing = arrangement::facing_of(outline(r), outline(index(other)));
                        return facing != 0;
                    });
                if (cutter_region < 0 || counts_[index(cutter_region)] == 0) continue;
                coincident_[r] = cutter_region;
                coincident_facing_[r] = facing;
            }
        });
    lying_on_ = bucketize<std::int32_t>(count, [&](const auto& put) {
        for (std::size_t r = 0; r < count; ++r) {
            if (coincident_[r] >= 0 && !overlay_.of_cutter(r))
                put(index(coincident_[r]), static_cast<std::int32_t>(r));
        }
    });
}

void CutterWinding::collect_uses(Progress* progress) {
    const std::size_t count = overlay_.size(), nodes = overlay_.node_count();
    std::vector<std::uint8_t> is_on_cutter(nodes, 0);
    for (std::size_t r = 0; r < count; ++r) {
        if (!counts(r)) continue;
        for (const auto& loop : overlay_.loops(r)) {
            for (const NodeId node : loop)
                is_on_cutter[index(node)] = 1;
        }
    }
    // of each edge that may be one of the cutter's: all uses
    constexpr std::size_t kChunk = 1 << 12;
    auto uses_by_node = sorted_in_buckets<EdgeUse>(
        nodes, (count + kChunk - 1) / kChunk,
        [&](std::size_t chunk, const auto& put) {
            for (std::size_t r = chunk * kChunk; r < std::min(count, (chunk + 1) * kChunk); ++r) {
                if (overlay_.of_cutter(r) && !counts(r)) continue;
                for_each_edge(overlay_.loops(r), static_cast<std::int32_t>(r),
                              [&](const EdgeUse& use) {
                                  if (is_on_cutter[index(use.edge[0])] != 0 &&
                                      is_on_cutter[index(use.edge[1])] != 0)
                                      put(index(use.edge[0]), use);
                              });
            }
        },
        {overlay_.threads(), progress});
    auto& uses = edges_.uses;
    uses = std::move(uses_by_node.values);
    first_edge_.assign(nodes + 1, 0);
    std::size_t use_count = 0;
    for (const auto of_edge : groups_of(uses, &EdgeUse::key)) {
        if (std::ranges::none_of(of_edge,
                                 [this](const EdgeUse& use) { return counts(index(use.item)); }))
            continue;
        ++first_edge_[index(of_edge[0].edge[0]) + 1];
        for (const EdgeUse& use : of_edge)
            uses[use_count++] = use;
        edges_.begins.push_back(use_count);
    }
    uses.resize(use_count);
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
    half_plane_begins_.resize(edges_.uses.size() + edge_count());
    half_plane_counts_.resize(edge_count());
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
                std::ranges::transform(fan.half_plane_begins,
                                       half_plane_begins_.data() + edges_.begins[e] + e, to_number);
                half_plane_counts_[e] = to_number(fan.half_planes());
            }
        });
    assert(overlay_.points().size() == points);  // all are known, so threads add none
}

std::int32_t CutterWinding::number(const Winding& winding) {
    const auto [number, is_new] =
        number_.find_or_add(hash_of(winding), static_cast<std::int32_t>(known_.size()),
                            [&](std::int32_t other) { return known_[index(other)] == winding; });
    if (is_new) known_.push_back(winding);
    return number;
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
    const std::size_t half_planes = fan.half_planes();
    is_known_[e] = 1;
    // the half-plane of a region that is known; a region may come to the edge from both sides
    std::size_t start = half_planes;
    std::int32_t behind = 0;
    for (std::size_t b = 0; b < half_planes && start == half_planes; ++b) {
        for (const std::size_t i : fan.half_plane(b)) {
            const auto region = index(uses[i].item);
            if (!overlay_.of_cutter(region) || winding_[2 * region] < 0) continue;
            start = b;
            behind = winding_[2 * region + uses[i].behind()];
            break;
        }
    }
    for (std::size_t n = 0; n < half_planes; ++n) {
        const std::size_t b = (start + n) % half_planes;
        std::int32_t ahead = behind;
        bool faces = false;
        for (const std::size_t i : fan.half_plane(b))
            faces = faces || !overlay_.of_cutter(index(uses[i].item));
        if (faces) {
            Winding winding = known_[index(behind)];
            for (const std::size_t i : fan.half_plane(b)) {
                if (!overlay_.of_cutter(index(uses[i].item)))
                    cross(winding, index(uses[i].item), uses[i].ahead());
            }
            ahead = number(winding);
        }
        for (const std::size_t i : fan.half_plane(b)) {
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

std::vector<std::uint8_t> cells_near_cutter(const CutterOverlay& overlay,
                                            const CutterWinding& winding) {
    std::vector<std::uint8_t> reaches(overlay.model().cell_block.size(), 0);
    const auto reach = [&reaches](std::int32_t cell) {
        if (cell >= 0) reaches[index(cell)] = 1;
    };
    for (std::size_t f = 0; f < overlay.model().face_count(); ++f) {
        for (std::size_t k = 0; overlay.is_active(f) && k < 2; ++k)
            reach(overlay.model().cell(f, k));
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

CutterCompartments::CutterCompartments(CutterOverlay& overlay, const CutterWinding& winding,
                                       std::span<const std::uint8_t> reaches, const Rules& rules,
                                       Progress* progress)
    : overlay_(overlay),
      items_(overlay.size() + overlay.model().face_count()),
      cells_(items_ + overlay.size() + 2 * overlay.undivided().components()) {
    join_beside(winding, reaches, progress);
    join_sectors(winding, rules, progress);
    join_undivided(winding, rules);
    const auto counts = [&](std::size_t side) {
        if (side >= items_ + overlay.size()) return false;
        const std::size_t item = side >= items_ ? side - items_ : side;
        if (item >= overlay.size()) return !overlay.is_active(item - overlay.size());
        if (overlay.of_cutter(item)) return winding.counts(item) && winding.touches_model(item);
        return side < items_ && winding.coincident(item) < 0;
    };
    cells_.number(counts, {1, progress});
    for (std::size_t compartment = 0; compartment < size(); ++compartment)
        first_.push_back(cells_.first_side(compartment));
    for (std::size_t item = items_; item-- > 0;) {
        if (of(item) < 0 || (item < overlay.size() && overlay.of_cutter(item))) continue;
        first_[index(of(item))] = item;
    }
    cells_.connect([&](const auto& visit) {
        for (std::size_t r = 0; r < overlay.size(); ++r) {
            if (overlay.of_cutter(r) && of(r) >= 0) visit(r, at(r, 0), at(r, 1));
        }
    });
}

/// Joins items that are in the same compartment: those around a cell that does not reach the
/// cutter, and those around an edge that is none of the cutter's.
void CutterCompartments::join_beside(const CutterWinding& winding,
                                     std::span<const std::uint8_t> reaches, Progress* progress) {
    const CutterOverlay& overlay = overlay_;
    const ComplexView& model = overlay.model();
    const auto regions = static_cast<std::int32_t>(overlay.size());
    // of an item, -1 where it is none: its face
    const auto face_of = [&](std::size_t item) {
        if (item >= overlay.size())
            return overlay.is_active(item - overlay.size())
                       ? -1
                       : static_cast<std::int32_t>(item) - regions;
        if (overlay.of_cutter(item) || winding.coincident(item) >= 0) return -1;
        return static_cast<std::int32_t>(overlay.face_of(item));
    };
    std::vector<std::int32_t> first(model.cell_block.size(), -1);
    for (std::size_t i = 0; i < items_; ++i) {
        const std::int32_t face = face_of(i);
        for (std::size_t k = 0; face >= 0 && k < 2; ++k) {
            const std::int32_t cell = model.cell(index(face), k);
            if (cell < 0 || reaches[index(cell)] != 0) continue;
            auto& known = first[index(cell)];
            if (known < 0) known = static_cast<std::int32_t>(i);
            cells_.join(known, static_cast<std::int32_t>(i));
        }
    }
    for (std::size_t f = 0; f < model.face_count(); ++f) {
        const std::int32_t group = overlay.far().group(f);
        if (group >= 0)
            cells_.join(regions + overlay.far().first(group),
                        regions + static_cast<std::int32_t>(f));
    }
    constexpr std::size_t kChunk = 1 << 12;
    const auto uses = sorted_in_buckets<EdgeUse>(
        overlay.node_count(), (items_ + kChunk - 1) / kChunk,
        [&](std::size_t chunk, const auto& put) {
            for (std::size_t i = chunk * kChunk; i < std::min(items_, (chunk + 1) * kChunk); ++i) {
                const std::int32_t face = face_of(i);
                if (face < 0) continue;
                const std::array cells{model.cell(index(face), 0), model.cell(index(face), 1)};
                if (std::ranges::none_of(cells, [&](std::int32_t cell) {
                        return cell >= 0 && reaches[index(cell)] != 0;
                    }))
                    continue;
                const auto add = [&](const EdgeUse& use) { put(index(use.edge[0]), use); };
                if (i < overlay.size()) {
                    for_each_edge(overlay.loops(i), static_cast<std::int32_t>(i), add);
                } else {
                    for_each_edge(std::array{model.face(index(face))}, static_cast<std::int32_t>(i),
                                  add);
                }
            }
        },
        {overlay.threads(), progress});
    parallel_ranges(overlay.node_count(), kChunk, {overlay.threads(), progress},
                    [&](std::size_t first_node, std::size_t end_node) {
                        for (std::size_t node = first_node; node < end_node; ++node) {
                            for (const auto of_edge : groups_of(uses[node], &EdgeUse::key)) {
                                if (of_edge.size() == 1 || winding.is_edge(of_edge[0].edge))
                                    continue;
                                for (const EdgeUse& use : of_edge.subspan(1))
                                    cells_.join(of_edge[0].item, use.item);
                            }
                        }
                    });
}

/// What bounds one sector around an edge is in one compartment. This is said of sectors beside the
/// model, too, for the sake of cells that rounding flattened away, but where the rules say
/// otherwise.
void CutterCompartments::join_sectors(const CutterWinding& winding, const Rules& rules,
                                      Progress* progress) {
    const auto side_of = [&](std::size_t item, std::size_t side) -> std::int32_t {
        if (!overlay_.of_cutter(item))
            return winding.coincident(item) < 0 ? static_cast<std::int32_t>(item) : -1;
        return rules.is_left_out(item) ? -1 : side_of_region(item, side);
    };
    parallel_ranges(winding.edge_count(), 1 << 10, {overlay_.threads(), progress},
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t e = begin; e < end; ++e) {
                            if (winding.is_undivided_border(e)) continue;
                            const auto uses = winding.edge(e);
                            const auto sectors = winding.sectors(e);
                            const bool in_model_alone = rules.in_model_alone(uses);
                            for (std::size_t b = 0; b < sectors.fan.half_planes(); ++b) {
                                if (!in_model_alone || sectors.windings[b] != 0)
                                    cells_.join_sector(uses, sectors.fan, b, side_of);
                            }
                        }
                    });
}

/// Along undivided triangles the compartment on either side is the same, where the model is.
void CutterCompartments::join_undivided(const CutterWinding& winding, const Rules& rules) {
    for (std::size_t component = 0; component < overlay_.undivided().components(); ++component) {
        for (const UndividedBorder& border : winding.borders(component)) {
            const auto region = index(border.region);
            for (std::size_t k = 0; k < 2; ++k) {
                if (winding.around(region, k).empty() || rules.is_left_out(region)) continue;
                const std::size_t along = items_ + overlay_.size() + 2 * component + k;
                cells_.join(side_of_region(region, k), static_cast<std::int32_t>(along));
            }
        }
    }
}

CutterSides::CutterSides(CutterOverlay& overlay, const CutterWinding& winding, Progress* progress)
    : PartSides(cells_near_cutter(overlay, winding)),
      overlay_(overlay),
      winding_(winding),
      compartments_(overlay, winding, cells_reaching(), rules(), progress),
      sides_(compartments_.size()) {
    refuse_borders();
    for (std::size_t r = 0; r < overlay.size(); ++r) {
        poll(progress, r);
        if (!overlay.of_cutter(r) || compartments_.of(r) < 0) continue;
        const auto compartment = index(compartments_.of(r));
        if (!sides_[compartment]) settle(compartment, side_at(r, true));
        if (overlay.cutter().is_closed || sides_[compartment] == kBelow) continue;
        const auto outline = overlay.loops(r)[0];
        refuse("two_sides",
               "a point of the model is above one part of the surface and below another",
               {outline[0], outline[1]});
    }
    for (std::size_t compartment = 0; compartment < sides_.size(); ++compartment) {
        if (!sides_[compartment])
            sides_[compartment] = side_at(compartments_.first_side(compartment).first, false);
    }
}

/// Sectors outside of the model count where an open cutter does not end; of a closed one nothing
/// need be said of them.
CutterCompartments::Rules CutterSides::rules() const {
    return {[this](std::span<const EdgeUse> uses) {
                return overlay_.cutter().is_closed || count_cutter_uses(uses) % 2 == 1;
            },
            [this](std::size_t region) { return !winding_.touches_model(region); }};
}

/// Takes the side of a compartment to all that can be reached from it.
void CutterSides::settle(std::size_t compartment, std::int8_t side) {
    sides_[compartment] = side;
    compartments_.cells().spread(
        compartment, sides_,
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

/// How many of the uses of an edge are the cutter's.
std::ptrdiff_t CutterSides::count_cutter_uses(std::span<const EdgeUse> uses) const {
    return std::ranges::count_if(
        uses, [this](const EdgeUse& use) { return overlay_.of_cutter(index(use.item)); });
}

/// An edge in the model at which an odd number of regions meet: the cutter ends there.
void CutterSides::refuse_borders() const {
    for (std::size_t e = 0; e < winding_.edge_count(); ++e) {
        const auto uses = winding_.edge(e);
        const auto windings = winding_.sectors(e).windings;
        if (count_cutter_uses(uses) % 2 == 0 || std::count(windings.begin(), windings.end(), 0) > 0)
            continue;
        refuse("ends_inside", "the surface does not part the model: it ends inside of it",
               uses[0].edge);
    }
}

/// The side of something that is not joined with the cutter, or of one of its regions.
std::int8_t CutterSides::side_at(std::size_t item, bool of_cutter) {
    if (of_cutter && !overlay_.cutter().is_closed) return kBelow;
    if (!nearest_) nearest_.emplace(overlay_.cutter());
    const bool is_region = item < overlay_.size();
    if (!overlay_.cutter().is_closed) {
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
