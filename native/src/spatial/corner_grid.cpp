// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/corner_grid.hpp"

namespace realmodel::spatial {

namespace {

constexpr std::int32_t kMostInCell = 24;
constexpr int kDeepest = 24;

}  // namespace

CornerGrid::CornerGrid(std::vector<Member> members, std::size_t numbers) : whereabouts_(numbers) {
    members_.reserve(members.size());
    if (!members.empty()) add_level(members, kNone, kNone, 0);
}

std::int32_t CornerGrid::add_level(std::span<Member> members, std::int32_t above,
                                   std::int32_t cell_above, int depth) {
    Level level{};
    level.low = level.high = members[0].position;
    level.above = above;
    level.cell_above = cell_above;
    for (const Member& member : members) {
        for (int k = 0; k < 2; ++k) {
            level.low[k] = std::min(level.low[k], member.position[k]);
            level.high[k] = std::max(level.high[k], member.position[k]);
        }
    }
    const double width = level.high[0] - level.low[0], height = level.high[1] - level.low[1];
    // Outlines are lines: with a tenth of its members along each way, a cell that they pass has a
    // few of them, and levels take memory in proportion to what they hold.
    const double along =
        std::clamp(static_cast<double>(members.size()) / 10, 2.0, kMostAlong - 1.0);
    const double cell_size = std::max(width, height) / along;
    level.columns = level.rows = 1;
    if (cell_size > 0 && std::isfinite(1 / cell_size)) {
        level.cell_size = cell_size;
        level.cells_per_unit = 1 / cell_size;
        level.columns = static_cast<std::int32_t>(width / cell_size) + 1;
        level.rows = static_cast<std::int32_t>(height / cell_size) + 1;
    }
    level.first = static_cast<std::int32_t>(cells_.size());
    const auto number = static_cast<std::int32_t>(levels_.size());
    const std::int32_t cell_count = level.columns * level.rows;
    cells_.resize(cells_.size() + cell_count);

    std::array<std::int32_t, kMostAlong * kMostAlong + 1> begin{};
    for (const Member& member : members) {
        const std::int32_t cell = cell_at(member.position, level);
        whereabouts_[member.number].cell = cell;
        ++begin[cell - level.first + 1];
    }
    for (std::int32_t k = 0; k < cell_count; ++k) {
        if (begin[k + 1] > 0) set_used(level, level.first + k, true);
        begin[k + 1] += begin[k];
    }
    levels_.push_back(level);
    std::vector<Member> sorted(members.size());
    for (auto next = begin; const Member& member : members)
        sorted[next[whereabouts_[member.number].cell - level.first]++] = member;

    for (std::int32_t k = 0; k < cell_count; ++k) {
        const std::int32_t cell = level.first + k;
        const std::span here(sorted.data() + begin[k], sorted.data() + begin[k + 1]);
        const auto count = static_cast<std::int32_t>(here.size());
        if (count > kMostInCell && depth < kDeepest && level.cells_per_unit > 0) {
            const std::int32_t below = add_level(here, number, cell, depth + 1);
            cells_[cell] = {below, kIsLevel};
            continue;
        }
        cells_[cell] = {static_cast<std::int32_t>(members_.size()), count};
        for (const Member& member : here) {
            whereabouts_[member.number] = {static_cast<std::int32_t>(members_.size()), cell,
                                           number};
            members_.push_back(member);
        }
    }
    return number;
}

void CornerGrid::set_used(Level& level, std::int32_t cell, bool is_used) {
    const std::int32_t within = cell - level.first;
    const std::int32_t row = within / level.columns;
    const std::uint32_t column = 1U << within % level.columns;
    std::uint32_t& used = level.used[row];
    used = is_used ? used | column : used & ~column;
    level.used_rows &= ~(1U << row);
    if (used != 0) level.used_rows |= 1U << row;
}

/// A cell that nothing is left in is passed over from now on, and so is a level.
void CornerGrid::clear(std::int32_t number, std::int32_t cell) {
    while (number != kNone) {
        Level& level = levels_[number];
        cells_[cell] = {};
        set_used(level, cell, false);
        if (level.used_rows != 0) return;
        cell = level.cell_above;
        number = level.above;
    }
}

void CornerGrid::remove(std::int32_t number) {
    auto& [member, at, level] = whereabouts_[number];
    if (member == kNone) return;
    Cell& cell = cells_[at];
    --cell.count;
    const Member& last = members_[cell.first + cell.count];
    members_[member] = last;
    whereabouts_[last.number].member = member;
    member = kNone;
    if (cell.count == 0) clear(level, at);
}

}  // namespace realmodel::spatial
