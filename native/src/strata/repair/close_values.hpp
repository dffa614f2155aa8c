// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace realmodel::strata {

/// Runs of different values, ascending, each no further from the next one than rounding.
struct CloseValues {
    struct Value {
        double value;
        std::size_t count;
    };
    std::vector<Value> values;
    std::vector<std::size_t> ends;  ///< of each run, in `values`
};

/// Finds the runs among more values than there is memory for: whoever has them goes through all of
/// them until that is done. Where there are many, some of these passes count how many are where;
/// each of the others takes a slice of them.
class CloseValueSearch {
public:
    /// @param least, most  of all values
    /// @param count        of all values
    /// @param reach        how far values of a run may be apart
    /// @param at_once      values in a slice
    CloseValueSearch(double least, double most, std::size_t count, double reach,
                     std::size_t at_once);

    bool is_done() const { return is_done_; }
    /// To be called in each pass for all values, in any order.
    void see(double value) {
        if (value < slice_.least || value > slice_.most) return;
        if (bins_.empty()) {
            seen_.push_back(value);
        } else {
            bins_[bin_of(value)].add(value);
        }
    }
    void end_pass();
    CloseValues take() { return std::move(found_); }

private:
    /// All values from one to another.
    struct Slice {
        double least, most;
        std::size_t count = 0;

        void add(double value);
    };

    std::size_t bin_of(double value) const;
    void begin_pass();
    void divide();
    void look_at_seen();
    void add(double value, std::size_t count);
    void end_run();

    double reach_;
    std::size_t at_once_;
    std::vector<Slice> waiting_;  // the least one last
    Slice slice_;
    std::vector<Slice> bins_;   // of equal width; empty where the slice is small enough
    std::vector<double> seen_;  // else its values
    std::vector<CloseValues::Value> run_;
    CloseValues found_;
    bool is_done_ = false;
};

}  // namespace realmodel::strata
