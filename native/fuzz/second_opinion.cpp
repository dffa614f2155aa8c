// SPDX-License-Identifier: GPL-3.0-or-later
#include "second_opinion.hpp"

#include <limits>

#include "realmodel/validation/sampling.hpp"
#include "realmodel/validation/topology.hpp"

namespace realmodel::fuzz {

std::vector<Defect> second_opinion(const strata::CellComplex& complex, const StackCase& stack) {
    std::vector<double> base;
    for (const RockCase& rock : stack.rocks) {
        base.insert(base.end(), rock.surfaces.size(),
                    rock.base_elevation.value_or(std::numeric_limits<double>::quiet_NaN()));
    }
    ComplexView view = complex;
    view.block_base = base;
    std::vector<Defect> defects;
    const auto add = [&](const std::vector<validation::TestResult>& tests) {
        for (const validation::TestResult& test : tests) {
            if (!test.findings.passed())
                defects.push_back({"validation " + test.name, test.findings.first[0].text});
        }
    };
    add(validation::check_topology(view, {1, nullptr}));
    // where borders were joined the model is that of an input that differs by rounding
    if (!defects.empty() || were_borders_joined(complex)) return defects;
    std::vector<std::int32_t> block_of_surface;
    for (const RockCase& rock : stack.rocks) {
        for (std::size_t k = 0; k < rock.surfaces.size(); ++k) {
            const auto surface = static_cast<std::int32_t>(block_of_surface.size());
            block_of_surface.push_back(k > 0 || rock.base_elevation ? surface : -1);
        }
    }
    constexpr std::int64_t kPlaces = 150;
    const std::vector<strata::StackInput> rocks = views_of(stack);
    add(validation::check_samples(view, {rocks, block_of_surface}, kPlaces, 1, {1, nullptr}));
    return defects;
}

}  // namespace realmodel::fuzz
