// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <numeric>
#include <vector>

#include "strata/overlay/chunk_joining.hpp"

namespace realmodel::strata {
namespace {

using exact::PlanArrangement;
using exact::VertexId;

/// A comb of edges, upright ones over level ones: each chunk finds the crossings of one upright.
class Comb {
public:
    static constexpr int kEdges = 12;

    Comb() {
        std::vector<std::array<VertexId, 2>> upright, level;
        for (int i = 0; i < kEdges; ++i) {
            upright.push_back({geometry.add_vertex(i, -1), geometry.add_vertex(i + 0.25, kEdges)});
            level.push_back({geometry.add_vertex(-1, i), geometry.add_vertex(kEdges, i + 0.25)});
        }
        geometry.freeze_vertices();
        for (int i = 0; i < kEdges; ++i) {
            const auto& [from, to] = upright[static_cast<std::size_t>(i)];
            upright_.push_back(geometry.add_edge(from, to).id());
            const auto& [left, right] = level[static_cast<std::size_t>(i)];
            level_.push_back(geometry.add_edge(left, right).id());
        }
    }

    /// Commits in this order of finishing; the crossings by number.
    std::vector<std::array<LineId, 2>> commit(const std::vector<std::size_t>& order,
                                              std::size_t facets) {
        OrderedCommit committing(geometry, order.size(), facets);
        std::vector<std::unique_ptr<LocalArrangement>> scopes(order.size());
        for (const std::size_t chunk : order) {
            scopes[chunk] = std::make_unique<LocalArrangement>(geometry);
            for (const LineId other : level_) {
                const PointId at = scopes[chunk]->crossing(upright_[chunk], other);
                scopes[chunk]->mark_point_used(at);
            }
            committing.finished(chunk, *scopes[chunk]);
        }
        committing.finish();
        std::vector<std::array<LineId, 2>> crossings;
        for (PointId p(geometry.vertex_count()); index(p) < geometry.point_count(); ++p)
            crossings.push_back({geometry.point(p).first, geometry.point(p).second});
        return crossings;
    }

    PlanArrangement geometry;

private:
    std::vector<LineId> upright_, level_;
};

std::vector<std::size_t> in_order() {
    std::vector<std::size_t> order(Comb::kEdges);
    std::iota(order.begin(), order.end(), std::size_t{0});
    return order;
}

TEST(OrderedCommit, NumbersDoNotDependOnWhoIsFirst) {
    const auto expected = Comb().commit(in_order(), 1000);
    ASSERT_EQ(expected.size(), static_cast<std::size_t>(Comb::kEdges * Comb::kEdges));
    auto order = in_order();
    std::reverse(order.begin(), order.end());
    EXPECT_EQ(Comb().commit(order, 1000), expected);
    std::rotate(order.begin(), order.begin() + 5, order.end());
    EXPECT_EQ(Comb().commit(order, 1000), expected);
}

TEST(OrderedCommit, ReturnsTheChunksThatACallCommitted) {
    PlanArrangement geometry;
    geometry.freeze_vertices();
    OrderedCommit committing(geometry, 4, 4);
    std::vector<std::unique_ptr<LocalArrangement>> owned;
    for (int i = 0; i < 4; ++i)
        owned.push_back(std::make_unique<LocalArrangement>(geometry));
    std::vector<std::size_t> passed;
    const auto pass = [&](std::size_t chunk) { passed.push_back(chunk); };
    const auto finished = [&](std::size_t chunk) {
        const auto [first, last] = committing.finished(chunk, *owned[chunk], pass);
        return std::array{first, last};
    };
    const auto none = finished(1);
    EXPECT_EQ(none[0], none[1]);
    EXPECT_EQ(finished(0), (std::array<std::size_t, 2>{0, 2}));
    const auto still_none = finished(3);
    EXPECT_EQ(still_none[0], still_none[1]);
    EXPECT_EQ(finished(2), (std::array<std::size_t, 2>{2, 4}));
    EXPECT_EQ(passed, (std::vector<std::size_t>{0, 1, 2, 3}));
    const auto rest = committing.finish(pass);
    EXPECT_EQ(rest.first, rest.last);
}

TEST(PlanArrangement, HasTheRoomThatWasMade) {
    PlanArrangement geometry;
    geometry.make_room(10, 20);
    EXPECT_TRUE(geometry.has_room(10, 20));
    EXPECT_FALSE(geometry.has_room(1, 1000000));
    EXPECT_FALSE(geometry.has_room(1000000, 1));
}

}  // namespace
}  // namespace realmodel::strata
