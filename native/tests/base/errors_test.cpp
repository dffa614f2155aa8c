// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/errors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

namespace realmodel {
namespace {

TEST(InputError, SaysWhatAndWhere) {
    const InputError error("double_valued", "two triangles overlap", 2, {17, 40},
                           std::array<double, 3>{1.0, 2.0, 3.0});
    EXPECT_STREQ(error.what(), "two triangles overlap");
    EXPECT_EQ(error.kind, "double_valued");
    EXPECT_EQ(error.surface, 2);
    EXPECT_EQ(error.items, (std::vector<std::int64_t>{17, 40}));
    ASSERT_TRUE(error.place.has_value());
    EXPECT_EQ(*error.place, (std::array<double, 3>{1.0, 2.0, 3.0}));
}

TEST(InputError, NeedsNoPlace) {
    const InputError error("too_large", "more than 2^31 vertices");
    EXPECT_EQ(error.surface, -1);
    EXPECT_TRUE(error.items.empty());
    EXPECT_FALSE(error.place.has_value());
}

TEST(InputError, IsARuntimeErrorAndCancelledIsNone) {
    EXPECT_THROW(throw InputError("bad_index", "vertex 9 of 8"), std::runtime_error);
    EXPECT_THROW(
        {
            try {
                throw Cancelled();
            } catch (const std::runtime_error&) {
                FAIL() << "a handler of errors must not catch the wish to stop";
            }
        },
        Cancelled);
}

TEST(InternalError, SaysWhatDoesNotHoldAndWhere) {
    const InternalError error("each edge has two faces", std::array<double, 3>{0.5, 2, -3});
    EXPECT_STREQ(error.what(), "this does not hold: each edge has two faces at 0.5, 2, -3");
    EXPECT_STREQ(InternalError("a").what(), "this does not hold: a");
}

}  // namespace
}  // namespace realmodel
