// SPDX-License-Identifier: GPL-3.0-or-later
#include "realmodel/interpolation/variogram.hpp"

#include <cmath>
#include <cstdio>
#include <utility>

#include "interpolation/kriging/covariance.hpp"
#include "realmodel/base/errors.hpp"

namespace realmodel::interpolation {

namespace {

constexpr std::pair<VariogramModel, std::string_view> kNamedModels[] = {
    {VariogramModel::kSpherical, "spherical"},
    {VariogramModel::kExponential, "exponential"},
    {VariogramModel::kGaussian, "gaussian"},
    {VariogramModel::kCubic, "cubic"},
    {VariogramModel::kMatern32, "matern32"},
    {VariogramModel::kMatern52, "matern52"},
    {VariogramModel::kWave, "wave"}};

std::string number_text(double number) {
    char text[40];
    std::snprintf(text, sizeof text, "%.6g", number);
    return text;
}

bool is_positive(double number) {
    return number > 0 && std::isfinite(number);
}

}  // namespace

std::string_view name_of(VariogramModel model) {
    for (const auto& [named_model, name] : kNamedModels) {
        if (named_model == model) return name;
    }
    return {};
}

VariogramModel variogram_model(std::string_view name) {
    std::string known;
    for (const auto& [model, model_name] : kNamedModels) {
        if (model_name == name) return model;
        known += (known.empty() ? "" : ", ") + std::string(model_name);
    }
    throw InputError("variogram", "variogram model \"" + std::string(name) +
                                      "\" is not known; there are " + known);
}

double structure(VariogramModel model, double t) {
    const auto root = [](double square) { return std::sqrt(square); };
    return 1 - covariance_of({model, 1, 0, 0, 1, 1, 0}, t, 0.0, root);
}

double Variogram::first_sill() const {
    double left = sill - nugget;
    for (const NestedStructure& nested : further)
        left -= nested.sill;
    return left;
}

std::vector<NestedStructure> Variogram::structures() const {
    std::vector<NestedStructure> all{{model, range, first_sill(), anisotropy}};
    all.insert(all.end(), further.begin(), further.end());
    return all;
}

void check_variogram(const Variogram& variogram) {
    const auto require = [](bool right, const std::string& what) {
        if (!right) throw InputError("variogram", what);
    };
    const std::string sill = number_text(variogram.sill);
    require(is_positive(variogram.range),
            "the variogram's range is " + number_text(variogram.range) + "; it must be positive");
    require(is_positive(variogram.sill),
            "the variogram's sill is " + sill + "; it must be positive");
    require(variogram.nugget >= 0 && variogram.nugget <= variogram.sill,
            "the variogram's nugget is " + number_text(variogram.nugget) +
                "; it must lie between 0 and the sill, " + sill + ", which includes it");
    check_anisotropy(variogram.anisotropy);
    for (const NestedStructure& nested : variogram.further) {
        require(is_positive(nested.range) && is_positive(nested.sill),
                "a structure of the variogram has range " + number_text(nested.range) +
                    " and sill " + number_text(nested.sill) + "; both must be positive");
        check_anisotropy(nested.anisotropy);
    }
    require(
        variogram.first_sill() >= -1e-12 * variogram.sill,
        "nugget and structures of the variogram have more than its sill, " + sill + ", together");
}

void check_anisotropy(const Anisotropy& anisotropy) {
    if (!is_positive(anisotropy.ratio)) {
        throw InputError("anisotropy", "the anisotropy's ratio is " +
                                           number_text(anisotropy.ratio) + "; it must be positive");
    }
    if (!std::isfinite(anisotropy.azimuth)) {
        throw InputError("anisotropy", "the anisotropy's azimuth is not a finite number");
    }
}

}  // namespace realmodel::interpolation
