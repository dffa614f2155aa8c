// SPDX-License-Identifier: GPL-3.0-or-later
#include "volumes.hpp"

#include <algorithm>
#include <cmath>

#include "parallel_counts.hpp"

namespace realmodel::strata {

namespace {

/// Sum with a running correction (Knuth's exact sum of two doubles, added up).
struct Sum {
    double total = 0, correction = 0;
    void add(double value) {
        const double next = total + value;
        const double added = next - total;
        correction += (total - (next - added)) + (value - added);
        total = next;
    }
    double value() const { return total + correction; }
};

/// The area of a face in plan, and the volume between the face and the height of its first corner.
struct Projection {
    double area = 0, volume = 0;
};

Projection project(const CellComplex& complex, std::size_t face) {
    const auto corner = [&](std::int64_t i) -> const std::array<double, 3>& {
        return complex
            .vertices[static_cast<std::size_t>(complex.face_vertices[static_cast<std::size_t>(i)])];
    };
    const std::int64_t begin = complex.face_offsets[face], end = complex.face_offsets[face + 1];
    const auto corners = static_cast<std::int64_t>(complex.face_vertices.size());
    constexpr std::int64_t kAhead = 40;  // corners
    const auto& origin = corner(begin);
    Projection sum;
    const auto* last = &corner(begin + 1);
    double x = (*last)[0] - origin[0], y = (*last)[1] - origin[1], z = (*last)[2] - origin[2];
    for (std::int64_t i = begin + 2; i < end; ++i) {
        prefetch(&corner(std::min(i + kAhead, corners - 1)));
        const auto& next = corner(i);
        const double u = next[0] - origin[0], v = next[1] - origin[1], w = next[2] - origin[2];
        const double twice_area = x * v - u * y;
        sum.area += twice_area;
        sum.volume += twice_area * (z + w);
        x = u;
        y = v;
        z = w;
    }
    sum.area /= 2;
    sum.volume /= 6;
    return sum;
}

std::size_t block_of(const CellComplex& complex, std::int32_t cell) {
    return static_cast<std::size_t>(complex.cell_block[static_cast<std::size_t>(cell)]);
}

}  // namespace

// A face within a block adds to one cell what it takes from the other. Walls between blocks count
// too: the rounded corners of one are in line in plan only up to rounding. Heights are seen from
// one of the model's own, so terms err by no more than the rounding of its coordinates does.
std::vector<double> block_volumes(const CellComplex& complex, std::size_t blocks, int threads,
                                  const Progress* progress) {
    const double anchor = complex.vertices.empty() ? 0.0 : complex.vertices.front()[2];
    // Chunks depend on the input alone, and so do the sums.
    const std::size_t faces = complex.face_cells.size();
    const std::size_t chunk = std::max<std::size_t>(1 << 13, faces / 256 + 1);
    std::vector<std::vector<Sum>> sums((faces + chunk - 1) / chunk);
    parallel_ranges(faces, chunk, threads, progress, [&](std::size_t begin, std::size_t end) {
        auto& of_chunk = sums[begin / chunk];
        of_chunk.resize(blocks);
        for (std::size_t f = begin; f < end; ++f) {
            const auto [inside, outside] = complex.face_cells[f];
            if (outside >= 0 && block_of(complex, inside) == block_of(complex, outside)) continue;
            const Projection below = project(complex, f);
            const auto first = static_cast<std::size_t>(complex.face_offsets[f]);
            const double height =
                complex.vertices[static_cast<std::size_t>(complex.face_vertices[first])][2];
            const double volume = below.volume + below.area * (height - anchor);
            double sign = 1.0;
            for (const std::int32_t cell : complex.face_cells[f]) {
                if (cell >= 0) of_chunk[block_of(complex, cell)].add(sign * volume);
                sign = -sign;
            }
        }
    });
    std::vector<double> result;
    for (std::size_t b = 0; b < blocks; ++b) {
        Sum sum;
        for (const auto& of_chunk : sums) {
            sum.add(of_chunk[b].total);
            sum.add(of_chunk[b].correction);
        }
        result.push_back(sum.value());
    }
    return result;
}

}  // namespace realmodel::strata
