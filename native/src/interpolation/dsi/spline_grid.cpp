// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/spline_grid.hpp"

#include <algorithm>
#include <cmath>

#include "base/counting_sort.hpp"
#include "base/vectors.hpp"

namespace realmodel::interpolation {

namespace {

using Weights3 = std::array<double, 3>;

Weights3 slope(double u) {
    return {u - 1, 1 - 2 * u, u};
}
constexpr Weights3 kCurvature{1, -2, 1};

SplineGrid::SplineWeights product(const Weights3& x, const Weights3& y, double scale) {
    SplineGrid::SplineWeights out{};
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i)
            out[3 * j + i] = scale * x[i] * y[j];
    }
    return out;
}

}  // namespace

SplineGrid::SplineGrid(const PlanPosition& low, double cell, std::size_t columns, std::size_t rows)
    : low_(low), cell_(cell), inverse_cell_(1 / cell), columns_(columns), rows_(rows) {}

SplineGrid SplineGrid::coarser() const {
    return {low_, 2 * cell_, (columns_ + 1) / 2, (rows_ + 1) / 2};
}

std::size_t SplineGrid::cell_of(const PlanPosition& position) const {
    const auto along = [&](int axis, std::size_t count) {
        const double at = (position[axis] - low_[axis]) / cell_;
        return at > 0 ? std::min(static_cast<std::size_t>(at), count - 1) : 0;
    };
    return along(1, rows_) * columns_ + along(0, columns_);
}

SplineGrid::SplineWeights SplineGrid::values(const PlanPosition& position, std::size_t cell) const {
    const auto [x, y] = values_along(position, cell % columns_, cell / columns_);
    return product(x, y, 1);
}

SplineGrid::SplineWeights SplineGrid::rises(const PlanPosition& position, std::size_t cell,
                                            const PlanPosition& along_vector) const {
    const double u = (position[0] - low_[0]) / cell_ - static_cast<double>(cell % columns_);
    const double v = (position[1] - low_[1]) / cell_ - static_cast<double>(cell / columns_);
    const SplineWeights x = product(slope(u), along(v), along_vector[0] / cell_);
    const SplineWeights y = product(along(u), slope(v), along_vector[1] / cell_);
    SplineWeights out{};
    for (std::size_t k = 0; k < kReach; ++k)
        out[k] = x[k] + y[k];
    return out;
}

SplineGrid::SplineWeights SplineGrid::bends(const PlanPosition& position, std::size_t cell,
                                            const std::array<double, 3>& bending) const {
    const double u = (position[0] - low_[0]) / cell_ - static_cast<double>(cell % columns_);
    const double v = (position[1] - low_[1]) / cell_ - static_cast<double>(cell / columns_);
    const double scale = 1 / (cell_ * cell_);
    const SplineWeights xx = product(kCurvature, along(v), scale * bending[0]);
    const SplineWeights xy = product(slope(u), slope(v), scale * bending[1]);
    const SplineWeights yy = product(along(u), kCurvature, scale * bending[2]);
    SplineWeights out{};
    for (std::size_t k = 0; k < kReach; ++k)
        out[k] = xx[k] + xy[k] + yy[k];
    return out;
}

void add_square(SplineGrid::Element& element, const SplineGrid::SplineWeights& weights,
                double strength) {
    for (std::size_t a = 0; a < SplineGrid::kReach; ++a) {
        const double scaled = strength * weights[a];
        for (std::size_t b = 0; b < SplineGrid::kReach; ++b)
            element[SplineGrid::kReach * a + b] += scaled * weights[b];
    }
}

SplineStencils::SplineStencils(const SplineGrid& grid)
    : grid_(grid),
      width_(grid.columns() + 2),
      height_(grid.rows() + 2),
      ranges_in_row_((width_ + kMostRows - 1) / kMostRows),
      entries_(25 * width_ * height_) {
    // Two rows, and two columns, up and down.
    std::vector<WavefrontSweep::Reach> reach;
    const auto ranges_in_row = static_cast<std::ptrdiff_t>(ranges_in_row_);
    const auto pieces = static_cast<std::ptrdiff_t>(ranges_in_row_ * height_);
    for (std::ptrdiff_t piece = 0; piece < pieces; ++piece) {
        reach.emplace_back(std::max<std::ptrdiff_t>(0, piece - 2 * ranges_in_row - 1),
                           std::min(pieces - 1, piece + 2 * ranges_in_row + 1));
    }
    sweep_ = WavefrontSweep(std::move(reach));
}

std::array<std::size_t, 2> SplineStencils::rows(std::ptrdiff_t piece) const {
    const auto number = static_cast<std::size_t>(piece);
    const std::size_t column = number % ranges_in_row_ * kMostRows, row = number / ranges_in_row_;
    return {grid_.number(column, row), grid_.number(std::min(column + kMostRows, width_), row)};
}

