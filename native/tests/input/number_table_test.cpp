// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/input/number_table.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <clocale>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "../sanitized.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::input {
namespace {

TableFormat first_column(char separator = ';', char decimal = '.') {
    return {separator, decimal, {0}, {}, {}};
}

/// What read_numbers makes of one entry, or the kind of its refusal.
std::string read_one(const std::string& entry, char decimal = '.') {
    try {
        const NumberTable table = read_numbers(entry, first_column(';', decimal), 1);
        char text[40];
        std::snprintf(text, sizeof text, "%a", table.values.at(0));
        return text;
    } catch (const InputError& error) {
        return error.kind;
    }
}

std::string hexadecimal(double value) {
    char text[40];
    std::snprintf(text, sizeof text, "%a", value);
    return text;
}

/// The C library's answer, which is correctly rounded, as is Python's float().
std::string expected(const std::string& entry) {
    const double value = std::strtod(entry.c_str(), nullptr);
    return std::isinf(value) ? "too_large" : hexadecimal(value);
}

TEST(NumberTable, SameDoublesAsTheCLibrary) {
    std::mt19937_64 random(1);
    char text[900];
    for (int i = 0; i < (kSanitized ? 20'000 : 100'000); ++i) {
        const double value = std::bit_cast<double>(random());
        if (!std::isfinite(value)) continue;
        const int digits = static_cast<int>(random() % 30);
        for (const char* format : {"%.*e", "%.*g"}) {
            std::snprintf(text, sizeof text, format, digits, value);
            ASSERT_EQ(read_one(text), expected(text)) << text;
        }
        std::snprintf(text, sizeof text, "%.*f", digits, std::ldexp(value, -std::ilogb(value) / 2));
        ASSERT_EQ(read_one(text), expected(text)) << text;
    }
}

TEST(NumberTable, AtTheEndsOfTheRangeOfDoubles) {
    const std::string zeros(400, '0');
    const std::vector<std::string> texts{"4e-324",
                                         "3e-324",
                                         "2e-324",
                                         "2.4703282292062327e-324",
                                         "2.4703282292062328e-324",
                                         "2.2250738585072011e-308",
                                         "-1e-400",
                                         "1e-99999999999",
                                         "1.7976931348623157e308",
                                         "1.7976931348623158e308",
                                         "1.7976931348623159e308",
                                         "1e99999999999",
                                         "1" + zeros,
                                         "1" + zeros + "e-400",
                                         "0." + zeros + "1",
                                         "0." + zeros + "1e400",
                                         "0." + zeros + "1e800",
                                         "0." + zeros + "1e999999999999999999",
                                         "-0",
                                         "-0e99999",
                                         "0.0",
                                         "." + zeros};
    for (const std::string& text : texts)
        EXPECT_EQ(read_one(text), expected(text)) << text;
}

TEST(NumberTable, OnlyPlainNumbersAreNumbers) {
    for (const char* text : {".", "+", "-", "+-1", "--1", "0x10", "1_0", "1e", "1e+", "1,5", "1 2",
                             "1.5.2", "e5", "x", "\"", "''", "1\x80", "infinit", "nan1"}) {
        EXPECT_EQ(read_one(text), "not_a_number") << text;
    }
    for (const char* text : {"nan", "-NaN", "inf", "-inf", "+Infinity"}) {
        EXPECT_EQ(read_one(text), "not_finite") << text;
    }
    for (const char* text :
         {"1.", "1", "+1", "1 # one", "1#one", " 1\t", "\"1\"", "\" 1.0 \"", "01e0"}) {
        EXPECT_EQ(read_one(text), hexadecimal(1)) << text;
    }
    EXPECT_EQ(read_one("1,5", ','), hexadecimal(1.5));
    EXPECT_EQ(read_one(",5e1", ','), hexadecimal(5));
    EXPECT_EQ(read_one("1.5", ','), "not_a_number");
}

TEST(NumberTable, LocaleDoesNotMatter) {
    const std::string before = std::setlocale(LC_NUMERIC, nullptr);
    for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE"}) {
        if (std::setlocale(LC_NUMERIC, name) != nullptr) break;
    }
    EXPECT_EQ(read_numbers("1.5", first_column(), 1).values, std::vector<double>{1.5});
    std::setlocale(LC_NUMERIC, before.c_str());
}

TEST(NumberTable, BytesAtRandomAreReadOrRefused) {
    const std::string alphabet = "0123456789.,;+-eE #\"\n\r\tnaif!%>/x\x80\xff";
    std::mt19937 random(2);
    for (int i = 0; i < 50'000; ++i) {
        std::string text(random() % 40, ' ');
        for (char& c : text)
            c = alphabet[random() % alphabet.size()];
        const char separators[] = {' ', ',', ';', '\t'};
        TableFormat format{
            separators[random() % 4], random() % 2 != 0u ? '.' : ',', {1, 0}, {}, {}};
        if (random() % 2 != 0u) format.filters.push_back({2, {{1.0}, {"a"}}});
        if (random() % 2 != 0u) format.missing = {{0.0, std::nan("")}, {""}};
        try {
            const NumberTable table = read_numbers(text, format, 1);
            ASSERT_EQ(table.values.size() % 2, 0u);
            for (const double value : table.values)
                ASSERT_TRUE(std::isfinite(value));
        } catch (const InputError& error) {
            ASSERT_GE(error.items.at(0), 0);
            if (error.kind == "too_few") continue;
            ASSERT_LE(error.items.at(2), error.items.at(3));
            ASSERT_LE(error.items.at(3), static_cast<std::int64_t>(text.size()));
        }
    }
}

TEST(NumberTable, RowsThatCount) {
    const std::string text =
        "a;1;10\n# note\n\nb ; 2;20\n\"a\";3;-9999\n\"a\";4;30\r\n!x\n%\n//\n>\nc;x;y";
    TableFormat format{';', '.', {2, 1}, {{0, {{}, {"a", "b"}}}}, {{-9999}, {}}};
    const NumberTable table = read_numbers(text, format, 1);
    EXPECT_EQ(table.values, (std::vector<double>{10, 1, 20, 2, 30, 4}));
    EXPECT_EQ(table.lines, 11u);
    EXPECT_EQ(table.filtered, 1u);
    EXPECT_EQ(table.missing, 1u);
    format.filters = {{1, {{4, 1}, {}}}};
    EXPECT_EQ(read_numbers(text, format, 1).values, (std::vector<double>{10, 1, 30, 4}));
}

TEST(NumberTable, TheFirstWrongLineIsNamedForAnyNumberOfThreads) {
    std::string text;
    for (int i = 0; i < 200'000; ++i)
        text += "1.25 2.5 3\n";
    const std::string right = text;
    text.replace(11 * 123'456, 11, "1.25 2.x 3\n");
    text.replace(11 * 150'000, 11, "1.25 2.5  \n");
    const TableFormat format{' ', '.', {0, 1, 2}, {}, {}};
    for (const int threads : {1, 2, 7}) {
        const NumberTable table = read_numbers(right, format, threads);
        ASSERT_EQ(table.lines, 200'000u);
        ASSERT_EQ(table.values.size(), 600'000u);
        try {
            (void)read_numbers(text, format, threads);
            FAIL();
        } catch (const InputError& error) {
            EXPECT_EQ(error.kind, "not_a_number");
            EXPECT_EQ(error.items,
                      (std::vector<std::int64_t>{123'456, 1, 11 * 123'456 + 5, 11 * 123'456 + 8}));
        }
    }
}

}  // namespace
}  // namespace realmodel::input
