// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/validation/sampling.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "../strata/complex_checks.hpp"
#include "realmodel/base/errors.hpp"
#include "small_complex.hpp"

namespace realmodel::validation {
namespace {

using strata::OwnedSurface;
using strata::Rule;
using Names = std::vector<std::string>;

struct OwnedRegion {
    std::vector<double> vertices;
    std::vector<std::int32_t> triangles;
};

/// A rock mass that owns its arrays.
struct OwnedRock {
    std::vector<OwnedSurface> surfaces;
    std::vector<Rule> rules;
    std::optional<OwnedRegion> region;
    std::optional<double> base;

    strata::StackInput view() const {
        strata::StackInput input;
        for (const OwnedSurface& s : surfaces)
            input.surfaces.push_back(s.view());
        input.rules = rules;
        if (region) input.region = TriangleView{region->vertices, region->triangles};
        input.base_elevation = base;
        return input;
    }
};

std::vector<strata::StackInput> views(const std::vector<OwnedRock>& rocks) {
    std::vector<strata::StackInput> input;
    for (const OwnedRock& rock : rocks)
        input.push_back(rock.view());
    return input;
}

OwnedComplex model_of(const std::vector<OwnedRock>& rocks, bool blocks = false) {
    auto built = strata::build_rock_masses(views(rocks), {1, nullptr});
    if (blocks) built = strata::merge_columns(built);
    OwnedComplex model = owned(built, blocks);
    std::size_t first = 0;
    for (const OwnedRock& rock : rocks) {
        if (rock.base) model.base[first] = *rock.base;
        first += rock.surfaces.size();
    }
    return model;
}

/// Blocks are numbered as their surfaces; there are as many.
std::vector<TestResult> sample(OwnedComplex& model, const std::vector<OwnedRock>& rocks,
                               int places = 400, std::uint64_t seed = 1, int threads = 1) {
    std::vector<std::int32_t> block(static_cast<std::size_t>(model.surfaces));
    std::iota(block.begin(), block.end(), 0);
    const auto input = views(rocks);
    return check_samples(model.view(), {input, block}, places, seed, {threads, nullptr});
}

OwnedSurface level(double x0, double x1, double y0, double y1, double z, int n = 1) {
    return strata::grid(
        n, n, x0, y0, x1, y1, [z](double, double) { return z; }, n % 2 == 0);
}

OwnedRegion box_region(double x0, double x1, double y0, double y1) {
    return {{x0, y0, x1, y0, x1, y1, x0, y1}, {0, 1, 2, 0, 2, 3}};
}

/// Waves, a plane that cuts them, a part of the plan only, something that stays out of it all.
OwnedRock landscape(const std::vector<Rule>& rules = {}) {
    OwnedRock rock;
    rock.surfaces.push_back(strata::grid(
        6, 7, 0, 0, 8, 8, [](double x, double y) { return std::sin(x) + std::cos(y); }));
    rock.surfaces.push_back(strata::grid(
        5, 5, 0, 0, 8, 8, [](double x, double) { return 0.4 * x - 1.3; }, true));
    rock.surfaces.push_back(level(2, 6.5, 1.25, 7, 2.5, 3));
    rock.surfaces.push_back(strata::grid(
        4, 4, 0, 0, 7, 8, [](double x, double y) { return 3 - 0.5 * std::cos(x - y); }));
    rock.base = -5.0;
    rock.rules = rules;
    return rock;
}

TEST(Sampling, PassesLandscapesUnderAllRules) {
    constexpr Rule e = Rule::kErosional, c = Rule::kConformable, b = Rule::kBase,
                   d = Rule::kDiscontinuous;
    for (const std::vector<Rule>& rules : {std::vector<Rule>{},
                                           std::vector<Rule>{e, c, d, e},
                                           {b, e, c, e},
                                           {d, c, b, e},
                                           {c, d, e, b}}) {
        for (const bool blocks : {false, true}) {
            std::vector<OwnedRock> rocks{landscape(rules)};
            auto model = model_of(rocks, blocks);
            const auto results = sample(model, rocks, 2000);
            EXPECT_EQ(failed(results), Names{});
            EXPECT_GE(findings(results, "places").examined, 1900);
            EXPECT_GE(findings(results, "walls").examined, 500);
            EXPECT_GE(findings(results, "surfaces").examined, 4000);
            EXPECT_LE(findings(results, "places").undecided, 20);
            EXPECT_LE(findings(results, "walls").undecided, 20);
        }
    }
}

TEST(Sampling, RefusesTheModelOfOtherRules) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks);
    using enum Rule;
    for (std::vector<Rule> rules :
         {std::vector<Rule>{kErosional, kConformable, kErosional, kErosional},
          {kBase, kErosional, kErosional, kErosional}}) {
        rocks[0].rules = rules;
        EXPECT_FALSE(findings(sample(model, rocks), "places").passed());
    }
}

