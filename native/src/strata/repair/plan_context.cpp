// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/plan_context.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

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

constexpr std::size_t kRange = 1 << 12;  // looked at at a time

std::array<double, 3> vertex_of(const TriangleView& surface, std::int64_t v) {
    const auto i = static_cast<std::size_t>(v) * 3;
    return {surface.vertices[i], surface.vertices[i + 1], surface.vertices[i + 2]};
}

/// Looks at the coordinates of vertices.
void check_vertices(const TriangleView& surface, int index, std::size_t begin, std::size_t end) {
    for (auto v = static_cast<std::int64_t>(begin); v < static_cast<std::int64_t>(end); ++v) {
        for (const double c : vertex_of(surface, v)) {
            if (!is_within_limits(c)) {
                throw InputError("not_finite",
                                 "vertex " + std::to_string(v) +
                                     " has a coordinate that is not a number or is beyond 1e50",
                                 index, {v});
            }
        }
    }
}

/// Looks at the corners of triangles.
void check_corners(const TriangleView& surface, int index, std::size_t begin, std::size_t end) {
    const std::size_t count = surface.vertices.size() / 3;
    for (std::size_t i = 3 * begin; i < 3 * end; ++i) {
        const std::int32_t v = surface.triangles[i];
        if (v >= 0 && static_cast<std::size_t>(v) < count) continue;
        const auto t = static_cast<std::int64_t>(i / 3);
        throw InputError("bad_index",
                         "triangle " + std::to_string(t) + " names vertex " + std::to_string(v) +
                             " of " + std::to_string(count),
                         index, {t});
    }
}

/// What the triangles of a range are used as, and which of them have no area.
struct RangeOfTriangles {
    struct Used {
        std::int64_t number;
        std::array<std::int32_t, 3> vertex;  ///< of the surface, counter-clockwise in plan
    };
    std::vector<Used> used;
    std::vector<std::int64_t> flat;
};

/// Triangles with an area, counter-clockwise; marks their vertices.
RangeOfTriangles triangles_with_area(const TriangleView& surface, int index,
                                     const PlanSnapping& snapping, std::size_t begin,
                                     std::size_t end, std::vector<std::uint8_t>& is_used) {
    RangeOfTriangles found;
    found.used.reserve(end - begin);
    for (std::size_t t = begin; t < end; ++t) {
        std::array<std::int32_t, 3> v;
        std::array<std::array<double, 3>, 3> p;
        for (std::size_t i = 0; i < 3; ++i) {
            v[i] = surface.triangles[t * 3 + i];
            p[i] = vertex_of(surface, v[i]);
            p[i][0] = snapping.x(p[i][0]);
            p[i][1] = snapping.y(p[i][1]);
        }
        const int turn =
            exact::orient2d({p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]});
        const auto number = static_cast<std::int64_t>(t);
        if (turn == 0) {
            if (!exact::in_one_line(p[0], p[1], p[2])) {
                throw InputError("vertical_triangle",
                                 "triangle " + std::to_string(t) +
                                     " is vertical: a surface may have only one height at each "
                                     "point in plan; tilt or remove it",
                                 index, {number}, p[0]);
            }
            found.flat.push_back(number);
            continue;
        }
        if (turn < 0) std::swap(v[1], v[2]);
        for (const std::int32_t i : v)
            atomic_set(is_used[static_cast<std::size_t>(i)]);
        found.used.push_back({number, v});
    }
    return found;
}

/// What the vertices of a surface were added as, none where no triangle uses them.
struct AddedVertices {
    std::vector<exact::SpaceId> space;
    std::vector<exact::VertexId> plan;
};

/// Adds the used vertices in their order, each fetched some rounds before it is needed.
AddedVertices add_vertices(PlanArrangement& geometry, const TriangleView& surface,
                           const PlanSnapping& snapping, const std::vector<std::uint8_t>& is_used,
                           Progress* progress) {
    constexpr std::size_t kAhead = 12;
    struct Adding {
        double x, y, z;
        exact::VertexId plan;
    };
    std::array<Adding, 2 * kAhead> ahead{};  // of vertices, in turn
    const std::size_t count = is_used.size();
    AddedVertices added{std::vector<exact::SpaceId>(count, kNone),
                        std::vector<exact::VertexId>(count, kNone)};
    const auto is_to_add = [&](std::size_t round, std::size_t behind) {
        return round >= behind && round - behind < count && is_used[round - behind] != 0;
    };
    for (std::size_t round = 0; round < count + 2 * kAhead; ++round) {
        poll(progress, round);
        // the space vertex of one, the plan vertex of a later one, the slot of an even later one
        if (is_to_add(round, 2 * kAhead)) {
            const Adding& e = ahead[round % ahead.size()];
            added.plan[round - 2 * kAhead] = e.plan;
            added.space[round - 2 * kAhead] = geometry.add_space_vertex(e.plan, e.z);
        }
        if (is_to_add(round, kAhead)) {
            Adding& e = ahead[(round - kAhead) % ahead.size()];
            e.plan = geometry.add_vertex(e.x, e.y);
            geometry.prefetch_space_vertex(e.plan, e.z);
        }
        if (is_to_add(round, 0)) {
            const auto [x, y, z] = vertex_of(surface, static_cast<std::int64_t>(round));
            Adding& e = ahead[round % ahead.size()];
            e = {snapping.x(x), snapping.y(y), z, kNone};
            geometry.prefetch_vertex(e.x, e.y);
        }
    }
    return added;
}

