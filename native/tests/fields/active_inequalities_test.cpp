// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>

#include "fields/spline_constraints.hpp"

namespace realmodel::fields {
namespace {

const Vec3 kFrom{0, 0, 0};

/// f at a place less f at the origin.
Functional value_at(const Vec3& at, double right = 0) {
    Functional out = Functional::difference(at, kFrom);
    out.right = right;
    return out;
}

/// f = z at places around the origin.
std::vector<Functional> plane() {
    std::vector<Functional> out;
    for (int n = 0; n < 27; ++n) {
        const Vec3 at{0.8 * (n % 3 - 1), 0.8 * (n / 3 % 3 - 1), 0.8 * (n / 9 - 1)};
        if (n != 13) out.push_back(value_at(at, at[2]));
    }
    return out;
}

Inequality at_least(const Vec3& at, double least) {
    return {value_at(at), least, Inequality::Origin::kBound, 0, at};
}

/// The spline through the plane's values and the active inequalities.
Spline fitted(const ActiveInequalities& active) {
    std::vector<Functional> rows = plane();
    active.append_to(rows);
    return {rows, {}, {}};
}

TEST(ActiveInequalities, ThoseThatDoNotHoldAreMetAsEqualities) {
    ActiveInequalities active({at_least({0.5, 0, 0.5}, 0.4), at_least({0, 0.5, 0.5}, 0.7)});
    EXPECT_TRUE(active.activate(fitted(active), 1e-9));
    EXPECT_FALSE(active.states()[0].active);
    EXPECT_TRUE(active.states()[1].active);
    const Spline spline = fitted(active);
    EXPECT_NEAR(spline.of(value_at({0, 0.5, 0.5})), 0.7, 1e-9);
    EXPECT_FALSE(active.activate(spline, 1e-9));
    EXPECT_FALSE(active.release(spline, plane().size()));
}

TEST(ActiveInequalities, OneThatWouldHoldByItselfIsReleasedOnce) {
    ActiveInequalities active({at_least({0, 0.5, 0.5}, 0.4)});
    active.set_states({{true, false, false, false}});
    EXPECT_TRUE(active.release(fitted(active), plane().size()));
    EXPECT_FALSE(active.states()[0].active);
    active.set_states({{true, true, true, false}});  // it did not hold once it was released
    EXPECT_FALSE(active.release(fitted(active), plane().size()));
}

TEST(ActiveInequalities, WhatContradictsTheOthersIsSuspectedAndLeftOut) {
    ActiveInequalities active({at_least({0, 0.5, 0.5}, 0.51), at_least({0.2, 0.1, 0.9}, 5.0)});
    EXPECT_TRUE(active.activate(fitted(active), 1e-9));
    const std::vector<std::size_t> wrong = active.suspected(fitted(active), plane().size());
    ASSERT_EQ(wrong, std::vector<std::size_t>{1});
    active.leave_out(wrong);
    EXPECT_FALSE(active.states()[0].active);  // begun again
    EXPECT_TRUE(active.activate(fitted(active), 1e-9));
    EXPECT_FALSE(active.states()[1].active);
}

}  // namespace
}  // namespace realmodel::fields
