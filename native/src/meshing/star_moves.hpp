// SPDX-License-Identifier: GPL-3.0-or-later
// Moves of one vertex to where its triangles are best.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "meshing/valences.hpp"

namespace realmodel::meshing {

/// Moves vertices, one at a time, by Newton's method to where the sum of the inverse mean ratios of
/// their triangles is least (Munson 2007, "Mesh shape-quality optimization using the inverse
/// mean-ratio metric"): within the star of a vertex this sum is convex. Some vertices are free,
/// some slide along a line, all others stay.
class StarMoves {
public:
    explicit StarMoves(Valences& valences)
        : valences_(valences), mesh_(valences.mesh()), kinds_(mesh_.points.size(), kStays) {}

    void free(std::int32_t vertex) { kinds_[vertex] = kIsFree; }
    bool moves_freely(std::int32_t vertex) const { return kinds_[vertex] == kIsFree; }
    /// Lets vertices slide between two ends.
    std::int32_t add_line(const PlanPoint& begin, const PlanPoint& end);
    void slide_on(std::int32_t vertex, std::int32_t line) { kinds_[vertex] = line; }
    bool slides(std::int32_t vertex) const { return kinds_[vertex] >= 0; }

    void move(std::int32_t vertex);

private:
    struct Shape;
    static constexpr std::int32_t kStays = -1, kIsFree = -2;

    void go_freely(std::int32_t vertex);
    void slide(std::int32_t vertex);
    Shape shape_of_star(std::int32_t vertex);
    Shape shape_at(const PlanPoint& place) const;
    template <class Place>
    void step(std::int32_t vertex, const Shape& now, double way, const Place& place_at);

    const Valences& valences_;
    FlatMesh& mesh_;
    std::vector<std::int32_t> kinds_;  ///< of each vertex: kStays, kIsFree or the line it slides on
    std::vector<std::array<PlanPoint, 2>> lines_;
    std::vector<std::array<std::int32_t, 2>> base_;  ///< the edges opposite to the vertex
};

}  // namespace realmodel::meshing
