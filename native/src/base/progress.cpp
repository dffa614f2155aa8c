// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/base/progress.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>

#include "realmodel/base/errors.hpp"

namespace realmodel {

namespace {

/// Length of the longest beginning of `text` that fits into `room` bytes and cuts no UTF-8
/// character.
std::size_t whole_characters(const char* text, std::size_t room) {
    const std::size_t length = std::strlen(text);
    if (length <= room) return length;
    std::size_t end = room;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) {
        --end;
    }
    return end;
}

/// Sets what is less to a value; returns by how much.
double raise_to(std::atomic<double>& number, double value) noexcept {
    double before = number.load(std::memory_order_relaxed);
    while (before < value) {
        if (number.compare_exchange_weak(before, value, std::memory_order_relaxed))
            return value - before;
    }
    return 0;
}

}  // namespace

void Progress::report(double fraction, const char* text) noexcept {
    if (!std::isnan(fraction)) {
        fraction_.store(std::clamp(fraction, 0.0, 1.0));
        take_on_whole(std::clamp(fraction, 0.0, 1.0));
    }
    if (text == nullptr) return;
    const std::size_t length = whole_characters(text, text_.size() - 1);
    const std::lock_guard lock(text_mutex_);
    std::memcpy(text_.data(), text, length);
    text_[length] = '\0';
}

void Progress::begin(double start, double end, const char* text) noexcept {
    phase_end_.store(std::clamp(end, 0.0, 1.0));
    report(start, text);
}

void Progress::advance(double fraction) noexcept {
    raise_to(fraction_, fraction);
    take_on_whole(fraction);
}

void Progress::take_on_whole(double fraction) noexcept {
    if (whole_ == nullptr) return;
    const double step = share_ * raise_to(passed_on_, fraction);
    if (step == 0) return;
    double before = whole_->fraction_.load(std::memory_order_relaxed);
    while (!whole_->fraction_.compare_exchange_weak(before, std::min(1.0, before + step),
                                                    std::memory_order_relaxed)) {
    }
    if (whole_->whole_ != nullptr) whole_->take_on_whole(whole_->fraction());
}

CountedLoop::CountedLoop(Progress* progress, std::size_t rounds, double share) noexcept
    : progress_(progress) {
    if (progress == nullptr || rounds == 0) return;
    from_ = progress->fraction();
    const double left = std::max(0.0, progress->phase_end_.load() - from_);
    step_ = left * std::clamp(share, 0.0, 1.0) / static_cast<double>(rounds);
}

void CountedLoop::count() noexcept {
    if (progress_ == nullptr) return;
    const std::size_t done = done_.fetch_add(1, std::memory_order_relaxed) + 1;
    progress_->advance(from_ + step_ * static_cast<double>(done));
}

void Progress::cancel() noexcept {
    cancelled_.store(true);
}

bool Progress::cancelled() const noexcept {
    return cancelled_.load() || (whole_ != nullptr && whole_->cancelled());
}

void Progress::check() const {
    if (cancelled()) throw Cancelled();
}

double Progress::fraction() const noexcept {
    return fraction_.load();
}

std::string Progress::text() const {
    const std::lock_guard lock(text_mutex_);
    return text_.data();
}

}  // namespace realmodel
