// SPDX-License-Identifier: GPL-3.0-or-later
// Small builds of each kind while an allocation fails, one after the other (a sample of them): as
// SQLite is tested.
#include <gtest/gtest.h>

#include <new>

#include "allocations/failing_allocations.hpp"
#include "small_builds.hpp"

#if defined(__linux__) && !defined(REALMODEL_SANITIZED)  // sanitizers allocate themselves

namespace realmodel {
namespace {

class FailedAllocations : public testing::TestWithParam<std::size_t> {};

TEST_P(FailedAllocations, AreErrorsAndLeaveNothingBehind) {
    const fuzz::SmallBuild build = fuzz::small_builds(1).at(GetParam());
    const std::uint64_t expected = build.digest(1);
    for (const int threads : {1, 3}) {
        for (const bool and_later : {false, true}) {
            std::uint64_t number = 1;
            for (std::uint64_t allocations = 1; number <= allocations;) {
                bool is_out_of_memory = false;
                std::uint64_t made = 0;
                {
                    const fuzz::FailingAllocations failing(number, and_later);
                    try {
                        made = build.digest(threads);
                    } catch (const std::bad_alloc&) {
                        is_out_of_memory = true;
                    }
                    allocations = failing.count();
                }
                if (!is_out_of_memory) {
                    ASSERT_EQ(made, expected) << build.name << ", allocation " << number;
                }
                number += 1 + number / 6;
            }
            EXPECT_EQ(build.digest(threads), expected) << build.name;
        }
    }
}

/// CGAL fills a table of the thread while it inserts a point, and adds exact numbers in storage
/// that is not set at first: of these allocations some are within.
TEST(TetrahedraAfterFailedAllocations, AreTheSame) {
    struct Case {
        std::uint64_t seed, first, last, step;
    };
    for (const Case& c : {Case{1006, 1700, 2000, 5}, Case{2000072, 2900, 2912, 1}}) {
        const fuzz::SmallBuild build = fuzz::small_builds(c.seed).back();
        ASSERT_EQ(build.name, "tetrahedra");
        const std::uint64_t expected = build.digest(1);
        for (std::uint64_t number = c.first; number < c.last; number += c.step) {
            {
                const fuzz::FailingAllocations failing(number, true);
                EXPECT_THROW(build.digest(1), std::bad_alloc) << "allocation " << number;
            }
            ASSERT_EQ(build.digest(1), expected) << "after allocation " << number;
        }
    }
}

INSTANTIATE_TEST_SUITE_P(SmallBuilds, FailedAllocations,
                         testing::Range<std::size_t>(0, fuzz::small_builds(1).size()),
                         [](const auto& kind) { return "Kind" + std::to_string(kind.param); });

}  // namespace
}  // namespace realmodel

#endif
