// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/cells/volumes.hpp"

#include <algorithm>
#include <cmath>

#include "base/checked_indices.hpp"
#include "base/floating_point.hpp"
#include "base/index.hpp"
#include "base/parallel.hpp"
#include "base/parallel_counts.hpp"
#include "base/vectors.hpp"
#include "realmodel/strata/cell_volumes.hpp"

namespace realmodel::strata {

namespace {

/// The area of a face in plan, and the volume between the face and the height of its first corner.
struct FaceProjection {
    double area = 0, volume = 0;
};

FaceProjection project(const CellComplex& complex, std::size_t face,
                       std::span<const PlanOffset> offsets) {
    const auto corner = [&](std::int64_t i) -> const std::array<double, 3>& {
        return complex
            .vertices[static_cast<std::size_t>(complex.face_vertices[static_cast<std::size_t>(i)])];
    };
    const std::int64_t begin = complex.face_offsets[face], end = complex.face_offsets[face + 1];
    const auto corners = static_cast<std::int64_t>(complex.face_vertices.size());
    constexpr std::int64_t kAhead = 40;  // corners
    for (std::int64_t i = begin + kAhead; i < std::min(end + kAhead, corners); ++i)
        prefetch(&corner(i));
    const auto offset = [&](std::int64_t i) {
        const auto v = static_cast<std::size_t>(complex.face_vertices[static_cast<std::size_t>(i)]);
        return v < offsets.size() ? offsets[v] : PlanOffset{0, 0};
    };
    const auto& origin = corner(begin);
    const PlanOffset off = offset(begin);
    const auto from_origin = [&](std::int64_t i) {
        const auto& at = corner(i);
        const PlanOffset moved = offset(i);
        return std::array{at[0] - origin[0] + (moved[0] - off[0]),
                          at[1] - origin[1] + (moved[1] - off[1]), at[2] - origin[2]};
    };
    FaceProjection sum;
    auto [x, y, z] = from_origin(begin + 1);
    for (std::int64_t i = begin + 2; i < end; ++i) {
        const auto [u, v, w] = from_origin(i);
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

/// What some faces of a block add up to, seen from the height of the one that is largest in plan:
/// terms are then no larger than the block is high, at whatever elevation it lies, and what
/// rounding leaves of the areas of long faces is not multiplied by the height of a spike.
struct BlockSum {
    double anchor = 0, largest = -1;  // of no face yet
    CorrectedSum volume, area;

    void add(const FaceProjection& face, double height, double sign) {
        see_from(height, std::abs(face.area));
        volume.add(sign * (face.volume + face.area * (height - anchor)));
        area.add(sign * face.area);
    }
    void add(const BlockSum& other) {
        if (other.largest < 0) return;
        see_from(other.anchor, other.largest);
        for (const double term : {other.volume.total, other.volume.correction,
                                  other.area.value() * (other.anchor - anchor)})
            volume.add(term);
        area.add(other.area.value());
    }

private:
    void see_from(double height, double size) {
        if (size <= largest) return;
        volume.add(area.value() * (anchor - height));
        anchor = height;
        largest = size;
    }
};

}  // namespace

// A face within a block adds to one cell what it takes from the other. Walls between blocks count
// too: the rounded corners of one are in line in plan only up to rounding.
std::vector<double> block_volumes(const CellComplex& complex, std::size_t blocks,
                                  const Execution& execution, std::span<const PlanOffset> offsets) {
    const auto block_of = [&](std::int32_t cell) {
        return static_cast<std::size_t>(complex.cell_block[static_cast<std::size_t>(cell)]);
    };
    // Chunks depend on the input alone, and so do the sums.
    const std::size_t faces = complex.face_cells.size();
    const std::size_t chunk = std::max<std::size_t>(1 << 13, faces / 256 + 1);
    std::vector<std::vector<BlockSum>> sums((faces + chunk - 1) / chunk);
    parallel_ranges(faces, chunk, execution, [&](std::size_t begin, std::size_t end) {
        auto& of_chunk = sums[begin / chunk];
        of_chunk.resize(blocks);
        for (std::size_t f = begin; f < end; ++f) {
            const auto [inside, outside] = complex.face_cells[f];
            if (outside >= 0 && block_of(inside) == block_of(outside)) continue;
            const FaceProjection below = project(complex, f, offsets);
            const auto first = static_cast<std::size_t>(complex.face_offsets[f]);
            const double height =
                complex.vertices[static_cast<std::size_t>(complex.face_vertices[first])][2];
            of_chunk[block_of(inside)].add(below, height, 1.0);
            if (outside >= 0) of_chunk[block_of(outside)].add(below, height, -1.0);
        }
    });
    std::vector<double> result;
    for (std::size_t b = 0; b < blocks; ++b) {
        BlockSum sum;
        for (const auto& of_chunk : sums)
            sum.add(of_chunk[b]);
        result.push_back(sum.volume.value());
    }
    return result;
}

std::vector<double> cell_volumes(std::span<const Vec3> vertices,
                                 std::span<const std::int64_t> face_offsets,
                                 std::span<const std::int32_t> face_vertices,
                                 std::span<const std::array<std::int32_t, 2>> face_cells,
                                 std::size_t cells, const Execution& execution) {
    const std::size_t faces = face_cells.size();
    if (face_offsets.size() != faces + 1)
        refuse_index("face", faces, "has no offset, or one too many");
    const auto loop_of = [&](std::size_t f) {
        return checked_corners("face", f, face_offsets, face_vertices, 1);
    };
    std::vector<std::int32_t> origin(cells, -1);  // a corner of each cell
    for (std::size_t f = 0; f < faces; ++f) {
        poll(execution.progress, f);
        const auto loop = loop_of(f);
        require_vertices("face", f, loop, vertices.size());
        require_cells(f, face_cells[f], cells);
        for (const std::int32_t cell : face_cells[f]) {
            if (cell >= 0 && origin[static_cast<std::size_t>(cell)] < 0)
                origin[static_cast<std::size_t>(cell)] = loop[0];
        }
    }
    // the shares of the faces on several threads; then in order, so that sums do not depend on them
    std::vector<std::array<double, 2>> share(faces);
    parallel_for_each(faces, execution, [&](std::size_t f) {
        const auto loop = loop_of(f);
        const auto at = [&](std::size_t i) -> const Vec3& { return vertices[index(loop[i])]; };
        const Vec3 area = polygon_normal(loop.size(), at);  // twice as long
        for (std::size_t side = 0; side < 2; ++side) {
            const std::int32_t cell = face_cells[f][side];
            if (cell < 0) continue;
            const Vec3& o = vertices[index(origin[index(cell)])];
            const double volume = dot(minus(at(0), o), area) / 6;
            share[f][side] = side == 0 ? volume : -volume;
        }
    });
    std::vector<double> volume(cells, 0.0);
    for (std::size_t f = 0; f < faces; ++f) {
        poll(execution.progress, f);
        for (std::size_t side = 0; side < 2; ++side) {
            const std::int32_t cell = face_cells[f][side];
            if (cell >= 0) volume[static_cast<std::size_t>(cell)] += share[f][side];
        }
    }
    return volume;
}

}  // namespace realmodel::strata
