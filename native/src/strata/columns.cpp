// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <utility>

#include "realmodel/base/memory.hpp"
#include "strata/build.hpp"
#include "strata/cells/cell_building.hpp"
#include "strata/overlay/facet_overlay.hpp"
#include "strata/overlay/rock_regions.hpp"
#include "strata/overlay/rules.hpp"
#include "strata/overlay/whole_triangles.hpp"
#include "strata/steps.hpp"

namespace realmodel::strata {

namespace {

constexpr std::size_t kManyPoints = 1000000;

/// The tilings e_k of a rock mass, from the youngest to the oldest.
class TilingSequence {
public:
    TilingSequence(PlanContext& context, LoadedRock& rock, const Execution& execution)
        : context_(context), rock_(rock), execution_(execution) {
        if (rock.is_erosional() && rock.emptied.empty())
            return;  // e_k is the surface itself, made when it is asked for
        RuleReplay replay(TilingRaising(context.geometry, execution), rock.rules, rock.fills);
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            if (execution.progress != nullptr) execution.progress->check();
            if (std::ranges::binary_search(rock.emptied, k)) {
                replayed_.clear();
                if (auto lowest = replay.clear_rock()) replayed_.push_back(std::move(*lowest));
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

private:
    SurfaceTiling surface(std::size_t k) {
        const auto number = rock_.first_surface + static_cast<std::int32_t>(k);
        SurfaceTiling tiling = make_surface_tiling(context_.geometry, rock_.surfaces[k],
                                                   std::move(rock_.plans[k]), number, execution_);
        rock_.surfaces[k] = std::vector<UsedTriangle>();  // without its memory
        context_.surface_of_plane.resize(context_.geometry.plane_count(), number);
        return tiling;
    }

    PlanContext& context_;
    LoadedRock& rock_;
    Execution execution_;
    std::vector<SurfaceTiling> replayed_;
};

/// Beneath facets where nothing is wanted no column reaches the base. To be called where all of
/// these are thick, for they become the outside.
void leave_out_unwanted(const PlanContext& context, double base, Envelope& envelope) {
    LocalArrangement scope(context.geometry);
    for (std::size_t f = 0; f < envelope.size(); ++f) {
        if (!envelope.plane[f].has_value()) continue;
        spatial::Box box = box_of(scope, envelope.outlines[f], envelope.plane[f]);
        box.low[2] = base;
        if (!context.wanted->any_in(box)) envelope.block_beneath[f] = kSkyBlock;
    }
}

/// Closes the rock mass beneath its envelope.
void finish_rock(const PlanContext& context, const LoadedRock& rock, Envelope& envelope,
                 Construction& construction) {
    bool is_far_above = false;
    if (rock.base) {
        const auto lowest = lowest_position(context.geometry, envelope);
        check_base(rock, lowest);
        const double base = *rock.base_elevation;
        is_far_above = lowest[2] - base >
                       context.geometry.clear_height(std::max(std::abs(lowest[2]), std::abs(base)));
    }
    if (is_far_above && context.wanted) leave_out_unwanted(context, *rock.base_elevation, envelope);
    finish(envelope, rock.base, is_far_above, construction);
}

/// Adds the columns and faces of a rock mass, going down from its youngest surface.
void add_rock(PlanContext& context, LoadedRock& rock, Construction& construction, double start,
              double share, const Execution& execution) {
    const std::size_t first_node = construction.node_block.size();
    const auto count = static_cast<std::int32_t>(rock.surfaces.size());
    const WantedBoxes* wanted = context.wanted ? &*context.wanted : nullptr;
    Envelope envelope;
    if (rock.region) envelope = region_envelope(context, rock, execution);
    TilingSequence tilings(context, rock, execution);
    const std::int32_t oldest = tilings.oldest();
    for (std::int32_t k = count - 1; k >= oldest; --k) {
        begin_step(execution.progress, start + share * static_cast<double>(count - 1 - k) / count,
                   share / count, "intersecting the surfaces");
        SurfaceTiling tiling = tilings.take(k);
        if (context.window) clip_to_window(context, rock, tiling, execution.progress);
        envelope = envelope.size() == 0
                       ? initial_envelope(tiling, k)
                       : overlay_columns(context.geometry, std::move(envelope), {tiling, k},
                                         construction, wanted, execution);
        // What input and chunks leave unused is scattered; giving it back takes time.
        if (k % 4 == 0 && context.geometry.point_count() > kManyPoints) give_back_memory();
    }
    finish_rock(context, rock, envelope, construction);
    construction.count_blocks_from(first_node, rock.first_surface);
}

}  // namespace

BuiltCells build_columns(PlanContext& context, const Execution& execution) {
    // of triangulations of these vertices, and one is crossed by a trace here and there
    context.geometry.expect_lines(4 * context.geometry.point_count());
    Construction construction;
    construction.may_lack_nodes = context.wanted.has_value();
    construction.is_local = context.is_local;
    RockFootprints footprints;
    double start = kInputDone;
    for (LoadedRock& rock : context.rocks) {
        const double share = (kOverlayDone - kInputDone) *
                             static_cast<double>(rock.surfaces.size()) /
                             std::max(context.surfaces, 1);
        const std::size_t first_face = construction.faces.size();
        add_rock(context, rock, construction, start, share, execution);
        start += share;
        if (context.rocks.size() > 1)
            footprints.add(context.geometry, construction.faces, first_face, execution.progress);
    }
    return build_cells(context.geometry, construction, nullptr, context.surface_of_plane,
                       context.window, execution);
}

}  // namespace realmodel::strata
