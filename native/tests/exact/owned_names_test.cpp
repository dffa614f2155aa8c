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

TEST(OwnedNames, EdgesAreFoundAgainHoweverManyMeet) {
    PlanArrangement geometry;
    constexpr int kLines = 40;
    const VertexId from = geometry.add_vertex(0, 0);
    std::vector<VertexId> to;
    for (int i = 0; i < kLines; ++i)
        to.push_back(geometry.add_vertex(i + 1, 5));
    geometry.freeze_vertices();
    std::vector<LineId> fan;
    for (const VertexId v : to)
        fan.push_back(geometry.add_edge(from, v).id());
    for (std::size_t i = 0; i < to.size(); ++i)
        EXPECT_EQ(geometry.add_edge(to[i], from), DirectedLine(fan[i], true));
    EXPECT_EQ(geometry.line_count(), static_cast<std::size_t>(kLines));
}

}  // namespace
}  // namespace realmodel::exact
