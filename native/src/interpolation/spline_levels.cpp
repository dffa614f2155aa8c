// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/spline_levels.hpp"

#include <algorithm>
#include <cmath>

namespace realmodel::interpolation {

namespace {

constexpr std::size_t coarsest_coefficients = 300;
constexpr int smoothing_degree = 3;
// Of the mean roughness on the diagonal: what no roughness and no pull holds (outside the mesh, or
// a tilt of all) is held by this much, in the preconditioner only.
constexpr double held = 1e-10;

using Weights3 = std::array<double, 3>;

Weights3 spline(double u) {
    return {0.5 * (1 - u) * (1 - u), 0.5 + u * (1 - u), 0.5 * u * u};
}
Weights3 slope(double u) {
    return {u - 1, 1 - 2 * u, u};
}
constexpr Weights3 curvature{1, -2, 1};

/// The splines on half a cell from those on the cell: row k gives the k-th on the half.
constexpr double halves[2][3][3] = {{{0.75, 0.25, 0}, {0.25, 0.75, 0}, {0, 0.75, 0.25}},
                                    {{0.25, 0.75, 0}, {0, 0.75, 0.25}, {0, 0.25, 0.75}}};

SplineGrid::Weights product(const Weights3& x, const Weights3& y, double scale) {
    SplineGrid::Weights out{};
    for (std::size_t j = 0; j < 3; ++j) {
        for (std::size_t i = 0; i < 3; ++i)
            out[3 * j + i] = scale * x[i] * y[j];
    }
    return out;
}

}  // namespace

SplineGrid::SplineGrid(const Place& low, double cell, std::size_t columns, std::size_t rows)
    : low_(low), cell_(cell), columns_(columns), rows_(rows) {}

SplineGrid SplineGrid::coarser() const {
    return {low_, 2 * cell_, (columns_ + 1) / 2, (rows_ + 1) / 2};
}

std::size_t SplineGrid::cell_of(const Place& place) const {
    const auto along = [&](int axis, std::size_t count) {
        const double at = (place[axis] - low_[axis]) / cell_;
        return at > 0 ? std::min(static_cast<std::size_t>(at), count - 1) : 0;
    };
    return along(1, rows_) * columns_ + along(0, columns_);
}

SplineGrid::Weights SplineGrid::values(const Place& place, std::size_t cell) const {
    const double u = (place[0] - low_[0]) / cell_ - static_cast<double>(cell % columns_);
    const double v = (place[1] - low_[1]) / cell_ - static_cast<double>(cell / columns_);
    return product(spline(u), spline(v), 1);
}

SplineGrid::Weights SplineGrid::bends(const Place& place, std::size_t cell,
                                      const std::array<double, 3>& bending) const {
    const double u = (place[0] - low_[0]) / cell_ - static_cast<double>(cell % columns_);
    const double v = (place[1] - low_[1]) / cell_ - static_cast<double>(cell / columns_);
    const double scale = 1 / (cell_ * cell_);
    const Weights xx = product(curvature, spline(v), scale * bending[0]);
    const Weights xy = product(slope(u), slope(v), scale * bending[1]);
    const Weights yy = product(spline(u), curvature, scale * bending[2]);
    Weights out{};
    for (std::size_t k = 0; k < reach; ++k)
        out[k] = xx[k] + xy[k] + yy[k];
    return out;
}

void add_square(SplineGrid::Element& element, const SplineGrid::Weights& weights, double strength) {
    for (std::size_t a = 0; a < SplineGrid::reach; ++a) {
        const double scaled = strength * weights[a];
        for (std::size_t b = 0; b < SplineGrid::reach; ++b)
            element[SplineGrid::reach * a + b] += scaled * weights[b];
    }
}

SplineLevels::SplineLevels(const SplineGrid& grid, std::span<const Place> nodes,
                           std::span<const Hinge> hinges, int threads,
                           const std::function<void()>& check)
    : threads_(threads), check_(check), rough_(grid.cells()) {
    // Hinges by cells, so that each cell sums its own in their order.
    std::vector<std::size_t> first(grid.cells() + 1, 0);
    std::vector<std::int32_t> cell_of(hinges.size()), held_by(hinges.size());
    for (std::size_t h = 0; h < hinges.size(); ++h) {
        cell_of[h] = static_cast<std::int32_t>(grid.cell_of(hinges[h].middle));
        ++first[static_cast<std::size_t>(cell_of[h]) + 1];
    }
    for (std::size_t c = 1; c < first.size(); ++c)
        first[c] += first[c - 1];
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t h = 0; h < hinges.size(); ++h)
        held_by[next[static_cast<std::size_t>(cell_of[h])]++] = static_cast<std::int32_t>(h);
    check_();
    in_pieces(grid.cells(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c) {
            rough_[c].fill(0);
            for (std::size_t k = first[c]; k < first[c + 1]; ++k) {
                const Hinge& h = hinges[static_cast<std::size_t>(held_by[k])];
                add_square(rough_[c], grid.bends(h.middle, c, h.bending), 1);
            }
        }
    });
    levels_.emplace_back(grid);
    fill_up(nodes, hinges);
    while (levels_.back().grid.coefficients() > coarsest_coefficients)
        levels_.emplace_back(levels_.back().grid.coarser());
    for (Level& level : levels_) {
        for (Vector* v :
             {&level.inverse_diagonal, &level.right, &level.x, &level.residual, &level.step})
            v->assign(level.grid.length(), 0.0);
        level.stencil.assign(25 * level.grid.length(), 0.0);
    }
}

