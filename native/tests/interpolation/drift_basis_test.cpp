// SPDX-License-Identifier: GPL-3.0-or-later
#include "interpolation/drift_basis.hpp"

#include <gtest/gtest.h>

#include "dense_kriging.hpp"

namespace realmodel::interpolation {
namespace {

Eigen::MatrixXd terms_at(const DriftFrame& frame, const std::vector<PlanPosition>& positions,
                         Drift drift) {
    const auto count = static_cast<Eigen::Index>(positions.size());
    Eigen::MatrixXd out(count, drift_terms(drift));
    for (Eigen::Index i = 0; i < count; ++i)
        out.row(i) = frame.terms(positions[i]);
    return out;
}

TEST(DriftFrame, TermsAreCountedFromTheMeanAlongTheGreatestSpread) {
    const std::vector<PlanPosition> along_x{{10, 5}, {14, 5}, {12, 6}, {12, 4}};
    const DriftFrame frame(along_x, Drift::kQuadratic);
    const DriftFrame::Terms at_end = frame.terms({14, 5}), above = frame.terms({12, 7});
    const std::array<double, 6> end{1, 1, 0, 1, 0, 0}, up{1, 0, 1, 0, 0, 1};
    for (int term = 0; term < 6; ++term) {
        EXPECT_NEAR(at_end(term), end[term], 1e-15);
        EXPECT_NEAR(above(term), up[term], 1e-15);
    }
    EXPECT_EQ(drift_terms(Drift::kConstant), 1);
    EXPECT_EQ(drift_terms(Drift::kLinear), 3);
}

TEST(DriftBasis, IsOrthonormalAndSpansTheTerms) {
    const Nodes positions = scattered_nodes(30, 500);
    const DriftFrame frame(positions, Drift::kQuadratic);
    const Eigen::MatrixXd terms = terms_at(frame, positions, Drift::kQuadratic);
    DriftBasis basis;
    basis.make(terms, terms);
    ASSERT_EQ(basis.size(), 6);
    const Eigen::VectorXd trend = terms * Eigen::VectorXd::LinSpaced(6, 1, 3);
    EXPECT_NEAR((basis.expand(basis.project(trend)) - trend).norm(), 0, 1e-12);
    for (Eigen::Index a = 0; a < 6; ++a) {
        for (Eigen::Index b = 0; b < 6; ++b) {
            double product = 0;
            for (Eigen::Index i = 0; i < terms.rows(); ++i)
                product += basis.orthonormal(i, a) * basis.orthonormal(i, b);
            EXPECT_NEAR(product, a == b ? 1 : 0, 1e-13);
        }
    }
    // solve() gives the row of Q of a position that is among the data.
    const DriftBasis::Coefficients row = basis.solve(frame.terms(positions[7]));
    for (Eigen::Index a = 0; a < 6; ++a)
        EXPECT_NEAR(row(a), basis.orthonormal(7, a), 1e-12);
}

TEST(DriftBasis, TermsThatThePointsDoNotDistinguishAreLeftOut) {
    std::vector<PlanPosition> line, two{{0, 0}, {3, 4}}, one{{1, 2}};
    for (int i = 0; i < 9; ++i)
        line.push_back({3.0 * i, 4.0 * i});
    const auto kept = [](const std::vector<PlanPosition>& positions, Drift drift) {
        const Eigen::MatrixXd terms = terms_at(DriftFrame(positions, drift), positions, drift);
        DriftBasis basis;
        basis.make(terms, terms);
        return basis.size();
    };
    EXPECT_EQ(kept(line, Drift::kLinear), 2);
    EXPECT_EQ(kept(line, Drift::kQuadratic), 3);
    EXPECT_EQ(kept(two, Drift::kQuadratic), 2);
    EXPECT_EQ(kept(one, Drift::kLinear), 1);
}

}  // namespace
}  // namespace realmodel::interpolation
