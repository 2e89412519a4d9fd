// Powers and logarithms with the same bits on every machine, which those of the C library have not.
#pragma once

namespace raio {

/// 2^x, to about 1e-15 of the value; x from -1000 to 1000.
double exact_exp2(double x);

/// The logarithm of x to base 2, to about 1e-15; x is positive, finite and normal.
double exact_log2(double x);

}  // namespace raio
