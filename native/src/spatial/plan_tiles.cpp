// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/plan_tiles.hpp"

#include <algorithm>
#include <cmath>

#include "base/counting_sort.hpp"

namespace realmodel::spatial {

PlanTiles::PlanTiles(const PlanBox& frame, std::size_t count) : frame_(frame) {
    const double width = frame.width(), height = frame.height();
    const auto wanted = static_cast<double>(std::clamp<std::size_t>(count, 1, 1U << 26));
    const double shape = height > 0 ? std::clamp(width / height, 1.0 / wanted, wanted) : wanted;
    columns_ = std::max<std::int32_t>(1, static_cast<std::int32_t>(std::sqrt(wanted * shape)));
    rows_ = std::max<std::int32_t>(1, static_cast<std::int32_t>(std::sqrt(wanted / shape)));
    step_x_ = std::max(width / columns_, 1e-300);
    step_y_ = std::max(height / rows_, 1e-300);
}

namespace {

constexpr int kLevels = 16;  // of the curve: 65536 x 65536 cells
constexpr int kDigits = 11;  // of the key that one pass of a radix sort sorts by

std::uint32_t place_on_curve(std::uint32_t x, std::uint32_t y) {
    // In each of the four states of the curve: the quarter's number, and the state within it.
    static constexpr std::uint8_t number[4][4] = {
        {0, 1, 3, 2}, {0, 3, 1, 2}, {2, 3, 1, 0}, {2, 1, 3, 0}};
    static constexpr std::uint8_t next[4][4] = {
        {1, 0, 3, 0}, {0, 2, 1, 1}, {2, 1, 2, 3}, {3, 3, 0, 2}};
    std::uint32_t state = 0, key = 0;
    for (int level = kLevels - 1; level >= 0; --level) {
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

std::vector<std::uint32_t> along_hilbert_curve(std::span<const PlanPosition> positions) {
    const PlanBox box = box_around(positions);
    const double extent = std::max(box.width(), box.height());
    const double last_cell = (1U << kLevels) - 1;
    const double scale = extent > 0 ? last_cell / extent : 0;
    const auto cell = [&](double offset) {
        return static_cast<std::uint32_t>(std::min(offset * scale, last_cell));
    };
    Array<Keyed> keyed(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const auto [x, y] = positions[i];
        keyed[i] = {place_on_curve(cell(x - box.low_x), cell(y - box.low_y)),
                    static_cast<std::uint32_t>(i)};
    }
    for (int shift = 0; shift < 2 * kLevels; shift += kDigits) {
        keyed = bucketize<Keyed>(1U << kDigits, [&](const auto& put) {
                    for (const Keyed& item : keyed)
                        put((item.key >> shift) & ((1U << kDigits) - 1), item);
                }).values;
    }
    std::vector<std::uint32_t> order(positions.size());
    for (std::size_t i = 0; i < keyed.size(); ++i)
        order[i] = keyed[i].number;
    return order;
}

}  // namespace realmodel::spatial
