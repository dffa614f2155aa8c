// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/owned_names.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <utility>
#include <vector>

#include "base/key_table.hpp"
#include "exact/plan_arrangement.hpp"

namespace realmodel::exact {
namespace {

TEST(OwnedNames, FindsWhatAnOwnerHasAndSendsTheRestElsewhere) {
    OwnedNames names;
    KeyTable elsewhere;
    std::vector<std::pair<std::int32_t, std::int32_t>> things;
    std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> reference;
    std::mt19937 random(1);
    std::uniform_int_distribution<std::int32_t> owner(0, 300), which(0, 40);
    int sent = 0;
    for (int i = 0; i < 20000; ++i) {
        // the first owners have few things, the others more than a list holds
        const std::int32_t o = owner(random), w = o < 150 ? which(random) % 8 : which(random);
        const auto next = static_cast<std::int32_t>(things.size());
        std::int32_t number = names.find_or_add(o, next, [&](std::int32_t n) {
            return things[static_cast<std::size_t>(n)].second == w;
        });
        if (number == OwnedNames::kElsewhere) {
            ++sent;
            EXPECT_GE(o, 150);
            number = elsewhere
                         .insert({o, w, 0, 0}, next,
                                 [&](std::int32_t n) {
                                     const auto [a, b] = things[static_cast<std::size_t>(n)];
                                     return KeyTable::Key{a, b, 0, 0};
                                 })
                         .number;
        }
        EXPECT_EQ(number, reference.emplace(std::pair(o, w), next).first->second);
        if (number == next) things.emplace_back(o, w);
    }
    EXPECT_GT(sent, 1000);
}

TEST(OwnedNames, LinesAndCrossingsAreFoundAgainHoweverManyMeetAndAfterNamesWereForgotten) {
    PlanArrangement geometry;
    constexpr int kLines = 40;
    const VertexId from = geometry.add_vertex(0, 0), to = geometry.add_vertex(100, 1);
    std::vector<std::array<VertexId, 2>> across;
    for (int i = 0; i < kLines; ++i)
        across.push_back({geometry.add_vertex(i + 1, -5), geometry.add_vertex(i + 1, 5)});
    geometry.freeze_vertices();
    std::vector<LineId> lines;
    for (const auto& [low, high] : across)
        lines.push_back(line_of(geometry.add_edge(low, high)));
    for (const auto& [low, high] : across)
        lines.push_back(line_of(geometry.add_edge(from, high)));  // a fan
    const LineId along = line_of(geometry.add_edge(from, to));
    const auto crossing = [&](LineId a, LineId b) {
        Point p;
        p.first = a;
        p.second = b;
        return geometry.add_point(p);
    };
    std::vector<PointId> points;
    for (int i = 0; i < kLines; ++i)
        points.push_back(crossing(lines[static_cast<std::size_t>(i)], along));
    for (int round = 0; round < 2; ++round) {
        for (std::size_t i = 0; i < across.size(); ++i) {
            EXPECT_EQ(line_of(geometry.add_edge(across[i][1], across[i][0])), lines[i]);
            EXPECT_EQ(line_of(geometry.add_edge(across[i][1], from)), lines[i + kLines]);
            EXPECT_EQ(crossing(along, lines[i]), points[i]);
        }
        EXPECT_EQ(geometry.line_count(), 2 * static_cast<std::size_t>(kLines) + 1);
        EXPECT_EQ(geometry.point_count(), 2 + 3 * static_cast<std::size_t>(kLines));
        geometry.forget_names();
    }
}

}  // namespace
}  // namespace realmodel::exact
