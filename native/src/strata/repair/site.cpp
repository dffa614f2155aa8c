// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/site.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "exact/orient2d.hpp"
#include "realmodel/base/errors.hpp"
#include "strata/limits.hpp"
#include "strata/repair/surface_input.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

std::vector<PlanTriangle> enter_region(PlanArrangement& geometry, const TriangleView& region,
                                       std::int32_t first_surface, const PlanSnapping& snapping) {
    for (std::size_t i = 0; i < region.vertices.size(); ++i) {
        if (is_within_limits(region.vertices[i])) continue;
        throw InputError("not_finite",
                         "corner " + std::to_string(i / 2) +
                             " of the region has a coordinate that is not a number or is beyond "
                             "1e50",
                         first_surface, {static_cast<std::int64_t>(i / 2)});
    }
    std::vector<PlanTriangle> triangles;
    for (std::size_t t = 0; t * 3 < region.triangles.size(); ++t) {
        std::array<std::array<double, 2>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto row = static_cast<std::size_t>(region.triangles[t * 3 + i]) * 2;
            if (region.triangles[t * 3 + i] < 0 || row + 1 >= region.vertices.size()) {
                throw InputError("bad_index",
                                 "triangle " + std::to_string(t) +
                                     " of the region refers to vertex " +
                                     std::to_string(region.triangles[t * 3 + i]) +
                                     ", but the vertices are numbered from 0 to " +
                                     std::to_string(region.vertices.size() / 2 - 1),
                                 -1, {static_cast<std::int64_t>(t)});
            }
            p[i] = {snapping.x(region.vertices[row]), snapping.y(region.vertices[row + 1])};
        }
        const int orientation = exact::orient2d(p[0], p[1], p[2]);
        if (orientation == 0) continue;
        if (orientation < 0) std::swap(p[1], p[2]);
        PlanTriangle v;
        for (std::size_t i = 0; i < 3; ++i)
            v[i] = geometry.add_vertex(p[i][0], p[i][1]);
        triangles.push_back(v);
    }
    return triangles;
}

Frame enter_frame(PlanArrangement& geometry) {
    PlanBox box = spatial::kNoBox;
    for (VertexId v{0}; index(v) < geometry.point_count(); ++v) {
        const exact::Point& p = geometry.point(v);
        box = box.united({p.x, p.y, p.x, p.y});
    }
    // A power of two keeps the exact numbers short where the input is a lattice.
    const double extent = std::max({box.width(), box.height(), std::abs(box.high_x) * 0x1p-30,
                                    std::abs(box.high_y) * 0x1p-30, std::abs(box.low_x) * 0x1p-30,
                                    std::abs(box.low_y) * 0x1p-30, 1e-30});
    double step = std::ldexp(1.0, std::ilogb(extent));
    if (step < extent) step *= 2;
    const auto down = [&](double v) { return (std::floor(v / step) - 1.0) * step; };
    const auto up = [&](double v) { return (std::ceil(v / step) + 1.0) * step; };
    const double x0 = down(box.low_x), y0 = down(box.low_y), x1 = up(box.high_x),
                 y1 = up(box.high_y);
    Frame frame{geometry.add_vertex(x0, y0), geometry.add_vertex(x1, y0),
                geometry.add_vertex(x1, y1), geometry.add_vertex(x0, y1)};
    // What fills the frame around long borders would all run to its corners and be near everything
    // there, were there not more vertices along its sides. Halves of halves are exact.
    const double wanted = std::sqrt(static_cast<double>(geometry.point_count())) / 8;
    const double parts = std::ldexp(1.0, std::ilogb(std::clamp(wanted, 1.0, 256.0)));
    for (double i = 1; i < parts; ++i) {
        const double x = x0 + (x1 - x0) * (i / parts), y = y0 + (y1 - y0) * (i / parts);
        for (const auto& p : {std::array{x, y0}, {x1, y}, {x, y1}, {x0, y}})
            frame.push_back(geometry.add_vertex(p[0], p[1]));
    }
    return frame;
}

EnteredSurface enter_window(PlanArrangement& geometry, const Window& window) {
    const std::array<std::array<double, 2>, 4> corner{{{window.low_x, window.low_y},
                                                       {window.high_x, window.low_y},
                                                       {window.high_x, window.high_y},
                                                       {window.low_x, window.high_y}}};
    std::array<exact::SpaceId, 4> v;
    for (std::size_t i = 0; i < 4; ++i) {
        if (!is_within_limits(corner[i][0]) || !is_within_limits(corner[i][1]))
            throw InputError("not_finite", "a corner of the window is not a number or beyond 1e50");
        v[i] = geometry.add_space_vertex(geometry.add_vertex(corner[i][0], corner[i][1]), 0.0);
    }
    return {{{0, {v[0], v[1], v[2]}}, {1, {v[0], v[2], v[3]}}}, {}};
}

