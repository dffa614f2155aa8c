// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <initializer_list>
#include <vector>

#include "arrangement/polygons.hpp"

namespace realmodel {

using NodeLoop = std::vector<arrangement::NodeId>;

/// A loop from its least node on, so that those that differ in their beginning only are equal.
template <class Nodes>
NodeLoop from_least(const Nodes& nodes) {
    NodeLoop loop(nodes.begin(), nodes.end());
    std::rotate(loop.begin(), std::min_element(loop.begin(), loop.end()), loop.end());
    return loop;
}

inline NodeLoop node_loop(std::initializer_list<int> numbers) {
    NodeLoop loop;
    for (const int number : numbers)
        loop.push_back(arrangement::NodeId{number});
    return from_least(loop);
}

/// All of some polygons, each from its least node on, in their order.
inline std::vector<NodeLoop> loops_of(const arrangement::Polygons& polygons) {
    std::vector<NodeLoop> loops;
    for (std::size_t p = 0; p < polygons.size(); ++p)
        loops.push_back(from_least(polygons[p]));
    return loops;
}

}  // namespace realmodel
