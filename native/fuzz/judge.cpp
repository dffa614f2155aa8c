// SPDX-License-Identifier: GPL-3.0-or-later
#include "judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/floating_point.hpp"
#include "digest.hpp"
#include "exact_volumes.hpp"
#include "realmodel/base/errors.hpp"
#include "repair.hpp"
#include "second_opinion.hpp"

namespace realmodel::fuzz {

namespace {

using strata::CellComplex;
using strata::CellKind;

CellComplex built(const StackCase& stack, int threads, strata::CellKind cells) {
    return strata::build_rock_masses(views_of(stack), {threads, nullptr}, cells);
}

/// Which surfaces have a block beneath them.
std::vector<bool> possible_blocks(const StackCase& stack) {
    std::vector<bool> possible;
    for (const RockCase& rock : stack.rocks) {
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k)
            possible.push_back(k > 0 || rock.base_elevation.has_value());
    }
    return possible;
}

void compare_volumes(const StackCase& stack, const CellComplex& complex,
                     const std::vector<double>& exact, std::vector<Defect>& defects) {
    const std::vector<double> allowed = volume_allowance(stack, exact);
    const std::vector<bool> possible = possible_blocks(stack);
    std::vector<bool> present(exact.size(), false);
    for (const std::int32_t block : complex.cell_block)
        present[static_cast<std::size_t>(block)] = true;
    const bool exactly = !were_borders_joined(complex);
    for (std::size_t k = 0; k < exact.size(); ++k) {
        if (possible[k] && !(std::abs(complex.volumes[k] - exact[k]) <= allowed[k])) {
            defects.push_back({"volume", "block " + std::to_string(k) + " has " +
                                             std::to_string(complex.volumes[k]) + ", exactly " +
                                             std::to_string(exact[k])});
        }
        if (present[k] && exact[k] == 0 && (exactly || !possible[k]))
            defects.push_back(
                {"sliver", "block " + std::to_string(k) + ": its exact volume is zero"});
    }
}

/// Number of connected parts of each block.
std::vector<int> compartments_of(const CellComplex& c) {
    std::vector<std::int32_t> parent(c.cell_block.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t i) {
        while (parent[static_cast<std::size_t>(i)] != i)
            i = parent[static_cast<std::size_t>(i)] =
                parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
        return i;
    };
    const auto block = [&](std::int32_t cell) {
        return c.cell_block[static_cast<std::size_t>(cell)];
    };
    for (const auto& [a, b] : c.face_cells) {
        if (b >= 0 && block(a) == block(b)) parent[static_cast<std::size_t>(root(a))] = root(b);
    }
    std::vector<int> count(c.volumes.size(), 0);
    for (std::int32_t i = 0; i < static_cast<std::int32_t>(parent.size()); ++i) {
        if (root(i) == i) ++count[static_cast<std::size_t>(block(i))];
    }
    return count;
}

void compare_kinds(const StackCase& stack, const CellComplex& columns, const CellComplex& blocks,
                   std::vector<Defect>& defects) {
    const std::vector<double> allowed = volume_allowance(stack, columns.volumes);
    for (std::size_t k = 0; k < columns.volumes.size(); ++k) {
        if (!(std::abs(columns.volumes[k] - blocks.volumes[k]) <= allowed[k])) {
            defects.push_back({"kinds differ in volume",
                               "block " + std::to_string(k) + " has " +
                                   std::to_string(columns.volumes[k]) + " as columns, " +
                                   std::to_string(blocks.volumes[k]) + " as blocks"});
        }
    }
    std::vector<int> cells(blocks.volumes.size(), 0);
    for (const std::int32_t block : blocks.cell_block)
        ++cells[static_cast<std::size_t>(block)];
    const std::vector<int> parts = compartments_of(columns);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        if (parts[k] != cells[k]) {
            defects.push_back({"kinds differ in parts",
                               "block " + std::to_string(k) + ": columns make " +
                                   std::to_string(parts[k]) + " connected parts, there are " +
                                   std::to_string(cells[k]) + " block cells"});
        }
    }
    for (Defect& defect : boundary_differences(columns, blocks))
        defects.push_back(std::move(defect));
}

std::vector<Defect> named(std::vector<Defect> defects, const char* which) {
    for (Defect& defect : defects)
        defect.kind = std::string(which) + " " + defect.kind;
    return defects;
}

