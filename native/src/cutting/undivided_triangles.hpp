// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "base/counting_sort.hpp"
#include "cutting/cutter_surface.hpp"
#include "spatial/box_tree.hpp"

namespace realmodel::cutting {

/// Triangles of a surface that no face of a model comes near, and that meet other triangles only at
/// corners and edges that they share: nothing divides them. Those that are connected by edges make
/// a component, on each side of which the same is everywhere. Each component has an edge at a
/// triangle that is none of them, which stands for all of it.
class UndividedTriangles {
public:
    UndividedTriangles() = default;
    /// @param tree   of boxes around the triangles
    /// @param meets   of triangles: 1 where a face may be near
    /// @param groups  of triangles: those of a component are of one
    UndividedTriangles(const CutterSurface& surface, const spatial::BoxTree& tree,
                       std::vector<std::uint8_t> meets, std::span<const std::int32_t> groups,
                       const Execution& execution);

    bool has(std::int32_t triangle) const { return component(triangle) >= 0; }
    /// The component of a triangle, -1 none.
    std::int32_t component(std::int32_t triangle) const {
        return component_.empty() ? -1 : component_[index(triangle)];
    }
    /// Those of a component, in order.
    std::span<const std::int32_t> triangles(std::size_t component) const {
        return triangles_[component];
    }
    std::size_t components() const { return triangles_.size(); }

    /// An edge between a triangle of a component and one that is none, as the former runs.
    struct Border {
        std::int32_t triangle, neighbor;
        std::array<std::int32_t, 2> edge;
    };
    std::span<const Border> borders(std::size_t component) const { return borders_[component]; }

private:
    std::vector<std::int32_t> component_;  ///< of triangles, -1 none
    Buckets<std::int32_t> triangles_;      ///< of components
    Buckets<Border> borders_;              ///< likewise
};

/// Whether two triangles, by vertices of a surface, surely have nothing in common beside corners
/// and the edge that they share. What doubles do not tell is not sure.
bool are_surely_apart(const CutterSurface& surface, const std::array<std::int32_t, 3>& one,
                      const std::array<std::int32_t, 3>& other);

}  // namespace realmodel::cutting