/// A surface on its way in: what has to be done with it, in four steps, each in chunks that several
/// threads may do at once. Nothing but adding vertices looks at the geometry.
class SurfaceLoading {
public:
    SurfaceLoading(const TriangleView& surface, int index, const PlanSnapping& snapping)
        : surface_(surface),
          index_(index),
          snapping_(snapping),
          triangles_(surface.triangles.size() / 3),
          vertices_(surface.vertices.size() / 3) {}

    static constexpr std::size_t kSteps = 4;
    std::size_t chunks(std::size_t step) const {
        switch (step) {
            case 0:
                return ranges_of(vertices_) + ranges_of(triangles_);
            case 1:
                return ranges_of(triangles_);
            case 2:
                return 1;
            default:
                return 1 + ranges_of(triangles_);
        }
    }
    /// To be called before the chunks of a step, by one thread.
    void begin(std::size_t step) {
        if (step == 1) {
            is_used_.assign(vertices_, 0);
            ranges_.resize(ranges_of(triangles_));
        } else if (step == 3) {
            is_used_ = {};
            for (const RangeOfTriangles& range : ranges_)
                first_.push_back(range.used.size());
            result_.triangles.resize(exclusive_scan(first_));
        }
    }
    void run(std::size_t step, std::size_t chunk, PlanArrangement& geometry, Progress* progress) {
        if (step == 0) {
            check(chunk);
        } else if (step == 1) {
            ranges_[chunk] =
                triangles_with_area(surface_, index_, snapping_, chunk * kRange,
                                    std::min(triangles_, (chunk + 1) * kRange), is_used_);
        } else if (step == 2) {
            added_ = add_vertices(geometry, surface_, snapping_, is_used_, progress);
        } else if (chunk == 0) {
            link(progress);
        } else {
            use(chunk - 1);
        }
    }
    /// To be called when all is done.
    LoadedSurface finish(std::vector<Warning>& warnings) {
        Warning flat{"no_area", index_, {}, {}};
        for (const RangeOfTriangles& range : ranges_)
            flat.items.insert(flat.items.end(), range.flat.begin(), range.flat.end());
        if (!flat.items.empty()) {
            const char* what = flat.items.size() == 1 ? " triangle" : " triangles";
            flat.text = std::to_string(flat.items.size()) + what + " without area left out";
            warnings.push_back(std::move(flat));
        }
        ranges_ = {};
        added_ = {};
        return std::move(result_);
    }

private:
    static std::size_t ranges_of(std::size_t count) { return (count + kRange - 1) / kRange; }

    void check(std::size_t chunk) const {
        const std::size_t of_vertices = ranges_of(vertices_);
        if (chunk < of_vertices) {
            check_vertices(surface_, index_, chunk * kRange,
                           std::min(vertices_, (chunk + 1) * kRange));
        } else {
            chunk -= of_vertices;
            check_corners(surface_, index_, chunk * kRange,
                          std::min(triangles_, (chunk + 1) * kRange));
        }
    }
    void link(Progress* progress) {
        Array<PlanTriangle> corners(result_.triangles.size());
        PlanTriangle* next = corners.begin();
        for (const RangeOfTriangles& range : ranges_) {
            for (const RangeOfTriangles::Used& triangle : range.used) {
                for (std::size_t i = 0; i < 3; ++i)
                    (*next)[i] = added_.plan[index(triangle.vertex[i])];
                ++next;
            }
        }
        result_.links = link_triangles({corners.begin(), corners.size()}, progress);
    }
    void use(std::size_t range) {
        std::transform(ranges_[range].used.begin(), ranges_[range].used.end(),
                       result_.triangles.begin() + static_cast<std::ptrdiff_t>(first_[range]),
                       [&](const RangeOfTriangles::Used& triangle) {
                           UsedTriangle used{triangle.number, {}};
                           for (std::size_t i = 0; i < 3; ++i)
                               used.corner[i] = added_.space[index(triangle.vertex[i])];
                           return used;
                       });
    }

