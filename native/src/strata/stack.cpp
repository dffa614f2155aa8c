// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/stack.hpp"

#include <memory>

#include "realmodel/base/page_store.hpp"
#include "strata/blocks.hpp"
#include "strata/cells/volumes.hpp"
#include "strata/columns.hpp"
#include "strata/repair/border_joining.hpp"
#include "strata/repair/plan_snapping.hpp"
#include "strata/repair/site.hpp"
#include "strata/steps.hpp"

namespace realmodel::strata {

namespace {

/// The input with its borders joined, where that is needed and breaks nothing; else as it is given.
std::unique_ptr<Site> enter_joined(std::span<const StackInput> rocks,
                                   std::vector<Warning>& warnings, int threads,
                                   Progress* progress) {
    const auto enter = [&](std::span<const StackInput> input, const PlanSnapping& snapping) {
        begin_step(progress, kBordersDone, kInputDone - kBordersDone, "checking the surfaces");
        warnings.clear();
        return enter_site(input, snapping, warnings, threads, progress);
    };
    if (share_one_plan(rocks)) return enter(rocks, {});
    begin_step(progress, 0.0, kBordersDone, "comparing the borders");
    const PlanSnapping snapping = find_snapping(rocks, threads, progress);
    const JoinedBorders joined = join_borders(rocks, snapping, threads, progress);
    if (snapping.empty() && joined.divided == 0) return enter(rocks, {});
    auto site = joined.divided > 0 ? enter(joined.rocks, {}) : enter(rocks, snapping);
    // Whatever is wrong, what the user hears is about the input as given.
    if (!site->is_single_valued) return enter(rocks, {});
    warnings.push_back(joined_by_rounding(snapping, joined));
    return site;
}

}  // namespace

CellComplex build_rock_masses(std::span<const StackInput> rocks, int threads, Progress* progress,
                              CellKind cells) {
    const page_store::Keeper keeper;
    std::vector<Warning> warnings;
    const std::unique_ptr<Site> entered = enter_joined(rocks, warnings, threads, progress);
    Site& site = *entered;
    site.check_regions();
    CellComplex result;
    if (site.is_empty()) {
        result.face_offsets.push_back(0);
    } else {
        result = cells == CellKind::kBlocks ? build_blocks(site, threads, progress)
                                            : build_columns(site, threads, progress);
    }
    result.cell_kind = cells;
    result.volumes =
        block_volumes(result, static_cast<std::size_t>(site.surfaces), threads, progress);
    result.warnings.insert(result.warnings.begin(), warnings.begin(), warnings.end());
    result.decisions = site.geometry.all_decisions();
    result.exact_decisions = site.geometry.exact_decisions();
    begin_step(progress, 1.0, 0.0, "done");
    return result;
}

CellComplex build_stack(const StackInput& input, int threads, Progress* progress, CellKind cells) {
    return build_rock_masses({&input, 1}, threads, progress, cells);
}

}  // namespace realmodel::strata
