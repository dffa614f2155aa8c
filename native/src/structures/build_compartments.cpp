// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/structures/build_compartments.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "base/algorithms.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "realmodel/base/errors.hpp"
#include "realmodel/base/memory.hpp"
#include "realmodel/strata/cell_components.hpp"
#include "realmodel/structures/merge_cells.hpp"

namespace realmodel::structures {

namespace {

constexpr double kBuilt = 0.4;  // of the time: until the stacks are built; then they are joined

[[noreturn]] void refuse_compartment(std::size_t compartment, const char* what) {
    throw InputError("bad_part", "part " + std::to_string(compartment) + " of space: " + what, -1,
                     {static_cast<std::int64_t>(compartment)});
}

/// The rock masses of a compartment, between its first solids where it has some.
const std::vector<CompartmentStack>& rocks_of(const CompartmentInput& compartment) {
    return compartment.between.empty() ? compartment.rocks : compartment.between[0].rocks;
}

void check_stack(const StructuredInput& input, std::size_t compartment,
                 const CompartmentStack& rock) {
    const strata::StackInput& stack = rock.stack;
    if (rock.surfaces.size() != stack.surfaces.size())
        refuse_compartment(compartment, "numbers for each surface of a stack are needed");
    if (!stack.rules.empty() && stack.rules.size() != stack.surfaces.size())
        refuse_compartment(compartment, "rules: one for each surface of a stack, or none at all");
    if (!std::ranges::is_sorted(stack.emptied) ||
        (!stack.emptied.empty() && stack.emptied.back() >= stack.surfaces.size()))
        refuse_compartment(compartment, "emptied: surfaces of the stack, ascending");
    if (!stack.fills.empty() &&
        (stack.emptied.empty() || stack.fills.size() != stack.emptied.back()))
        refuse_compartment(compartment, "fills: of each surface before the last emptying");
    for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
        const CompartmentSurface& surface = rock.surfaces[k];
        if (surface.number < kCutFace || surface.number >= input.surfaces)
            refuse_compartment(compartment, "a surface has a number that the model has not");
        if (surface.block < -1 || (surface.block >= 0 && index(surface.block) >= input.blocks))
            refuse_compartment(compartment, "a block has a number that the model has not");
        if (!surface.triangles.empty() &&
            surface.triangles.size() != stack.surfaces[k].triangle_count())
            refuse_compartment(compartment, "numbers for each triangle of a surface are needed");
    }
}

void check_solids(const StructuredInput& input, std::size_t p) {
    const CompartmentInput& compartment = input.compartments[p];
    if (compartment.solids.empty() != compartment.between.empty() ||
        (!compartment.solids.empty() && !compartment.rocks.empty()))
        refuse_compartment(p, "solids have the rock masses between them, and only these");
    for (const LevelSolid& solid : compartment.solids) {
        if (solid.surface < 0 || solid.surface >= input.surfaces)
            refuse_compartment(p, "a solid has the number of a surface that the model has not");
    }
    for (const LevelCompartment& between : compartment.between) {
        if (between.sides.size() != compartment.solids.size())
            refuse_compartment(p, "sides: one for each solid");
        if (between.rocks.size() != compartment.between[0].rocks.size())
            refuse_compartment(p, "between solids there are not as many rock masses as elsewhere");
        for (const CompartmentStack& rock : between.rocks)
            check_stack(input, p, rock);
    }
}

void check_input(const StructuredInput& input) {
    const std::size_t structures = input.structures.size();
    if (input.acts.size() != structures * input.blocks)
        throw InputError("bad_part", "acts: one for each structure and block");
    if (input.piece && !input.piece->continued.empty() &&
        input.piece->continued.size() != structures)
        throw InputError("bad_part", "continued: one for each structure");
    for (std::size_t p = 0; p < input.compartments.size(); ++p) {
        const CompartmentInput& compartment = input.compartments[p];
        if (compartment.sides.size() != structures)
            refuse_compartment(p, "sides: one for each structure");
        if (compartment.solids.empty() &&
            compartment.rocks.size() != rocks_of(input.compartments[0]).size())
            refuse_compartment(p, "it has not as many rock masses as the others");
        for (const CompartmentStack& rock : compartment.rocks)
            check_stack(input, p, rock);
        check_solids(input, p);
    }
}

/// The stacks of the rock masses that are in a compartment, and what their surfaces, counted
/// through all of them, are in the whole.
struct StacksHere {
    std::vector<strata::StackInput> stacks;
    std::vector<std::int64_t> rocks;
    std::vector<CompartmentSurface> surfaces;

