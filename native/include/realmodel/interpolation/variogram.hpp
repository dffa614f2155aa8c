// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace realmodel::interpolation {

/// Form of a semivariogram; t = h / range, the practical range: f(1) is 1 or 0.95.
enum class VariogramModel {
    spherical,    ///< 1.5 t - 0.5 t^3, 1 beyond t = 1
    exponential,  ///< 1 - exp(-3 t)
    gaussian,     ///< 1 - exp(-3 t^2)
    cubic,        ///< 7 t^2 - 8.75 t^3 + 3.5 t^5 - 0.75 t^7, 1 beyond t = 1
    matern32,     ///< 1 - (1 + a t) exp(-a t), a = 4.7439
    matern52,     ///< 1 - (1 + b t + b^2 t^2 / 3) exp(-b t), b = 5.9186
};

inline constexpr std::array all_variogram_models{
    VariogramModel::spherical, VariogramModel::exponential, VariogramModel::gaussian,
    VariogramModel::cubic,     VariogramModel::matern32,    VariogramModel::matern52};

/// "spherical" and so on.
std::string_view name_of(VariogramModel model);

/// The other way round. Throws InputError "variogram" naming the models there are.
VariogramModel variogram_model(std::string_view name);

/// f(t) of a model, t >= 0; 0 at 0.
double structure(VariogramModel model, double t);

/// Geometric anisotropy: the range is longest along `azimuth` (degrees, clockwise from north = +y).
struct Anisotropy {
    double ratio = 1.0;  ///< longest to shortest range; 2 and 0.5 mean the same, 1: none
    double azimuth = 0.0;
};

/// A further structure of a nested variogram: adds sill * f(h / range).
struct NestedStructure {
    VariogramModel model = VariogramModel::spherical;
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
    VariogramModel model = VariogramModel::spherical;
    double range = 1.0;
    double sill = 1.0;
    double nugget = 0.0;
    Anisotropy anisotropy{};
    std::vector<NestedStructure> further{};

    /// Sill of the first structure alone.
    double first_sill() const;

    /// Along the azimuth of each structure.
    double gamma(double distance) const;
};

/// Throws InputError of kind "variogram" or "anisotropy" for numbers that mean nothing: ranges and
/// sills positive, 0 <= nugget <= sill, further sills and nugget no more than the sill, ratios
/// positive, all finite.
void check_variogram(const Variogram& variogram);
void check_anisotropy(const Anisotropy& anisotropy);

/// Lengths under anisotropy: those across the azimuth count `ratio` times.
class AnisotropicLength {
public:
    explicit AnisotropicLength(const Anisotropy& anisotropy);
    double operator()(double dx, double dy) const;

    /// The length is that of (along . d, across . d).
    std::array<double, 2> along() const { return {along_x_, along_y_}; }
    std::array<double, 2> across() const { return {across_x_, across_y_}; }

private:
    double along_x_, along_y_, across_x_, across_y_;
};

}  // namespace realmodel::interpolation
