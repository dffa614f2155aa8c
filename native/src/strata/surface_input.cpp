// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <string>

#include "layer.hpp"
#include "parallel_chunks.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/exact/turn.hpp"

namespace realmodel::strata {

using exact::PlanGeometry;

namespace {

// Beyond these the products behind floating-point filters overflow or vanish.
constexpr double kLargest = 1e50;

constexpr exact::SpaceId kNotEntered = -1;

std::array<double, 3> vertex_of(const SurfaceView& surface, std::int64_t v) {
    const auto i = static_cast<std::size_t>(v) * 3;
    return {surface.vertices[i], surface.vertices[i + 1], surface.vertices[i + 2]};
}

void check_numbers(const SurfaceView& surface, int index) {
    const auto count = static_cast<std::int64_t>(surface.vertices.size() / 3);
    for (std::int64_t v = 0; v < count; ++v) {
        for (const double c : vertex_of(surface, v)) {
            if (!(std::abs(c) <= kLargest)) {
                throw InputError("not_finite",
                                 "vertex " + std::to_string(v) +
                                     " has a coordinate that is not a number or is beyond 1e50",
                                 index, {v});
            }
        }
    }
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        if (surface.triangles[i] < 0 || surface.triangles[i] >= count) {
            const auto t = static_cast<std::int64_t>(i / 3);
            throw InputError("bad_index",
                             "triangle " + std::to_string(t) + " names vertex " +
                                 std::to_string(surface.triangles[i]) + " of " +
                                 std::to_string(count),
                             index, {t});
        }
    }
}

bool in_one_line(const std::array<double, 3>& a, const std::array<double, 3>& b,
                 const std::array<double, 3>& c) {
    for (const auto& [i, j] : {std::array<std::size_t, 2>{0, 1}, {0, 2}, {1, 2}}) {
        if (exact::turn({a[i], a[j]}, {b[i], b[j]}, {c[i], c[j]}) != 0) return false;
    }
    return true;
}

}  // namespace

std::vector<UsedTriangle> enter_surface(PlanGeometry& geometry, const SurfaceView& surface,
                                        int index, const PlanSnapping& snapping,
                                        std::vector<Warning>& warnings, const Progress* progress) {
    check_numbers(surface, index);
    std::vector<exact::SpaceId> entered(surface.vertices.size() / 3, kNotEntered);
    const auto enter = [&](std::int32_t v) {
        exact::SpaceId& id = entered[static_cast<std::size_t>(v)];
        if (id == kNotEntered) {
            const auto [x, y, z] = vertex_of(surface, v);
            id = geometry.add_space_vertex(geometry.add_vertex(snapping.x(x), snapping.y(y)), z);
        }
        return id;
    };
    std::vector<UsedTriangle> used;
    used.reserve(surface.triangles.size() / 3);
    Warning flat{"no_area", index, {}, {}};
    for (std::size_t t = 0; t * 3 < surface.triangles.size(); ++t) {
        poll(progress, t);
        std::array<std::int32_t, 3> v;
        std::array<std::array<double, 3>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            v[i] = surface.triangles[t * 3 + i];
            p[i] = vertex_of(surface, v[i]);
            p[i][0] = snapping.x(p[i][0]);
            p[i][1] = snapping.y(p[i][1]);
        }
        const int turn = exact::turn({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]});
        const auto number = static_cast<std::int64_t>(t);
        if (turn == 0) {
            if (!in_one_line(p[0], p[1], p[2])) {
                throw InputError("vertical_triangle",
                                 "triangle " + std::to_string(t) +
                                     " stands upright: the surface has no single height there",
                                 index, {number}, p[0]);
            }
            flat.items.push_back(number);
            continue;
        }
        if (turn < 0) std::swap(v[1], v[2]);
        used.push_back({number, {enter(v[0]), enter(v[1]), enter(v[2])}});
    }
    if (!flat.items.empty()) {
        const char* what = flat.items.size() == 1 ? " triangle" : " triangles";
        flat.text = std::to_string(flat.items.size()) + what + " without area left out";
        warnings.push_back(std::move(flat));
    }
    return used;
}

}  // namespace realmodel::strata
