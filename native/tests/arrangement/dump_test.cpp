// SPDX-License-Identifier: GPL-3.0-or-later
#include "debug/dump.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "../base/read_text.hpp"

namespace realmodel::arrangement {
namespace {

class ArrangementDump : public testing::Test {
protected:
    void TearDown() override { std::filesystem::remove(path_); }
    SpacePointId at(double x, double y, double z) { return points_.add(Position{x, y, z}); }

    std::string path_ = file_of_test(".obj");
    exact::SpacePoints points_;
};

TEST_F(ArrangementDump, RegionsAreFacesInAGroupForEachTriangle) {
    TriangleArrangement arrangement(points_);
    arrangement.add({at(0, 0, 0), at(4, 0, 0), at(0, 4, 0)});
    arrangement.add({at(1, -1, -1), at(1, 9, -1), at(1, 1, 9)});  // passes through it
    arrangement.insert(*arrangement.intersection(0, 1));
    arrangement.divide({1});
    dump_regions(points_, arrangement, path_.c_str());
    const std::string text = read_text(path_);
    EXPECT_EQ(count(text, "\nf "), 3);  // two parts of the first; the other is not parted
    EXPECT_EQ(count(text, "g triangle_"), 2);
    EXPECT_EQ(count(text, "\nl "), 1);  // the slit in it
}

TEST_F(ArrangementDump, AFileThatCannotBeWrittenIsAnError) {
    EXPECT_THROW(dump_regions(points_, TriangleArrangement(points_), "/no/such/folder/r.obj"),
                 std::runtime_error);
}

}  // namespace
}  // namespace realmodel::arrangement