EnteredRock enter_rock(PlanArrangement& geometry, const StackInput& input,
                       std::int32_t first_surface, const PlanSnapping& snapping,
                       std::vector<Warning>& warnings, const Execution& execution) {
    EnteredRock rock;
    rock.first_surface = first_surface;
    rock.rules = input.rules;
    rock.emptied = input.emptied;
    rock.fills = input.fills;
    if (!rock.emptied.empty()) rock.rules.resize(input.surfaces.size(), Rule::kErosional);
    if (input.base_elevation && !is_within_limits(*input.base_elevation)) {
        throw InputError("not_finite", "the base elevation is not a number or is beyond 1e50",
                         first_surface);
    }
    rock.base_elevation = input.base_elevation;
    rock.surfaces =
        enter_surfaces(geometry, input.surfaces, first_surface, snapping, warnings, execution);
    if (input.region) rock.region = enter_region(geometry, *input.region, first_surface, snapping);
    if (input.window) rock.window = enter_window(geometry, *input.window);
    return rock;
}

SurfacePlan plan_window(const Site& site, const EnteredSurface& window, Progress* progress) {
    std::vector<PlanTriangle> triangles;
    for (const UsedTriangle& triangle : window.triangles)
        triangles.push_back(plan_of(site.geometry, triangle));
    SurfacePlan result{link_triangles(triangles, progress), {}};
    result.filling = fill_frame(site.geometry, result.links.border, site.frame);
    return result;
}

/// The base of a rock mass; its heights must be there before the vertices are frozen.
void enter_base(Site& site, EnteredRock& rock) {
    if (!rock.base_elevation) return;
    std::array<exact::SpaceId, 3> corner;
    for (std::size_t i = 0; i < 3; ++i)
        corner[i] = site.geometry.add_space_vertex(site.frame[i], *rock.base_elevation);
    rock.base = site.geometry.add_plane(corner);
    site.surface_of_plane.resize(site.geometry.plane_count(), kBase);
}

}  // namespace

bool EnteredRock::is_erosional() const {
    return std::all_of(rules.begin(), rules.end(),
                       [](Rule r) { return meaning(r).cuts && !meaning(r).protects; });
}

std::unique_ptr<Site> enter_site(std::span<const StackInput> rocks, const PlanSnapping& snapping,
                                 std::vector<Warning>& warnings, const Execution& execution) {
    auto entered = std::make_unique<Site>();
    Site& site = *entered;
    std::size_t vertices = 0, triangles = 0;
    for (const StackInput& rock : rocks) {
        for (const TriangleView& surface : rock.surfaces) {
            vertices += surface.vertices.size() / 3;
            triangles += surface.triangles.size() / 3;
        }
    }
    site.geometry.expect_vertices(vertices);
    site.geometry.expect_planes(triangles + rocks.size());
    for (const StackInput& rock : rocks) {
        EnteredRock& own = site.rocks.emplace_back(
            enter_rock(site.geometry, rock, site.surfaces, snapping, warnings, execution));
        own.number = static_cast<std::int32_t>(site.rocks.size()) - 1;
        site.surfaces += static_cast<std::int32_t>(rock.surfaces.size());
    }
    if (site.is_empty()) return entered;
    site.frame = enter_frame(site.geometry);
    for (EnteredRock& rock : site.rocks)
        enter_base(site, rock);
    site.geometry.freeze_vertices();
    for (EnteredRock& rock : site.rocks) {
        rock.plans = plan_surfaces(site.geometry, rock.surfaces, site.frame, execution);
        for (const SurfacePlan& plan : rock.plans)
            site.is_single_valued &= plan.filling && !plan.filling->is_covered_twice();
        if (rock.region) {
            rock.region_border = link_triangles(*rock.region, execution.progress).border;
            auto filling = fill_frame(site.geometry, rock.region_border, site.frame);
            site.is_single_valued &= filling && !filling->is_covered_twice();
            if (filling) rock.region_filling = std::move(*filling);
        }
        if (rock.window) rock.window_plan = plan_window(site, *rock.window, execution.progress);
    }
    return entered;
}

void Site::check_regions() const {
    for (const EnteredRock& rock : rocks) {
        if (!rock.region) continue;
        const bool crosses = rock.region_filling.triangles.empty();
        if (!crosses && !rock.region_filling.is_covered_twice()) continue;
        throw InputError(
            "bad_region",
            crosses ? "edges of the region's border cross" : "triangles of the region overlap", -1,
            {rock.number});
    }
}

void check_base(const EnteredRock& rock, const std::array<double, 3>& lowest) {
    const double base = *rock.base_elevation;
    if (lowest[2] > base) return;
    throw InputError("base_not_below",
                     "base_elevation " + std::to_string(base) +
                         " is not below the whole rock mass, whose lowest point is " + "(" +
                         std::to_string(lowest[0]) + ", " + std::to_string(lowest[1]) + ", " +
                         std::to_string(lowest[2]) + "); choose a lower base_elevation",
                     -1, {rock.number}, lowest);
}

}  // namespace realmodel::strata
