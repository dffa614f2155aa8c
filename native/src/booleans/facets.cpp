// SPDX-License-Identifier: GPL-3.0-or-later
#include "booleans/facets.hpp"

#include <algorithm>

#include "arrangement/polygons.hpp"
#include "base/parallel.hpp"
#include "base/parallel_sort.hpp"

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

void find_facets(const Parts& parts, FacetMesh& mesh, const Execution& execution) {
    const std::size_t count = parts.triangles.size();
    std::vector<Keyed> keyed(count);
    parallel_ranges(count, 1 << 12, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            keyed[i] = {parts.triangles[i].corners, static_cast<std::int32_t>(i)};
            std::sort(keyed[i].sorted.begin(), keyed[i].sorted.end());
        }
    });
    parallel_sort(keyed, std::less<>(), execution);
    std::vector<std::int32_t> first(count);  // of the parts that coincide
    for (std::size_t i = 0, begin = 0; i < count; ++i) {
        poll(execution.progress, i);
        if (keyed[i].sorted != keyed[begin].sorted) begin = i;
        first[index(keyed[i].part)] = keyed[begin].part;
    }
    mesh.of_part.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        poll(execution.progress, i);
        const Part& part = parts.triangles[i];
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

struct EdgeUse {
    std::array<std::int32_t, 2> edge;
    FacetUse use;
    std::int32_t side;  ///< which edge of its facet
    auto operator<=>(const EdgeUse&) const = default;
};

}  // namespace

FacetMesh facets_of(const Parts& parts, const Execution& execution) {
    FacetMesh mesh;
    find_facets(parts, mesh, execution);
    const std::size_t count = mesh.facets.size();
    checked_number(2 * count, "sides of triangles");  // those who ask number them
    std::vector<EdgeUse> uses(3 * count);
    parallel_ranges(count, 1 << 12, execution, [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
            const auto& corners = mesh.facets[f].corners;
            for (std::size_t k = 0; k < 3; ++k) {
                const std::int32_t a = corners[k], b = corners[(k + 1) % 3];
                const FacetUse use{static_cast<std::int32_t>(f),
                                   static_cast<std::int8_t>(a < b ? 1 : -1)};
                uses[3 * f + k] = {arrangement::unordered(a, b), use, static_cast<std::int32_t>(k)};
            }
        }
    });
    parallel_sort(uses, std::less<>(), execution);
    mesh.uses.reserve(uses.size());
    mesh.edges_of.resize(count);
    for (std::size_t i = 0; i < uses.size(); ++i) {
        poll(execution.progress, i);
        if (i == 0 || uses[i].edge != uses[i - 1].edge) {
            if (i > 0) mesh.use_begins.push_back(i);
            checked_number(mesh.edges.size(), "edges");
            mesh.edges.push_back(uses[i].edge);
        }
        mesh.uses.push_back(uses[i].use);
        mesh.edges_of[index(uses[i].use.facet)][index(uses[i].side)] =
            static_cast<std::int32_t>(mesh.edges.size() - 1);
    }
    mesh.use_begins.push_back(uses.size());
    return mesh;
}

}  // namespace realmodel::booleans
