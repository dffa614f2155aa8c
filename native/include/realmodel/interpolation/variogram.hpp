// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string_view>
#include <vector>

namespace realmodel::interpolation {

/// Model of a semivariogram; t = h / range, the practical range: f(1) is 1 or 0.95.
enum class VariogramModel {
    kSpherical,    ///< 1.5 t - 0.5 t^3, 1 beyond t = 1
    kExponential,  ///< 1 - exp(-3 t)
    kGaussian,     ///< 1 - exp(-3 t^2)
    kCubic,        ///< 7 t^2 - 8.75 t^3 + 3.5 t^5 - 0.75 t^7, 1 beyond t = 1
    kMatern32,     ///< 1 - (1 + a t) exp(-a t), a = 4.7439
    kMatern52,     ///< 1 - (1 + b t + b^2 t^2 / 3) exp(-b t), b = 5.9186
    /// 1 - cos(2 pi ratio v / range) exp(-3 t^2), v across the azimuth of the anisotropy, and t of
    /// the distance without it: a hole effect, of folds whose axes run along the azimuth and of
    /// which there are `ratio` in a range.
    kWave,
};

/// Those that rise with distance.
inline constexpr std::array kRisingModels{VariogramModel::kSpherical, VariogramModel::kExponential,
                                          VariogramModel::kGaussian,  VariogramModel::kCubic,
                                          VariogramModel::kMatern32,  VariogramModel::kMatern52};

/// "spherical" and so on.
std::string_view name_of(VariogramModel model);

/// The model of a name.
/// @throws InputError kind "variogram", naming the models there are
VariogramModel variogram_model(std::string_view name);

/// f(t) of a model, t >= 0, along its azimuth; 0 at 0.
double structure(VariogramModel model, double t);

/// Geometric anisotropy: the range is longest along `azimuth` (degrees, clockwise from north = +y).
/// That of a wave is the direction of its crests, and how many there are in a range.
struct Anisotropy {
    double ratio = 1.0;  ///< longest to shortest range; 2 and 0.5 mean the same, 1: none
    double azimuth = 0.0;
};

/// A further structure of a nested variogram: adds sill * f(h / range).
struct NestedStructure {
    VariogramModel model = VariogramModel::kSpherical;
    double range = 1.0;
    double sill = 1.0;
    Anisotropy anisotropy{};
};

/// Semivariogram gamma(h) = nugget + (sill - nugget) f(h / range) for h > 0, and 0 at h = 0
/// (Chiles and Delfiner 2012, "Geostatistics", section 2.5). The sill includes the nugget; the
/// range is the one along the anisotropy's azimuth.
///
/// A nested variogram (section 2.4.3 there) is a sum of several structures. `sill` is then that of
/// all together: the first structure has what the nugget and the further ones leave of it.
struct Variogram {
    VariogramModel model = VariogramModel::kSpherical;
    double range = 1.0;
    double sill = 1.0;
    double nugget = 0.0;
    Anisotropy anisotropy{};
    std::vector<NestedStructure> further{};

    /// Sill of the first structure alone.
    double first_sill() const;
    /// All of them, the first one first.
    std::vector<NestedStructure> structures() const;
};

/// Ranges, sills and ratios must be positive, 0 <= nugget <= sill, nugget and further sills
/// together no more than the sill, all finite.
/// @throws InputError kind "variogram" or "anisotropy"
void check_variogram(const Variogram& variogram);
void check_anisotropy(const Anisotropy& anisotropy);

}  // namespace realmodel::interpolation
