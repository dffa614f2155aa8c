// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "realmodel/strata/stack.hpp"

namespace realmodel::fuzz {

using Point = std::array<double, 3>;
using PlanPoint = std::array<double, 2>;
using Triangle = std::array<std::int32_t, 3>;

/// A triangulated surface that owns its arrays.
struct Mesh {
    std::vector<Point> vertices;
    std::vector<Triangle> triangles;
    bool operator==(const Mesh&) const = default;
};

/// A triangulation in plan.
struct PlanMesh {
    std::vector<PlanPoint> vertices;
    std::vector<Triangle> triangles;
    bool operator==(const PlanMesh&) const = default;
};

/// One rock mass.
struct RockCase {
    std::vector<Mesh> surfaces;       ///< oldest first
    std::vector<strata::Rule> rules;  ///< one a surface, or none at all
    std::optional<PlanMesh> region;
    std::optional<double> base_elevation;
    bool operator==(const RockCase&) const = default;

    strata::Rule rule(std::size_t k) const {
        return rules.empty() ? strata::Rule::kErosional : rules[k];
    }
    /// Writes the rules out where there are none, so that single ones can be changed.
    std::vector<strata::Rule>& all_rules();
};

/// One input of the stack builder as a test case.
struct StackCase {
    std::vector<RockCase> rocks;
    std::string label;  ///< how it was made
};

std::size_t triangle_count(const StackCase& stack);
std::size_t surface_count(const StackCase& stack);

/// The builder's view of a case, which must outlive it.
std::vector<strata::StackInput> views_of(const StackCase& stack);

/// Leaves out vertices that no triangle uses.
Mesh compacted(const Mesh& mesh);
PlanMesh compacted(const PlanMesh& mesh);

/// Whether two triangles share an area in plan; exact.
bool overlap(const std::array<PlanPoint, 3>& a, const std::array<PlanPoint, 3>& b);

/// The corners of a triangle in plan, counter-clockwise (flat ones as they are).
std::array<PlanPoint, 3> plan_corners(const Mesh& mesh, const Triangle& triangle);
std::array<PlanPoint, 3> plan_corners(const PlanMesh& mesh, const Triangle& triangle);

/// Whether a triangle has no area in plan; exact.
bool is_flat(const std::array<PlanPoint, 3>& corners);

}  // namespace realmodel::fuzz
