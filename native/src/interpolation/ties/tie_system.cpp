// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/ties/tie_system.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>

#include "base/algorithms.hpp"
#include "base/vectors.hpp"
#include "interpolation/node_loop.hpp"
#include "realmodel/interpolation/ties.hpp"
#include "spatial/mesh_locator.hpp"
#include "spatial/plan_tiles.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::size_t kNodesInChunk = 1024;

std::vector<std::size_t> places_not_zero(std::span<const double> coefficients) {
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < coefficients.size(); ++i)
        if (coefficients[i] != 0) places.push_back(i);
    return places;
}

}  // namespace

KernelSum::KernelSum(std::span<const PlanPosition> positions, std::span<const double> sided,
                     std::size_t faults, std::span<const double> coefficients, double radius)
    : sided_(sided),
      coefficients_(coefficients),
      faults_(faults),
      radius_(radius),
      numbers_(places_not_zero(coefficients)),
      bins_(transformed(numbers_, [&](std::size_t i) { return positions[i]; })) {}

double KernelSum::at(const SheetNode& node) const {
    double sum = 0;
    const auto& [x, y] = node.position;
    bins_.within({x - radius_, y - radius_, x + radius_, y + radius_},
                 [&](std::size_t number, const PlanPosition& position) {
                     const std::size_t i = numbers_[number];
                     const SheetNode center{position, sided_.subspan(i * faults_, faults_)};
                     sum += coefficients_[i] * tie_kernel(node, center, radius_);
                 });
    return sum;
}

std::vector<double> tied_heights(std::span<const double> heights,
                                 std::span<const PlanPosition> nodes, std::span<const double> sided,
                                 const TieTerms& terms, const Execution& execution) {
    std::vector<double> z(heights.begin(), heights.end());
    const std::size_t count = terms.positions.size();
    if (count == 0) return z;
    const std::size_t faults = terms.sided.size() / count;
    std::vector<KernelSum> sums;
    for (std::size_t level = 0; level < terms.radii.size(); ++level) {
        const auto weights = std::span(terms.coefficients).subspan(level * count, count);
        if (std::all_of(weights.begin(), weights.end(), [](double c) { return c == 0; })) continue;
        sums.emplace_back(terms.positions, terms.sided, faults, weights, terms.radii[level]);
    }
    const NodeLoop loop{nodes.size(), kNodesInChunk, execution};
    loop.over_nodes([] { return 0; },
                    [&](int, std::size_t i) {
                        const SheetNode node{nodes[i], sided.subspan(i * faults, faults)};
                        double correction = 0;
                        for (const KernelSum& sum : sums)
                            correction += sum.at(node);
                        z[i] += correction;
                    });
    return z;
}

namespace {

double mesh_area(const TiedSheets& sheets) {
    double area = 0;
    for (const auto& t : sheets.triangles)
        area += twice_area(sheets.nodes[t[0]], sheets.nodes[t[1]], sheets.nodes[t[2]]);
    return std::abs(area) / 2;
}

}  // namespace

TieRows::TieRows(const TiedSheets& sheets, const TieData& data)
    : rows(data.places.size()), area(0) {
    const std::size_t count = sheets.nodes.size();
    const spatial::MeshLocator locator(sheets.nodes, sheets.triangles);
    area = mesh_area(sheets);
    faults = count > 0 ? sheets.weights.size() / count : 0;
    std::vector<std::array<std::int64_t, 3>> keys(rows.size());
    std::vector<std::int64_t> every;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto location = locator.find(data.places[i]);
        if (!location) continue;
        const auto& corners = sheets.triangles[static_cast<std::size_t>(location->triangle)];
        const auto first =
            static_cast<std::int64_t>(data.sheets[i]) * static_cast<std::int64_t>(count);
        TieRow& row = rows[i];
        row = {{}, location->weights, data.lower[i], data.upper[i], HUGE_VAL, true};
        for (std::size_t k = 0; k < 3; ++k) {
            const PlanPosition& p = sheets.nodes[corners[k]];
            keys[i][k] = first + corners[k];
            row.is_known =
                row.is_known && !std::isnan(sheets.heights[static_cast<std::size_t>(keys[i][k])]);
            row.shortest_edge =
                std::min(row.shortest_edge, length(minus(p, sheets.nodes[corners[(k + 1) % 3]])));
        }
        if (row.is_known) every.insert(every.end(), keys[i].begin(), keys[i].end());
    }
    sort_unique(every);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (std::size_t k = 0; k < 3 && rows[i].is_known; ++k) {
            const auto at = std::lower_bound(every.begin(), every.end(), keys[i][k]);
            rows[i].corners[k] = static_cast<std::int32_t>(at - every.begin());
        }
    }
    for (const std::int64_t key : every) {
        const std::size_t sheet = static_cast<std::size_t>(key) / count,
                          node = static_cast<std::size_t>(key) % count;
        positions.push_back(sheets.nodes[node]);
        heights.push_back(sheets.heights[static_cast<std::size_t>(key)]);
        for (std::size_t fault = 0; fault < faults; ++fault)
            sided.push_back(sheets.sides[sheet * faults + fault] *
                            sheets.weights[fault * count + node]);
    }
}

