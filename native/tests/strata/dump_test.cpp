// SPDX-License-Identifier: GPL-3.0-or-later
#include "debug/dump.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "../base/read_text.hpp"

namespace realmodel::strata {
namespace {

using Position = std::array<double, 3>;

/// What a file says, read as other programs read it.
struct ReadBack {
    std::vector<std::string> groups;
    std::vector<Position> vertices;
    std::vector<std::vector<std::size_t>> faces, lines;
};

ReadBack read_back(const std::string& path) {
    ReadBack read;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string kind;
        words >> kind;
        if (kind == "g") words >> read.groups.emplace_back();
        if (kind == "v") {
            auto& [x, y, z] = read.vertices.emplace_back();
            words >> x >> y >> z;
        }
        if (kind == "f" || kind == "l") {
            auto& numbers = (kind == "f" ? read.faces : read.lines).emplace_back();
            for (std::size_t number = 0; words >> number;)
                numbers.push_back(number - 1);
        }
    }
    return read;
}

class DumpTest : public testing::Test {
protected:
    /// A triangle on z = 1 + x / 2 as the envelope's facet on surface 3, beside a facet of sky.
    void SetUp() override {
        constexpr std::array<Position, 3> kCorners{{{0, 0, 1}, {4, 0, 3}, {0, 2, 1}}};
        std::array<exact::VertexId, 3> plan;
        std::array<exact::SpaceId, 3> space;
        for (std::size_t i = 0; i < 3; ++i) {
            plan[i] = geometry_.add_vertex(kCorners[i][0], kCorners[i][1]);
            space[i] = geometry_.add_space_vertex(plan[i], kCorners[i][2]);
        }
        const PlaneId plane = geometry_.add_plane(space);
        geometry_.freeze_vertices();
        for (std::size_t i = 0; i < 3; ++i)
            outline_.push_back({plan[i], geometry_.add_edge(plan[i], plan[(i + 1) % 3])});
        envelope_.add_facet(outline_, plane, 3, 3);
        envelope_.add_facet(outline_, kSky, -1, -1);
        faces_.add(outline_, plane, -1, 0, kOutsideCell);
    }
    void TearDown() override { std::filesystem::remove(path_); }

    std::string path_ = file_of_test(".obj");
    exact::PlanArrangement geometry_;
    Polygon outline_;
    Envelope envelope_;
    FaceList faces_;
};

TEST_F(DumpTest, AnEnvelopeIsItsFacetsOnSurfaces) {
    dump_envelope(geometry_, envelope_, path_.c_str());
    const ReadBack read = read_back(path_);
    EXPECT_EQ(read.groups, std::vector<std::string>{"surface_3"});
    ASSERT_EQ(read.faces.size(), 1u);
    ASSERT_EQ(read.vertices.size(), 3u);
    EXPECT_EQ(read.vertices[read.faces[0][1]], (Position{4, 0, 3}));
}

TEST_F(DumpTest, FacesOfTheBaseHaveAGroupOfTheirOwn) {
    dump_faces(geometry_, faces_, path_.c_str());
    const ReadBack read = read_back(path_);
    EXPECT_EQ(read.groups, std::vector<std::string>{"base"});
    EXPECT_EQ(read.faces.size(), 1u);
}

TEST_F(DumpTest, AnArrangementIsItsPointsAndLines) {
    dump_arrangement(geometry_, path_.c_str());
    const ReadBack read = read_back(path_);
    ASSERT_EQ(read.lines.size(), 3u);
    EXPECT_EQ(read.vertices[0], (Position{0, 0, 0}));
    // The sloping edge runs across the whole box, from corner to corner.
    std::array<Position, 2> ends{read.vertices[read.lines[1][0]], read.vertices[read.lines[1][1]]};
    std::sort(ends.begin(), ends.end());
    EXPECT_NEAR(ends[0][0], 0, 1e-12);
    EXPECT_NEAR(ends[0][1], 2, 1e-12);
    EXPECT_NEAR(ends[1][0], 4, 1e-12);
}

TEST_F(DumpTest, AComplexHasItsWallsInAGroup) {
    CellComplex cells;  // a wall and a face of surface 2 that share an edge
    cells.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 0, 5}, {0, 0, 7.25}, {0, 1, 7.25}};
    cells.face_offsets = {0, 4, 7};
    cells.face_vertices = {0, 1, 2, 3, 3, 2, 4};
    cells.face_surface = {kWall, 2};
    dump_complex(cells, path_.c_str());
    const ReadBack read = read_back(path_);
    EXPECT_EQ(read.groups, (std::vector<std::string>{"walls", "surface_2"}));
    ASSERT_EQ(read.vertices.size(), 5u);
    EXPECT_EQ(read.vertices[3], (Position{0, 0, 7.25}));
    ASSERT_EQ(read.faces.size(), 2u);
    EXPECT_EQ(read.faces[0], (std::vector<std::size_t>{0, 1, 2, 3}));
}

TEST_F(DumpTest, AFileThatCannotBeWrittenIsAnError) {
    EXPECT_THROW(dump_envelope(geometry_, envelope_, "/no/such/folder/e.obj"), std::runtime_error);
}

}  // namespace
}  // namespace realmodel::strata