/// Cells that the border of the mesh cuts get the roughness of a whole one, as if the mesh went on
/// to their end: splines of which only a tip reaches the mesh would else be all but free. (That is
/// harmless: a smooth surface can be continued smoothly.)
void SplineLevels::fill_up(std::span<const Place> nodes, std::span<const Hinge> hinges) {
    const SplineGrid& grid = levels_.front().grid;
    std::vector<char> touched(grid.cells(), 0);
    for (const Place& node : nodes)
        touched[grid.cell_of(node)] = 1;
    std::vector<double> traces;
    const auto trace = [](const SplineGrid::Element& element) {
        double sum = 0;
        for (std::size_t k = 0; k < SplineGrid::reach; ++k)
            sum += element[(SplineGrid::reach + 1) * k];
        return sum;
    };
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
    const Place corner = grid.corner();
    constexpr std::array<double, 2> at{0.2113248654051871, 0.7886751345948129};  // Gauss
    for (const double u : at) {
        for (const double v : at) {
            const Place place{corner[0] + u * grid.cell(), corner[1] + v * grid.cell()};
            for (std::size_t k = 0; k < 3; ++k) {
                std::array<double, 3> bending{};
                bending[k] = 1;
                add_square(whole, grid.bends(place, 0, bending), size[k]);
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

void SplineLevels::set_pulls(std::span<const Pull> pulls) {
    std::vector<SplineGrid::Element> elements = rough_;
    const SplineGrid& finest = levels_.front().grid;
    double trace = 0;
    for (const SplineGrid::Element& element : elements) {
        for (std::size_t k = 0; k < SplineGrid::reach; ++k)
            trace += element[(SplineGrid::reach + 1) * k];
    }
    for (const Pull& pull : pulls) {
        const std::size_t cell = finest.cell_of(pull.place);
        add_square(elements[cell], finest.values(pull.place, cell), pull.strength);
    }
    const double least =
        trace > 0 ? held * trace / static_cast<double>(finest.coefficients()) : 1.0;
    for (std::size_t at = 0; at < levels_.size(); ++at) {
        check_();
        if (at > 0) restrict_elements(elements, levels_[at - 1].grid);
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
            for (std::size_t part = 0; part < 4; ++part) {
                const std::size_t column = 2 * (c % coarse.columns()) + part % 2;
                const std::size_t row = 2 * (c / coarse.columns()) + part / 2;
                if (column >= fine.columns() || row >= fine.rows()) continue;
                const SplineGrid::Element& from = elements[row * fine.columns() + column];
                double s[9][9];
                for (std::size_t a = 0; a < 9; ++a) {
                    for (std::size_t b = 0; b < 9; ++b)
                        s[a][b] = halves[part % 2][a % 3][b % 3] * halves[part / 2][a / 3][b / 3];
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
                            out[c][9 * a + b] += s[k][a] * half[k][b];
                    }
                }
            }
        }
    });
    elements = std::move(out);
}

void SplineLevels::assemble(Level& level, const std::vector<SplineGrid::Element>& elements,
                            double least) {
    const SplineGrid& grid = level.grid;
    const std::size_t columns = grid.columns() + 2, rows = grid.rows() + 2;
    Vector magnitude(grid.length(), 0.0);
    in_pieces(rows, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            for (std::size_t column = 0; column < columns; ++column) {
                const std::size_t number = grid.number(column, row);
                double* stencil = level.stencil.data() + 25 * number;
                std::fill(stencil, stencil + 25, 0.0);
                for (std::size_t a = 0; a < 9; ++a) {  // as the a-th of a cell's
                    if (column < a % 3 || row < a / 3) continue;
                    const std::size_t i = column - a % 3, j = row - a / 3;
                    if (i >= grid.columns() || j >= grid.rows()) continue;
                    const SplineGrid::Element& element = elements[j * grid.columns() + i];
                    for (std::size_t b = 0; b < 9; ++b) {
                        const std::size_t dx = 2 + b % 3 - a % 3, dy = 2 + b / 3 - a / 3;
                        stencil[5 * dy + dx] += element[9 * a + b];
                    }
                }
                stencil[12] += least;
                level.inverse_diagonal[number] = 1 / stencil[12];
                for (int k = 0; k < 25; ++k)
                    magnitude[number] += std::abs(stencil[k]) / stencil[12];
            }
        }
    });
    const double bound = *std::max_element(magnitude.begin(), magnitude.end());
    level.largest =
        largest_eigenvalue(level.inverse_diagonal, bound, threads_,
                           [&](const Vector& x, Vector& out) { multiply(level, x, out); });
}