TEST(Sampling, FindsAWrongBlock) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks, true);
    auto& block = model.block[0];
    block = block == 0 ? 1 : 0;
    const Findings found = findings(sample(model, rocks), "places");
    ASSERT_FALSE(found.passed());
    EXPECT_NE(found.first[0].text.find("the model has block"), std::string::npos);
    EXPECT_NE(found.first[0].text.find("; the closed form has block"), std::string::npos);
    EXPECT_TRUE(found.first[0].place);
}

TEST(Sampling, FindsASurfaceMovedByVeryLittle) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks);
    for (std::size_t i = 2; i < rocks[0].surfaces[1].vertices.size(); i += 3)
        rocks[0].surfaces[1].vertices[i] += 1e-12;
    const auto results = sample(model, rocks);
    EXPECT_FALSE(findings(results, "places").passed());
    EXPECT_FALSE(findings(results, "surfaces").passed());
}

TEST(Sampling, FindsABorderMovedByVeryLittle) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks);
    for (std::size_t i = 0; i < rocks[0].surfaces[2].vertices.size(); i += 3) {
        double& x = rocks[0].surfaces[2].vertices[i];
        if (x == 6.5) x += 1e-12;
    }
    EXPECT_EQ(failed(sample(model, rocks, 8000)), Names{"places"});
}

TEST(Sampling, FindsAFaceThatNamesAnotherSurface) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks);
    std::replace(model.surface.begin(), model.surface.end(), 1, 3);
    const auto results = sample(model, rocks);
    EXPECT_EQ(failed(results), Names{"surfaces"});
    EXPECT_NE(findings(results, "surfaces").first[0].text.find("the surface 3 that it names"),
              std::string::npos);
}

TEST(Sampling, FindsWhatIsMissingAndWhatIsTooMuch) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks);
    OwnedComplex nothing;
    nothing.volume = model.volume;
    nothing.base = model.base;
    nothing.surfaces = model.surfaces;
    const Findings none = findings(sample(nothing, rocks), "places");
    ASSERT_FALSE(none.passed());
    EXPECT_NE(none.first[0].text.find("the model has nothing; the closed form has block 0"),
              std::string::npos);
    rocks[0].region = box_region(0, 5, 0, 8);
    const Findings more = findings(sample(model, rocks), "places");
    ASSERT_FALSE(more.passed());
    EXPECT_NE(more.first[0].text.find("; the closed form has nothing"), std::string::npos);
}

TEST(Sampling, PassesRegionsWithHoles) {
    std::vector<OwnedRock> rocks{landscape()};
    // an L of two boxes that leaves out a corner, and one apart
    OwnedRegion region = box_region(0.5, 5, 0.5, 3.3);
    const std::vector<double> more{0.5, 3.3, 3, 3.3, 3, 7.7, 0.5, 7.7, 6, 5, 7, 5, 7, 6, 6, 6};
    region.vertices.insert(region.vertices.end(), more.begin(), more.end());
    for (const std::int32_t first : {4, 8}) {
        for (const std::int32_t i : {0, 1, 2, 0, 2, 3})
            region.triangles.push_back(first + i);
    }
    rocks[0].region = region;
    for (const bool blocks : {false, true}) {
        auto model = model_of(rocks, blocks);
        EXPECT_EQ(failed(sample(model, rocks, 1000)), Names{});
    }
}

/// Two rock masses that share the border x = 1, with different heights there.
std::vector<OwnedRock> neighbors() {
    std::vector<OwnedRock> rocks(2);
    rocks[0].surfaces = {level(0, 1, 0, 1, 0), level(0, 1, 0, 1, 2), level(0, 1, 0, 1, 3, 2)};
    rocks[1].surfaces = {level(1, 2, 0, 1, 1, 3), level(1, 2, 0, 1, 2.5, 2)};
    rocks[1].base = -1.0;
    return rocks;
}

