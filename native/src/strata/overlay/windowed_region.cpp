// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/windowed_region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "strata/overlay/facet_overlay.hpp"
#include "strata/overlay/shared_polygons.hpp"
#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {

namespace {

/// The window of a tile: its own, or the region that a rock mass without one has there.
std::array<Corner, 4> window_outline(Site& site, const EnteredRock& rock) {
    const auto half = [&](std::size_t t) {
        return rock.window ? plan_of(site.geometry, rock.window->triangles[t]) : (*rock.region)[t];
    };
    const auto [a, b, c] = half(0);
    const std::array corners{a, b, c, half(1)[2]};
    std::array<Corner, 4> outline;
    for (std::size_t i = 0; i < 4; ++i)
        outline[i] = {corners[i], site.geometry.add_edge(corners[i], corners[(i + 1) % 4])};
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

Envelope region_envelope(Site& site, EnteredRock& rock, const Execution& execution) {
    const Envelope region = initial_envelope(
        make_region_tiling(site.geometry, *rock.region, rock.region_filling), kSkyBlock);
    if (!rock.window) return region;
    // The window is a surface under the sky: what lies above it stays sky.
    const SurfaceTiling window = make_surface_tiling(site.geometry, rock.window->triangles,
                                                     rock.window_plan, {}, -1, execution);
    site.surface_of_plane.resize(site.geometry.plane_count(), kBase);
    Construction nothing;
    Overlaid overlaid = overlay_facets(site.geometry, region, {window, kSkyBlock}, nullptr, nullptr,
                                       nothing, execution);
    std::fill(overlaid.kept.plane.begin(), overlaid.kept.plane.end(), kOutside);
    for (std::size_t i = 0; i < overlaid.below.polygon.size(); ++i)
        overlaid.kept.add_facet(overlaid.below.outlines[i], kSky, -1, kSkyBlock);
    return std::move(overlaid.kept);
}

void clip_to_window(Site& site, const EnteredRock& rock, SurfaceTiling& tiling,
                    Progress* progress) {
    const auto window = window_outline(site, rock);
    LocalArrangement scope(site.geometry);
    Clipper clipper(scope);
    PolygonPool clipped;
    std::vector<std::size_t> which;
    for (std::size_t p = 0; p < tiling.plane.size(); ++p) {
        poll(progress, p);
        const PolygonView whole = tiling.polygons[p];
        if (!tiling.plane[p].has_value() || !may_cross(box_of(scope, whole), *site.window))
            continue;
        const PolygonView inside = clipper.intersect(whole, window);
        const bool is_same = std::ranges::equal(whole, inside, {}, &Corner::point, &Corner::point);
        if (inside.empty() || is_same) continue;
        clipped.add(inside);
        which.push_back(p);
    }
    scope.commit(site.geometry);
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

}  // namespace realmodel::strata
