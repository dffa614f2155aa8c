// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/node_loop.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <new>
#include <string>
#include <vector>

#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

TEST(NodeLoop, EachNodeOnceAndTheProgressToItsEnd) {
    for (const int threads : {1, 3}) {
        Progress progress;
        std::vector<std::atomic<int>> seen(1001);
        const NodeLoop loop{seen.size(), 10, {threads, &progress}, "nodes", 0.25, 0.75};
        loop.over_nodes([] { return 0; }, [&](int, std::size_t i) { ++seen[i]; });
        for (const auto& times : seen)
            EXPECT_EQ(times, 1);
        EXPECT_NEAR(progress.fraction(), 0.75, 1e-12);
        EXPECT_EQ(progress.text(), "nodes");
    }
}

TEST(NodeLoop, TheErrorOfTheLowestNodeReachesTheCaller) {
    for (const int threads : {1, 2, 5}) {
        const NodeLoop loop{5000, 7, {threads, nullptr}};
        std::string message;
        try {
            loop.over_nodes([] { return 0; },
                            [](int, std::size_t i) {
                                if (i % 1000 == 777) throw InputError("option", std::to_string(i));
                            });
        } catch (const InputError& error) {
            message = error.what();
        }
        EXPECT_EQ(message, "777");
        EXPECT_THROW(loop.over_chunks([]() -> int { throw std::bad_alloc(); },
                                      [](int, std::size_t, std::size_t) {}),
                     std::bad_alloc);
    }
}

TEST(NodeLoop, StopsBetweenTwoNodes) {
    Progress progress;
    int done = 0;
    const NodeLoop loop{1000, 1000, {1, &progress}};
    const auto work = [&](int, std::size_t i) {
        ++done;
        if (i == 4) progress.cancel();
    };
    EXPECT_THROW(loop.over_nodes([] { return 0; }, work), Cancelled);
    EXPECT_EQ(done, 5);
}

}  // namespace
}  // namespace realmodel::interpolation
