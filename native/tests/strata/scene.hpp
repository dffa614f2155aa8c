// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "complex_checks.hpp"
#include "strata/repair/plan_context.hpp"
#include "strata/tiling/surface_tiling.hpp"

namespace realmodel::strata {

/// Surfaces that are loaded, as the stages of the overlay get them.
struct Scene {
    std::unique_ptr<PlanContext> context;

    explicit Scene(const std::vector<OwnedSurface>& surfaces) {
        StackInput input;
        for (const OwnedSurface& s : surfaces)
            input.surfaces.push_back(s.view());
        std::vector<Warning> warnings;
        context = load_input({&input, 1}, {}, warnings, {1, nullptr});
    }
    exact::PlanArrangement& geometry() { return context->geometry; }
    SurfaceTiling tiling(std::size_t k) {
        LoadedRock& rock = context->rocks[0];
        return make_surface_tiling(geometry(), rock.surfaces[k], rock.plans[k], static_cast<int>(k),
                                   {1, nullptr});
    }
    BlockTiling block_tiling(std::size_t k, TriangleLinks& links) {
        LoadedRock& rock = context->rocks[0];
        return make_block_tiling(geometry(), rock.surfaces[k], std::move(rock.plans[k]),
                                 static_cast<std::int32_t>(k), links, {1, nullptr});
    }
};

/// Two triangles over the unit square at heights z + slope x.
inline OwnedSurface square(double z, double slope = 0, bool other = false) {
    return grid(
        1, 1, 0, 0, 1, 1, [=](double x, double) { return z + slope * x; }, other);
}

/// One triangle with corners (0, 0), (1, 0) and (0, 1) at given heights.
inline OwnedSurface one_triangle(double z0, double z1, double z2) {
    OwnedSurface s;
    const auto a = s.vertex(0, 0, z0), b = s.vertex(1, 0, z1), c = s.vertex(0, 1, z2);
    s.triangle(a, b, c);
    return s;
}

}  // namespace realmodel::strata
