// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/node_order.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace realmodel::interpolation {

namespace {

constexpr int levels = 16;  // of the curve: 65536 x 65536 cells
constexpr int digits = 11;  // of the key that one pass sorts by
constexpr int passes = 3;   // 33 digits hold 2 * levels
constexpr std::uint32_t buckets = 1U << digits;

/// Position of a cell along the curve.
std::uint32_t position(std::uint32_t x, std::uint32_t y) {
    // In each of the four states of the curve: the quarter's number, and the state within it.
    static constexpr std::uint8_t number[4][4] = {
        {0, 1, 3, 2}, {0, 3, 1, 2}, {2, 3, 1, 0}, {2, 1, 3, 0}};
    static constexpr std::uint8_t next[4][4] = {
        {1, 0, 3, 0}, {0, 2, 1, 1}, {2, 1, 2, 3}, {3, 3, 0, 2}};
    std::uint32_t state = 0, key = 0;
    for (int level = levels - 1; level >= 0; --level) {
        const std::uint32_t quarter = 2 * ((x >> level) & 1U) + ((y >> level) & 1U);
        key = 4 * key + number[state][quarter];
        state = next[state][quarter];
    }
    return key;
}

struct Keyed {
    std::uint32_t key, number;
};

}  // namespace

std::vector<std::uint32_t> along_curve(std::span<const Place> places) {
    std::vector<std::uint32_t> order(places.size());
    if (places.empty()) return order;
    Place low = places[0], high = places[0];
    for (const Place& place : places) {
        for (int axis = 0; axis < 2; ++axis) {
            low[axis] = std::min(low[axis], place[axis]);
            high[axis] = std::max(high[axis], place[axis]);
        }
    }
    const double extent = std::max(high[0] - low[0], high[1] - low[1]);
    const double last_cell = (1U << levels) - 1;
    const double scale = extent > 0 ? last_cell / extent : 0;
    const auto cell = [&](const Place& place, int axis) {
        return static_cast<std::uint32_t>(std::min((place[axis] - low[axis]) * scale, last_cell));
    };
    std::vector<Keyed> keyed(places.size()), sorted(places.size());
    std::array<std::array<std::uint32_t, buckets>, passes> begin{};
    const auto digit = [](std::uint32_t key, int pass) {
        return (key >> (digits * pass)) & (buckets - 1);
    };
    for (std::size_t i = 0; i < places.size(); ++i) {
        keyed[i] = {position(cell(places[i], 0), cell(places[i], 1)),
                    static_cast<std::uint32_t>(i)};
        for (int pass = 0; pass < passes; ++pass)
            ++begin[static_cast<std::size_t>(pass)][digit(keyed[i].key, pass)];
    }
    for (int pass = 0; pass < passes; ++pass) {
        auto& first = begin[static_cast<std::size_t>(pass)];
        std::uint32_t sum = 0;
        for (std::uint32_t& count : first)
            sum += std::exchange(count, sum);
        for (const Keyed& item : keyed)
            sorted[first[digit(item.key, pass)]++] = item;
        keyed.swap(sorted);
    }
    for (std::size_t i = 0; i < keyed.size(); ++i)
        order[i] = keyed[i].number;
    return order;
}

}  // namespace realmodel::interpolation
