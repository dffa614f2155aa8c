// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/kriging/tiled_cholesky.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <new>
#include <random>

#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {
namespace {

/// An exponential covariance on a line.
double entry(Eigen::Index i, Eigen::Index j) {
    return std::exp(-0.05 * std::abs(static_cast<double>(i - j)));
}

Eigen::MatrixXd matrix_of(Eigen::Index order, const TiledCholesky::Entry& of) {
    Eigen::MatrixXd out(order, order);
    for (Eigen::Index i = 0; i < order; ++i) {
        for (Eigen::Index j = 0; j < order; ++j)
            out(i, j) = of(std::max(i, j), std::min(i, j));
    }
    return out;
}

TEST(TiledCholesky, SolvesAsEigenDoesForAnyNumberOfThreads) {
    for (const Eigen::Index order : {1, 7, 127, 128, 129, 300, 400}) {
        Eigen::MatrixXd right(order, 3);
        for (Eigen::Index i = 0; i < order; ++i)
            right.row(i) << 1, std::sin(0.1 * static_cast<double>(i)), static_cast<double>(i % 5);
        const Eigen::MatrixXd expected =
            Eigen::LLT<Eigen::MatrixXd>(matrix_of(order, entry)).matrixL().solve(right);
        Eigen::MatrixXd first;
        for (const int threads : {1, 2, 5}) {
            const TiledCholesky factor(order, entry, 1e-10, {threads, nullptr}, 1);
            Eigen::MatrixXd found = right;
            factor.solve(found, nullptr);
            EXPECT_LT((found - expected).norm(), 1e-12 * expected.norm()) << order;
            if (threads == 1) first = found;
            EXPECT_EQ(found, first);
        }
    }
}

TEST(TiledCholesky, SolvesByTheTransposedFactorAndKnowsTheDeterminant) {
    for (const Eigen::Index order : {1, 128, 300}) {
        const Eigen::LLT<Eigen::MatrixXd> expected(matrix_of(order, entry));
        const TiledCholesky factor(order, entry, 1e-10, {2, nullptr}, 1);
        Eigen::MatrixXd right(order, 2);
        for (Eigen::Index i = 0; i < order; ++i)
            right.row(i) << 1, std::sin(0.1 * static_cast<double>(i));
        Eigen::MatrixXd found = right;
        factor.solve(found, nullptr);
        factor.solve_transposed(found, nullptr);
        EXPECT_LT((found - expected.solve(right)).norm(), 1e-11 * found.norm());
        const Eigen::MatrixXd lower = expected.matrixL();
        const double logs = 2 * lower.diagonal().array().log().sum();
        EXPECT_NEAR(factor.log_determinant(), logs, 1e-9 * std::max(1.0, std::abs(logs)));
    }
}

TEST(TiledCholesky, RowsThatOthersDetermineAreLeftOut) {
    // Rows 130 and 131 repeat 5 and 40: what is left is the factor without them.
    const auto of = [](Eigen::Index i) { return i == 130 ? 5 : i == 131 ? 40 : i; };
    const auto repeated = [&](Eigen::Index i, Eigen::Index j) { return entry(of(i), of(j)); };
    const TiledCholesky factor(200, repeated, 1e-10, {2, nullptr}, 1);
    for (Eigen::Index i = 0; i < 200; ++i)
        EXPECT_EQ(factor.left_out(i), i == 130 || i == 131);
    Eigen::MatrixXd found = Eigen::MatrixXd::Ones(200, 1);
    factor.solve(found, nullptr);
    EXPECT_EQ(found(130, 0), 0);
    const auto skipped = [](Eigen::Index i) { return i < 130 ? i : i + 2; };
    const TiledCholesky without(
        198, [&](Eigen::Index i, Eigen::Index j) { return entry(skipped(i), skipped(j)); }, 1e-10,
        {1, nullptr}, 1);
    Eigen::MatrixXd expected = Eigen::MatrixXd::Ones(198, 1);
    without.solve(expected, nullptr);
    for (Eigen::Index i = 0; i < 198; ++i)
        EXPECT_NEAR(found(skipped(i), 0), expected(i, 0), 1e-12);
}

TEST(TiledCholesky, WhatAnEntryThrowsAndCancellingReachTheCaller) {
    for (const int threads : {1, 3}) {
        const auto failing = [](Eigen::Index i, Eigen::Index j) -> double {
            if (i == 300 && j == 200) throw std::bad_alloc();
            return entry(i, j);
        };
        EXPECT_THROW(TiledCholesky(400, failing, 1e-10, {threads, nullptr}, 1), std::bad_alloc);
        Progress progress;
        const auto cancelling = [&](Eigen::Index i, Eigen::Index j) {
            if (i == 300) progress.cancel();
            return entry(i, j);
        };
        EXPECT_THROW(TiledCholesky(400, cancelling, 1e-10, {threads, &progress}, 1), Cancelled);
    }
}

TEST(TiledCholesky, TheMemoryItSays) {
    EXPECT_EQ(TiledCholesky::bytes(128), 128 * 128 * 8);
    EXPECT_EQ(TiledCholesky::bytes(129), 3 * 128 * 128 * 8);
}

}  // namespace
}  // namespace realmodel::interpolation
