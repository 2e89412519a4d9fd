// The functions of <cmath> that C libraries round differently, with the same bits on every machine.
// They use only +, -, *, / and the square root, which IEEE 754 defines. A lint
// (cmake/check_rooms.cmake) keeps the others out of src/.
#pragma once

namespace raio::core {

/// 2^x, to about 1e-15 of the value; x from -1000 to 1000.
double exact_exp2(double x);

/// The logarithm of x to base 2, to about 1e-15; x is positive, finite and normal.
double exact_log2(double x);

/// Like the functions of <cmath> with the same names. They compute with twice the digits of a
/// double, so the result is the double nearest to the true value, except for a few arguments in a
/// million. Zeros, infinities and NaN give the results of IEEE 754. Angles are in radians, of any
/// size.
double exact_sin(double x);
double exact_cos(double x);
double exact_tan(double x);
double exact_acos(double x);
double exact_atan(double x);
double exact_log(double x);
double exact_log10(double x);
/// NaN if x < 0, even for integer y.
double exact_pow(double x, double y);
double exact_cbrt(double x);

/// The length of (x, y, z), to about 3e-16 of it, without intermediate overflow or underflow.
double exact_hypot(double x, double y, double z = 0);

}  // namespace raio::core
