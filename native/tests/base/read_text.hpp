// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

namespace realmodel {

/// A file for the test that runs, and no other: CTest runs them side by side.
inline std::string file_of_test(const std::string& ending) {
    const auto& test = *testing::UnitTest::GetInstance()->current_test_info();
    return testing::TempDir() + test.test_suite_name() + "." + test.name() + ending;
}

/// What a file says.
inline std::string read_text(const std::string& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    return text.str();
}

/// How often some words are in a text.
inline int count(const std::string& text, const std::string& words) {
    int found = 0;
    for (auto at = text.find(words); at != std::string::npos; at = text.find(words, at + 1))
        ++found;
    return found;
}

}  // namespace realmodel
