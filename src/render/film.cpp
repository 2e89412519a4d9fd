#include "render/film.h"

#include <algorithm>
#include <cmath>

namespace raio {

Film::Film(int width, int height, double bound, uint64_t samples)
    : width_(width),
      height_(height),
      bound_(std::clamp(bound, 1e-30, 1e38)),
      sums_(size_t(width) * height * 3) {
  // The sum of all samples stays below 2^62; and no finer than 2^-40, where a picture has no more
  // to say.
  int exponent = 0;
  std::frexp(bound_ * double(samples), &exponent);
  scale_ = std::ldexp(1.0, std::min(62 - exponent, 40));
}

Image Film::resolve(int samples_per_pixel) const {
  Image image(width_, height_);
  const double unit = 1 / (scale_ * samples_per_pixel);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const int64_t* s = &sums_[i * 3];
    image.pixels[i] = {float(double(s[0]) * unit), float(double(s[1]) * unit),
                       float(double(s[2]) * unit)};
  }
  return image;
}

}  // namespace raio
