// SPDX-License-Identifier: GPL-3.0-or-later
#include "structures/merge_vertices.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "base/index.hpp"
#include "base/parallel_sort.hpp"
#include "base/vectors.hpp"

namespace realmodel::structures {

void merge_vertices(const VertexMerging& task, const Execution& execution) {
    if (const Device* const device = execution.device;
        device != nullptr && device->merge(device->state, task))
        return;
    const auto at = [&](std::int32_t v) { return task.vertices + 3 * index(v); };
    std::vector<std::pair<Vec3, std::int32_t>> order;
    std::vector<std::int32_t> number(task.vertex_count), shared;
    std::iota(number.begin(), number.end(), 0);
    for (const std::int32_t v : number) {
        if (task.is_shared[index(v)] == 0) continue;
        order.push_back({{at(v)[0], at(v)[1], at(v)[2]}, v});
        shared.push_back(v);
    }
    parallel_sort(order, std::less<>(), execution);
    auto next = shared.begin();
    for (std::size_t i = 0; i < order.size(); ++i) {
        if (i > 0 && order[i].first != order[i - 1].first) ++next;
        std::ranges::copy(order[i].first, at(*next));
        number[index(order[i].second)] = *next;
    }
    for (std::size_t corner = 0; corner < task.corner_count; ++corner)
        task.corners[corner] = number[index(task.corners[corner])];
}

}  // namespace realmodel::structures
