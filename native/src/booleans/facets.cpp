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
    // parts that coincide lie one after another, the first of them first
    const auto each_first = [&](const auto& visit) {
        parallel_each(count, execution, [&](std::size_t i) {
            if (i > 0 && keyed[i].sorted == keyed[i - 1].sorted) return;
            std::size_t end = i + 1;
            while (end < count && keyed[end].sorted == keyed[i].sorted)
                ++end;
            visit(std::span(keyed.begin() + i, keyed.begin() + end));
        });
    };
    mesh.first_part.resize(count);
    each_first([&](std::span<const Keyed> parts_of_one) {
        for (const Keyed& key : parts_of_one)
            mesh.first_part[index(key.part)] = parts_of_one[0].part;
    });
    mesh.of_part.resize(count);
    number_in_order(
        count, execution,
        [&](std::size_t i) { return mesh.first_part[i] == static_cast<std::int32_t>(i); },
        [&](std::size_t facets) { mesh.facets.resize(facets); },
        [&](std::size_t i, std::size_t facet) {
            mesh.facets[facet].corners = parts.triangles[i].corners;
            mesh.of_part[i] = static_cast<std::int32_t>(facet);
        });
    each_first([&](std::span<const Keyed> parts_of_one) {
        const std::int32_t number = mesh.of_part[index(parts_of_one[0].part)];
        Facet& facet = mesh.facets[index(number)];
        for (const Keyed& key : parts_of_one) {
            const RefinedTriangle& part = parts.triangles[index(key.part)];
            mesh.of_part[index(key.part)] = number;
            facet.times[part.source] += turn_alike(part.corners, facet.corners) ? 1 : -1;
            facet.is_of[part.source] = true;
        }
    });
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
    return mesh;
}

}  // namespace realmodel::booleans