void SplineLevels::factor_coarsest(double least) {
    const Level& level = levels_.back();
    coarsest_numbers_.clear();
    for (std::size_t row = 0; row < level.grid.rows() + 2; ++row) {
        for (std::size_t column = 0; column < level.grid.columns() + 2; ++column)
            coarsest_numbers_.push_back(level.grid.number(column, row));
    }
    const auto count = static_cast<Eigen::Index>(coarsest_numbers_.size());
    Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(count, count);
    const auto width = static_cast<Eigen::Index>(level.grid.columns() + 2);
    const auto height = static_cast<Eigen::Index>(level.grid.rows() + 2);
    for (Eigen::Index a = 0; a < count; ++a) {
        const double* stencil =
            level.stencil.data() + 25 * coarsest_numbers_[static_cast<std::size_t>(a)];
        for (Eigen::Index k = 0; k < 25; ++k) {
            const Eigen::Index column = a % width + k % 5 - 2, row = a / width + k / 5 - 2;
            if (column < 0 || row < 0 || column >= width || row >= height) continue;
            matrix(a, row * width + column) = stencil[k];
        }
        matrix(a, a) += least;
    }
    coarsest_.compute(matrix);
}

void SplineLevels::multiply(const Level& level, const Vector& x, Vector& out) const {
    const SplineGrid& grid = level.grid;
    const std::size_t columns = grid.columns() + 2, rows = grid.rows() + 2, stride = grid.stride();
    const auto some_rows = static_cast<std::ptrdiff_t>(rows);
#pragma omp parallel for schedule(static) num_threads(threads_) if (rows * columns > 65536)
    for (std::ptrdiff_t row = 0; row < some_rows; ++row) {
        const std::size_t start = grid.number(0, static_cast<std::size_t>(row));
        for (std::size_t column = 0; column < columns; ++column) {
            const std::size_t number = start + column;
            const double* stencil = level.stencil.data() + 25 * number;
            const double* at = x.data() + number - 2 * stride - 2;
            double sum = 0;
            for (int j = 0; j < 5; ++j) {
                const double* line = at + static_cast<std::size_t>(j) * stride;
                for (int i = 0; i < 5; ++i)
                    sum += stencil[5 * j + i] * line[i];
            }
            out[number] = sum;
        }
    }
}

