// SPDX-License-Identifier: GPL-3.0-or-later
#include "stack_case.hpp"

#include <algorithm>

#include "exact/orientation.hpp"

namespace realmodel::fuzz {

namespace {

template <class M>
M without_unused(const M& mesh) {
    M kept;
    std::vector<std::int32_t> number(mesh.vertices.size(), -1);
    for (Triangle triangle : mesh.triangles) {
        for (std::int32_t& corner : triangle) {
            auto& known = number[static_cast<std::size_t>(corner)];
            if (known < 0) {
                known = static_cast<std::int32_t>(kept.vertices.size());
                kept.vertices.push_back(mesh.vertices[static_cast<std::size_t>(corner)]);
            }
            corner = known;
        }
        kept.triangles.push_back(triangle);
    }
    return kept;
}

template <class M>
std::array<PlanPoint, 3> corners_of(const M& mesh, const Triangle& triangle) {
    std::array<PlanPoint, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& vertex = mesh.vertices[static_cast<std::size_t>(triangle[i])];
        corners[i] = {vertex[0], vertex[1]};
    }
    if (exact::orient2d(corners[0], corners[1], corners[2]) < 0) std::swap(corners[1], corners[2]);
    return corners;
}

/// Whether an edge of counter-clockwise `a` has all of `b` on its outer side or on it.
bool separated(const std::array<PlanPoint, 3>& a, const std::array<PlanPoint, 3>& b) {
    for (std::size_t i = 0; i < 3; ++i) {
        if (std::all_of(b.begin(), b.end(), [&](const PlanPoint& p) {
                return exact::orient2d(a[i], a[(i + 1) % 3], p) <= 0;
            }))
            return true;
    }
    return false;
}

}  // namespace

std::vector<strata::Rule>& RockCase::all_rules() {
    rules.resize(surfaces.size(), strata::Rule::kErosional);
    return rules;
}

std::size_t triangle_count(const StackCase& stack) {
    std::size_t count = 0;
    for (const RockCase& rock : stack.rocks) {
        for (const Mesh& surface : rock.surfaces)
            count += surface.triangles.size();
    }
    return count;
}

std::size_t surface_count(const StackCase& stack) {
    std::size_t count = 0;
    for (const RockCase& rock : stack.rocks)
        count += rock.surfaces.size();
    return count;
}

std::vector<strata::StackInput> views_of(const StackCase& stack) {
    const auto numbers = [](const auto& rows) {
        using Number = typename std::decay_t<decltype(rows)>::value_type::value_type;
        constexpr std::size_t width =
            std::tuple_size_v<typename std::decay_t<decltype(rows)>::value_type>;
        const Number* first = rows.empty() ? nullptr : rows.front().data();
        return std::span<const Number>(first, rows.size() * width);
    };
    std::vector<strata::StackInput> inputs;
    for (const RockCase& rock : stack.rocks) {
        strata::StackInput input;
        for (const Mesh& s : rock.surfaces)
            input.surfaces.push_back({numbers(s.vertices), numbers(s.triangles)});
        input.rules = rock.rules;
        if (rock.region)
            input.region = {numbers(rock.region->vertices), numbers(rock.region->triangles)};
        input.base_elevation = rock.base_elevation;
        inputs.push_back(std::move(input));
    }
    return inputs;
}

Mesh compacted(const Mesh& mesh) {
    return without_unused(mesh);
}

PlanMesh compacted(const PlanMesh& mesh) {
    return without_unused(mesh);
}

bool is_flat(const std::array<PlanPoint, 3>& corners) {
    return exact::orient2d(corners[0], corners[1], corners[2]) == 0;
}

bool overlap(const std::array<PlanPoint, 3>& a, const std::array<PlanPoint, 3>& b) {
    return !is_flat(a) && !is_flat(b) && !separated(a, b) && !separated(b, a);
}

std::array<PlanPoint, 3> plan_corners(const Mesh& mesh, const Triangle& triangle) {
    return corners_of(mesh, triangle);
}

std::array<PlanPoint, 3> plan_corners(const PlanMesh& mesh, const Triangle& triangle) {
    return corners_of(mesh, triangle);
}

}  // namespace realmodel::fuzz
