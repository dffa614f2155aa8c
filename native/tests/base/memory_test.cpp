// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/memory.hpp"

#include <gtest/gtest.h>

#if defined(__linux__)
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>
#endif

namespace realmodel {
namespace {

TEST(AvailableMemory, IsWithinReason) {
    const std::uint64_t available = available_memory();
    EXPECT_GT(available, 1'000'000U);
    EXPECT_LT(available, std::uint64_t{1} << 50);
}

#if defined(__linux__)
TEST(AvailableMemory, KnowsTheLimitOfAddressSpace) {
    rlimit before{};
    ASSERT_EQ(getrlimit(RLIMIT_AS, &before), 0);
    std::ifstream statm("/proc/self/statm");
    std::uint64_t pages = 0;
    ASSERT_TRUE(statm >> pages);
    constexpr std::uint64_t spare = 64U << 20U;
    rlimit low = before;
    low.rlim_cur = pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) + spare;
    ASSERT_EQ(setrlimit(RLIMIT_AS, &low), 0);
    const std::uint64_t left = available_memory();
    ASSERT_EQ(setrlimit(RLIMIT_AS, &before), 0);
    EXPECT_LE(left, spare);
}
#endif

}  // namespace
}  // namespace realmodel
