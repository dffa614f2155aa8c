// SPDX-License-Identifier: GPL-3.0-or-later
// Rock masses as Python hands them over: lists of arrays.
#pragma once

#include <pybind11/stl.h>

#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "realmodel/strata/stack.hpp"

namespace realmodel::bindings {

using SurfaceArrays = std::pair<NumpyArray<double>, Indices>;

inline strata::Rule rule_of(const std::string& name) {
    if (const auto rule = strata::rule_named(name)) return *rule;
    throw pybind11::value_error("rules: there is no rule \"" + name + "\"");
}

/// (surfaces, region, base elevation, rules).
using RockArrays = std::tuple<std::vector<SurfaceArrays>, std::optional<SurfaceArrays>,
                              std::optional<double>, std::vector<std::string>>;

inline strata::StackInput view_of(const RockArrays& rock) {
    const auto& [surfaces, region, base_elevation, rules] = rock;
    strata::StackInput input;
    for (const auto& [vertices, triangles] : surfaces) {
        require_columns(vertices, 3, "vertices of a surface");
        require_columns(triangles, 3, "triangles of a surface");
        input.surfaces.push_back({view(vertices), view(triangles)});
    }
    if (region) {
        require_columns(region->first, 2, "vertices of the region");
        require_columns(region->second, 3, "triangles of the region");
        input.region = {view(region->first), view(region->second)};
    }
    input.base_elevation = base_elevation;
    for (const std::string& rule : rules)
        input.rules.push_back(rule_of(rule));
    if (!rules.empty() && rules.size() != surfaces.size()) {
        throw pybind11::value_error("rules: one for each surface, or none at all");
    }
    return input;
}

}  // namespace realmodel::bindings
