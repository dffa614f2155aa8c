// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/dsi/spline_levels.hpp"

#include <algorithm>
#include <cmath>

#include "base/counting_sort.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kCoarsestCoefficients = 300;
// Of the mean roughness on the diagonal: what neither roughness nor constraints hold (outside the
// mesh, or a tilt of all) is held by this much, in the preconditioner only.
constexpr double kHeldSpline = 1e-10;

/// The splines on half a cell from those on the cell: row k gives the k-th on the half.
constexpr double kHalves[2][3][3] = {{{0.75, 0.25, 0}, {0.25, 0.75, 0}, {0, 0.75, 0.25}},
                                     {{0.25, 0.75, 0}, {0, 0.75, 0.25}, {0, 0.25, 0.75}}};

/// Adds S^T from S, S the splines on a quarter of a cell from those on the cell.
void add_quarter(SplineGrid::Element& to, const SplineGrid::Element& from, std::size_t quarter) {
    double s[9][9];
    for (std::size_t a = 0; a < 9; ++a) {
        for (std::size_t b = 0; b < 9; ++b)
            s[a][b] = kHalves[quarter % 2][a % 3][b % 3] * kHalves[quarter / 2][a / 3][b / 3];
    }
    double half[9][9] = {};
    for (std::size_t a = 0; a < 9; ++a) {
        for (std::size_t k = 0; k < 9; ++k) {
            for (std::size_t b = 0; b < 9; ++b)
                half[a][b] += from[9 * a + k] * s[k][b];
        }
    }
    for (std::size_t k = 0; k < 9; ++k) {
        for (std::size_t a = 0; a < 9; ++a) {
            for (std::size_t b = 0; b < 9; ++b)
                to[9 * a + b] += s[k][a] * half[k][b];
        }
    }
}

/// The coefficients of a grid as a matrix: (column, row).
auto coefficients_of(const SplineGrid& grid, Vector& values) {
    return Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
        values.data() + grid.number(0, 0), static_cast<Eigen::Index>(grid.columns() + 2),
        static_cast<Eigen::Index>(grid.rows() + 2),
        Eigen::OuterStride<>(static_cast<Eigen::Index>(grid.stride())));
}

double trace(const SplineGrid::Element& element) {
    double sum = 0;
    for (std::size_t k = 0; k < SplineGrid::kReach; ++k)
        sum += element[(SplineGrid::kReach + 1) * k];
    return sum;
}

}  // namespace

SplineLevels::SplineLevels(const SplineGrid& grid, std::span<const PlanPosition> nodes,
                           std::span<const Hinge> hinges, int threads,
                           const std::function<void()>& check)
    : threads_(threads), check_(check), rough_(grid.cells()) {
    // Hinges by cells, so that each cell sums its own in their order.
    const auto in_cell = bucketize<std::int32_t>(grid.cells(), [&](const auto& visit) {
        for (std::size_t h = 0; h < hinges.size(); ++h)
            visit(grid.cell_of(hinges[h].middle), static_cast<std::int32_t>(h));
    });
    check_();
    in_pieces(grid.cells(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            rough_[c].fill(0);
            for (const std::int32_t number : in_cell[c]) {
                const Hinge& h = hinges[number];
                add_square(rough_[c], grid.bends(h.middle, c, h.bending), 1);
            }
        }
    });
    levels_.emplace_back(grid);
    fill_border_cells(nodes, hinges);
    while (levels_.back().stencils.grid().coefficients() > kCoarsestCoefficients)
        levels_.emplace_back(levels_.back().stencils.grid().coarser());
    for (SplineLevel& level : levels_) {
        const std::size_t length = level.stencils.grid().length();
        level.smoother.resize(length);
        level.right.assign(length, 0.0);
        level.x.assign(length, 0.0);
    }
}

