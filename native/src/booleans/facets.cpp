// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facets.hpp"

#include <algorithm>
#include <cassert>

#include "base/counting_sort.hpp"
#include "base/parallel.hpp"

namespace realmodel::booleans {

namespace {

/// Whether one triangle's corners are an even permutation of another's.
bool turn_alike(const std::array<std::int32_t, 3>& a, const std::array<std::int32_t, 3>& b) {
    for (std::size_t k = 0; k < 3; ++k) {
        if (a[0] == b[k]) return a[1] == b[(k + 1) % 3];
    }
    return false;
}

struct Keyed {
    std::array<std::int32_t, 3> sorted;
    std::int32_t part;
    auto operator<=>(const Keyed&) const = default;
};

void find_facets(const RefinedTriangles& parts, FacetMesh& mesh, const Execution& execution) {
    const std::size_t count = parts.triangles.size();
    constexpr std::size_t kChunk = 1 << 12;
    const auto keyed =
        sorted_in_buckets<Keyed>(
            parts.vertices.size(), (count + kChunk - 1) / kChunk,
            [&](std::size_t chunk, const auto& put) {
                for (std::size_t i = chunk * kChunk; i < std::min(count, (chunk + 1) * kChunk);
                     ++i) {
                    Keyed key{parts.triangles[i].corners, static_cast<std::int32_t>(i)};
                    std::sort(key.sorted.begin(), key.sorted.end());
                    put(index(key.sorted[0]), key);
                }
            },
            execution)
            .values;
    std::vector<std::int32_t> first(count);  // of the parts that coincide
    for (std::size_t i = 0, begin = 0; i < count; ++i) {
        poll(execution.progress, i);
        if (keyed[i].sorted != keyed[begin].sorted) begin = i;
        first[index(keyed[i].part)] = keyed[begin].part;
    }
    mesh.of_part.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        poll(execution.progress, i);
        const RefinedTriangle& part = parts.triangles[i];
        if (first[i] == static_cast<std::int32_t>(i)) {
            mesh.of_part[i] = static_cast<std::int32_t>(mesh.facets.size());
            mesh.facets.push_back({part.corners});
        } else {
            mesh.of_part[i] = mesh.of_part[index(first[i])];
        }
        Facet& facet = mesh.facets[index(mesh.of_part[i])];
        facet.times[part.source] += turn_alike(part.corners, facet.corners) ? 1 : -1;
        facet.is_of[part.source] = true;
    }
}

}  // namespace

FacetMesh facets_of(const RefinedTriangles& parts, const Execution& execution) {
    FacetMesh mesh;
    find_facets(parts, mesh, execution);
    const std::size_t count = mesh.facets.size();
    checked_number(2 * count + 1, "sides of triangles");  // those who ask number them
    mesh.edges = arrangement::edges_of(
        count,
        parts.vertices.size(), [&](std::size_t f) -> const auto& { return mesh.facets[f].corners; },
        execution);
    assert(mesh.edges.uses.size() == 3 * count);
    mesh.edges_of.resize(count);
    for (std::size_t e = 0; e < mesh.edges.size(); ++e) {
        poll(execution.progress, e);
        for (const arrangement::EdgeUse& use : mesh.edges[e]) {
            const auto& corners = mesh.facets[index(use.item)].corners;
            std::size_t k = 0;
            while (unordered(corners[k], corners[(k + 1) % 3]) != use.edge)
                ++k;
            mesh.edges_of[index(use.item)][k] = static_cast<std::int32_t>(e);
        }
    }
    return mesh;
}

}  // namespace realmodel::booleans
