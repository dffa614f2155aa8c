// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulation/narrow_strips.hpp"

#include <cstddef>

#include "base/index.hpp"

namespace realmodel::simulation {

namespace {

constexpr std::int32_t kMostSteps = 4;  ///< across edges, from columns of more elements

}  // namespace

std::vector<std::uint8_t> narrow_strips(const PlanTopology& plan, const ColumnFronts& columns) {
    const std::size_t count = plan.triangles();
    std::vector<std::int32_t> steps(count, -1);  // to columns of more elements
    std::vector<std::size_t> found;
    for (std::size_t t = 0; t < count; ++t) {
        if (columns.elements(t) < 2) continue;
        steps[t] = 0;
        found.push_back(t);
    }
    const auto for_neighbors = [&](std::size_t t, const auto& visit) {
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t n = plan.neighbor(t, i);
            if (n >= 0 && columns.elements(index(n)) == 1 && plan.rock(index(n)) == plan.rock(t))
                visit(index(n));
        }
    };
    for (std::size_t k = 0; k < found.size(); ++k) {
        for_neighbors(found[k], [&](std::size_t n) {
            if (steps[n] >= 0) return;
            steps[n] = steps[found[k]] + 1;
            found.push_back(n);
        });
    }
    std::vector<std::uint8_t> is_narrow(count, 0), is_seen(count, 0);
    for (std::size_t start = 0; start < count; ++start) {
        if (columns.elements(start) > 1) is_narrow[start] = 1;
        if (columns.elements(start) != 1 || is_seen[start] != 0) continue;
        std::vector<std::size_t> strip{start};
        is_seen[start] = 1;
        bool is_wide = false;
        for (std::size_t k = 0; k < strip.size(); ++k) {
            is_wide = is_wide || steps[strip[k]] < 0 || steps[strip[k]] > kMostSteps;
            for_neighbors(strip[k], [&](std::size_t n) {
                if (is_seen[n] != 0) return;
                is_seen[n] = 1;
                strip.push_back(n);
            });
        }
        for (const std::size_t t : strip)
            is_narrow[t] = is_wide ? 0 : 1;
    }
    return is_narrow;
}

}  // namespace realmodel::simulation
