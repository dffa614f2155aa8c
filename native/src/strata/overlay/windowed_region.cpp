// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/overlay/windowed_region.hpp"

#include <algorithm>

#include "strata/overlay/facet_overlay.hpp"
#include "strata/overlay/whole_triangles.hpp"

namespace realmodel::strata {

Envelope region_envelope(Site& site, EnteredRock& rock, int threads, const Progress* progress) {
    const Envelope region = initial_envelope(
        make_region_tiling(site.geometry, *rock.region, rock.region_filling), kSkyBlock);
    if (!rock.window) return region;
    // The window is a surface under the sky: what lies above it stays sky.
    const SurfaceTiling window = make_surface_tiling(site.geometry, rock.window->triangles,
                                                     rock.window_plan, {}, -1, threads, progress);
    site.surface_of_plane.resize(site.geometry.plane_count(), kBase);
    Construction nothing;
    Overlaid overlaid = overlay_facets(site.geometry, region, window, kSkyBlock, nullptr, nullptr,
                                       nothing, threads, progress);
    std::fill(overlaid.kept.plane.begin(), overlaid.kept.plane.end(), kOutside);
    for (std::size_t i = 0; i < overlaid.below.polygon.size(); ++i)
        overlaid.kept.add_facet(overlaid.below.outlines[i], kSky, -1, kSkyBlock);
    return std::move(overlaid.kept);
}

}  // namespace realmodel::strata
