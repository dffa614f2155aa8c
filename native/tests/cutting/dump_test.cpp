// SPDX-License-Identifier: GPL-3.0-or-later
#include "debug/dump.hpp"

#include <filesystem>

#include "../base/read_text.hpp"
#include "halved_box.hpp"

namespace realmodel::cutting {
namespace {

class CuttingDump : public AHalvedBox {
protected:
    ~CuttingDump() override { std::filesystem::remove(path_); }
    std::string path_ = file_of_test(".obj");
};

TEST_F(CuttingDump, PartsAreGroupsOfPolygonsSeenFromOutside) {
    cut_at(0.5);
    dump_parts(rounded_parts(), path_.c_str());
    const std::string text = read_text(path_);
    EXPECT_NE(text.find("v 1 1 0.5\n"), std::string::npos);
    const std::size_t second = text.find("g part_1\n");
    EXPECT_LT(text.find("g part_0\n"), second);
    EXPECT_LT(text.find("f 9 10 12 11\n"), second);  // the cap of the lower part
    EXPECT_NE(text.find("f 11 12 10 9\n", second), std::string::npos);
}

TEST_F(CuttingDump, AFileThatCannotBeWrittenIsAnError) {
    EXPECT_THROW(dump_parts(rounded_parts(), "/nowhere/parts.obj"), std::runtime_error);
}

}  // namespace
}  // namespace realmodel::cutting
