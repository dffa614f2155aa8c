// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace realmodel::validation {

/// One thing that is wrong, and where. Numbers are -1 where none is meant.
struct Offender {
    std::string text;
    std::int64_t cell = -1;
    std::int64_t face = -1;
    std::int64_t vertex = -1;
    std::int64_t block = -1;
    std::optional<std::array<double, 3>> place = std::nullopt;
};

/// What one test found.
struct Findings {
    static constexpr std::size_t kMost = 5;  ///< offenders kept; all are counted

    std::int64_t examined = 0;
    std::int64_t failed = 0;
    std::int64_t undecided = 0;  ///< closer to an edge than rounding lets tell
    std::vector<Offender> first;

    bool passed() const { return failed == 0; }
    /// Counts an offender; `describe` is called for the first few only.
    template <class Describe>
    void fail(const Describe& describe) {
        if (first.size() < kMost) first.push_back(describe());
        ++failed;
    }
    /// Adds what was found in a later part of the model.
    void append(const Findings& later) {
        examined += later.examined;
        failed += later.failed;
        undecided += later.undecided;
        for (const Offender& offender : later.first) {
            if (first.size() < kMost) first.push_back(offender);
        }
    }
};

/// A test of the contract (docs/dev/geometry.md) under its name, with what it found and what it
/// cost.
struct TestResult {
    std::string name;
    std::string unit;  ///< of what was examined: cells, faces, vertices, blocks, points
    Findings findings;
    double seconds = 0;
};

}  // namespace realmodel::validation
