// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/corner_grid.hpp"

namespace realmodel::meshing {

namespace {

constexpr std::uint8_t most_in_cell = 16;
constexpr double cells_along = 16;
constexpr int deepest = 24;

}  // namespace

CornerGrid::CornerGrid(std::span<const PlanPoint> places, std::span<const std::int32_t> members)
    : places_(places),
      before_(places.size(), empty),
      after_(places.size(), empty),
      cell_(places.size(), empty),
      level_of_(places.size(), empty) {
    std::vector<std::int32_t> all(members.begin(), members.end());
    if (!all.empty()) add_level(all, empty, 0);
}

std::int32_t CornerGrid::add_level(std::span<std::int32_t> members, std::int32_t cell, int depth) {
    Level level{};
    level.low = level.high = places_[members[0]];
    level.cell = cell;
    for (const std::int32_t m : members) {
        for (int k = 0; k < 2; ++k) {
            level.low[k] = std::min(level.low[k], places_[m][k]);
            level.high[k] = std::max(level.high[k], places_[m][k]);
        }
    }
    const double width = level.high[0] - level.low[0], height = level.high[1] - level.low[1];
    const double side = std::max(width, height) / cells_along;
    level.columns = level.rows = 1;
    if (side > 0 && std::isfinite(1 / side)) {
        level.side = side;
        level.cells_per_unit = 1 / side;
        level.columns = static_cast<std::int32_t>(width / side) + 1;
        level.rows = static_cast<std::int32_t>(height / side) + 1;
    }
    const auto number = static_cast<std::int32_t>(levels_.size());
    level.first = static_cast<std::int32_t>(cells_.size());
    levels_.push_back(level);
    cells_.resize(cells_.size() + static_cast<std::size_t>(level.columns) * level.rows, empty);

    const auto cell_of = [&](std::int32_t m) {
        return level.first +
               cell_along(places_[m][1] - level.low[1], level, level.rows) * level.columns +
               cell_along(places_[m][0] - level.low[0], level, level.columns);
    };
    std::vector<std::uint8_t> held(cells_.size() - level.first, 0);
    for (const std::int32_t m : members) {
        cell_[m] = cell_of(m);
        std::uint8_t& here = held[cell_[m] - level.first];
        if (here <= most_in_cell) ++here;
    }
    std::vector<std::int32_t> crowded;
    for (const std::int32_t m : members) {
        const bool is_crowded = held[cell_[m] - level.first] > most_in_cell;
        if (is_crowded && depth < deepest && level.cells_per_unit > 0) {
            crowded.push_back(m);
            continue;
        }
        std::int32_t& head = cells_[cell_[m]];
        if (head == empty) ++levels_[number].used;
        level_of_[m] = number;
        after_[m] = head;
        if (head >= 0) before_[head] = m;
        head = m;
    }
    std::stable_sort(crowded.begin(), crowded.end(),
                     [&](std::int32_t m, std::int32_t n) { return cell_[m] < cell_[n]; });
    for (std::size_t begin = 0, end = 0; begin < crowded.size(); begin = end) {
        const std::int32_t shared = cell_[crowded[begin]];
        for (end = begin; end < crowded.size() && cell_[crowded[end]] == shared;)
            ++end;
        const std::int32_t below =
            add_level(std::span(crowded).subspan(begin, end - begin), shared, depth + 1);
        levels_[below].above = number;
        cells_[shared] = empty - 1 - below;
        ++levels_[number].used;
    }
    return number;
}

void CornerGrid::remove(std::int32_t member) {
    if (level_of_[member] == empty) return;
    const std::int32_t before = before_[member], after = after_[member];
    if (after >= 0) before_[after] = before;
    if (before >= 0) {
        after_[before] = after;
    } else {
        cells_[cell_[member]] = after;
        // A level that nothing is left in is passed over from now on.
        std::int32_t level = after == empty ? level_of_[member] : empty;
        while (level != empty && --levels_[level].used == 0 && levels_[level].above != empty) {
            cells_[levels_[level].cell] = empty;
            level = levels_[level].above;
        }
    }
    level_of_[member] = empty;
}

}  // namespace realmodel::meshing