    explicit StacksHere(const std::vector<CompartmentStack>& all) {
        for (std::size_t r = 0; r < all.size(); ++r) {
            const CompartmentStack& rock = all[r];
            if (rock.surfaces.empty()) continue;
            stacks.push_back(rock.stack);
            rocks.push_back(static_cast<std::int64_t>(r));
            surfaces.insert(surfaces.end(), rock.surfaces.begin(), rock.surfaces.end());
        }
    }

    bool is_any_emptied() const {
        return std::ranges::any_of(stacks,
                                   [](const auto& stack) { return !stack.emptied.empty(); });
    }

    /// What an error or a warning names, as the whole has it.
    void name_as_in_whole(int& surface, std::vector<std::int64_t>& items,
                          const std::string& kind) const {
        if (kind == "rocks_overlap" || kind == "base_not_below" || kind == "bad_region") {
            for (std::int64_t& rock : items)
                rock = rocks[static_cast<std::size_t>(rock)];
        }
        if (surface < 0) return;
        const CompartmentSurface& in_whole = surfaces[static_cast<std::size_t>(surface)];
        surface = in_whole.number;
        if (in_whole.triangles.empty() || kind == "not_finite") return;  // that names a vertex
        for (std::int64_t& triangle : items)
            triangle = in_whole.triangles[static_cast<std::size_t>(triangle)];
    }
};

/// Where each cell comes when those where nothing is are left out and, if asked for, connected
/// cells of one block become one.
std::vector<std::int32_t> merged_numbers(const CellComplex& complex,
                                         const std::vector<std::int32_t>& block, bool as_one,
                                         Progress* progress) {
    std::vector<std::int32_t> first;  // the first of the cells that each becomes one with
    if (as_one) first = strata::cell_components(complex.face_cells, block, progress);
    std::vector<std::int32_t> number(block.size(), -1);
    std::int32_t next = 0;
    for (std::size_t c = 0; c < block.size(); ++c) {
        if (block[c] < 0) continue;
        const std::size_t representative = as_one ? index(first[c]) : c;
        number[c] = representative == c ? next++ : number[representative];
    }
    return number;
}

/// Whether two surfaces lie upon the same block, or upon nothing.
bool repeats_blocks(const std::vector<CompartmentSurface>& surfaces) {
    std::vector<std::int32_t> blocks = transformed(surfaces, &CompartmentSurface::block);
    std::ranges::sort(blocks);
    return std::ranges::adjacent_find(blocks) != blocks.end();
}

/// A built complex with blocks and surfaces as the whole numbers them, and with the cells wanted.
CellComplex as_in_whole(CellComplex built, const StacksHere& here, CellKind cells,
                        Progress* progress) {
    const auto block_beneath = [&](std::int32_t surface) {
        return here.surfaces[index(surface)].block;
    };
    std::vector<std::int32_t> block(built.cell_block.size());
    std::ranges::transform(built.cell_block, block.begin(), block_beneath);
    const bool is_empty_anywhere = std::ranges::find(block, -1) != block.end();
    const bool as_one =
        cells == CellKind::kBlocks && (built.cell_kind != cells || repeats_blocks(here.surfaces));
    if (as_one || is_empty_anywhere) {
        std::vector<Warning> warnings = std::move(built.warnings);
        built = merge_cells(built, merged_numbers(built, block, as_one, progress), progress);
        built.warnings = std::move(warnings);
    }
    for (std::int32_t& of_cell : built.cell_block)
        of_cell = block_beneath(of_cell);
    for (std::int32_t& surface : built.face_surface) {
        if (surface >= 0) surface = here.surfaces[index(surface)].number;
    }
    for (Warning& warning : built.warnings)
        here.name_as_in_whole(warning.surface, warning.items, warning.kind);
    built.cell_kind = cells;
    return built;
}

CellComplex model_of_stacks(const StructuredInput& input, const CompartmentInput& compartment,
                            const std::vector<CompartmentStack>& rocks,
                            const Execution& execution) {
    const StacksHere here(rocks);
    if (here.stacks.empty()) return {};
    const CellKind built_as = here.is_any_emptied() ? CellKind::kColumns : input.cells;
    const bool may_leave_out = built_as == CellKind::kColumns && compartment.wanted;
    try {
        return as_in_whole(strata::build_rock_masses(here.stacks, execution, built_as,
                                                     may_leave_out ? &*compartment.wanted : nullptr,
                                                     input.piece.has_value()),
                           here, input.cells, execution.progress);
    } catch (InputError& error) {
        here.name_as_in_whole(error.surface, error.items, error.kind);
        throw;
    }
}

/// The models that have cells, the compartments that they are of, and their warnings, each once.
struct CompartmentModels {
    std::vector<CompartmentModel> models;
    std::vector<std::int32_t> compartments;
    std::vector<Warning> warnings;

