// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/input/lzw.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>
#include <string>

#include "../sanitized.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::input {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The compressor of TIFF 6.0, section 13, as it stands there.
Bytes encoded(const Bytes& data, bool with_end = true) {
    Bytes out;
    std::uint64_t bits = 0;
    int held = 0, width = 9;
    const auto put = [&](int code) {
        bits = bits << width | static_cast<std::uint64_t>(code);
        held += width;
        for (; held >= 8; held -= 8)
            out.push_back(static_cast<std::uint8_t>(bits >> (held - 8)));
    };
    std::map<std::string, int> table;
    const auto restart = [&] {
        put(256);
        table.clear();
        for (int i = 0; i < 256; ++i)
            table[std::string(1, static_cast<char>(i))] = i;
        width = 9;
    };
    int next = 258;
    restart();
    std::string omega;
    for (const std::uint8_t byte : data) {
        const std::string longer = omega + static_cast<char>(byte);
        if (table.count(longer) != 0u) {
            omega = longer;
            continue;
        }
        put(table[omega]);
        table[longer] = next++;
        if (next == 512 || next == 1024 || next == 2048) ++width;
        if (next == 4095) {
            restart();
            next = 258;
        }
        omega = std::string(1, static_cast<char>(byte));
    }
    if (!omega.empty()) {
        put(table[omega]);
        if (++next == 512 || next == 1024 || next == 2048) ++width;
    }
    if (with_end) put(257);
    if (held > 0) out.push_back(static_cast<std::uint8_t>(bits << (8 - held)));
    return out;
}

TEST(Lzw, GivesBackWhatWasCompressed) {
    std::mt19937 random(1);
    for (const std::size_t size : {0u, 1u, 2u, 3u, 300u, 5000u, kSanitized ? 20'000u : 200'000u}) {
        for (const unsigned kinds : {1u, 2u, 4u, 256u}) {
            Bytes data(size);
            for (std::uint8_t& byte : data)
                byte = static_cast<std::uint8_t>(random() % kinds);
            EXPECT_EQ(decode_lzw(encoded(data), size), data) << size << " " << kinds;
            EXPECT_EQ(decode_lzw(encoded(data, false), size), data) << "without an end";
        }
    }
}

TEST(Lzw, DamagedDataAreRefusedOrEndSomewhere) {
    std::mt19937 random(2);
    const Bytes data(1000, 7);
    const Bytes whole = encoded(data);
    EXPECT_THROW((void)decode_lzw(whole, 999), InputError);
    for (int i = 0; i < 20'000; ++i) {
        Bytes damaged = whole;
        for (int n = 0; n < 3; ++n)
            damaged[random() % damaged.size()] = static_cast<std::uint8_t>(random());
        try {
            EXPECT_LE(decode_lzw(damaged, 1000).size(), 1000u);
        } catch (const InputError& error) {
            EXPECT_EQ(error.kind, "damaged");
        }
    }
}

}  // namespace
}  // namespace realmodel::input