void SplineLevels::solve() {
    cycle(0);
}

/// x of a level from its right side.
void SplineLevels::cycle(std::size_t at) {
    check_();
    Level& level = levels_[at];
    if (at + 1 == levels_.size()) {
        const auto count = static_cast<Eigen::Index>(coarsest_numbers_.size());
        Eigen::VectorXd right(count);
        for (Eigen::Index k = 0; k < count; ++k)
            right(k) = level.right[coarsest_numbers_[static_cast<std::size_t>(k)]];
        const Eigen::VectorXd x = coarsest_.solve(right);
        for (Eigen::Index k = 0; k < count; ++k)
            level.x[coarsest_numbers_[static_cast<std::size_t>(k)]] = x(k);
        return;
    }
    smooth(level, true);
    multiply(level, level.x, level.step);
    in_pieces(level.x.size(), threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            level.residual[i] = level.right[i] - level.step[i];
    });
    Level& coarse = levels_[at + 1];
    const SplineGrid &fine = level.grid, &grid = coarse.grid;
    constexpr std::array<double, 4> mask{0.25, 0.75, 0.75, 0.25};
    in_pieces(grid.rows() + 2, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            for (std::size_t column = 0; column < grid.columns() + 2; ++column) {
                double sum = 0;  // fine coefficients 2 i - 2 .. 2 i + 1 along each axis
                for (std::size_t j = 0; j < 4; ++j) {
                    if (2 * row + j < 2 || 2 * row + j - 2 >= fine.rows() + 2) continue;
                    for (std::size_t i = 0; i < 4; ++i) {
                        if (2 * column + i < 2 || 2 * column + i - 2 >= fine.columns() + 2)
                            continue;
                        sum += mask[i] * mask[j] *
                               level.residual[fine.number(2 * column + i - 2, 2 * row + j - 2)];
                    }
                }
                coarse.right[grid.number(column, row)] = sum;
            }
        }
    });
    cycle(at + 1);
    in_pieces(fine.rows() + 2, threads_, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            for (std::size_t column = 0; column < fine.columns() + 2; ++column) {
                const double x0 = column % 2 == 0 ? 0.75 : 0.25, y0 = row % 2 == 0 ? 0.75 : 0.25;
                const double* from = coarse.x.data() + grid.number(column / 2, row / 2);
                const double low = x0 * from[0] + (1 - x0) * from[1];
                const double high = x0 * from[grid.stride()] + (1 - x0) * from[grid.stride() + 1];
                level.x[fine.number(column, row)] += y0 * low + (1 - y0) * high;
            }
        }
    });
    smooth(level, false);
}

void SplineLevels::smooth(Level& level, bool from_zero) {
    if (from_zero) {
        std::fill(level.x.begin(), level.x.end(), 0.0);
        level.residual = level.right;
    } else {
        multiply(level, level.x, level.step);
        in_pieces(level.x.size(), threads_, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                level.residual[i] = level.right[i] - level.step[i];
        });
    }
    Vector product(level.x.size(), 0.0);
    chebyshev(level.x, level.residual, level.step, product, level.inverse_diagonal, level.largest,
              smoothing_degree, threads_,
              [&](const Vector& x, Vector& out) { multiply(level, x, out); });
}

}  // namespace realmodel::interpolation
