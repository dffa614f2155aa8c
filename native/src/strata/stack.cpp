// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/stack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <utility>

#include "strata/build.hpp"
#include "strata/cells/volumes.hpp"
#include "strata/repair/border_joining.hpp"
#include "strata/repair/plan_context.hpp"
#include "strata/repair/plan_snapping.hpp"
#include "strata/steps.hpp"

namespace realmodel::strata {

namespace {

/// Input that is loaded, as given or with its borders joined.
struct LoadedInput {
    std::unique_ptr<PlanContext> context;
    std::vector<Warning> warnings;
    PlanSnapping snapping;
    BorderChains chains;
    JoinedBorders joined;
    bool is_joined = false;
};

std::unique_ptr<PlanContext> load_unrepaired(std::span<const StackInput> rocks,
                                             const PlanSnapping& snapping,
                                             std::vector<Warning>& warnings,
                                             const Execution& execution) {
    begin_step(execution.progress, kBordersDone, kInputDone - kBordersDone,
               "checking the surfaces");
    warnings.clear();
    return load_input(rocks, snapping, warnings, execution);
}

/// Finds which borders are to be joined, and whether any is.
bool compare_borders(std::span<const StackInput> rocks, LoadedInput& loaded,
                     const Execution& execution) {
    begin_step(execution.progress, 0.0, kBordersDone, "comparing the borders");
    loaded.snapping = find_snapping(rocks, execution);
    loaded.chains = find_chains(rocks, loaded.snapping, execution);
    return !loaded.snapping.empty() || !loaded.chains.empty();
}

/// The input with the joins found, unless they break something: whatever is wrong then, what the
/// user hears is about the input as given.
void load_with_joins(std::span<const StackInput> rocks, LoadedInput& loaded,
                     const Execution& execution) {
    if (loaded.chains.empty()) {
        loaded.context = load_unrepaired(rocks, loaded.snapping, loaded.warnings, execution);
    } else {
        loaded.joined = join_borders(rocks, loaded.snapping, loaded.chains, execution.progress);
        loaded.context = load_unrepaired(loaded.joined.rocks, {}, loaded.warnings, execution);
    }
    loaded.is_joined = loaded.context->is_single_valued;
    if (loaded.is_joined)
        loaded.warnings.push_back(joined_by_rounding(loaded.snapping, loaded.chains));
}

/// The input with its borders joined, where that is needed and breaks nothing; else as it is given.
/// In one plan only borders of its own parts may lie beside each other: they are looked at where
/// these overlap.
LoadedInput load_repaired(std::span<const StackInput> rocks, const Execution& execution) {
    LoadedInput loaded;
    const auto join = [&] {
        if (compare_borders(rocks, loaded, execution)) load_with_joins(rocks, loaded, execution);
    };
    const bool is_one_plan = share_one_plan(rocks);
    if (!is_one_plan) join();
    if (loaded.is_joined) return loaded;
    loaded.context = load_unrepaired(rocks, {}, loaded.warnings, execution);
    if (!is_one_plan || loaded.context->is_single_valued) return loaded;
    join();
    if (!loaded.is_joined) loaded.context = load_unrepaired(rocks, {}, loaded.warnings, execution);
    return loaded;
}

/// Volumes of blocks: over the exact plan positions, so that those of tiles add up to those of the
/// whole. But where rounding moves them so much that who adds up the cells of a whole model finds
/// others, over the cells as they are.
std::vector<double> volumes_of(const BuiltCells& built, std::size_t blocks, bool is_tile,
                               const Execution& execution) {
    std::vector<double> volumes = block_volumes(built.complex, blocks, execution,
                                                {built.offsets.data(), built.offsets.size()});
    if (is_tile || built.offsets.size() == 0) return volumes;
    std::vector<double> of_cells = block_volumes(built.complex, blocks, execution);
    double largest = 0;
    for (const double volume : of_cells)
        largest = std::max(largest, std::abs(volume));
    constexpr double kSame = 1e-10;  // of the largest block
    const bool are_same = std::ranges::equal(volumes, of_cells, [&](double one, double other) {
        return std::abs(one - other) <= kSame * largest;
    });
    return are_same ? volumes : of_cells;
}

Tile build_context(PlanContext& context, const std::vector<Warning>& warnings, CellKind cells,
                   const Execution& execution) {
    context.check_regions();
    BuiltCells built;
    CellComplex& result = built.complex;
    if (context.is_empty()) {
        result.face_offsets.push_back(0);
    } else {
        built = cells == CellKind::kBlocks ? build_blocks(context, execution)
                                           : build_columns(context, execution);
    }
    result.cell_kind = cells;
    const auto blocks = static_cast<std::size_t>(context.surfaces);
    result.volumes = context.wanted
                         ? std::vector<double>(blocks)
                         : volumes_of(built, blocks, context.window.has_value(), execution);
    result.warnings.insert(result.warnings.begin(), warnings.begin(), warnings.end());
    result.decisions = context.geometry.all_decisions();
    result.exact_decisions = context.geometry.exact_decisions();
    begin_step(execution.progress, 1.0, 0.0, "done");
    return {std::move(result), std::move(built.border)};
}

}  // namespace

CellComplex build_rock_masses(std::span<const StackInput> rocks, const Execution& execution,
                              CellKind cells, const WantedSpace* wanted, bool is_local) {
    const LoadedInput loaded = load_repaired(rocks, execution);
    if (wanted != nullptr) loaded.context->wanted.emplace(*wanted);
    loaded.context->is_local = is_local;
    return build_context(*loaded.context, loaded.warnings, cells, execution).complex;
}

Tile build_tile(std::span<const StackInput> rocks, const Window& window, const Execution& execution,
                CellKind cells) {
    const std::array corners{window.low_x,  window.low_y,  window.high_x, window.low_y,
                             window.high_x, window.high_y, window.low_x,  window.high_y};
    constexpr std::array<std::int32_t, 6> kTriangles{0, 1, 2, 0, 2, 3};
    std::vector<StackInput> in_window(rocks.begin(), rocks.end());
    for (StackInput& rock : in_window) {
        if (rock.region) {
            rock.window = window;
        } else {
            rock.region = {corners, kTriangles};
        }
    }
    std::vector<Warning> warnings;
    const auto context = load_unrepaired(in_window, {}, warnings, execution);
    context->window = window;
    return build_context(*context, warnings, cells, execution);
}

CellComplex build_stack(const StackInput& input, const Execution& execution, CellKind cells) {
    return build_rock_masses({&input, 1}, execution, cells);
}

}  // namespace realmodel::strata
