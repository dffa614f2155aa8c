// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact/int126.hpp"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "exact/arithmetic.hpp"

namespace realmodel::exact {
namespace {

TEST(Int126, AgreesWithGmpOrIsNotKnown) {
    std::mt19937_64 random(1);
    int unknown = 0;
    for (int round = 0; round < 2000; ++round) {
        std::vector<Int126> shorts;
        std::vector<mpz_class> longs;
        for (int i = 0; i < 4; ++i) {
            const auto value = static_cast<std::int64_t>(random()) >> (2 + random() % 61);
            shorts.emplace_back(value);
            longs.push_back(mpz_class(std::to_string(value)));
        }
        for (int step = 0; step < 12; ++step) {
            const std::size_t i = random() % shorts.size(), j = random() % shorts.size();
            switch (random() % 4) {
                case 0:
                    shorts.push_back(shorts[i] + shorts[j]);
                    longs.emplace_back(longs[i] + longs[j]);
                    break;
                case 1:
                    shorts.push_back(shorts[i] - shorts[j]);
                    longs.emplace_back(longs[i] - longs[j]);
                    break;
                case 2:
                    shorts.push_back(-shorts[i]);
                    longs.emplace_back(-longs[i]);
                    break;
                default:
                    shorts.push_back(shorts[i] * shorts[j]);
                    longs.emplace_back(longs[i] * longs[j]);
            }
            if (!is_known(shorts.back())) {
                ++unknown;
                continue;
            }
            EXPECT_EQ(sign_of(shorts.back()), sgn(longs.back()));
            EXPECT_EQ(shorts.back().to_mpz(), longs.back());
        }
    }
    EXPECT_GT(unknown, 100);
    EXPECT_LT(unknown, 20000);
}

TEST(Int126, DifferencesAreWholeNumbersOfTheInputOrNotKnown) {
    PlanArrangement g;
    const VertexId a = g.add_vertex(0.75, -3), b = g.add_vertex(1e6, 2.5),
                   far = g.add_vertex(1e30, 0);
    const SpaceId low = g.add_space_vertex(a, 0.125), high = g.add_space_vertex(b, 7);
    g.freeze_vertices();
    const ShortArithmetic in(g);
    const IntegerArithmetic exact{g};
    EXPECT_EQ(in.dx(b, a).to_mpz(), exact.dx(b, a));
    EXPECT_EQ(in.dy(a, b).to_mpz(), exact.dy(a, b));
    EXPECT_EQ(in.dz(high, low).to_mpz(), exact.dz(high, low));
    EXPECT_EQ(in.plan(0.75).to_mpz(), exact.plan(0.75));
    EXPECT_EQ(in.height(7).to_mpz(), exact.height(7));
    EXPECT_FALSE(is_known(in.dx(far, a)));
}

TEST(Int126, NoAnswerFromShortOnesIsGivenByLongOnes) {
    PlanArrangement g;
    const VertexId a = g.add_vertex(1e-30, 0), b = g.add_vertex(1e30, 1);
    g.freeze_vertices();
    int asked = 0;
    const int sign = exactly(g, [&](const auto& in, auto) -> std::optional<int> {
        ++asked;
        const auto d = in.dx(b, a);
        return is_known(d) ? std::optional(sign_of(d)) : std::nullopt;
    });
    EXPECT_EQ(sign, 1);
    EXPECT_GE(asked, 2);  // by each shorter type there is, and by GMP
}

}  // namespace
}  // namespace realmodel::exact
