// SPDX-License-Identifier: GPL-3.0-or-later
// Making, writing, repairing and minimizing stacks.
#include <gtest/gtest.h>
#if !defined(_WIN32)
#include <unistd.h>
#endif

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>

#include "boolean_judge.hpp"
#include "case_file.hpp"
#include "examination.hpp"
#include "generate.hpp"
#include "heights.hpp"
#include "judge.hpp"
#include "minimize.hpp"
#include "mutate.hpp"
#include "repair.hpp"

namespace realmodel::fuzz {
namespace {

const std::filesystem::path kCorpus = std::filesystem::path(REALMODEL_TEST_DATA) / "stacks";

Mesh square(double z) {
    return {{{0, 0, z}, {1, 0, z}, {1, 1, z}, {0, 1, z}}, {{0, 1, 2}, {0, 2, 3}}};
}

TEST(Cases, OfANumberAreTheSameAgain) {
    for (std::uint64_t number = 0; number < 50; ++number) {
        const StackCase stack = case_number(3, number, {});
        EXPECT_EQ(stack.rocks, case_number(3, number, {}).rocks);
        EXPECT_NE(stack.rocks, case_number(4, number, {}).rocks);
    }
}

TEST(Cases, OfEveryFamilyCanBeBuilt) {
    for (std::size_t family = 0; family < families().size(); ++family) {
        int usable = 0;
        for (std::uint64_t seed = 0; seed < 5; ++seed) {
            RandomSource random(seed);
            StackCase stack = make_stack(random, family, 1, 3);
            bool built = false;
            EXPECT_TRUE(make_valid(stack, built).empty());
            usable += built ? 1 : 0;
        }
        EXPECT_GE(usable, 4) << families()[family];
    }
}

TEST(Cases, OfBytesNeedNone) {
    const std::vector<std::uint8_t> bytes{17, 200, 3, 99, 255, 1, 2, 3, 4};
    for (std::size_t count = 0; count <= bytes.size(); ++count) {
        RandomSource random(std::span<const std::uint8_t>(bytes).first(count));
        EXPECT_FALSE(make_case(random, {}).rocks.empty());
    }
}

TEST(Cases, SurviveTheirFiles) {
    const auto file = std::filesystem::temp_directory_path() /
                      ("realmodel-case-" + std::to_string(std::rand()) + ".json");
    for (std::uint64_t number = 0; number < 200; ++number) {
        const StackCase stack = case_number(5, number, {});
        write_case(stack, file, "a \"reason\"");
        const StackCase read = read_case(file);
        EXPECT_EQ(read.rocks, stack.rocks);
        EXPECT_EQ(read.label, stack.label);
    }
    std::ofstream(file) << "{\"surfaces\": [{\"vertices\": [[0, 0]], \"triangles\": []}]}";
    EXPECT_THROW(read_case(file), std::runtime_error);
    std::filesystem::remove(file);
    EXPECT_THROW(read_case(file), std::runtime_error);
}

TEST(Cases, OfTheCorpusAreFound) {
    const auto files = case_files(kCorpus);
    EXPECT_GE(files.size(), 8u);
    for (const auto& file : files)
        EXPECT_GT(triangle_count(read_case(file)), 0u) << file;
}

TEST(Repair, TakesOutWhatIsRefused) {
    StackCase stack{{{{square(0), square(1)}, {}, {}, 5.0}}, ""};
    stack.rocks[0].surfaces[1].triangles.push_back({1, 2, 3});
    stack.rocks.push_back({{square(7), square(8)}, {}, {}, {}});
    bool usable = false;
    EXPECT_TRUE(make_valid(stack, usable).empty());
    EXPECT_TRUE(usable);
    EXPECT_EQ(stack.rocks.size(), 1u);
    EXPECT_EQ(triangle_count(stack), 4u);
    EXPECT_LT(*stack.rocks[0].base_elevation, 0);
}

TEST(Repair, AsksWhetherARefusalIsJust) {
    const StackCase stack{{{{square(0), square(1)}, {}, {}, -1.0}, {{square(2)}, {}, {}, {}}}, ""};
    EXPECT_TRUE(unjust(stack, InputError("double_valued", "", 0, {0, 1})));
    EXPECT_TRUE(unjust(stack, InputError("double_valued", "", 0, {0, 2})));
    EXPECT_TRUE(unjust(stack, InputError("vertical_triangle", "", 1, {0})));
    EXPECT_TRUE(unjust(stack, InputError("base_not_below", "", -1, {0})));
    EXPECT_TRUE(unjust(stack, InputError("not_finite", "", 0)));
    EXPECT_TRUE(unjust(stack, InputError("bad_index", "", 0)));
    EXPECT_FALSE(unjust(stack, InputError("rocks_overlap", "", -1, {0, 1})));
}

TEST(Minimize, FindsTheOneTriangleThatMatters) {
    RandomSource random(9);
    StackCase stack = make_stack(random, 0, 3, 3);
    stack.rocks[0].base_elevation = -9;
    stack.rocks[0].surfaces[1].vertices[5] = {0.3, 0.7, 123.456};
    stack.rocks[0].surfaces[1].triangles[3] = {5, 6, 7};
    int asked = 0;
    const auto fails = [&](const StackCase& candidate) {
        ++asked;
        for (const RockCase& rock : candidate.rocks) {
            for (const Mesh& surface : rock.surfaces) {
                for (const Point& p : surface.vertices) {
                    if (p[2] > 100) return true;
                }
            }
        }
        return false;
    };
    const StackCase small = minimized(stack, fails, 2000);
    EXPECT_LE(asked, 2000);
    ASSERT_EQ(surface_count(small), 1u);
    EXPECT_EQ(triangle_count(small), 1u);
    EXPECT_FALSE(small.rocks[0].base_elevation.has_value());
    for (const Point& p : small.rocks[0].surfaces[0].vertices) {
        for (const double c : p)
            EXPECT_EQ(c, std::round(c));
    }
}

TEST(Judge, CallsARefusalOfWhatShouldBeValidADefect) {
    StackCase stack{{{{square(0), square(1)}, {}, {}, {}}}, ""};
    EXPECT_TRUE(defects_of(stack).empty());
    stack.rocks[0].surfaces[1].triangles.push_back({0, 1, 2});
    const auto defects = defects_of(stack);
    ASSERT_EQ(defects.size(), 1u);
    EXPECT_EQ(defects[0].kind, "refused");
}

#if !defined(_WIN32)  // where there is no fork()
TEST(Examination, TellsWhatAProcessFound) {
    const auto found = in_a_process(
        [] {
            return std::vector<Defect>{{"a", "b c"}, {"d", ""}};
        },
        20);
    ASSERT_EQ(found.size(), 2u);
    EXPECT_EQ(found[0].kind, "a");
    EXPECT_EQ(found[0].sentence, "b c");
    EXPECT_EQ(found[1].kind, "d");
    EXPECT_EQ(least_kind(found), "a");
    EXPECT_TRUE(in_a_process([] { return std::vector<Defect>{}; }, 20).empty());
}

TEST(Examination, ACrashAndAHangAreDefects) {
    const auto killed = in_a_process(
        []() -> std::vector<Defect> {
            std::raise(SIGKILL);
            return {};
        },
        20);
    ASSERT_EQ(killed.size(), 1u);
    EXPECT_EQ(killed[0].kind, "crash");
    const auto hung = in_a_process(
        []() -> std::vector<Defect> {
            for (;;)
                pause();
        },
        0.02);
    ASSERT_EQ(hung.size(), 1u);
    EXPECT_EQ(hung[0].kind, "hang");
    const auto busy = in_a_process(
        []() -> std::vector<Defect> {
            for (volatile unsigned turns = 0;;)
                turns = turns + 1;
        },
        1);
    ASSERT_EQ(busy.size(), 1u);
    EXPECT_EQ(busy[0].kind, "hang");
}
#endif

}  // namespace
}  // namespace realmodel::fuzz
