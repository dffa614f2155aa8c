// SPDX-License-Identifier: GPL-3.0-or-later
#include "volumes.hpp"

#include <cmath>

#include "parallel_chunks.hpp"

namespace realmodel::strata {

namespace {

using Vector = std::array<double, 3>;

Vector minus(const Vector& a, const Vector& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

double triple(const Vector& a, const Vector& b, const Vector& c) {
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Sum with a running correction (Neumaier 1974).
struct Sum {
    double total = 0, correction = 0;
    void add(double value) {
        const double next = total + value;
        correction +=
            std::abs(total) >= std::abs(value) ? (total - next) + value : (value - next) + total;
        total = next;
    }
    double value() const { return total + correction; }
};

}  // namespace

std::vector<double> block_volumes(const CellComplex& complex, std::size_t blocks,
                                  const Progress* progress) {
    std::vector<std::int32_t> anchor(complex.cell_block.size(), -1);
    const auto vertex = [&](std::int64_t corner) {
        return complex.face_vertices[static_cast<std::size_t>(corner)];
    };
    for (std::size_t f = 0; f < complex.face_cells.size(); ++f) {
        for (const std::int32_t cell : complex.face_cells[f]) {
            if (cell >= 0) anchor[static_cast<std::size_t>(cell)] = vertex(complex.face_offsets[f]);
        }
    }
    std::vector<double> volume(complex.cell_block.size(), 0.0);
    for (std::size_t f = 0; f < complex.face_cells.size(); ++f) {
        poll(progress, f);
        double sign = 1.0 / 6.0;
        for (const std::int32_t cell : complex.face_cells[f]) {
            if (cell >= 0) {
                const auto c = static_cast<std::size_t>(cell);
                const Vector& origin = complex.vertices[static_cast<std::size_t>(anchor[c])];
                const auto at = [&](std::int64_t corner) {
                    return minus(complex.vertices[static_cast<std::size_t>(vertex(corner))],
                                 origin);
                };
                const Vector first = at(complex.face_offsets[f]);
                for (auto i = complex.face_offsets[f] + 1; i + 1 < complex.face_offsets[f + 1];
                     ++i) {
                    volume[c] += sign * triple(first, at(i), at(i + 1));
                }
            }
            sign = -sign;
        }
    }
    std::vector<Sum> sums(blocks);
    for (std::size_t c = 0; c < volume.size(); ++c) {
        sums[static_cast<std::size_t>(complex.cell_block[c])].add(volume[c]);
    }
    std::vector<double> result;
    for (const Sum& sum : sums)
        result.push_back(sum.value());
    return result;
}

}  // namespace realmodel::strata