/// Cells that the border of the mesh cuts get the roughness of a whole one, as if the mesh
/// continued to their end: splines of which only a tip reaches the mesh would otherwise be nearly
/// free. (That is harmless: a smooth surface can be continued smoothly.)
void SplineLevels::fill_border_cells(std::span<const PlanPosition> nodes,
                                     std::span<const Hinge> hinges) {
    const SplineGrid& grid = levels_.front().stencils.grid();
    std::vector<char> touched(grid.cells(), 0);
    for (const PlanPosition& node : nodes)
        touched[grid.cell_of(node)] = 1;
    std::vector<double> traces;
    for (std::size_t c = 0; c < grid.cells(); ++c) {
        if (const double t = trace(rough_[c]); t > 0) traces.push_back(t);
    }
    if (traces.empty()) return;
    const auto middle = traces.begin() + static_cast<std::ptrdiff_t>(traces.size() / 2);
    std::nth_element(traces.begin(), middle, traces.end());
    // A whole cell: the mean bending of all hinges, at its quadrature points.
    SplineGrid::Element whole{};
    std::array<double, 3> size{};
    for (const Hinge& h : hinges) {
        for (std::size_t k = 0; k < 3; ++k)
            size[k] += h.bending[k] * h.bending[k];
    }
    const PlanPosition corner = grid.corner();
    constexpr std::array<double, 2> at{0.2113248654051871, 0.7886751345948129};  // Gauss
    for (const double u : at) {
        for (const double v : at) {
            const PlanPosition position{corner[0] + u * grid.cell(), corner[1] + v * grid.cell()};
            for (std::size_t k = 0; k < 3; ++k) {
                std::array<double, 3> bending{};
                bending[k] = 1;
                add_square(whole, grid.bends(position, 0, bending), size[k]);
            }
        }
    }
    const double scale = *middle / trace(whole);
    for (std::size_t c = 0; c < grid.cells(); ++c) {
        const double missing = 1 - trace(rough_[c]) / *middle;
        if (touched[c] == 0 || missing <= 0) continue;
        for (std::size_t k = 0; k < whole.size(); ++k)
            rough_[c][k] += missing * scale * whole[k];
    }
}

void SplineLevels::set_constraints(std::span<const WeightedPosition> constraints) {
    std::vector<SplineGrid::Element> elements = rough_;
    const SplineGrid& finest = levels_.front().stencils.grid();
    double whole = 0;
    for (const SplineGrid::Element& element : elements) {
        for (std::size_t k = 0; k < SplineGrid::kReach; ++k)
            whole += element[(SplineGrid::kReach + 1) * k];
    }
    for (const WeightedPosition& c : constraints) {
        const std::size_t cell = finest.cell_of(c.position);
        const bool is_rise = c.along != PlanPosition{};
        add_square(
            elements[cell],
            is_rise ? finest.rises(c.position, cell, c.along) : finest.values(c.position, cell),
            c.strength);
    }
    const double least =
        whole > 0 ? kHeldSpline * whole / static_cast<double>(finest.coefficients()) : 1.0;
    for (std::size_t at = 0; at < levels_.size(); ++at) {
        check_();
        if (at > 0) restrict_elements(elements, levels_[at - 1].stencils.grid());
        assemble(levels_[at], elements, least);
    }
    factor_coarsest(least);
}

/// Each cell of the coarser grid from its four: the same surface in the coarser splines.
void SplineLevels::restrict_elements(std::vector<SplineGrid::Element>& elements,
                                     const SplineGrid& fine) const {
    const SplineGrid coarse = fine.coarser();
    std::vector<SplineGrid::Element> out(coarse.cells());
    in_pieces(coarse.cells(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            out[c].fill(0);
            for (std::size_t quarter = 0; quarter < 4; ++quarter) {
                const std::size_t column = 2 * (c % coarse.columns()) + quarter % 2;
                const std::size_t row = 2 * (c / coarse.columns()) + quarter / 2;
                if (column >= fine.columns() || row >= fine.rows()) continue;
                add_quarter(out[c], elements[row * fine.columns() + column], quarter);
            }
        }
    });
    elements = std::move(out);
}

void SplineLevels::assemble(SplineLevel& level, const std::vector<SplineGrid::Element>& elements,
                            double least) {
    level.stencils.assemble(elements, least, threads_);
    const SplineGrid& grid = level.stencils.grid();
    Vector inverse_diagonal(grid.length(), 0.0);
    double bound = 1;
    for (std::size_t row = 0; row < grid.rows() + 2; ++row) {
        for (std::size_t column = 0; column < grid.columns() + 2; ++column) {
            const double inverse = 1 / level.stencils.entry(column, row, 12);
            double magnitude = 0;
            for (std::size_t k = 0; k < 25; ++k)
                magnitude += std::abs(level.stencils.entry(column, row, k));
            inverse_diagonal[grid.number(column, row)] = inverse;
            bound = std::max(bound, magnitude * inverse);
        }
    }
    const double largest =
        largest_eigenvalue(level.stencils, inverse_diagonal, bound, threads_of(grid));
    level.smoother.set(std::move(inverse_diagonal), largest);
}

