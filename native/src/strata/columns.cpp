// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/columns.hpp"

#include <algorithm>
#include <utility>

#include "realmodel/base/memory.hpp"
#include "strata/cells/cell_building.hpp"
#include "strata/overlay/facet_overlay.hpp"
#include "strata/overlay/rock_footprints.hpp"
#include "strata/overlay/rules.hpp"
#include "strata/overlay/whole_triangles.hpp"
#include "strata/overlay/windowed_region.hpp"
#include "strata/steps.hpp"

namespace realmodel::strata {

namespace {

constexpr std::size_t kManyPoints = 1000000;

/// The tilings e_k of a rock mass, from the youngest to the oldest.
class TilingSequence {
public:
    TilingSequence(Site& site, EnteredRock& rock, const Execution& execution)
        : site_(site), rock_(rock), execution_(execution) {
        if (rock.is_erosional() && rock.emptied.empty())
            return;  // e_k is the surface itself, made when it is asked for
        RuleReplay replay(TilingRaising(site.geometry, execution), rock.rules, rock.fills);
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            if (execution.progress != nullptr) execution.progress->check();
            if (std::ranges::binary_search(rock.emptied, k)) {
                replayed_.clear();
                if (auto lowest = replay.empty()) replayed_.push_back(std::move(*lowest));
            }
            replayed_.push_back(replay.add(surface(k)));
        }
    }

    /// The number of the oldest one, once the others are there: after the rock was emptied that of
    /// the last surface before, for the top of what stayed.
    std::int32_t oldest() const {
        const std::size_t count = rock_.surfaces.size();
        return static_cast<std::int32_t>(replayed_.empty() ? 0 : count - replayed_.size());
    }
    SurfaceTiling take(std::int32_t k) {
        if (replayed_.empty()) return surface(static_cast<std::size_t>(k));
        SurfaceTiling tiling = std::move(replayed_.back());
        replayed_.pop_back();
        return tiling;
    }
    /// Takes the outlines of a tiling that was taken before and is done with: the next one may be
    /// on the same mesh.
    void give_back(SurfaceTiling tiling) { similar_ = std::move(tiling.polygons); }

private:
    SurfaceTiling surface(std::size_t k) {
        const auto number = rock_.first_surface + static_cast<std::int32_t>(k);
        SurfaceTiling tiling =
            make_surface_tiling(site_.geometry, rock_.surfaces[k].triangles,
                                std::move(rock_.plans[k]), similar_, number, execution_);
        rock_.surfaces[k] = {};
        site_.surface_of_plane.resize(site_.geometry.plane_count(), number);
        return tiling;
    }

    Site& site_;
    EnteredRock& rock_;
    Execution execution_;
    PolygonPool similar_;
    std::vector<SurfaceTiling> replayed_;
};

/// Beneath facets where nothing is wanted no column reaches the base. To be called where all of
/// these are thick, for they become the outside.
void leave_out_unwanted(const Site& site, double base, Envelope& envelope) {
    LocalArrangement scope(site.geometry);
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        if (!envelope.plane[f].has_value()) continue;
        spatial::Box box = box_of(scope, envelope.outlines[f], envelope.plane[f]);
        box.low[2] = base;
        if (!site.wanted->any_in(box)) envelope.block_beneath[f] = kSkyBlock;
    }
}

/// Closes the rock mass beneath its envelope.
void finish_rock(const Site& site, const EnteredRock& rock, Envelope& envelope,
                 Construction& construction) {
    bool is_far_above = false;
    if (rock.base) {
        const auto lowest = lowest_position(site.geometry, envelope);
        check_base(rock, lowest);
        const double base = *rock.base_elevation;
        is_far_above = lowest[2] - base >
                       site.geometry.clear_height(std::max(std::abs(lowest[2]), std::abs(base)));
    }
    if (is_far_above && site.wanted) leave_out_unwanted(site, *rock.base_elevation, envelope);
    finish(envelope, rock.base, is_far_above, construction);
}

/// Adds the columns and faces of a rock mass, going down from its youngest surface.
void add_rock(Site& site, EnteredRock& rock, Construction& construction, double start, double share,
              const Execution& execution) {
    const std::size_t first_node = construction.node_block.size();
    const auto count = static_cast<std::int32_t>(rock.surfaces.size());
    const WantedBoxes* wanted = site.wanted ? &*site.wanted : nullptr;
    Envelope envelope;
    if (rock.region) envelope = region_envelope(site, rock, execution);
    TilingSequence tilings(site, rock, execution);
    const std::int32_t oldest = tilings.oldest();
    for (std::int32_t k = count - 1; k >= oldest; --k) {
        begin_step(execution.progress, start + share * static_cast<double>(count - 1 - k) / count,
                   share / count, "intersecting the surfaces");
        SurfaceTiling tiling = tilings.take(k);
        if (site.window) clip_to_window(site, rock, tiling, execution.progress);
        envelope = envelope.size() == 0
                       ? initial_envelope(tiling, k)
                       : overlay_columns(site.geometry, std::move(envelope), {tiling, k},
                                         construction, wanted, execution);
        tilings.give_back(std::move(tiling));
        // What input and chunks leave unused is scattered; giving it back takes time.
        if (k % 4 == 0 && site.geometry.point_count() > kManyPoints) give_back_memory();
    }
    finish_rock(site, rock, envelope, construction);
    construction.count_blocks_from(first_node, rock.first_surface);
}

}  // namespace

BuiltCells build_columns(Site& site, const Execution& execution) {
    // of triangulations of these vertices, and one is crossed by a trace here and there
    site.geometry.expect_lines(4 * site.geometry.point_count());
    Construction construction;
    construction.may_lack_nodes = site.wanted.has_value();
    construction.is_local = site.is_local;
    RockFootprints footprints;
    double start = kInputDone;
    for (EnteredRock& rock : site.rocks) {
        const double share = (kOverlayDone - kInputDone) *
                             static_cast<double>(rock.surfaces.size()) / std::max(site.surfaces, 1);
        const std::size_t first_face = construction.faces.size();
        add_rock(site, rock, construction, start, share, execution);
        start += share;
        if (site.rocks.size() > 1)
            footprints.add(site.geometry, construction.faces, first_face, execution.progress);
    }
    return build_cells(site.geometry, construction, nullptr, site.surface_of_plane, site.window,
                       execution);
}

}  // namespace realmodel::strata
