// SPDX-License-Identifier: GPL-3.0-or-later
#include "input/number_text.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace realmodel::input {
namespace {

TEST(NumberText, ReadsTheNumberAtTheBeginning) {
    const ParsedNumber plain = parse_number("-12.5e1;7", '.');
    EXPECT_EQ(plain.spelling, Spelling::kNumber);
    EXPECT_EQ(plain.value, -125);
    EXPECT_EQ(plain.length, 7U);
    EXPECT_EQ(parse_number("3,25 m", ',').value, 3.25);
    EXPECT_EQ(parse_number("1e+", '.').length, 1U);  // an exponent without digits is none
    EXPECT_TRUE(std::signbit(parse_number("-0", '.').value));
}

TEST(NumberText, WordsAndWhatIsNoNumber) {
    EXPECT_EQ(parse_number("NaN", '.').spelling, Spelling::kNotFinite);
    EXPECT_EQ(parse_number("-inf", '.').value, -HUGE_VAL);
    EXPECT_EQ(parse_number("+Infinity", '.').length, 9U);
    for (const char* text : {"", "-", ".", "x", "e5", "+-1"})
        EXPECT_EQ(parse_number(text, '.').spelling, Spelling::kNotANumber) << text;
}

TEST(NumberText, BeyondTheRangeOfDoubles) {
    EXPECT_EQ(parse_number("1e309", '.').spelling, Spelling::kTooLarge);
    EXPECT_EQ(parse_number("1e-400", '.').value, 0);
    EXPECT_TRUE(std::signbit(parse_number("-1e-400", '.').value));
    const std::string zeros = "0." + std::string(400, '0') + "1";
    EXPECT_EQ(parse_number(zeros, '.').value, 0);
    EXPECT_EQ(parse_number(zeros + "e999999999999999999", '.').spelling, Spelling::kTooLarge);
}

}  // namespace
}  // namespace realmodel::input
