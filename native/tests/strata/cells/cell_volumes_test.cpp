// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/strata/cell_volumes.hpp"

#include <cmath>
#include <numeric>

#include "../complex_checks.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::strata {
namespace {

CellComplex landscape(double x0) {
    const auto height = [x0](double x, double y) { return std::sin(x - x0) + std::cos(y); };
    return build({grid(5, 6, x0, 0, x0 + 8, 8, height),
                  grid(
                      4, 4, x0, 0, x0 + 8, 8, [](double, double) { return 0.25; }, true)},
                 -3.0);
}

std::vector<double> volumes(const CellComplex& c, int threads = 1) {
    return cell_volumes(c.vertices, c.face_offsets, c.face_vertices, c.face_cells,
                        c.cell_block.size(), {threads});
}

TEST(CellVolumes, AddUpToTheBlocks) {
    for (const double x0 : {0.0, 4.5e6}) {
        const CellComplex c = landscape(x0);
        const auto volume = volumes(c);
        std::vector<double> sums(c.volumes.size(), 0.0);
        for (std::size_t i = 0; i < volume.size(); ++i) {
            EXPECT_GT(volume[i], 0);
            sums[static_cast<std::size_t>(c.cell_block[i])] += volume[i];
        }
        for (std::size_t b = 0; b < sums.size(); ++b)
            EXPECT_NEAR(sums[b], c.volumes[b], 1e-7 * c.volumes[b]);
        EXPECT_EQ(volumes(c, 3), volume);
    }
}

TEST(CellVolumes, OfTwoBoxes) {
    const auto level = [](double z) {
        return grid(1, 1, 0, 0, 2, 3, [z](double, double) { return z; });
    };
    const CellComplex c = merge_columns(build({level(1), level(5)}, 0.0));
    EXPECT_EQ(volumes(c).size(), 2u);
    EXPECT_EQ(volumes(c)[0] + volumes(c)[1], 30.0);
    EXPECT_EQ(std::max(volumes(c)[0], volumes(c)[1]), 24.0);
}

TEST(CellVolumes, RefuseNumbersOutOfRange) {
    const auto refuses = [](const auto& spoil) {
        CellComplex c = landscape(0);
        spoil(c);
        EXPECT_THROW(volumes(c), InputError);
    };
    refuses([](CellComplex& c) { c.face_vertices[3] = -1; });
    refuses([](CellComplex& c) { c.face_vertices[3] = 1 << 20; });
    refuses([](CellComplex& c) { c.face_cells[3][1] = 1 << 20; });
    refuses([](CellComplex& c) { c.face_cells[3][0] = -2; });
    refuses([](CellComplex& c) { c.face_offsets[3] = 1 << 20; });
    refuses([](CellComplex& c) { c.face_offsets.pop_back(); });
}

}  // namespace
}  // namespace realmodel::strata
