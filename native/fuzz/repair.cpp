// SPDX-License-Identifier: GPL-3.0-or-later
#include "repair.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::fuzz {

namespace {

/// A surface counted through all rock masses.
struct Located {
    std::size_t rock = 0, surface = 0;
};

std::optional<Located> locate(const StackCase& stack, int surface) {
    auto left = static_cast<std::size_t>(surface);
    for (std::size_t r = 0; surface >= 0 && r < stack.rocks.size(); ++r) {
        if (left < stack.rocks[r].surfaces.size()) return Located{r, left};
        left -= stack.rocks[r].surfaces.size();
    }
    return std::nullopt;
}

double lowest_of(const RockCase& rock) {
    double lowest = HUGE_VAL;
    for (const Mesh& surface : rock.surfaces) {
        for (const Triangle& t : surface.triangles) {
            for (const std::int32_t v : t)
                lowest = std::min(lowest, surface.vertices[static_cast<std::size_t>(v)][2]);
        }
    }
    return lowest;
}

std::vector<std::array<PlanPoint, 3>> all_triangles(const RockCase& rock) {
    std::vector<std::array<PlanPoint, 3>> triangles;
    for (const Mesh& surface : rock.surfaces) {
        for (const Triangle& t : surface.triangles)
            triangles.push_back(plan_corners(surface, t));
    }
    return triangles;
}

bool some_overlap(const RockCase& a, const RockCase& b) {
    const auto others = all_triangles(b);
    for (const auto& t : all_triangles(a)) {
        if (std::any_of(others.begin(), others.end(),
                        [&](const auto& other) { return overlap(t, other); }))
            return true;
    }
    return false;
}

bool valid_items(const Mesh& mesh, const InputError& refusal, std::size_t count) {
    return refusal.items.size() >= count &&
           std::all_of(refusal.items.begin(), refusal.items.end(), [&](std::int64_t t) {
               return t >= 0 && static_cast<std::size_t>(t) < mesh.triangles.size();
           });
}

/// The rock mass that the refusal of its base names, or null.
template <class Case>
auto* rock_named(Case& stack, const InputError& refusal) {
    const bool is_there = refusal.items.size() == 1 && refusal.items[0] >= 0 &&
                          static_cast<std::size_t>(refusal.items[0]) < stack.rocks.size();
    return is_there ? &stack.rocks[static_cast<std::size_t>(refusal.items[0])] : nullptr;
}

bool beyond_limits(const Mesh& mesh) {
    for (const Point& p : mesh.vertices) {
        for (const double c : p) {
            if (!(std::abs(c) <= 1e50)) return true;
        }
    }
    return false;
}

}  // namespace

bool repair(StackCase& stack, const InputError& refusal) {
    if (refusal.kind == "rocks_overlap" && refusal.items.size() == 2 && stack.rocks.size() > 1) {
        stack.rocks.erase(stack.rocks.begin() + static_cast<std::ptrdiff_t>(refusal.items[1]));
        return true;
    }
    if (refusal.kind == "base_not_below") {
        RockCase* rock = rock_named(stack, refusal);
        if (rock == nullptr) return false;
        const double lowest = lowest_of(*rock);
        rock->base_elevation = lowest - std::max(1.0, std::abs(lowest) * 1e-3);
        return true;
    }
    const auto at = locate(stack, refusal.surface);
    if (!at) return false;
    RockCase& rock = stack.rocks[at->rock];
    Mesh& mesh = rock.surfaces[at->surface];
    if (refusal.kind != "double_valued" && refusal.kind != "vertical_triangle") return false;
    if (!valid_items(mesh, refusal, 1)) return false;
    mesh.triangles.erase(mesh.triangles.begin() +
                         static_cast<std::ptrdiff_t>(refusal.items.back()));
    if (!mesh.triangles.empty()) return true;
    if (!rock.rules.empty())
        rock.rules.erase(rock.rules.begin() + static_cast<std::ptrdiff_t>(at->surface));
    rock.surfaces.erase(rock.surfaces.begin() + static_cast<std::ptrdiff_t>(at->surface));
    return !rock.surfaces.empty();
}

std::optional<std::string> unjust(const StackCase& stack, const InputError& refusal) {
    const std::string said = refusal.kind + ": " + refusal.what();
    if (refusal.kind == "rocks_overlap") {
        if (refusal.items.size() != 2 ||
            !some_overlap(stack.rocks[static_cast<std::size_t>(refusal.items[0])],
                          stack.rocks[static_cast<std::size_t>(refusal.items[1])]))
            return "the rock masses do not overlap: " + said;
        return std::nullopt;
    }
    if (refusal.kind == "base_not_below") {
        const RockCase* rock = rock_named(stack, refusal);
        if (rock == nullptr) return "no rock mass is named: " + said;
        if (!rock->base_elevation || lowest_of(*rock) > *rock->base_elevation)
            return "the base lies below: " + said;
        return std::nullopt;
    }
    const auto at = locate(stack, refusal.surface);
    if (!at) return "no surface is named: " + said;
    const RockCase& rock = stack.rocks[at->rock];
    const Mesh& mesh = rock.surfaces[at->surface];
    const auto triangle = [&](std::size_t i) {
        return mesh.triangles[static_cast<std::size_t>(refusal.items[i])];
    };
    if (refusal.kind == "double_valued") {
        if (!valid_items(mesh, refusal, 2) ||
            !overlap(plan_corners(mesh, triangle(0)), plan_corners(mesh, triangle(1))))
            return "the triangles do not overlap: " + said;
        return std::nullopt;
    }
    if (refusal.kind == "vertical_triangle") {
        if (!valid_items(mesh, refusal, 1) || !is_flat(plan_corners(mesh, triangle(0))))
            return "the triangle is not vertical: " + said;
        return std::nullopt;
    }
    if (refusal.kind == "not_finite" && beyond_limits(mesh)) return std::nullopt;
    return "unknown kind: " + said;
}

}  // namespace realmodel::fuzz
