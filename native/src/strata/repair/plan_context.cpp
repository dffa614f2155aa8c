// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/plan_context.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/checked_indices.hpp"
#include "base/parallel_counts.hpp"
#include "exact/orientation.hpp"
#include "realmodel/base/array.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {

using exact::PlanArrangement;
using exact::VertexId;

namespace {

/// Beyond this the products behind floating-point filters overflow or vanish.
constexpr double kLargestCoordinate = 1e50;

/// Whether a coordinate of the input is a number within the limits.
bool is_within_limits(double coordinate) {
    return std::abs(coordinate) <= kLargestCoordinate;
}

std::array<double, 3> vertex_of(const TriangleView& surface, std::int64_t v) {
    const auto i = static_cast<std::size_t>(v) * 3;
    return {surface.vertices[i], surface.vertices[i + 1], surface.vertices[i + 2]};
}

/// Looks at the coordinates of vertices.
void check_vertices(const TriangleView& surface, int index, const Execution& execution) {
    parallel_for_each(surface.vertices.size() / 3, execution, [&](std::size_t i) {
        const auto v = static_cast<std::int64_t>(i);
        if (std::ranges::all_of(vertex_of(surface, v), is_within_limits)) return;
        throw InputError("not_finite",
                         "vertex " + std::to_string(v) +
                             " has a coordinate that is not a number or is beyond 1e50",
                         index, {v});
    });
}

/// Looks at the corners of triangles.
void check_corners(const TriangleView& surface, int index, const Execution& execution) {
    parallel_for_each(surface.triangle_count(), execution, [&](std::size_t t) {
        require_vertices("triangle", t, surface.triangles.subspan(3 * t, 3),
                         surface.vertices.size() / 3, index);
    });
}

/// Which way each triangle turns in plan: 1 counter-clockwise, -1 clockwise, 0 it has no area.
/// Marks the vertices of those with an area.
Array<std::int8_t> turns_of(const TriangleView& surface, int index, const PlanSnapping& snapping,
                            std::vector<std::uint8_t>& is_used, const Execution& execution) {
    Array<std::int8_t> turns(surface.triangle_count());
    parallel_for_each(turns.size(), execution, [&](std::size_t t) {
        const auto v = surface.triangles.subspan(3 * t, 3);
        std::array<std::array<double, 3>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto [x, y, z] = vertex_of(surface, v[i]);
            p[i] = {snapping.x(x), snapping.y(y), z};
        }
        const int turn =
            exact::orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]});
        turns[t] = static_cast<std::int8_t>(turn);
        if (turn == 0 && !exact::in_one_line(p[0], p[1], p[2])) {
            throw InputError("vertical_triangle",
                             "triangle " + std::to_string(t) +
                                 " is vertical: a surface may have only one height at each "
                                 "point in plan; tilt or remove it",
                             index, {static_cast<std::int64_t>(t)}, p[0]);
        }
        for (std::size_t i = 0; i < 3 && turn != 0; ++i)
            atomic_set(is_used[realmodel::index(v[i])]);
    });
    return turns;
}

/// Adds the used vertices in their order, each fetched some rounds before it is needed; none of the
/// others.
std::vector<exact::SpaceId> add_vertices(PlanArrangement& geometry, const TriangleView& surface,
                                         const PlanSnapping& snapping,
                                         const std::vector<std::uint8_t>& is_used,
                                         Progress* progress) {
    constexpr std::size_t kAhead = 12;
    const std::size_t count = is_used.size();
    std::vector<exact::VertexId> plan(count, kNone);
    std::vector<exact::SpaceId> space(count, kNone);
    const auto vertex = [&](std::size_t v) {
        const auto [x, y, z] = vertex_of(surface, static_cast<std::int64_t>(v));
        return std::array{snapping.x(x), snapping.y(y), z};
    };
    const auto for_each_used = [&](const auto& fetch, const auto& add) {
        for (std::size_t v = 0; v < count; ++v) {
            poll(progress, v);
            if (v + kAhead < count && is_used[v + kAhead] != 0) fetch(v + kAhead);
            if (is_used[v] != 0) add(v);
        }
    };
    for_each_used(
        [&](std::size_t v) { geometry.prefetch_vertex(vertex(v)[0], vertex(v)[1]); },
        [&](std::size_t v) { plan[v] = geometry.add_vertex(vertex(v)[0], vertex(v)[1]); });
    for_each_used(
        [&](std::size_t v) { geometry.prefetch_space_vertex(plan[v], vertex(v)[2]); },
        [&](std::size_t v) { space[v] = geometry.add_space_vertex(plan[v], vertex(v)[2]); });
    return space;
}

}  // namespace

std::vector<UsedTriangle> load_surface(PlanArrangement& geometry, const TriangleView& surface,
                                       int index, const PlanSnapping& snapping,
                                       std::vector<Warning>& warnings, const Execution& execution) {
    check_vertices(surface, index, execution);
    check_corners(surface, index, execution);
    std::vector<std::uint8_t> is_used(surface.vertices.size() / 3, 0);
    const Array<std::int8_t> turns = turns_of(surface, index, snapping, is_used, execution);
    const auto space = add_vertices(geometry, surface, snapping, is_used, execution.progress);
    const auto flat = static_cast<std::size_t>(std::ranges::count(turns, 0));
    std::vector<UsedTriangle> used;
    used.reserve(turns.size() - flat);
    Warning warning{"no_area", index, {}, {}};
    for (std::size_t t = 0; t < turns.size(); ++t) {
        const auto number = static_cast<std::int64_t>(t);
        if (turns[t] == 0) {
            warning.items.push_back(number);
            continue;
        }
        const auto v = surface.triangles.subspan(3 * t, 3);
        const auto at = [&](std::size_t i) { return space[realmodel::index(v[i])]; };
        used.push_back({number, {at(0), at(turns[t] > 0 ? 1 : 2), at(turns[t] > 0 ? 2 : 1)}});
    }
    if (flat > 0) {
        const char* what = flat == 1 ? " triangle" : " triangles";
        warning.text = std::to_string(flat) + what + " without area left out";
        warnings.push_back(std::move(warning));
    }
    return used;
}

