// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/validation/topology.hpp"

#include <algorithm>
#include <cmath>

#include "../sanitized.hpp"
#include "../strata/complex_checks.hpp"
#include "realmodel/base/errors.hpp"
#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

using Names = std::vector<std::string>;

std::vector<TestResult> check(OwnedComplex& complex, int threads = 1) {
    return check_topology(complex.view(), {threads, nullptr});
}

/// The one offender that a test must have named.
Offender only(const std::vector<TestResult>& results, const std::string& name) {
    const Findings& found = findings(results, name);
    EXPECT_EQ(found.failed, 1) << name;
    if (found.first.empty()) return {};
    return found.first.front();
}

TEST(Topology, PassesTwoCubes) {
    auto cubes = two_cubes();
    const auto results = check(cubes);
    EXPECT_EQ(failed(results), Names{});
    EXPECT_EQ(findings(results, "closed").examined, 2);
    EXPECT_EQ(findings(results, "faces").examined, 11);
    EXPECT_EQ(findings(results, "vertices").examined, 12);
    EXPECT_EQ(findings(results, "outside").examined, 10);
    EXPECT_EQ(findings(results, "block volumes").examined, 2);
    EXPECT_EQ(findings(results, "volumes").undecided, 0);
}

TEST(Topology, FindsAnOpenCell) {
    auto cubes = two_cubes();
    cubes.loops.erase(cubes.loops.begin() + 5);
    cubes.cells.erase(cubes.cells.begin() + 5);
    cubes.surface.erase(cubes.surface.begin() + 5);
    const auto results = check(cubes);
    const Offender found = only(results, "closed");
    EXPECT_EQ(found.cell, 0);
    EXPECT_EQ(found.block, 0);
    EXPECT_EQ(found.text,
              "cell 0 is not closed: its faces use edge 2-3 0 times one way and once "
              "the other");
    EXPECT_EQ(found.place, (std::array<double, 3>{1, 1, 0}));
}

TEST(Topology, FindsAFaceTurnedOver) {
    auto cubes = two_cubes();
    std::reverse(cubes.loops[1].begin(), cubes.loops[1].end());
    const auto results = check(cubes);
    EXPECT_EQ(findings(results, "closed").failed, 2);
    EXPECT_EQ(findings(results, "closed").first[1].cell, 1);
    EXPECT_EQ(findings(results, "closed").first[0].text,
              "cell 0 is not closed: its faces use edge 4-5 0 times one way and 2 times the other");
}

TEST(Topology, FindsASideMissing) {
    auto cubes = two_cubes();
    cubes.cells[1][1] = -1;
    EXPECT_EQ(only(check(cubes), "closed").cell, 1);
}

/// Two cubes side by side in one block that touch along an edge, as one cell.
OwnedComplex touching_cubes() {
    OwnedComplex o;
    const auto vertex = [&](double x, double y, double z) {
        const std::array<double, 3> p{x, y, z};
        const auto at = std::find(o.vertices.begin(), o.vertices.end(), p);
        if (at == o.vertices.end()) o.vertices.push_back(p);
        return static_cast<std::int32_t>(std::find(o.vertices.begin(), o.vertices.end(), p) -
                                         o.vertices.begin());
    };
    for (const double at : {0.0, 1.0}) {
        std::vector<std::int32_t> v;
        for (const double z : {0.0, 1.0}) {
            for (const auto& [x, y] : {std::pair(0.0, 0.0), {1.0, 0.0}, {1.0, 1.0}, {0.0, 1.0}})
                v.push_back(vertex(at + x, at + y, z));
        }
        o.add_face({v[3], v[2], v[1], v[0]}, 0, -1, 0);
        o.add_face({v[4], v[5], v[6], v[7]}, 0, -1, 1);
        for (std::size_t i = 0; i < 4; ++i) {
            const std::size_t j = (i + 1) % 4;
            o.add_face({v[i], v[j], v[j + 4], v[i + 4]}, 0, -1, strata::kWall);
        }
    }
    o.block = {0};
    o.volume = {2.0};
    o.base = {std::numeric_limits<double>::quiet_NaN()};
    o.surfaces = 2;
    return o;
}

TEST(Topology, AllowsAnEdgeUsedFourTimesInBlocksOnly) {
    auto cubes = touching_cubes();
    EXPECT_EQ(failed(check(cubes)), Names{"closed"});
    EXPECT_NE(only(check(cubes), "closed").text.find("2 times one way and 2 times the other"),
              std::string::npos);
    cubes.blocks = true;
    EXPECT_EQ(failed(check(cubes)), Names{});
}

