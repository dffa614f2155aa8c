// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/ties/tie_rows.hpp"

#include <algorithm>
#include <cmath>

#include "base/keep_single.hpp"
#include "base/vectors.hpp"
#include "spatial/mesh_locator.hpp"

namespace realmodel::interpolation {

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
        const auto found = locator.find(data.places[i]);
        if (!found) continue;
        const auto& corners = sheets.triangles[static_cast<std::size_t>(found->triangle)];
        const auto first =
            static_cast<std::int64_t>(data.sheets[i]) * static_cast<std::int64_t>(count);
        TieRow& row = rows[i];
        row = {{}, found->weights, data.lower[i], data.upper[i], HUGE_VAL, true};
        for (std::size_t k = 0; k < 3; ++k) {
            const Position& p = sheets.nodes[corners[k]];
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

std::vector<std::int32_t> nodes_around(std::span<const Position> nodes,
                                       std::span<const std::array<std::int32_t, 3>> triangles,
                                       std::span<const Position> places) {
    const spatial::MeshLocator locator(nodes, triangles);
    std::vector<std::int32_t> found;
    for (const Position& place : places) {
        if (const auto at = locator.find(place)) {
            const auto& corners = triangles[static_cast<std::size_t>(at->triangle)];
            found.insert(found.end(), corners.begin(), corners.end());
        }
    }
    sort_unique(found);
    return found;
}

}  // namespace realmodel::interpolation