    /// @param sides_of  of the number of each complex the sides of its compartment
    template <class SidesOf>
    CompartmentModels(const StructuredInput& input, const std::vector<CellComplex>& built,
                      const SidesOf& sides_of) {
        for (std::size_t p = 0; p < built.size(); ++p) {
            if (built[p].cell_block.empty()) continue;
            ComplexView model = built[p];
            model.blocks = input.blocks;
            model.surfaces = input.surfaces;
            model.block_volume = {};
            models.push_back({model, sides_of(p)});
            compartments.push_back(static_cast<std::int32_t>(p));
            for (const Warning& warning : built[p].warnings) {
                if (std::ranges::find(warnings, warning) == warnings.end())
                    warnings.push_back(warning);
            }
        }
    }
};

/// Joins what is between the solids of a compartment. These are bodies that act by no rule of their
/// own: a face is left where the blocks on both sides differ.
CellComplex join_between(const StructuredInput& input, const CompartmentInput& compartment,
                         const std::vector<CellComplex>& built, const Execution& execution) {
    CompartmentModels models(input, built,
                             [&](std::size_t p) { return compartment.between[p].sides; });
    if (models.models.empty()) return {};
    std::vector<Structure> solids;
    for (const LevelSolid& solid : compartment.solids)
        solids.push_back({solid.boundary, true});
    const std::vector<std::uint8_t> acts(solids.size() * input.blocks, 0);
    const double largest = input.piece ? input.piece->largest : 0;
    CellComplex joined;
    try {
        joined = join_models(models.models, solids, acts, execution, {}, largest).complex;
    } catch (InputError& error) {
        if (error.surface >= 0) error.surface = compartment.solids[index(error.surface)].surface;
        throw;
    }
    for (std::int32_t& surface : joined.face_surface) {
        if (surface >= input.surfaces)
            surface = compartment.solids[index(surface - input.surfaces)].surface;
    }
    joined.warnings = std::move(models.warnings);
    return joined;
}

CellComplex model_of_compartment(const StructuredInput& input, const CompartmentInput& compartment,
                                 const Execution& execution) {
    if (compartment.solids.empty())
        return model_of_stacks(input, compartment, compartment.rocks, execution);
    constexpr double kStacks = 0.2;  // of the time
    std::vector<CellComplex> built;
    for (const LevelCompartment& between : compartment.between) {
        Progress building(execution.progress,
                          kStacks / static_cast<double>(compartment.between.size()));
        built.push_back(model_of_stacks(input, compartment, between.rocks,
                                        {execution.threads, &building, execution.device}));
        building.report(1.0, nullptr);
    }
    Progress joining(execution.progress, 1 - kStacks);
    CellComplex joined =
        join_between(input, compartment, built, {execution.threads, &joining, execution.device});
    joining.report(1.0, nullptr);
    return joined;
}

Joined join_compartments(const StructuredInput& input, const CompartmentModels& compartments,
                         const Execution& execution) {
    Joined joined;
    if (compartments.models.empty()) {
        joined.complex.face_offsets.push_back(0);
        joined.complex.cell_kind = input.cells;
        joined.complex.volumes.assign(input.blocks, 0.0);
        return joined;
    }
    const PieceOfWhole piece = input.piece.value_or(PieceOfWhole{});
    try {
        joined = join_models(compartments.models, input.structures, input.acts, execution,
                             piece.continued, piece.largest);
    } catch (InputError& error) {
        if (error.surface >= 0) error.surface += input.surfaces;
        throw;
    }
    for (std::int32_t& compartment : joined.cell_compartment)
        compartment = compartments.compartments[index(compartment)];
    joined.complex.warnings = compartments.warnings;
    return joined;
}

}  // namespace

Joined build_compartments(const StructuredInput& input, const Execution& execution) {
    check_input(input);
    begin_phase(execution.progress, 0, kBuilt, "intersecting and cutting");
    std::vector<CellComplex> built(input.compartments.size());
    parallel_tasks(built.size(), execution, kBuilt, [&](std::size_t p, const Execution& task) {
        built[p] = model_of_compartment(input, input.compartments[p], task);
    });
    give_back_memory();
    begin_phase(execution.progress, kBuilt, 1, "joining the compartments");
    Progress joining(execution.progress, 1 - kBuilt);
    const CompartmentModels models(input, built,
                                   [&](std::size_t p) { return input.compartments[p].sides; });
    Joined joined =
        join_compartments(input, models, {execution.threads, &joining, execution.device});
    joining.report(1.0, nullptr);
    return joined;
}

}  // namespace realmodel::structures
