// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

// Those of musl (native/third_party/musl).
double realmodel_acos(double x);
double realmodel_atan2(double y, double x);
double realmodel_cos(double x);
double realmodel_exp(double x);
double realmodel_expm1(double x);
double realmodel_hypot(double x, double y);
double realmodel_log(double x);
double realmodel_pow(double x, double y);
double realmodel_sin(double x);

/// Elementary functions that give the same bytes on every system and processor, within one unit in
/// the last place (atan2: two). Those of <cmath> are of the system's C library and differ in the
/// last digit: whatever reaches a result is computed with these. <cmath>'s sqrt, floor, ldexp and
/// the like are exact, the same everywhere.
namespace realmodel::elementary {

inline double acos(double x) {
    return realmodel_acos(x);
}
inline double atan2(double y, double x) {
    return realmodel_atan2(y, x);
}
inline double cos(double x) {
    return realmodel_cos(x);
}
inline double exp(double x) {
    return realmodel_exp(x);
}
inline double expm1(double x) {
    return realmodel_expm1(x);
}
inline double hypot(double x, double y) {
    return realmodel_hypot(x, y);
}
inline double log(double x) {
    return realmodel_log(x);
}
inline double pow(double x, double y) {
    return realmodel_pow(x, y);
}
inline double sin(double x) {
    return realmodel_sin(x);
}

}  // namespace realmodel::elementary
