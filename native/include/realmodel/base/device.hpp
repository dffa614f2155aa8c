// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>

namespace realmodel {

namespace interpolation {
struct CovarianceStructure;
}

/// Vertices of which those that are marked and have equal positions become one.
struct VertexMerging {
    double* vertices;  ///< x, y, z of each; no -0
    std::size_t vertex_count;
    const std::uint8_t* is_shared;  ///< of each vertex, 0 or 1
    std::int32_t* corners;          ///< vertices of faces, which get the new numbers
    std::size_t corner_count;
};

/// Nodes, each with its nearest points: ordinary kriging of each from these.
struct KrigingSystems {
    const double* points;  ///< x, y of each, relative to one origin
    const double* values;
    std::size_t point_count;
    const interpolation::CovarianceStructure* structures;
    std::size_t structure_count;
    const double* nodes;  ///< x, y of each
    std::size_t node_count;
    const std::int32_t* neighbors;  ///< of each node so many points, nearest first
    std::size_t neighbor_count;
    bool takes_points;  ///< a node on its nearest point gets its value, with variance 0
    double* estimates;  ///< out: of each node the value, and the variance in units of the sill
};

/// What a device (a GPU) computes instead of threads, with the same bytes. Plain functions, because
/// another module has them (native/cuda). Each returns whether it did it; where it did not,
/// vertices and corners are as they were, estimates mean nothing, and the caller computes them. Any
/// thread may call them.
struct Device {
    static constexpr std::uint32_t kLayout = 1;        ///< of the structures in this header
    static constexpr std::size_t kMostNeighbors = 96;  ///< whose system is in 48 KB

    std::uint32_t layout;
    void* state;  ///< the first argument of the functions
    bool (*merge)(void* state, const VertexMerging&);
    bool (*krige)(void* state, const KrigingSystems&);
};

}  // namespace realmodel
