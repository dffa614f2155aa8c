// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/disjoint_sets.hpp"
#include "base/parallel_counts.hpp"
#include "strata/overlay/block_classification.hpp"
#include "strata/overlay/block_overlay.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;

/// Links closed facets with what closes them. Neighbouring whole facets hang together, and so do
/// the triangles beneath them: one link for each connected part of them is enough.
void BlockOverlay::link_closed(const BlockTiling& layer, const Classified& c) {
    const auto first_node = c.first_closed;
    const auto whole_count = c.closed_whole.size();
    DisjointSets sets(whole_count);
    constexpr std::size_t kFacets = 1024, kTriangles = 1024;
    parallel_ranges(
        whole_count, kFacets, threads_, progress_, [&](std::size_t begin, std::size_t end) {
            const BlockTiling* of_plane =
                nullptr;  // facets of one surface mostly follow each other
            for (std::size_t i = begin; i < end; ++i) {
                const PlaneId plane = c.closed_whole[i];
                if (of_plane == nullptr || !of_plane->has(plane))
                    of_plane = &layers_[static_cast<std::size_t>(layer_of(plane))];
                for (const std::int32_t n :
                     of_plane->neighbour[static_cast<std::size_t>(plane - of_plane->first_plane)]) {
                    const PlaneId other = n + of_plane->first_plane;
                    if (n < 0 || other <= plane) continue;
                    const std::int32_t node = made_.whole[static_cast<std::size_t>(other)].below;
                    const std::int32_t j = node - first_node;
                    const bool closed_now = node >= first_node &&
                                            j < static_cast<std::int32_t>(whole_count) &&
                                            c.closed_whole[static_cast<std::size_t>(j)] == other;
                    if (closed_now &&
                        block_of(node) == block_of(first_node + static_cast<std::int32_t>(i)))
                        sets.join(static_cast<std::int32_t>(i), j);
                }
            }
        });
    constexpr std::int32_t kNothing = -1;
    struct Waiting {
        std::size_t tile;
        std::array<double, 2> middle;
        std::int32_t node;
        std::int32_t beneath;  ///< a triangle of the surface that lies there
    };
    std::vector<Waiting> waiting;
    const auto wait = [&](const std::array<double, 2>& middle, std::int32_t node) {
        const auto [x, y] = middle;
        const TileSpan span = tiles().span({x, y, x, y});
        waiting.push_back({tiles().tile(span.left, span.low), middle, node, kNothing});
    };
    const auto point = [&](PointId id) -> const exact::Point& { return geometry_.point(id); };
    for (std::size_t i = 0; i < whole_count; ++i) {
        const auto k = static_cast<std::int32_t>(i);
        if (sets.find(k) == k)
            wait(middle_of(geometry_.plane(c.closed_whole[i]).plan, point), first_node + k);
    }
    for (std::size_t i = 0; i < c.closed_parts.size(); ++i) {
        wait(middle_of(
                 parts_.outlines[c.closed_parts[i]],
                 [&](const Corner& corner) -> const exact::Point& { return point(corner.point); }),
             first_node + static_cast<std::int32_t>(whole_count + i));
    }
    if (waiting.empty()) return;
    // by tiles; most tiles have none, and that is asked of bytes
    std::vector<std::uint32_t> first(tiles().size() + 1, 0);
    std::vector<std::uint8_t> is_waited_in(tiles().size(), 0);
    for (const Waiting& w : waiting) {
        ++first[w.tile + 1];
        is_waited_in[w.tile] = 1;
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    {
        std::vector<Waiting> sorted(waiting.size());
        auto free = first;
        for (const Waiting& w : waiting)
            sorted[free[w.tile]++] = w;
        waiting.swap(sorted);
    }
    // The middle of a convex outline is inside it, so a triangle that it is in for certain shares
    // an area with the outline. The exact test is for the few middles near an edge.
    std::vector<std::vector<std::pair<std::uint32_t, std::int32_t>>> near(
        (layer.size() + kTriangles - 1) / kTriangles);
    parallel_ranges(
        layer.size(), kTriangles, threads_, progress_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t t = begin; t < end; ++t) {
                if (c.surface[t] != Classified::kBelow) continue;
                const auto number = static_cast<std::int32_t>(t);
                const auto& triangle = geometry_.plane(layer.first_plane + number).plan;
                tiles().for_each(surface_at_[t].span, [&](std::size_t tile) {
                    if (is_waited_in[tile] == 0) return;
                    for (auto w = first[tile]; w < first[tile + 1]; ++w) {
                        const int side = side_of_border(geometry_, triangle, waiting[w].middle);
                        if (side == 0) near[begin / kTriangles].emplace_back(w, number);
                        // a place is well inside one triangle at the most
                        if (side > 0) waiting[w].beneath = number;
                    }
                });
            }
        });
    LocalArrangement scope(geometry_);
    Clipper clipper(scope);
    const auto lies_over = [&](std::int32_t node, std::size_t triangle) {
        const auto i = static_cast<std::size_t>(node - first_node);
        Polygon outline;
        if (i < whole_count) {
            outline = outline_of(c.closed_whole[i]);
        } else {
            const PolygonView part = parts_.outlines[c.closed_parts[i - whole_count]];
            outline.assign(part.begin(), part.end());
        }
        return clipper.overlap(outline,
                               outline_of(layer.first_plane + static_cast<PlaneId>(triangle)));
    };
    for (const auto& pairs : near) {
        for (const auto& [w, t] : pairs) {
            if (waiting[w].beneath == kNothing &&
                lies_over(waiting[w].node, static_cast<std::size_t>(t)))
                waiting[w].beneath = t;
        }
    }
    for (Waiting& w : waiting) {
        // where rounding put a middle into a tile that nothing beneath it meets
        for (std::size_t t = 0; t < layer.size() && w.beneath == kNothing; ++t) {
            if (c.surface[t] == Classified::kBelow && lies_over(w.node, t))
                w.beneath = static_cast<std::int32_t>(t);
        }
        if (w.beneath != kNothing)
            made_.links.emplace_back(w.node, c.node[static_cast<std::size_t>(w.beneath)]);
    }
}

}  // namespace realmodel::strata