/// Leaves out what makes a region no triangulation.
void tidy(std::optional<PlanMesh>& region) {
    if (!region) return;
    std::vector<Triangle> kept;
    for (const Triangle& t : region->triangles) {
        const auto corners = plan_corners(*region, t);
        if (is_flat(corners)) continue;
        if (std::none_of(kept.begin(), kept.end(), [&](const Triangle& other) {
                return overlap(corners, plan_corners(*region, other));
            }))
            kept.push_back(t);
    }
    region->triangles = kept;
    if (kept.empty()) {
        region.reset();
    } else {
        *region = compacted(*region);
    }
}

}  // namespace

std::vector<double> volume_allowance(const StackCase& stack, const std::vector<double>& volumes) {
    Point low{HUGE_VAL, HUGE_VAL, HUGE_VAL}, high{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (const RockCase& rock : stack.rocks) {
        for (const Mesh& surface : rock.surfaces) {
            for (const Point& p : surface.vertices) {
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], p[axis]);
                    high[axis] = std::max(high[axis], p[axis]);
                }
            }
        }
        if (rock.base_elevation) low[2] = std::min(low[2], *rock.base_elevation);
    }
    Point extent{}, step{};
    for (std::size_t axis = 0; axis < 3 && low[axis] <= high[axis]; ++axis) {
        extent[axis] = high[axis] - low[axis];
        step[axis] = ulp(std::max(std::abs(low[axis]), std::abs(high[axis])));
    }
    // products of the least numbers are 0
    const double rounding = 64 * (step[2] * extent[0] * extent[1] +
                                  (step[0] * extent[1] + step[1] * extent[0]) * extent[2] +
                                  std::numeric_limits<double>::denorm_min());
    std::vector<double> allowed;
    for (const double volume : volumes)
        allowed.push_back(1e-9 * std::abs(volume) + rounding);
    return allowed;
}

std::vector<Defect> make_valid(StackCase& stack, bool& usable) {
    usable = false;
    for (RockCase& rock : stack.rocks) {
        tidy(rock.region);
        for (Mesh& surface : rock.surfaces)
            surface = compacted(surface);
    }
    for (std::size_t round = 0; round < 200 && !stack.rocks.empty(); ++round) {
        try {
            built(stack, 1, CellKind::kColumns);
            usable = true;
            return {};
        } catch (const InputError& refusal) {
            if (const auto wrong = unjust(stack, refusal)) return {{"unjust refusal", *wrong}};
            if (!repair(stack, refusal)) return {};
        } catch (const std::exception& error) {
            return {{"exception", error.what()}};
        }
    }
    return {};
}

std::vector<Defect> defects_of(const StackCase& stack, const JudgeOptions& options) {
    std::vector<Defect> defects;
    const auto add = [&](std::vector<Defect> more) {
        defects.insert(defects.end(), more.begin(), more.end());
    };
    try {
        const CellComplex columns = built(stack, 1, CellKind::kColumns);
        add(named(complex_defects(columns, Cells::kColumns), "columns"));
        const CellComplex blocks = built(stack, 1, CellKind::kBlocks);
        add(named(complex_defects(blocks, Cells::kBlocks), "blocks"));
        if (defects.empty()) {
            add(named(surface_defects(columns, stack), "columns"));
            add(named(surface_defects(blocks, stack), "blocks"));
            add(named(second_opinion(columns, stack), "columns"));
            add(named(second_opinion(blocks, stack), "blocks"));
            compare_kinds(stack, columns, blocks, defects);
        }
        if (triangle_count(stack) <= options.most_triangles) {
            if (const auto exact = exact_volumes(stack, options.most_polygons))
                for (const CellComplex* complex : {&columns, &blocks})
                    compare_volumes(stack, *complex, *exact, defects);
        }
        for (const int threads : options.threads) {
            if (digest(built(stack, threads, CellKind::kColumns)) != digest(columns) ||
                digest(built(stack, threads, CellKind::kBlocks)) != digest(blocks)) {
                defects.push_back(
                    {"threads", std::to_string(threads) + " threads give other bytes"});
            }
        }
    } catch (const InputError& refusal) {
        defects.push_back({"refused", refusal.what()});
    } catch (const std::exception& error) {
        defects.push_back({"exception", error.what()});
    }
    return defects;
}

}  // namespace realmodel::fuzz
