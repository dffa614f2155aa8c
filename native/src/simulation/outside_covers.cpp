// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/outside_covers.hpp"

#include <algorithm>
#include <array>

#include "base/index.hpp"
#include "simulation/corner_tetrahedra.hpp"
#include "simulation/flat_tetrahedra.hpp"

namespace realmodel::simulation {

namespace {

// Flatter ones would be under-determined: one of their faces is outside, where checkMesh sees none.
constexpr double kLeastOfCovers = 0.003;

template <std::size_t N>
bool has_all(const std::array<std::int32_t, N>& corners, std::span<const std::int32_t> wanted) {
    return std::ranges::all_of(wanted, [&](std::int32_t v) { return has(corners, v); });
}

}  // namespace

OutsideCovers::OutsideCovers(FilledMesh& mesh)
    : mesh_(mesh),
      tetrahedra_at_(rows_at(mesh, mesh.tetrahedra)),
      triangles_at_(rows_at(mesh, mesh.triangles)),
      tetrahedra_(mesh.tetrahedra),
      triangles_(mesh.triangles),
      is_taken_(mesh.tetrahedra.size(), 0) {}

bool OutsideCovers::add(std::span<const std::int32_t> corners, const Vec3& at) {
    struct Outer {
        std::int32_t row, region;
    };
    std::vector<Outer> outer;
    std::vector<std::int32_t> inner;
    for (const std::int32_t f : triangles_at_[index(corners[0])]) {
        if (!has_all(triangles_[index(f)], corners)) continue;
        std::int32_t owner = -1;
        int owners = 0;
        for (const std::int32_t t : tetrahedra_at_[index(corners[0])]) {
            if (!has_all(tetrahedra_[index(t)], triangles_[index(f)])) continue;
            if (is_taken_[index(t)] != 0) return false;
            owner = t;
            ++owners;
        }
        if (owners == 1)
            outer.push_back({f, mesh_.region[index(owner)]});
        else
            inner.push_back(f);
    }
    // the edges that two of these faces share, and the triangles inside that end there
    struct Hinge {
        std::array<std::int32_t, 2> edge;
        std::vector<std::int32_t> regions, inside;
    };
    std::vector<Hinge> hinges;
    for (const Outer& face : outer) {
        const auto& own = triangles_[index(face.row)];
        for (std::size_t i = 0; i < 3; ++i) {
            if (std::ranges::find(corners, own[i]) != corners.end()) continue;
            const auto edge = unordered(own[(i + 1) % 3], own[(i + 2) % 3]);
            auto hinge = std::ranges::find(hinges, edge, &Hinge::edge);
            if (hinge == hinges.end()) hinge = hinges.insert(hinge, {edge, {}, {}});
            hinge->regions.push_back(face.region);
        }
    }
    const auto has_two = [](const Hinge& hinge) { return hinge.regions.size() == 2; };
    if (!std::ranges::all_of(hinges, has_two)) return false;
    for (const std::int32_t f : inner)
        for (Hinge& hinge : hinges)
            if (has_all(triangles_[index(f)], hinge.edge)) hinge.inside.push_back(f);

    const std::int32_t added = checked_number(mesh_.points.size(), "points");
    mesh_.points.push_back(at);
    const auto covered = [&](const Outer& face) {
        const auto& [a, b, c] = triangles_[index(face.row)];
        return std::array{a, b, c, added};
    };
    const auto is_good = [&](const Outer& face) {
        return six_volumes(mesh_, covered(face)) > 0 &&
               roundness(mesh_, covered(face)) >= kLeastOfCovers;
    };
    if (!std::ranges::all_of(outer, is_good)) {
        mesh_.points.pop_back();
        return false;
    }
    for (const std::int32_t v : corners)
        for (const std::int32_t t : tetrahedra_at_[index(v)])
            is_taken_[index(t)] = 1;
    for (const Outer& face : outer) {
        mesh_.tetrahedra.push_back(covered(face));
        mesh_.region.push_back(face.region);
        for (const std::int32_t v : corners.subspan(1)) {
            mesh_.triangles.push_back(with(triangles_[index(face.row)], v, added));
            mesh_.surface.push_back(mesh_.surface[index(face.row)]);
        }
        mesh_.triangles[index(face.row)] = with(triangles_[index(face.row)], corners[0], added);
    }
    for (const Hinge& hinge : hinges) {
        // A boundary, or a kept surface within a region. A region that only touches the outside
        // along the edge is not between the new elements.
        if (hinge.regions[0] == hinge.regions[1] && hinge.inside.size() != 1) continue;
        mesh_.triangles.push_back({hinge.edge[0], hinge.edge[1], added});
        mesh_.surface.push_back(mesh_.surface[index(hinge.inside[0])]);
    }
    return true;
}

}  // namespace realmodel::simulation
