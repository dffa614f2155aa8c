// SPDX-License-Identifier: GPL-3.0-or-later
#include "spatial/small_boxes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace realmodel::spatial {
namespace {

/// Boxes with corners on a lattice, where many only touch, or anywhere; some are long.
std::vector<PlanBox> draw_boxes(int count, bool on_lattice, double offset, std::mt19937& random) {
    const auto draw = [&](double most) {
        const double at = std::uniform_real_distribution<double>(0, most)(random);
        return on_lattice ? std::floor(at) : at;
    };
    std::vector<PlanBox> boxes;
    for (int i = 0; i < count; ++i) {
        const double x = offset + draw(30), y = draw(30), most = i % 9 == 0 ? 25 : 3;
        boxes.push_back({x, y, x + draw(most), y + draw(most)});
    }
    return boxes;
}

TEST(SmallBoxes, AllThatMeetABoxAreFoundOnceOrLeftOut) {
    std::mt19937 random(3);
    for (const bool on_lattice : {false, true}) {
        for (const double offset : {0.0, 5e6, -3.25e11}) {
            const auto boxes = draw_boxes(400, on_lattice, offset, random);
            std::vector<std::int32_t> chosen(boxes.size());
            std::iota(chosen.begin(), chosen.end(), 0);
            for (const std::size_t cells : {0, 1, 200, 3000}) {
                SmallBoxes small;
                const auto others = small.fill(boxes, chosen, cells, {2, nullptr});
                const auto is_other = [&](std::int32_t i) {
                    return std::binary_search(others.begin(), others.end(), i);
                };
                EXPECT_TRUE(cells > 1 || others.empty());
                EXPECT_TRUE(cells > 200 || others.size() < boxes.size() / 2);
                for (const PlanBox& box : draw_boxes(100, on_lattice, offset, random)) {
                    Array<std::int32_t> found;
                    small.append(box, found);
                    std::sort(found.begin(), found.end());
                    EXPECT_EQ(std::adjacent_find(found.begin(), found.end()), found.end());
                    for (const std::int32_t i : chosen) {
                        if (!boxes[static_cast<std::size_t>(i)].meets(box) || is_other(i)) continue;
                        EXPECT_TRUE(std::binary_search(found.begin(), found.end(), i));
                    }
                    EXPECT_TRUE(std::none_of(found.begin(), found.end(), is_other));
                }
            }
        }
    }
}

TEST(SmallBoxes, FewOfThoseFarAwayAreFound) {
    std::mt19937 random(4);
    const auto boxes = draw_boxes(2000, false, 0, random);
    std::vector<std::int32_t> chosen(boxes.size());
    std::iota(chosen.begin(), chosen.end(), 0);
    SmallBoxes small;
    small.fill(boxes, chosen, boxes.size() / 2, {1, nullptr});
    for (const PlanBox& box : draw_boxes(100, false, 0, random)) {
        Array<std::int32_t> found;
        small.append(box, found);
        for (const std::int32_t i : found) {
            const PlanBox& b = boxes[static_cast<std::size_t>(i)];
            EXPECT_TRUE(b.low_x - 1e-3 <= box.high_x && b.high_x + 1e-3 >= box.low_x);
            EXPECT_TRUE(b.low_y - 1e-3 <= box.high_y && b.high_y + 1e-3 >= box.low_y);
        }
    }
    Array<std::int32_t> found;
    small.append({100, 100, 200, 200}, found);
    EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace realmodel::spatial