namespace {

std::vector<PlanTriangle> load_region(PlanArrangement& geometry, const TriangleView& region,
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
        require_vertices("region triangle", t, region.triangles.subspan(t * 3, 3),
                         region.vertices.size() / 2);
        std::array<std::array<double, 2>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            const auto row = static_cast<std::size_t>(region.triangles[t * 3 + i]) * 2;
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

Frame add_frame(PlanArrangement& geometry) {
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
    const double divisions = std::ldexp(1.0, std::ilogb(std::clamp(wanted, 1.0, 256.0)));
    for (double i = 1; i < divisions; ++i) {
        const double x = x0 + (x1 - x0) * (i / divisions), y = y0 + (y1 - y0) * (i / divisions);
        for (const auto& p : {std::array{x, y0}, {x1, y}, {x, y1}, {x0, y}})
            frame.push_back(geometry.add_vertex(p[0], p[1]));
    }
    return frame;
}

std::vector<UsedTriangle> load_window(PlanArrangement& geometry, const Window& window) {
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
    return {{0, {v[0], v[1], v[2]}}, {1, {v[0], v[2], v[3]}}};
}

LoadedRock load_rock(PlanArrangement& geometry, const StackInput& input, std::int32_t first_surface,
                     const PlanSnapping& snapping, std::vector<Warning>& warnings,
                     const Execution& execution) {
    LoadedRock rock;
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
    // Older surfaces come first, so that what is wrong with the oldest is heard of.
    for (const TriangleView& surface : input.surfaces) {
        const int number = first_surface + static_cast<int>(rock.surfaces.size());
        rock.surfaces.push_back(
            load_surface(geometry, surface, number, snapping, warnings, execution));
    }
    if (input.region) rock.region = load_region(geometry, *input.region, first_surface, snapping);
    if (input.window) rock.window = load_window(geometry, *input.window);
    return rock;
}

/// The base of a rock mass; its heights must be there before the vertices are frozen.
void add_base(PlanContext& context, LoadedRock& rock) {
    if (!rock.base_elevation) return;
    std::array<exact::SpaceId, 3> corner;
    for (std::size_t i = 0; i < 3; ++i)
        corner[i] = context.geometry.add_space_vertex(context.frame[i], *rock.base_elevation);
    rock.base = context.geometry.add_plane(corner);
    context.surface_of_plane.resize(context.geometry.plane_count(), kBase);
}

}  // namespace

bool LoadedRock::is_erosional() const {
    return std::all_of(rules.begin(), rules.end(),
                       [](Rule r) { return meaning(r).cuts && !meaning(r).protects; });
}

std::unique_ptr<PlanContext> load_input(std::span<const StackInput> rocks,
                                        const PlanSnapping& snapping,
                                        std::vector<Warning>& warnings,
                                        const Execution& execution) {
    auto loaded = std::make_unique<PlanContext>();
    PlanContext& context = *loaded;
    std::size_t vertices = 0, triangles = 0;
    for (const StackInput& rock : rocks) {
        for (const TriangleView& surface : rock.surfaces) {
            vertices += surface.vertices.size() / 3;
            triangles += surface.triangles.size() / 3;
        }
    }
    context.geometry.expect_vertices(vertices);
    context.geometry.expect_planes(triangles + rocks.size());
    for (const StackInput& rock : rocks) {
        LoadedRock& loaded_rock = context.rocks.emplace_back(
            load_rock(context.geometry, rock, context.surfaces, snapping, warnings, execution));
        loaded_rock.number = static_cast<std::int32_t>(context.rocks.size()) - 1;
        context.surfaces += static_cast<std::int32_t>(rock.surfaces.size());
    }
    if (context.is_empty()) return loaded;
    context.frame = add_frame(context.geometry);
    for (LoadedRock& rock : context.rocks)
        add_base(context, rock);
    context.geometry.freeze_vertices();
    for (LoadedRock& rock : context.rocks) {
        rock.plans.resize(rock.surfaces.size());
        parallel_chunks(rock.surfaces.size(), execution, [&](std::size_t k) {
            rock.plans[k] =
                plan_surface(context.geometry, rock.surfaces[k], context.frame, execution.progress);
        });
        for (const SurfacePlan& plan : rock.plans)
            context.is_single_valued &= plan.filling && !plan.filling->is_covered_twice();
        if (rock.region) {
            rock.region_border = link_triangles(*rock.region, execution.progress).border;
            auto filling = fill_frame(context.geometry, rock.region_border, context.frame);
            context.is_single_valued &= filling && !filling->is_covered_twice();
            if (filling) rock.region_filling = std::move(*filling);
        }
        if (rock.window)
            rock.window_plan =
                plan_surface(context.geometry, *rock.window, context.frame, execution.progress);
    }
    return loaded;
}

void PlanContext::check_regions() const {
    for (const LoadedRock& rock : rocks) {
        if (!rock.region) continue;
        const bool crosses = rock.region_filling.triangles.empty();
        if (!crosses && !rock.region_filling.is_covered_twice()) continue;
        throw InputError(
            "bad_region",
            crosses ? "edges of the region's border cross" : "triangles of the region overlap", -1,
            {rock.number});
    }
}

void check_base(const LoadedRock& rock, const std::array<double, 3>& lowest) {
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