    const TriangleView& surface_;
    int index_;
    const PlanSnapping& snapping_;
    std::size_t triangles_, vertices_;
    std::vector<std::uint8_t> is_used_;
    std::vector<RangeOfTriangles> ranges_;
    AddedVertices added_;
    std::vector<std::size_t> first_;
    LoadedSurface result_;
};

}  // namespace

std::vector<LoadedSurface> load_surfaces(PlanArrangement& geometry,
                                         std::span<const TriangleView> surfaces, int first_index,
                                         const PlanSnapping& snapping,
                                         std::vector<Warning>& warnings,
                                         const Execution& execution) {
    std::vector<SurfaceLoading> entries;
    for (std::size_t k = 0; k < surfaces.size(); ++k)
        entries.emplace_back(surfaces[k], first_index + static_cast<int>(k), snapping);
    std::vector<LoadedSurface> result;
    // Only one thread can add vertices, one surface after another. Meanwhile the others look at
    // the next surfaces and link the one before. Older surfaces come first, so that what is wrong
    // with the oldest is heard of.
    struct LoadingStep {
        SurfaceLoading* entry;
        std::size_t step, first_chunk;
    };
    constexpr std::size_t kSteps = SurfaceLoading::kSteps;
    for (std::size_t round = 0; round + 1 < entries.size() + kSteps && !entries.empty(); ++round) {
        std::vector<LoadingStep> parts;
        std::size_t chunks = 0;
        for (std::size_t step = kSteps; step-- > 0;) {
            if (round < step || round - step >= entries.size()) continue;
            SurfaceLoading& entry = entries[round - step];
            entry.begin(step);
            parts.push_back({&entry, step, chunks});
            chunks += entry.chunks(step);
        }
        parallel_chunks(chunks, execution, [&](std::size_t chunk) {
            const auto after = std::upper_bound(
                parts.begin(), parts.end(), chunk,
                [](std::size_t c, const LoadingStep& p) { return c < p.first_chunk; });
            const LoadingStep& part = *std::prev(after);
            part.entry->run(part.step, chunk - part.first_chunk, geometry, execution.progress);
        });
        if (round + 1 >= kSteps) result.push_back(entries[round + 1 - kSteps].finish(warnings));
    }
    return result;
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
    const double parts = std::ldexp(1.0, std::ilogb(std::clamp(wanted, 1.0, 256.0)));
    for (double i = 1; i < parts; ++i) {
        const double x = x0 + (x1 - x0) * (i / parts), y = y0 + (y1 - y0) * (i / parts);
        for (const auto& p : {std::array{x, y0}, {x1, y}, {x, y1}, {x0, y}})
            frame.push_back(geometry.add_vertex(p[0], p[1]));
    }
    return frame;
}

LoadedSurface load_window(PlanArrangement& geometry, const Window& window) {
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
    rock.surfaces =
        load_surfaces(geometry, input.surfaces, first_surface, snapping, warnings, execution);
    if (input.region) rock.region = load_region(geometry, *input.region, first_surface, snapping);
    if (input.window) rock.window = load_window(geometry, *input.window);
    return rock;
}

SurfacePlan plan_window(const PlanContext& context, const LoadedSurface& window,
                        Progress* progress) {
    std::vector<PlanTriangle> triangles;
    for (const UsedTriangle& triangle : window.triangles)
        triangles.push_back(plan_of(context.geometry, triangle));
    SurfacePlan result{link_triangles(triangles, progress), {}};
    result.filling = fill_frame(context.geometry, result.links.border, context.frame);
    return result;
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
        LoadedRock& own = context.rocks.emplace_back(
            load_rock(context.geometry, rock, context.surfaces, snapping, warnings, execution));
        own.number = static_cast<std::int32_t>(context.rocks.size()) - 1;
        context.surfaces += static_cast<std::int32_t>(rock.surfaces.size());
    }
    if (context.is_empty()) return loaded;
    context.frame = add_frame(context.geometry);
    for (LoadedRock& rock : context.rocks)
        add_base(context, rock);
    context.geometry.freeze_vertices();
    for (LoadedRock& rock : context.rocks) {
        rock.plans = plan_surfaces(context.geometry, rock.surfaces, context.frame, execution);
        for (const SurfacePlan& plan : rock.plans)
            context.is_single_valued &= plan.filling && !plan.filling->is_covered_twice();
        if (rock.region) {
            rock.region_border = link_triangles(*rock.region, execution.progress).border;
            auto filling = fill_frame(context.geometry, rock.region_border, context.frame);
            context.is_single_valued &= filling && !filling->is_covered_twice();
            if (filling) rock.region_filling = std::move(*filling);
        }
        if (rock.window) rock.window_plan = plan_window(context, *rock.window, execution.progress);
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