TEST(Sampling, PassesWallsBetweenRockMasses) {
    for (const bool blocks : {false, true}) {
        const auto rocks = neighbors();
        auto model = model_of(rocks, blocks);
        const auto results = sample(model, rocks, 1000);
        EXPECT_EQ(failed(results), Names{});
        EXPECT_EQ(findings(results, "walls").undecided, 0);
    }
}

TEST(Sampling, FindsAWallThatNamesTheWrongSide) {
    const auto rocks = neighbors();
    auto model = model_of(rocks, true);
    std::size_t between = 0;
    while (model.cells[between][1] < 0 || model.surface[between] != strata::kWall)
        ++between;
    const std::int32_t second = model.cells[between][1];
    model.cells[between][1] = -1;
    const auto results = sample(model, rocks, 2000);
    EXPECT_EQ(failed(results), Names{"walls"});
    const Offender& found = findings(results, "walls").first[0];
    EXPECT_EQ(found.face, static_cast<std::int64_t>(between));
    EXPECT_NE(found.text.find("has the outside on its second side, but block " +
                              std::to_string(model.block[static_cast<std::size_t>(second)])),
              std::string::npos);
}

/// A level face inside that was stored twice, the second time divided: closed cells, no two faces
/// with the same corners, and still not one model.
TEST(Sampling, FindsACutThroughTheInside) {
    std::vector<OwnedRock> rocks(1);
    rocks[0].surfaces = {level(0, 1, 0, 1, 1), level(0, 1, 0, 1, 2)};
    rocks[0].base = 0.0;
    auto cubes = two_cubes();
    EXPECT_EQ(failed(sample(cubes, rocks)), Names{});
    cubes.cells[1][1] = -1;
    cubes.add_face({4, 7, 6}, 1, -1, 0);
    cubes.add_face({4, 6, 5}, 1, -1, 0);
    EXPECT_EQ(failed(check_topology(cubes.view(), {1, nullptr})), Names{});
    const auto results = sample(cubes, rocks);
    ASSERT_EQ(failed(results), Names{"places"});
    EXPECT_NE(findings(results, "places").first[0].text.find("lies apart from what is below it"),
              std::string::npos);
}

TEST(Sampling, LeavesOpenWhatIsNarrowerThanRounding) {
    // a slit of one unit in the last place between two parts of a surface
    std::vector<OwnedRock> rocks(1);
    OwnedSurface top = level(0, 1, 0, 1, 1);
    const double beyond = std::nextafter(1.0, 2.0);
    const auto a = top.vertex(beyond, 0, 1), b = top.vertex(2, 0, 1), c = top.vertex(2, 1, 1),
               d = top.vertex(beyond, 1, 1);
    top.triangle(a, b, c);
    top.triangle(a, c, d);
    rocks[0].surfaces = {level(0, 2, 0, 1, 0), top};
    for (const bool blocks : {false, true}) {
        auto model = model_of(rocks, blocks);
        const auto results = sample(model, rocks, 1000);
        EXPECT_EQ(failed(results), Names{});
    }
}

TEST(Sampling, ManyThreadsFindTheSame) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks);
    model.block[7] = model.block[7] == 1 ? 2 : 1;
    std::replace(model.surface.begin(), model.surface.end(), 1, 3);
    const auto expected = sample(model, rocks, 3000, 5);
    EXPECT_FALSE(findings(expected, "surfaces").passed());
    for (const int threads : {2, 5}) {
        const auto results = sample(model, rocks, 3000, 5, threads);
        for (std::size_t i = 0; i < results.size(); ++i) {
            const Findings &one = results[i].findings, &other = expected[i].findings;
            EXPECT_EQ(one.examined, other.examined);
            EXPECT_EQ(one.failed, other.failed);
            EXPECT_EQ(one.undecided, other.undecided);
            ASSERT_EQ(one.first.size(), other.first.size());
            for (std::size_t j = 0; j < one.first.size(); ++j)
                EXPECT_EQ(one.first[j].text, other.first[j].text);
        }
    }
    EXPECT_NE(findings(sample(model, rocks, 3000, 6), "surfaces").first[0].text,
              findings(expected, "surfaces").first[0].text);
}

TEST(Sampling, RefusesTrianglesOutOfRange) {
    std::vector<OwnedRock> rocks{landscape()};
    auto model = model_of(rocks);
    rocks[0].surfaces[1].triangles[4] = 999;
    EXPECT_THROW(sample(model, rocks), InputError);
}

}  // namespace
}  // namespace realmodel::validation
