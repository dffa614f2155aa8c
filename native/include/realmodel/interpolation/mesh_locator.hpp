// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace realmodel {
class Progress;
}

namespace realmodel::interpolation {

/// Finds the triangle of a planar mesh that a place lies in: triangles are kept by the cells of a
/// grid. Exact; a place on several triangles gets the one with the least number.
class MeshLocator {
public:
    using Place = std::array<double, 2>;
    using Triangle = std::array<std::int32_t, 3>;

    /// A place in a triangle: weights of its corners, not negative, of sum 1.
    struct Found {
        std::int32_t triangle;
        std::array<double, 3> weights;
    };

    /// The vertices and triangles must outlive this and stay as they are. Triangles may turn either
    /// way; those without area in plan hold no place.
    /// Throws InputError of kind "not_finite" (items: the vertex), "bad_index" (items: the
    /// triangle).
    MeshLocator(std::span<const Place> vertices, std::span<const Triangle> triangles);

    std::optional<Found> find(const Place& place) const;

private:
    std::size_t cell(double coordinate, int axis) const;

    std::span<const Place> vertices_;
    std::span<const Triangle> triangles_;
    Place low_{}, high_{}, step_{1, 1};
    std::array<std::size_t, 2> cells_{1, 1};
    std::vector<std::size_t> first_;  // of each cell in held_, and one more
    std::vector<std::int32_t> held_;
};

/// Heights of a triangulated surface at places in plan, linear in each triangle; NaN where it has
/// none.
///
/// @param vertices   x, y, z
/// @param triangles  vertex numbers
/// Throws InputError as MeshLocator, and "not_finite" for nodes; Cancelled.
std::vector<double> heights_on_surface(std::span<const std::array<double, 3>> vertices,
                                       std::span<const std::array<std::int32_t, 3>> triangles,
                                       std::span<const std::array<double, 2>> nodes, int threads,
                                       Progress* progress = nullptr);

}  // namespace realmodel::interpolation
