// SPDX-License-Identifier: GPL-3.0-or-later
#include "strata/repair/close_values.hpp"

#include <algorithm>
#include <boost/sort/spreadsort/float_sort.hpp>
#include <cmath>

namespace realmodel::strata {

namespace {

constexpr std::size_t kBins = std::size_t{1} << 16;

void sort(std::vector<double>& values) {
    // apart: Boost takes the difference of the bits of the least and of the greatest one
    const auto middle =
        std::partition(values.begin(), values.end(), [](double value) { return value < 0; });
    boost::sort::spreadsort::float_sort(values.begin(), middle);
    boost::sort::spreadsort::float_sort(middle, values.end());
}

}  // namespace

CloseValueSearch::CloseValueSearch(double least, double most, std::size_t count, double reach,
                                   std::size_t at_once)
    : reach_(reach), at_once_(at_once), waiting_{{least, most, count}} {
    begin_pass();
}

void CloseValueSearch::Slice::add(double value) {
    least = count == 0 ? value : std::min(least, value);
    most = count == 0 ? value : std::max(most, value);
    ++count;
}

/// Ascends with the value, and the first and the last bin have some.
std::size_t CloseValueSearch::bin_of(double value) const {
    const double half = std::isinf(slice_.most - slice_.least) ? 0.5 : 1.0;
    const double low = half * slice_.least;
    const double share = (half * value - low) / (half * slice_.most - low);
    return std::min(bins_.size() - 1,
                    static_cast<std::size_t>(share * static_cast<double>(bins_.size())));
}

void CloseValueSearch::begin_pass() {
    while (!waiting_.empty() && waiting_.back().least == waiting_.back().most) {
        add(waiting_.back().least, waiting_.back().count);
        waiting_.pop_back();
    }
    if (waiting_.empty()) {
        end_run();
        slice_ = {HUGE_VAL, -HUGE_VAL};
        seen_ = {};
        is_done_ = true;
        return;
    }
    slice_ = waiting_.back();
    waiting_.pop_back();
    if (slice_.count > at_once_) {
        bins_.resize(std::min(kBins, slice_.count));
    } else {
        seen_.reserve(slice_.count);
    }
}

void CloseValueSearch::end_pass() {
    if (is_done_) return;
    if (bins_.empty()) {
        look_at_seen();
    } else {
        divide();
    }
    begin_pass();
}

void CloseValueSearch::divide() {
    std::vector<Slice> slices;
    for (const Slice& bin : bins_) {
        if (bin.count == 0) continue;
        if (slices.empty() || slices.back().count + bin.count > at_once_) {
            slices.push_back(bin);
        } else {
            slices.back().most = bin.most;
            slices.back().count += bin.count;
        }
    }
    waiting_.insert(waiting_.end(), slices.rbegin(), slices.rend());
    bins_ = {};
}

void CloseValueSearch::look_at_seen() {
    sort(seen_);
    for (std::size_t i = 0; i < seen_.size();) {
        std::size_t same = i + 1;
        while (same < seen_.size() && seen_[same] == seen_[i])
            ++same;
        add(seen_[i], same - i);
        i = same;
    }
    seen_.clear();
}

/// Values come ascending. A run may go on in the next slice.
void CloseValueSearch::add(double value, std::size_t count) {
    if (!run_.empty() && !(value - run_.back().value <= reach_)) end_run();
    run_.push_back({value, count});
}

void CloseValueSearch::end_run() {
    if (run_.size() > 1) {
        found_.values.insert(found_.values.end(), run_.begin(), run_.end());
        found_.ends.push_back(found_.values.size());
    }
    run_.clear();
}

}  // namespace realmodel::strata