TEST(Topology, FindsAnUnbalancedEdgeInBlocks) {
    auto cubes = touching_cubes();
    cubes.blocks = true;
    std::reverse(cubes.loops[3].begin(), cubes.loops[3].end());
    EXPECT_EQ(only(check(cubes), "closed").cell, 0);
}

TEST(Topology, FindsALoopThatRepeatsAVertex) {
    auto cubes = two_cubes();
    cubes.loops[2] = {8, 9, 10, 9, 10, 11};
    const Offender found = only(check(cubes), "loops");
    EXPECT_EQ(found.face, 2);
    EXPECT_EQ(found.vertex, 9);
    // and where there are many
    std::vector<std::int32_t>& loop = cubes.loops[2];
    loop = {8, 9, 10, 11};
    for (std::int32_t i = 0; i < 20; ++i) {
        cubes.vertices.push_back({0, 1 - 0.04 * (i + 1), 2});
        loop.push_back(12 + i);
    }
    EXPECT_EQ(findings(check(cubes), "loops").failed, 0);
    loop.push_back(20);
    EXPECT_EQ(only(check(cubes), "loops").vertex, 20);
}

TEST(Topology, FindsEqualVertices) {
    auto cubes = two_cubes();
    cubes.vertices.push_back({1, -0.0, 2});
    cubes.loops[8] = {5, 6, 10, 12};  // instead of vertex 9
    const auto results = check(cubes);
    const Offender found = only(results, "vertices");
    EXPECT_EQ(found.vertex, 12);
    EXPECT_EQ(found.text, "vertex 12 has the coordinates of vertex 9");
    EXPECT_EQ(only(results, "closed").cell, 1);
}

TEST(Topology, FindsUnusedVertices) {
    auto cubes = two_cubes();
    cubes.vertices.push_back({7, 7, 7});
    const Offender found = only(check(cubes), "vertices");
    EXPECT_EQ(found.vertex, 12);
    EXPECT_EQ(found.text, "vertex 12 belongs to no face");
}

TEST(Topology, FindsABentFace) {
    auto cubes = two_cubes();
    cubes.vertices[10][2] += 1e-12;
    const Offender found = only(check(cubes), "faces");
    EXPECT_EQ(found.face, 2);
    EXPECT_EQ(found.text, "face 2 is bent: its corners lie in no plane");
}

TEST(Topology, TakesRoundingForWhatItIs) {
    auto cubes = two_cubes();
    cubes.vertices[10][2] = std::nextafter(2.0, 3.0);
    cubes.vertices[5][0] = std::nextafter(1.0, 0.0);  // the wall leans, the level face is concave
    cubes.vertices[9][0] = std::nextafter(1.0, 2.0);
    EXPECT_EQ(failed(check(cubes)), Names{});
    // far from the origin the same step is large
    for (auto& v : cubes.vertices)
        v[0] += 4.5e6;
    EXPECT_EQ(failed(check(cubes)), Names{});
    cubes.vertices[5][0] += 1e-6;
    EXPECT_EQ(failed(check(cubes)), (Names{"faces", "block volumes"}));
}

TEST(Topology, FindsAFaceThatIsNotConvex) {
    auto cubes = two_cubes();
    cubes.vertices.push_back({0.5, 0.25, 2});  // dents the top, and its wall with it
    cubes.loops[2] = {8, 12, 9, 10, 11};
    cubes.loops[7] = {4, 5, 9, 12, 8};
    cubes.volume[1] = 1 - 0.125 / 3;
    const auto results = check(cubes);
    const Findings& found = findings(results, "faces");
    EXPECT_EQ(found.failed, 2);
    EXPECT_EQ(found.first[0].text, "face 2 is not convex");
    EXPECT_EQ(found.first[1].text, "face 7 is a wall but is not vertical");
}

TEST(Topology, AllowsAWallThatIsNotConvex) {
    auto cubes = two_cubes();
    // the base bulges into the wall: not level any more, the wall is a simple polygon still
    cubes.vertices.push_back({0.5, 0, 0.25});
    cubes.loops[0] = {3, 2, 1, 12, 0};
    cubes.loops[3] = {0, 12, 1, 5, 4};
    const auto results = check(cubes);
    EXPECT_EQ(only(results, "faces").text, "face 0 is not level with the flat base");
}

TEST(Topology, FindsAFaceThatCrossesItself) {
    auto cubes = two_cubes();
    cubes.loops[2] = {8, 9, 11, 10};
    cubes.loops[7] = {4, 5, 8, 9};  // a wall
    const Findings found = findings(check(cubes), "faces");
    ASSERT_EQ(found.failed, 2);
    EXPECT_EQ(found.first[0].text, "face 2 crosses itself");
    EXPECT_EQ(found.first[1].text, "face 7 crosses itself");
}

