// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>

#include "base/floating_point.hpp"

namespace realmodel {
namespace {

/// A double of any size up to 2^most, of either sign.
double any(std::mt19937_64& random, int most) {
    const double share = std::ldexp(static_cast<double>(random() >> 11), -53) + 0.5;
    const double number = std::ldexp(share, static_cast<int>(random() % (40 + most)) - 40);
    return random() % 2 == 0 ? number : -number;
}

/// The C library's are within one unit of the exact value, too: two apart at most, where one is no
/// more exact than a double.
void expect_near(double found, long double expected, const std::string& of, double units = 1) {
    const auto rounded = static_cast<double>(expected);
    if (std::isnan(rounded)) {
        EXPECT_TRUE(std::isnan(found)) << of;
    } else if (std::isinf(rounded)) {
        EXPECT_EQ(found, rounded) << of;
    } else {
        if (sizeof expected == sizeof found) ++units;
        EXPECT_LE(std::abs(found - expected), units * ulp(rounded)) << of;
    }
}

TEST(Elementary, AreWithinOneUnitInTheLastPlace) {
#if defined(_WIN32)
    GTEST_SKIP() << "the C library's functions, which these are compared with, are less exact";
#endif
    std::mt19937_64 random(1);
    using Wide = long double;
    for (int i = 0; i < 50'000; ++i) {
        const double x = any(random, 10), y = any(random, 10), large = any(random, 60);
        const double positive = std::abs(large), share = std::abs(std::fmod(x, 1.0));
        const std::string of = std::to_string(x) + ", " + std::to_string(y);
        expect_near(elementary::exp(x), std::exp(Wide(x)), "exp " + of);
        expect_near(elementary::expm1(x), std::expm1(Wide(x)), "expm1 " + of);
        expect_near(elementary::log(positive), std::log(Wide(positive)), "log " + of);
        expect_near(elementary::pow(positive, y), std::pow(Wide(positive), Wide(y)), "pow " + of);
        expect_near(elementary::sin(x), std::sin(Wide(x)), "sin " + of);
        expect_near(elementary::cos(x), std::cos(Wide(x)), "cos " + of);
        expect_near(elementary::atan2(x, large), std::atan2(Wide(x), Wide(large)), "atan2 " + of,
                    2);
        expect_near(elementary::acos(share), std::acos(Wide(share)), "acos " + of);
        expect_near(elementary::acos(-share), std::acos(Wide(-share)), "acos " + of);
        expect_near(elementary::hypot(x, y), std::hypot(Wide(x), Wide(y)), "hypot " + of);
        if (HasFailure()) return;
    }
}

TEST(Elementary, TheSameBytesAsOnOtherSystems) {
    std::mt19937_64 random(2);
    std::uint64_t digest = 0xcbf29ce484222325;  // FNV-1a
    const auto add = [&](double value) {
        std::uint64_t bits = 0;
        std::memcpy(&bits, &value, sizeof bits);
        digest = (digest ^ bits) * 0x100000001b3;
    };
    for (int i = 0; i < 20'000; ++i) {
        const double x = any(random, 9), y = any(random, 9), positive = std::abs(x);
        for (const double value :
             {elementary::exp(x), elementary::expm1(x), elementary::log(positive),
              elementary::pow(positive, y / 64), elementary::sin(x), elementary::cos(x),
              elementary::atan2(x, y), elementary::acos(x / 512), elementary::hypot(x, y)})
            add(value);
    }
    EXPECT_EQ(digest, 4855015430478077499u);
}

TEST(Elementary, AtTheEndsOfTheNumbers) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(elementary::exp(1000), infinity);
    EXPECT_EQ(elementary::exp(-1000), 0);
    EXPECT_EQ(elementary::expm1(-infinity), -1);
    EXPECT_EQ(elementary::log(0), -infinity);
    EXPECT_TRUE(std::isnan(elementary::log(-1)));
    EXPECT_EQ(elementary::pow(0, 0), 1);
    EXPECT_EQ(elementary::pow(2, -1074), 0x1p-1074);
    EXPECT_TRUE(std::isnan(elementary::sin(infinity)));
    EXPECT_EQ(elementary::acos(1), 0);
    EXPECT_TRUE(std::isnan(elementary::acos(1.5)));
    EXPECT_EQ(elementary::hypot(1e300, 1e300), std::sqrt(2.0) * 1e300);
    EXPECT_EQ(elementary::hypot(3e-320, 4e-320), 5e-320);
}

}  // namespace
}  // namespace realmodel
