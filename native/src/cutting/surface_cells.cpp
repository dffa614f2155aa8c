// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/surface_cells.hpp"

#include <algorithm>

#include "base/counting_sort.hpp"
#include "base/parallel.hpp"

namespace realmodel::cutting {

using arrangement::each_edge;

std::vector<std::uint8_t> cells_near_surface(const SurfaceOverlay& overlay,
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

SurfaceCells::SurfaceCells(SurfaceOverlay& overlay, const CutterWinding& winding,
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
        return side < items_ && winding.level(item) < 0;
    };
    cells_.number(counts, {1, progress});
    for (std::size_t part = 0; part < size(); ++part)
        first_.push_back(cells_.first_side(part));
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

/// Joins items that are in the same part: those around a cell that does not reach the surface, and
/// those around an edge that is none of the surface's.
void SurfaceCells::join_beside(const CutterWinding& winding, std::span<const std::uint8_t> reaches,
                               Progress* progress) {
    const SurfaceOverlay& overlay = overlay_;
    const ComplexView& model = overlay.model();
    const auto regions = static_cast<std::int32_t>(overlay.size());
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
                                     end < own.size() && own[end].key() == own[begin].key();)
                                    ++end;
                                if (end == begin + 1 || winding.is_edge(own[begin].edge)) continue;
                                for (std::size_t i = begin + 1; i < end; ++i)
                                    cells_.join(own[begin].item, own[i].item);
                            }
                        }
                    });
}

/// What bounds one sector around an edge is in one part. This is said of sectors beside the model,
/// too, for the sake of cells that rounding flattened away, but where the rules say otherwise.
void SurfaceCells::join_sectors(const CutterWinding& winding, const Rules& rules,
                                Progress* progress) {
    const auto side_of = [&](std::size_t item, std::size_t side) -> std::int32_t {
        if (!overlay_.of_cutter(item))
            return winding.level(item) < 0 ? static_cast<std::int32_t>(item) : -1;
        return rules.is_left_out(item) ? -1 : side_of_region(item, side);
    };
    parallel_ranges(winding.edge_count(), 1 << 10, {overlay_.threads(), progress},
                    [&](std::size_t begin, std::size_t end) {
                        for (std::size_t e = begin; e < end; ++e) {
                            if (winding.is_undivided_border(e)) continue;
                            const auto uses = winding.edge(e);
                            const auto sectors = winding.sectors(e);
                            const bool in_model_alone = rules.in_model_alone(uses);
                            for (std::size_t b = 0; b < sectors.fan.blades(); ++b) {
                                if (!in_model_alone || sectors.windings[b] != 0)
                                    cells_.join_sector(uses, sectors.fan, b, side_of);
                            }
                        }
                    });
}

/// Along undivided triangles the part on either side is the same, where the model is.
void SurfaceCells::join_undivided(const CutterWinding& winding, const Rules& rules) {
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

}  // namespace realmodel::cutting