TEST(Topology, FindsAWallThatComesBackAndCrossesItself) {
    auto cubes = two_cubes();
    // not a chain there and a chain back: a flag on its side whose end crosses its beginning
    cubes.vertices.insert(cubes.vertices.end(),
                          {{0.75, 0, 1.25}, {0.25, 0, 1.5}, {0.75, 0, 1.75}, {0.5, 0, 0.5}});
    cubes.loops[7] = {4, 5, 12, 13, 14, 9, 8};
    EXPECT_EQ(findings(check(cubes), "faces").failed, 0);
    cubes.loops[7] = {4, 5, 12, 13, 15, 9, 8};
    EXPECT_EQ(only(check(cubes), "faces").text, "face 7 crosses itself");
}

TEST(Topology, FindsAWallThatLeans) {
    auto cubes = two_cubes();
    for (std::size_t v : {8u, 9u})
        cubes.vertices[v][1] = 0.25;
    cubes.volume[1] = 0.875;
    EXPECT_EQ(only(check(cubes), "faces").text, "face 7 is a wall but is not vertical");
}

TEST(Topology, FindsABaseWhereNoneIs) {
    auto cubes = two_cubes();
    cubes.base[0] = 0.5;
    EXPECT_EQ(only(check(cubes), "faces").text, "face 0 is not level with the flat base");
    cubes.base[0] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(only(check(cubes), "faces").text,
              "face 0 names the flat base, but its block stands on none");
    cubes = two_cubes();
    cubes.surface[1] = strata::kBase;
    EXPECT_EQ(only(check(cubes), "faces").face, 1);
}

TEST(Topology, FindsAFaceStoredTwice) {
    auto cubes = two_cubes();
    cubes.cells[1][1] = -1;
    cubes.add_face({5, 4, 7, 6}, 1, -1, 0);
    const auto results = check(cubes);
    EXPECT_EQ(failed(results), Names{"outside"});
    const Offender found = only(results, "outside");
    EXPECT_EQ(found.face, 11);
    EXPECT_EQ(found.cell, 1);
    EXPECT_EQ(found.text, "face 11 has one cell, but face 1 of cell 0 lies at the same position");
}

TEST(Topology, FindsACellInsideOut) {
    auto cubes = two_cubes();
    for (auto& loop : cubes.loops)
        std::reverse(loop.begin(), loop.end());
    cubes.volume = {-1.0, -1.0};
    const auto results = check(cubes);
    EXPECT_EQ(failed(results), Names{"volumes"});
    EXPECT_EQ(findings(results, "volumes").first[1].text, "cell 1 is inside out: its volume is -1");
    EXPECT_EQ(findings(results, "volumes").first[1].place, (std::array<double, 3>{0.5, 0.5, 1.5}));
}

TEST(Topology, FindsAFlatCell) {
    auto cubes = two_cubes();
    cubes.base[0] = 1.0;
    for (std::size_t v = 0; v < 4; ++v)
        cubes.vertices[v][2] = 1.0;
    cubes.volume[0] = 0.0;
    const auto results = check(cubes);
    EXPECT_EQ(only(results, "volumes").text, "cell 0 is flat");
    EXPECT_EQ(findings(results, "vertices").failed, 4);
}

TEST(Topology, FindsAWrongBlockVolume) {
    auto cubes = two_cubes();
    cubes.volume[1] = 1 + 1e-8;
    const auto results = check(cubes);
    EXPECT_EQ(failed(results), Names{"block volumes"});
    EXPECT_EQ(only(results, "block volumes").text,
              "block 1 is reported with volume 1.00000001, its cells have 1");
    cubes.volume[1] = 1 + 1e-13;
    EXPECT_EQ(failed(check(cubes)), Names{});
}

