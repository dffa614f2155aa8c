// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/rock_regions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"
#include "strata/overlay/facet_overlay.hpp"
#include "strata/overlay/whole_triangles.hpp"
#include "strata/tiling/polygon.hpp"

namespace realmodel::strata {

namespace {

/// The window of a tile: its own, or the region that a rock mass without one has there.
std::array<Corner, 4> window_outline(PlanContext& context, const LoadedRock& rock) {
    const auto half = [&](std::size_t t) {
        return rock.window ? plan_of(context.geometry, (*rock.window)[t]) : (*rock.region)[t];
    };
    const auto [a, b, c] = half(0);
    const std::array corners{a, b, c, half(1)[2]};
    std::array<Corner, 4> outline;
    for (std::size_t i = 0; i < 4; ++i)
        outline[i] = {corners[i], context.geometry.add_edge(corners[i], corners[(i + 1) % 4])};
    return outline;
}

/// Whether a box may have something on either side of the window's border. Boxes of points are as
/// exact as doubles are.
bool may_cross(const PlanBox& box, const Window& window) {
    const double margin = 0x1p-40 * std::max({std::abs(box.low_x), std::abs(box.high_x),
                                              std::abs(box.low_y), std::abs(box.high_y)});
    const PlanBox wide = box.widened(margin);
    const bool is_inside = wide.low_x > window.low_x && wide.high_x < window.high_x &&
                           wide.low_y > window.low_y && wide.high_y < window.high_y;
    return !is_inside && wide.meets({window.low_x, window.low_y, window.high_x, window.high_y});
}

/// Says that a triangle of a tiling is none any more.
void unlink(SurfaceTiling& tiling, std::size_t p) {
    tiling.runs_on[p] = 0;
    if (p >= tiling.neighbor.size()) return;
    for (std::int32_t& beyond : tiling.neighbor[p]) {
        if (beyond < 0) continue;
        std::ranges::replace(tiling.neighbor[static_cast<std::size_t>(beyond)],
                             static_cast<std::int32_t>(p), -1);
        beyond = -1;
    }
}

}  // namespace

Envelope region_envelope(PlanContext& context, LoadedRock& rock, const Execution& execution) {
    const Envelope region = initial_envelope(
        make_region_tiling(context.geometry, *rock.region, rock.region_filling), kSkyBlock);
    if (!rock.window) return region;
    // The window is a surface under the sky: what lies above it stays sky.
    const SurfaceTiling window =
        make_surface_tiling(context.geometry, *rock.window, rock.window_plan, -1, execution);
    context.surface_of_plane.resize(context.geometry.plane_count(), kBase);
    Construction nothing;
    Overlaid overlaid = overlay_facets(context.geometry, region, {window, kSkyBlock}, nullptr,
                                       nullptr, nothing, execution);
    std::fill(overlaid.remaining.plane.begin(), overlaid.remaining.plane.end(), kOutside);
    for (std::size_t i = 0; i < overlaid.below.polygon.size(); ++i)
        overlaid.remaining.add_facet(overlaid.below.outlines[i], kSky, -1, kSkyBlock);
    return std::move(overlaid.remaining);
}

void clip_to_window(PlanContext& context, const LoadedRock& rock, SurfaceTiling& tiling,
                    Progress* progress) {
    const auto window = window_outline(context, rock);
    LocalArrangement scope(context.geometry);
    Clipper clipper(scope);
    PolygonPool clipped;
    std::vector<std::size_t> which;
    for (std::size_t p = 0; p < tiling.plane.size(); ++p) {
        poll(progress, p);
        const PolygonView whole = tiling.polygons[p];
        if (!tiling.plane[p].has_value() || !may_cross(box_of(scope, whole), *context.window))
            continue;
        clipper.begin(whole);
        const PolygonView inside = clipper.intersect(window);
        const bool is_same = std::ranges::equal(whole, inside, {}, &Corner::point, &Corner::point);
        if (inside.empty() || is_same) continue;
        clipped.add(inside);
        which.push_back(p);
    }
    scope.commit(context.geometry);
    share(scope, clipped);
    PolygonPool polygons;
    std::size_t next = 0;
    for (std::size_t p = 0; p < tiling.plane.size(); ++p) {
        if (next == which.size() || which[next] != p) {
            polygons.add(tiling.polygons[p]);
            continue;
        }
        polygons.add(clipped[next++]);
        unlink(tiling, p);
    }
    tiling.polygons = std::move(polygons);
}

void RockFootprints::add(const exact::PlanArrangement& geometry, const FaceList& faces,
                         std::size_t first_face, Progress* progress) {
    // The lowest faces tile what a rock mass covers, each position once; where columns are left
    // out, others may lie over or under them.
    Footprint footprint;
    LocalArrangement scope(geometry);
    for (std::size_t f = first_face; f < faces.size(); ++f) {
        if (faces.below[f] != kOutsideCell) continue;
        footprint.polygons.add(faces.polygons[f]);
        footprint.box = footprint.box.united(box_of(scope, faces.polygons[f]));
    }
    Clipper clipper(scope);
    std::optional<PlanGrid> grid;  // made for the first rock mass near this one
    Array<std::int32_t> candidates;
    for (std::size_t r = 0; r < rocks_.size(); ++r) {
        if (!footprint.box.meets(rocks_[r].box)) continue;
        const PolygonPool& earlier = rocks_[r].polygons;
        for (std::size_t i = 0; i < earlier.size(); ++i) {
            poll(progress, i);
            if (!footprint.box.meets(box_of(scope, earlier[i]))) continue;
            if (!grid) {
                grid.emplace(geometry, footprint.polygons,
                             std::vector<std::uint8_t>(footprint.polygons.size(), 1), 0,
                             Execution{1, progress});
            }
            grid->candidates(scope, earlier[i], candidates);
            clipper.begin(earlier[i]);
            for (const std::int32_t c : candidates) {
                const PolygonView other = footprint.polygons[static_cast<std::size_t>(c)];
                if (!clipper.overlaps(other)) continue;
                const auto [x, y] = scope.rounded(clipper.intersect(other)[0].point);
                throw InputError(
                    "rocks_overlap",
                    "rock masses " + std::to_string(r) + " and " + std::to_string(rocks_.size()) +
                        " overlap in plan; they may only share borders",
                    -1, {static_cast<std::int64_t>(r), static_cast<std::int64_t>(rocks_.size())},
                    std::array<double, 3>{x, y, 0.0});
            }
        }
    }
    rocks_.push_back(std::move(footprint));
}

}  // namespace realmodel::strata
