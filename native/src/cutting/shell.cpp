// SPDX-License-Identifier: GPL-3.0-or-later
#include "cutting/shell.hpp"

namespace realmodel::cutting {

void join_hollows(const Shells& shells, DisjointSets& sets) {
    for (const auto& [inner, hollow] : shells) {
        if (hollow.sixfold_volume > 0) continue;
        const Shells::value_type* around = nullptr;
        const auto rank = [&box = hollow.box](const PartShell& shell) {
            return std::pair(!shell.box.contains(box), shell.sixfold_volume);
        };
        for (const auto& other : shells) {
            if (other.first == inner || other.second.sixfold_volume <= -hollow.sixfold_volume)
                continue;
            if (around == nullptr || rank(other.second) < rank(around->second)) around = &other;
        }
        if (around != nullptr) sets.join(around->first, inner);
    }
}

}  // namespace realmodel::cutting
