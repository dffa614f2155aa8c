// SPDX-License-Identifier: GPL-3.0-or-later
// Vertices with equal positions become one: sorted by position, counted by a sum, renumbered.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/host_device.hpp"
#include "cpu_backend.hpp"
#include "realmodel/base/device.hpp"

namespace realmodel::cuda {

struct Vertex {
    double xyz[3];
};

REALMODEL_HOST_DEVICE inline bool equal(const Vertex& a, const Vertex& b) {
    return a.xyz[0] == b.xyz[0] && a.xyz[1] == b.xyz[1] && a.xyz[2] == b.xyz[2];
}

/// A whole number whose order is that of the number; both zeros alike.
REALMODEL_HOST_DEVICE inline std::uint64_t key_of(double number) {
    const double with_one_zero = number + 0.0;
    std::uint64_t bits = 0;
    memcpy(&bits, &with_one_zero, sizeof bits);
    constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
    return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

struct Count {  // from 0
    std::int32_t* numbers;
    REALMODEL_HOST_DEVICE void operator()(std::size_t i) const {
        numbers[i] = static_cast<std::int32_t>(i);
    }
};

struct KeysAlongAxis {
    const Vertex* vertices;
    const std::int32_t* order;
    int axis;
    std::uint64_t* keys;
    REALMODEL_HOST_DEVICE void operator()(std::size_t i) const {
        keys[i] = key_of(vertices[order[i]].xyz[axis]);
    }
};

/// 1 for the first vertex of each position in an order, else 0.
struct FirstOfPosition {
    const Vertex* vertices;
    const std::int32_t* order;
    std::int32_t* is_first;
    REALMODEL_HOST_DEVICE void operator()(std::size_t i) const {
        is_first[i] = i > 0 && equal(vertices[order[i]], vertices[order[i - 1]]) ? 0 : 1;
    }
};

/// Positions are numbered by the vertices, ascending: the first gets the least of their numbers.
struct NumberPositions {
    const Vertex* vertices;
    const std::int32_t *order, *rank, *shared;  // rank: positions up to each of the order
    std::int32_t* number;
    Vertex* merged;
    REALMODEL_HOST_DEVICE void operator()(std::size_t i) const {
        const std::int32_t position = rank[i] - 1;
        number[order[i]] = shared[position];
        if (i == 0 || rank[i - 1] <= position) merged[position] = vertices[order[i]];
    }
};

struct PutPositions {
    const Vertex* merged;
    const std::int32_t *shared, *positions;  // positions: how many
    Vertex* vertices;
    REALMODEL_HOST_DEVICE void operator()(std::size_t i) const {
        if (static_cast<std::int32_t>(i) < *positions) vertices[shared[i]] = merged[i];
    }
};

struct Renumber {
    const std::int32_t* number;
    std::int32_t* corners;
    REALMODEL_HOST_DEVICE void operator()(std::size_t i) const { corners[i] = number[corners[i]]; }
};

/// Sorts numbers of vertices by x, y and z; those of equal positions keep their order.
template <class Backend>
void sort_by_position(Backend& backend, const Vertex* vertices,
                      typename Backend::template Array<std::int32_t>& order) {
    typename Backend::template Array<std::uint64_t> keys(backend, order.size());
    for (const int axis : {2, 1, 0}) {
        backend.each(order.size(), KeysAlongAxis{vertices, order.data(), axis, keys.data()});
        backend.sort(keys, order);
    }
}

/// Makes one vertex of those with equal positions, in memory of the backend. shared: those that
/// are merged, ascending; order: the same, by position.
template <class Backend>
void merge_in_order(Backend& backend, Vertex* vertices, std::size_t vertex_count,
                    const std::int32_t* shared, const std::int32_t* order, std::size_t count,
                    std::int32_t* corners, std::size_t corner_count) {
    if (count == 0) return;
    typename Backend::template Array<std::int32_t> rank(backend, count);
    typename Backend::template Array<std::int32_t> number(backend, vertex_count);
    typename Backend::template Array<Vertex> merged(backend, count);
    backend.each(count, FirstOfPosition{vertices, order, rank.data()});
    backend.add_up(rank);
    backend.each(vertex_count, Count{number.data()});
    backend.each(
        count, NumberPositions{vertices, order, rank.data(), shared, number.data(), merged.data()});
    backend.each(count, PutPositions{merged.data(), shared, rank.data() + (count - 1), vertices});
    backend.each(corner_count, Renumber{number.data(), corners});
}

inline std::vector<std::int32_t> shared_of(const VertexMerging& task) {
    std::vector<std::int32_t> shared;
    for (std::size_t v = 0; v < task.vertex_count; ++v) {
        if (task.is_shared[v] != 0) shared.push_back(static_cast<std::int32_t>(v));
    }
    return shared;
}

/// All at once. Nothing is changed before all is done.
/// @throws OutOfDeviceMemory
template <class Backend>
void merge_at_once(Backend& backend, const VertexMerging& task,
                   const std::vector<std::int32_t>& shared) {
    using Numbers = typename Backend::template Array<std::int32_t>;
    auto* const host = reinterpret_cast<Vertex*>(task.vertices);
    typename Backend::template Array<Vertex> vertices(backend, task.vertex_count);
    Numbers ascending(backend, shared.size()), order(backend, shared.size());
    Numbers corners(backend, task.corner_count);
    backend.upload(vertices, static_cast<const Vertex*>(host));
    backend.upload(ascending, shared.data());
    backend.upload(order, shared.data());
    sort_by_position(backend, vertices.data(), order);
    backend.upload(corners, static_cast<const std::int32_t*>(task.corners));
    merge_in_order(backend, vertices.data(), vertices.size(), ascending.data(), order.data(),
                   order.size(), corners.data(), corners.size());
    backend.download(host, vertices);
    backend.download(task.corners, corners);
}

/// Some vertices at a time are sorted on the device; the sorted tiles are merged here. The order is
/// total, so that the tiles do not matter.
/// @throws OutOfDeviceMemory
template <class Backend>
void merge_in_tiles(Backend& backend, const VertexMerging& task,
                    const std::vector<std::int32_t>& shared, std::size_t tile) {
    auto* const all = reinterpret_cast<Vertex*>(task.vertices);
    std::vector<std::int32_t> order(shared.size());
    std::vector<Vertex> some;
    for (std::size_t begin = 0; begin < shared.size(); begin += tile) {
        some.clear();
        for (std::size_t i = begin; i < std::min(begin + tile, shared.size()); ++i)
            some.push_back(all[shared[i]]);
        typename Backend::template Array<Vertex> vertices(backend, some.size());
        typename Backend::template Array<std::int32_t> in_tile(backend, some.size());
        backend.upload(vertices, static_cast<const Vertex*>(some.data()));
        backend.each(some.size(), Count{in_tile.data()});
        sort_by_position(backend, vertices.data(), in_tile);
        backend.download(order.data() + begin, in_tile);
        for (std::size_t i = begin; i < begin + some.size(); ++i)
            order[i] = shared[begin + static_cast<std::size_t>(order[i])];
    }
    const auto before = [all](std::int32_t a, std::int32_t b) {
        for (int axis = 0; axis < 3; ++axis) {
            const double p = all[a].xyz[axis], q = all[b].xyz[axis];
            if (p != q) return p < q;
        }
        return a < b;
    };
    const auto at = [&order](std::size_t i) {
        return order.begin() + static_cast<std::ptrdiff_t>(std::min(i, order.size()));
    };
    for (std::size_t width = tile; width < order.size(); width *= 2) {
        for (std::size_t begin = 0; begin < order.size(); begin += 2 * width)
            std::inplace_merge(at(begin), at(begin + width), at(begin + 2 * width), before);
    }
    CpuBackend cpu;
    merge_in_order(cpu, all, task.vertex_count, shared.data(), order.data(), order.size(),
                   task.corners, task.corner_count);
}

}  // namespace realmodel::cuda