void SplineStencils::times(std::ptrdiff_t piece, const double* x, double* out) const {
    const auto number = static_cast<std::size_t>(piece);
    const std::size_t column = number % ranges_in_row_ * kMostRows, row = number / ranges_in_row_;
    const std::size_t count = std::min(kMostRows, width_ - column), stride = grid_.stride();
    std::fill(out, out + count, 0.0);
    const double* entries = entries_.data() + 25 * row * width_ + column;
    const double* at = x + grid_.number(column, row) - 2 * stride - 2;
    for (std::size_t line = 0; line < 5; ++line, entries += 5 * width_, at += stride) {
        const double *a = entries, *b = a + width_, *c = b + width_, *d = c + width_,
                     *e = d + width_;
#pragma omp simd
        for (std::size_t i = 0; i < count; ++i) {
            out[i] += a[i] * at[i] + b[i] * at[i + 1] + c[i] * at[i + 2] + d[i] * at[i + 3] +
                      e[i] * at[i + 4];
        }
    }
}

void SplineStencils::assemble(std::span<const SplineGrid::Element> elements, double least,
                              int threads) {
    const std::size_t columns = grid_.columns(), rows = grid_.rows();
    for_rows(height_, threads, [&](std::size_t row) {
        double* const entries = entries_.data() + 25 * row * width_;
        std::fill(entries, entries + 25 * width_, 0.0);
        for (std::size_t a = 0; a < 9; ++a) {  // as the a-th of a cell's
            if (row < a / 3 || row - a / 3 >= rows) continue;
            const SplineGrid::Element* cells = elements.data() + (row - a / 3) * columns;
            for (std::size_t b = 0; b < 9; ++b) {
                double* to = entries + (5 * (2 + b / 3 - a / 3) + 2 + b % 3 - a % 3) * width_;
                for (std::size_t cell = 0; cell < columns; ++cell)
                    to[cell + a % 3] += cells[cell][9 * a + b];
            }
        }
        for (std::size_t column = 0; column < width_; ++column)
            entries[12 * width_ + column] += least;
    });
}

namespace {

constexpr double kCellInEdges = 2;

double mean_edge(std::span<const PlanPosition> nodes,
                 std::span<const OrderedMesh::Triangle> triangles) {
    double sum = 0;
    for (const auto& t : triangles) {
        for (std::size_t k = 0; k < 3; ++k) {
            sum += distance(nodes[t[k]], nodes[t[(k + 1) % 3]]);
        }
    }
    const double mean = sum / (3 * static_cast<double>(triangles.size()));
    return mean > 0 ? mean : 1;
}

}  // namespace

OrderedMesh ordered_mesh(std::span<const PlanPosition> nodes,
                         std::span<const OrderedMesh::Triangle> triangles) {
    const spatial::PlanBox box = spatial::box_around(nodes);
    const double unit = mean_edge(nodes, triangles);
    const double width = box.width() / unit, height = box.height() / unit;
    const auto count = static_cast<double>(nodes.size());
    // No more cells than nodes, where the region fills little of its box.
    const double cell = std::max(
        {kCellInEdges, std::sqrt(width * height / count), std::max(width, height) / count});
    const auto cells = [&](double length) {
        return std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil(length / cell)));
    };
    const SplineGrid grid({0, 0}, cell, cells(width), cells(height));
    const auto to_mesh = [&](const PlanPosition& p) {
        return PlanPosition{(p[0] - box.low_x) / unit, (p[1] - box.low_y) / unit};
    };
    const auto by_cell = bucketize<std::int32_t>(grid.cells(), [&](const auto& visit) {
        for (std::size_t i = 0; i < nodes.size(); ++i)
            visit(grid.cell_of(to_mesh(nodes[i])), static_cast<std::int32_t>(i));
    });
    OrderedMesh mesh{grid,
                     {by_cell.offsets.begin(), by_cell.offsets.end()},
                     {by_cell.values.begin(), by_cell.values.end()},
                     {},
                     {},
                     {}};
    mesh.new_number.resize(nodes.size());
    for (const std::int32_t old : mesh.old_number) {
        mesh.new_number[old] = static_cast<std::int32_t>(mesh.nodes.size());
        mesh.nodes.push_back(to_mesh(nodes[old]));
    }
    for (const auto& t : triangles) {
        mesh.triangles.push_back(
            {mesh.new_number[t[0]], mesh.new_number[t[1]], mesh.new_number[t[2]]});
    }
    return mesh;
}

}  // namespace realmodel::interpolation