double TieRows::product(const TieRow& a, const TieRow& b, double radius) const {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        if (a.weights[i] == 0) continue;
        double inner = 0;
        for (std::size_t j = 0; j < 3; ++j)
            inner += b.weights[j] * tie_kernel(center(a.corners[i]), center(b.corners[j]), radius);
        sum += a.weights[i] * inner;
    }
    return sum;
}

namespace {

constexpr double kRidge = 1e-9;  // of the diagonal: no pivot is 0

}  // namespace

TieSystem::TieSystem(const TieRows& rows, std::span<const std::int32_t> members, double radius,
                     double ridge) {
    std::vector<PlanPosition> corners;  // three for each member
    for (const std::int32_t member : members)
        for (const std::int32_t corner : rows.rows[member].corners)
            corners.push_back(rows.positions[corner]);
    const spatial::PointBins bins(corners);
    const auto count = static_cast<std::int32_t>(members.size());
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<std::int32_t> near;
    for (std::int32_t b = 0; b < count; ++b) {
        near.clear();
        const TieRow& row = rows.rows[members[b]];
        for (const std::int32_t corner : row.corners) {
            const auto& [x, y] = rows.positions[corner];
            bins.within({x - radius, y - radius, x + radius, y + radius},
                        [&](std::size_t number, const PlanPosition&) {
                            const auto a = static_cast<std::int32_t>(number / 3);
                            if (a >= b) near.push_back(a);
                        });
        }
        sort_unique(near);
        for (const std::int32_t a : near) {
            const double value = rows.product(rows.rows[members[a]], row, radius);
            if (value != 0) entries.emplace_back(a, b, a == b ? value * (1 + ridge) : value);
        }
    }
    matrix_.resize(count, count);
    matrix_.setFromTriplets(entries.begin(), entries.end());
    factor_.compute(matrix_);
}

std::vector<std::int32_t> TieSystem::dependent(double share, double least) const {
    const auto& place = factor_.permutationP().indices();
    std::vector<std::int32_t> columns;
    for (Eigen::Index i = 0; i < matrix_.cols(); ++i) {
        // What those that are eliminated before leave.
        const double left = factor_.vectorD()[place[i]];
        if (!(left > share * matrix_.coeff(i, i) + least))
            columns.push_back(static_cast<std::int32_t>(i));
    }
    return columns;
}

double TieSystem::likeness(std::int32_t a, std::int32_t b) const {
    const double product = matrix_.coeff(std::max(a, b), std::min(a, b));
    return std::abs(product) / std::sqrt(matrix_.coeff(a, a) * matrix_.coeff(b, b));
}

std::vector<std::int32_t> TieSystem::related(std::int32_t at) const {
    std::vector<std::int32_t> columns;
    for (std::int32_t column = 0; column < at; ++column)
        if (matrix_.coeff(at, column) != 0) columns.push_back(column);
    for (Matrix::InnerIterator entry(matrix_, at); entry; ++entry)
        if (entry.row() != at) columns.push_back(static_cast<std::int32_t>(entry.row()));
    return columns;
}

std::vector<std::int32_t> crowded_members(const TieRows& rows,
                                          std::span<const std::int32_t> members, double least) {
    std::vector<bool> is_met(rows.positions.size(), false);
    const auto is_at_node = [](const TieRow& row) {
        return *std::max_element(row.weights.begin(), row.weights.end()) == 1;
    };
    for (const std::int32_t member : members) {
        const TieRow& row = rows.rows[member];
        for (std::size_t k = 0; k < 3 && is_at_node(row); ++k)
            if (row.weights[k] == 1) is_met[row.corners[k]] = true;
    }
    TieRows rest = rows;
    std::vector<std::int32_t> left, places, crowded;
    for (std::size_t i = 0; i < members.size(); ++i) {
        TieRow& row = rest.rows[members[i]];
        if (is_at_node(row)) continue;
        double square = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            if (is_met[row.corners[k]]) row.weights[k] = 0;
            square += row.weights[k] * row.weights[k];
        }
        if (square > least) {
            left.push_back(members[i]);
            places.push_back(static_cast<std::int32_t>(i));
        } else {
            crowded.push_back(static_cast<std::int32_t>(i));
        }
    }
    if (!left.empty()) {
        for (const std::int32_t at : TieSystem(rest, left, DBL_MIN, kRidge).dependent(0, least))
            crowded.push_back(places[at]);
    }
    std::sort(crowded.begin(), crowded.end());
    return crowded;
}

}  // namespace realmodel::interpolation
