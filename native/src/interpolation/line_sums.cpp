// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/line_sums.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "interpolation/data_points.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kNodesAtOnce = 1024;  // with one line's samples they fit the nearest cache

void check(const Lines& lines) {
    const std::size_t count = lines.directions.size();
    if (count == 0 || lines.starts.size() != count || lines.values.size() % count != 0 ||
        lines.values.size() < 2 * count)
        throw InputError("option", "each line needs a direction, a start and two samples or more");
    if (!(lines.step > 0) || !std::isfinite(lines.step) || !std::isfinite(1 / lines.step))
        throw InputError("option", "the step between samples must be positive");
}

}  // namespace

std::vector<double> line_sums(std::span<const std::array<double, 2>> nodes, const Lines& lines,
                              const Execution& execution) {
    check(lines);
    require_finite_nodes(nodes);
    const std::size_t samples = lines.values.size() / lines.directions.size();
    const double last = static_cast<double>(samples - 1), steps = 1 / lines.step;
    const auto last_cell = static_cast<std::int64_t>(samples - 2);
    std::vector<double> sums(nodes.size());
    const NodeLoop loop{nodes.size(), kNodesAtOnce, execution, "simulating heights"};
    loop.over_chunks([] { return 0; },
                     [&](int, std::size_t begin, std::size_t end) {
                         for (std::size_t l = 0; l < lines.directions.size(); ++l) {
                             if (cancelled(execution.progress)) return;
                             const auto [x, y] = lines.directions[l];
                             const double* line = lines.values.data() + l * samples;
                             const double start = lines.starts[l];
                             for (std::size_t i = begin; i < end; ++i) {
                                 const double along = nodes[i][0] * x + nodes[i][1] * y;
                                 const double at = std::clamp((along - start) * steps, 0.0, last);
                                 const auto k = std::min(static_cast<std::int64_t>(at), last_cell);
                                 const double share = at - static_cast<double>(k);
                                 sums[i] += line[k] + share * (line[k + 1] - line[k]);
                             }
                         }
                     });
    return sums;
}

}  // namespace realmodel::interpolation