TEST(Topology, ReadsNothingOutOfRange) {
    const auto spoilt = [](const auto& spoil) {
        auto cubes = two_cubes();
        spoil(cubes);
        const auto results = check(cubes);
        EXPECT_EQ(failed(results), Names{"arrays"});
        EXPECT_EQ(results.size(), 1u);
        return findings(results, "arrays").first.at(0).text;
    };
    EXPECT_EQ(spoilt([](auto& c) { c.loops[3] = {1, 2}; }), "face 3 has 2 corners");
    EXPECT_EQ(spoilt([](auto& c) { c.loops[3][1] = 12; }), "face 3 names vertex 12");
    EXPECT_EQ(spoilt([](auto& c) { c.loops[3][1] = -1; }), "face 3 names vertex -1");
    EXPECT_EQ(spoilt([](auto& c) { c.cells[3] = {-1, 0}; }), "face 3 lies between cells -1 and 0");
    EXPECT_EQ(spoilt([](auto& c) { c.cells[3] = {0, 2}; }), "face 3 lies between cells 0 and 2");
    EXPECT_EQ(spoilt([](auto& c) { c.cells[3] = {0, 0}; }), "face 3 lies between cells 0 and 0");
    EXPECT_EQ(spoilt([](auto& c) { c.surface[3] = 2; }), "face 3 names surface 2");
    EXPECT_EQ(spoilt([](auto& c) { c.surface[3] = -4; }), "face 3 names surface -4");
    EXPECT_EQ(spoilt([](auto& c) { c.block[1] = 2; }), "cell 1 names block 2");
    EXPECT_EQ(spoilt([](auto& c) { c.block.push_back(0); }), "cell 2 has no faces");
    EXPECT_EQ(spoilt([](auto& c) { c.vertices[4][1] = HUGE_VAL; }), "vertex 4 is not finite");
    EXPECT_EQ(spoilt([](auto& c) { c.base.pop_back(); }), "blocks without a volume or base");
}

TEST(Topology, ReadsNothingOutOfRangeInWrongOffsets) {
    auto cubes = two_cubes();
    auto view = cubes.view();
    for (const std::int64_t wrong : {-1, 3, 40, 1000}) {
        cubes.offsets[3] = wrong;
        EXPECT_EQ(failed(check_topology(view, {1, nullptr})), Names{"arrays"}) << wrong;
    }
    cubes.offsets[3] = 12;
    view.face_offsets = view.face_offsets.subspan(1);
    EXPECT_EQ(failed(check_topology(view, {1, nullptr})), Names{"arrays"});
}

/// A model of about `n` x `n` x 4 cells: as columns, or as blocks that are large cells.
OwnedComplex terrain(int n, bool blocks) {
    std::vector<strata::OwnedSurface> surfaces;
    for (int k = 0; k < 3; ++k) {
        surfaces.push_back(strata::grid(
            n, n + k, 0, 0, 8, 8,
            [k](double x, double y) { return 0.3 * k + std::sin(x + k) + std::cos(y - k); },
            k == 1));
    }
    auto built = strata::build(surfaces);
    if (blocks) built = strata::merge_columns(built);
    return owned(built, blocks);
}

TEST(Topology, PassesTerrainsWithTheSameFindingsForAnyThreads) {
    for (const bool blocks : {false, true}) {
        auto model = terrain(kSanitized ? 25 : 50, blocks);
        EXPECT_EQ(failed(check(model)), Names{});
        for (std::size_t f = 100; f < model.loops.size(); f += 997)
            std::reverse(model.loops[f].begin(), model.loops[f].end());
        model.vertices.push_back(model.vertices[77]);
        const auto expected = check(model);
        EXPECT_FALSE(findings(expected, "closed").passed());
        EXPECT_EQ(findings(expected, "vertices").failed, 2);
        for (const int threads : {2, 5}) {
            if (kSanitized && threads == 2) continue;
            const auto results = check(model, threads);
            ASSERT_EQ(results.size(), expected.size());
            for (std::size_t i = 0; i < results.size(); ++i) {
                const Findings &a = results[i].findings, &b = expected[i].findings;
                EXPECT_EQ(a.failed, b.failed);
                EXPECT_EQ(a.undecided, b.undecided);
                ASSERT_EQ(a.first.size(), b.first.size());
                for (std::size_t j = 0; j < a.first.size(); ++j)
                    EXPECT_EQ(a.first[j].text, b.first[j].text);
            }
        }
    }
}

TEST(Topology, FindsAHoleInALargeCell) {
    auto model = terrain(60, true);
    std::size_t top = 0;
    while (model.cells[top][1] >= 0 || model.surface[top] == strata::kWall)
        ++top;
    const std::int32_t cell = model.cells[top][0];
    model.loops.erase(model.loops.begin() + static_cast<std::ptrdiff_t>(top));
    model.cells.erase(model.cells.begin() + static_cast<std::ptrdiff_t>(top));
    model.surface.erase(model.surface.begin() + static_cast<std::ptrdiff_t>(top));
    EXPECT_EQ(only(check(model, 2), "closed").cell, cell);
}

TEST(Topology, CanBeCancelled) {
    auto model = terrain(20, false);
    Progress progress;
    progress.cancel();
    EXPECT_THROW(check_topology(model.view(), {2, &progress}), Cancelled);
}

}  // namespace
}  // namespace realmodel::validation
