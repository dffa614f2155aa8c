// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "base/checked_indices.hpp"
#include "base/counting_sort.hpp"
#include "base/index.hpp"
#include "realmodel/shells/shells.hpp"

namespace realmodel::shells {

namespace {

/// One use of an edge, listed with its lower vertex.
struct PolygonEdgeUse {
    std::int32_t upper;
    std::int32_t corner;
};

constexpr std::size_t kFewUses = 24;  // so few are compared one by one

void require_in_range(std::span<const std::int32_t> offsets, std::span<const std::int32_t> corners,
                      std::size_t vertices) {
    if (offsets.empty() || offsets[0] != 0)
        refuse_index("polygon", 0, "does not begin with the first corner");
    for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
        require_vertices("polygon", f, checked_corners("polygon", f, offsets, corners, 0),
                         vertices);
    }
    if (std::cmp_not_equal(offsets.back(), corners.size()))
        refuse_index("polygon", offsets.size() - 1, "has corners beyond the last");
}

/// Calls use(corner, lower, upper) for each corner and the next of its polygon.
template <class Use>
void for_each_corner_edge(std::span<const std::int32_t> offsets,
                          std::span<const std::int32_t> corners, const Use& use) {
    for (std::size_t f = 0; f + 1 < offsets.size(); ++f) {
        const auto begin = static_cast<std::size_t>(offsets[f]);
        const auto end = static_cast<std::size_t>(offsets[f + 1]);
        for (std::size_t c = begin; c < end; ++c) {
            const std::int32_t a = corners[c], b = corners[c + 1 < end ? c + 1 : begin];
            use(c, std::min(a, b), std::max(a, b));
        }
    }
}

}  // namespace

PolygonEdges polygon_edges(std::span<const std::int32_t> offsets,
                           std::span<const std::int32_t> corners, std::size_t vertices) {
    require_in_range(offsets, corners, vertices);
    auto uses = bucketize<PolygonEdgeUse>(vertices, [&](const auto& put) {  // by the lower vertex
        for_each_corner_edge(
            offsets, corners, [&](std::size_t corner, std::int32_t lower, std::int32_t upper) {
                put(index(lower), PolygonEdgeUse{upper, static_cast<std::int32_t>(corner)});
            });
    });
    PolygonEdges incidence;
    incidence.edges.reserve(corners.size() / 2 + 1);
    incidence.of_corner.resize(corners.size());
    for (std::size_t v = 0; v < vertices; ++v) {
        const std::span<PolygonEdgeUse> some = uses[v];
        const bool sorted = some.size() > kFewUses;
        if (sorted) std::ranges::stable_sort(some, {}, &PolygonEdgeUse::upper);
        const std::size_t first = incidence.edges.size();
        for (const PolygonEdgeUse& use : some) {
            std::size_t edge =
                sorted && incidence.edges.size() > first ? incidence.edges.size() - 1 : first;
            while (edge < incidence.edges.size() && incidence.edges[edge][1] != use.upper)
                ++edge;
            if (edge == incidence.edges.size())
                incidence.edges.push_back({static_cast<std::int32_t>(v), use.upper});
            incidence.of_corner[index(use.corner)] = static_cast<std::int32_t>(edge);
        }
    }
    return incidence;
}

}  // namespace realmodel::shells