/// Small grids are done before other threads have met.
int SplineLevels::threads_of(const SplineGrid& grid) const {
    return grid.coefficients() > 65536 ? threads_ : 1;
}

void SplineLevels::factor_coarsest(double least) {
    const SplineStencils& stencils = levels_.back().stencils;
    const auto width = static_cast<Eigen::Index>(stencils.grid().columns() + 2);
    const auto height = static_cast<Eigen::Index>(stencils.grid().rows() + 2);
    const Eigen::Index count = width * height;
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index a = 0; a < count; ++a) {
        for (Eigen::Index k = 0; k < 25; ++k) {
            const Eigen::Index column = a % width + k % 5 - 2, row = a / width + k / 5 - 2;
            if (column < 0 || row < 0 || column >= width || row >= height) continue;
            matrix(a, row * width + column) = stencils.entry(a % width, a / width, k);
        }
        matrix(a, a) += least;
    }
    coarsest_.compute(matrix);
}

/// x of a level from its right side.
void SplineLevels::cycle(std::size_t at) {
    check_();
    SplineLevel& level = levels_[at];
    if (at + 1 == levels_.size()) {
        const SplineGrid& grid = level.stencils.grid();
        const Eigen::MatrixXd right = coefficients_of(grid, level.right);
        const Eigen::VectorXd x = coarsest_.solve(right.reshaped());
        coefficients_of(grid, level.x) = x.reshaped(right.rows(), right.cols());
        return;
    }
    const int threads = threads_of(level.stencils.grid());
    level.smoother.pre_smooth(level.stencils, level.right, level.x, threads);
    const Vector& residual = level.smoother.residual();
    Vector& correction = level.smoother.correction();
    SplineLevel& coarse = levels_[at + 1];
    const SplineGrid &fine = level.stencils.grid(), &grid = coarse.stencils.grid();
    // A coarse coefficient from the fine ones 2 i - 2 .. 2 i + 1 along each axis; what lies beside
    // the grid is 0.
    constexpr std::array<double, 4> kMask{0.25, 0.75, 0.75, 0.25};
    for_rows(grid.rows() + 2, threads, [&](std::size_t row) {
        Vector line(fine.columns() + 8, 0.0);  // of fine columns from -2 on
        for (std::size_t j = 0; j < 4; ++j) {
            if (2 * row + j < 2 || 2 * row + j - 2 >= fine.rows() + 2) continue;
            const double* from = residual.data() + fine.number(0, 2 * row + j - 2);
            for (std::size_t i = 0; i < fine.columns() + 2; ++i)
                line[i + 2] += kMask[j] * from[i];
        }
        double* to = coarse.right.data() + grid.number(0, row);
        for (std::size_t column = 0; column < grid.columns() + 2; ++column) {
            const double* from = line.data() + 2 * column;
            to[column] =
                kMask[0] * from[0] + kMask[1] * from[1] + kMask[2] * from[2] + kMask[3] * from[3];
        }
    });
    cycle(at + 1);
    for_rows(fine.rows() + 2, threads, [&](std::size_t row) {
        const double y0 = row % 2 == 0 ? 0.75 : 0.25;
        const double* low = coarse.x.data() + grid.number(0, row / 2);
        const double* high = low + grid.stride();
        double* to = correction.data() + fine.number(0, row);
        for (std::size_t column = 0; column < fine.columns() + 2; ++column) {
            const double x0 = column % 2 == 0 ? 0.75 : 0.25;
            const std::size_t i = column / 2;
            to[column] = y0 * (x0 * low[i] + (1 - x0) * low[i + 1]) +
                         (1 - y0) * (x0 * high[i] + (1 - x0) * high[i + 1]);
        }
    });
    level.smoother.post_smooth(level.stencils, level.right, level.x, threads);
}

}  // namespace realmodel::interpolation
