#include "io/clear_sky.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/exact_math.h"
#include "base/parallel.h"

namespace raio::core {
namespace {

using std::numbers::pi;

// Lengths are in metres, wavelengths in nanometres, spectra in bands of 20 nm.
constexpr double kGround = 6'360'000, kTop = kGround + 60'000;  // from the earth's centre
constexpr double kObserver = 10;                                // above the ground
constexpr double kAlbedo = 0.2;                                 // of the ground
constexpr double kSunRadius = 0.2665 * pi / 180;
constexpr int kBands = 18;
constexpr double kFirstBand = 390, kBandWidth = 20;
constexpr double kLimbDarkening = 0.6;  // of the radiance at the edge of the sun

using Spectrum = std::array<double, kBands>;

double exp_of(double x) { return exact_exp2(std::max(x * std::numbers::log2e, -1000.0)); }

// Column densities along a path: the integral of each substance's density, in metres at the density
// of the ground (air and aerosols) or of the ozone layer's middle.
struct Columns {
  double air = 0, aerosol = 0, ozone = 0;

  void add(const Columns& b, double length) {
    air += b.air * length, aerosol += b.aerosol * length, ozone += b.ozone * length;
  }
};

Columns densities(double height) {
  constexpr double kAir = 8'430, kAerosol = 1'200;             // scale heights
  constexpr double kOzone = 25'000, kOzoneHalfWidth = 15'000;  // the layer, a triangle
  return {exp_of(-height / kAir), exp_of(-height / kAerosol),
          std::max(0.0, 1 - std::abs(height - kOzone) / kOzoneHalfWidth)};
}

// The irradiance of the sun above the atmosphere, W/m^2/nm: a black body of 5778 K.
double solar_irradiance(double wavelength) {
  constexpr double kC1 = 1.191043e-16, kC2 = 1.438777e-2;  // 2 h c^2, h c / k
  constexpr double kSunInSquare = 2.16273e-5;              // (radius / distance)^2
  const double m = wavelength * 1e-9;
  return pi * kSunInSquare * kC1 / (m * m * m * m * m) / (exp_of(kC2 / (m * 5778)) - 1) * 1e-9;
}

// Scattering by air at the ground, 1/m: Bucholtz 1995, "Rayleigh-scattering calculations for the
// terrestrial atmosphere".
double air_scattering(double wavelength) {
  constexpr double kMolecules = 2.54743e25;  // per m^3
  const double um = wavelength / 1000;
  const auto cross_section = [&](double a, double b, double c, double d) {
    return a * 1e-4 * exact_pow(um, -(b + c * um + d / um));
  };
  return kMolecules * (um < 0.5 ? cross_section(3.01577e-28, 3.55212, 1.35579, 0.11563)
                                : cross_section(4.01061e-28, 3.99668, 1.10298e-3, 2.71393e-2));
}

// Wyman, Sloan and Shirley 2013, "Simple Analytic Approximations to the CIE XYZ Color Matching
// Functions".
Vec3d matched_color(double wavelength) {
  const auto lobe = [&](double height, double middle, double below, double above) {
    const double t = (wavelength - middle) / (wavelength < middle ? below : above);
    return height * exp_of(-t * t / 2);
  };
  return {lobe(1.056, 599.8, 37.9, 31.0) + lobe(0.362, 442.0, 16.0, 26.7) -
              lobe(0.065, 501.1, 20.4, 26.2),
          lobe(0.821, 568.8, 46.9, 40.5) + lobe(0.286, 530.9, 16.3, 31.1),
          lobe(1.217, 437.0, 11.8, 36.0) + lobe(0.681, 459.0, 26.0, 13.8)};
}

Vec3d rgb_of(Vec3d xyz) {
  return {3.2404542 * xyz.x - 1.5371385 * xyz.y - 0.4985314 * xyz.z,
          -0.9692660 * xyz.x + 1.8760108 * xyz.y + 0.0415560 * xyz.z,
          0.0556434 * xyz.x - 0.2040259 * xyz.y + 1.0572252 * xyz.z};
}

// The albedo of aerosols, and their phase function: Cornette and Shanks 1992, "Physically
// reasonable analytic expression for the single-scattering phase function".
constexpr double kAerosolAlbedo = 0.92, kForward = 0.76;

double aerosol_phase(double cosine) {
  constexpr double g = kForward, g2 = g * g;
  const double base = 1 + g2 - 2 * g * cosine;
  return 3 * (1 - g2) * (1 + cosine * cosine) / (8 * pi * (2 + g2) * base * std::sqrt(base));
}

double air_phase(double cosine) { return 3 / (16 * pi) * (1 + cosine * cosine); }

// A number between those of a table, at a place from 0 to its size - 1.
struct Place {
  Place(double at, size_t size)
      : first(std::min(size_t(std::max(at, 0.0)), size - 2)),
        part(std::clamp(at - double(first), 0.0, 1.0)) {}
  template <class T>
  auto of(const T& table) const {
    return table(first) * (1 - part) + table(first + 1) * part;
  }

  size_t first;
  double part;
};

class Atmosphere {
 public:
  explicit Atmosphere(double turbidity) {
    // Serdyuchenko et al. 2014, "High spectral resolution ozone absorption cross-sections", 10^-27
    // m^2; 300 Dobson units.
    constexpr Spectrum kOzone = {0.66, 2.8, 8.5, 23,  49,  90,  160, 280, 350,
                                 470,  470, 430, 320, 220, 150, 94,  66,  42};
    constexpr double kOzonePerVolume = 300 * 2.687e20 / 15'000;
    constexpr int kSteps = 600;
    Columns up;
    for (int i = 0; i < kSteps; ++i) up.add(densities((i + 0.5) * 100), 100);
    const double vertical = air_scattering(550) * up.air;  // the optical depth at 550 nm
    const double aerosol = (turbidity - 1) * vertical / up.aerosol;
    for (size_t b = 0; b < kBands; ++b) {
      const double wavelength = kFirstBand + kBandWidth * double(b);
      air_[b] = air_scattering(wavelength);
      // Angstrom's exponent 1.3.
      aerosol_[b] = aerosol * exact_pow(550 / wavelength, 1.3);
      ozone_[b] = kOzone[b] * 1e-27 * kOzonePerVolume;
      sun_[b] = solar_irradiance(wavelength);
      Vec3d xyz;
      for (int step = -2; step <= 2; ++step)
        xyz = xyz + matched_color(wavelength + 4 * step) * (kBandWidth / 5);
      rgb_[b] = rgb_of(xyz) * (683 / kSkyUnit);
    }
    tabulate_columns();
    tabulate_multiple();
  }

  const Spectrum& sun() const { return sun_; }
  // The colour of the radiance or irradiance 1 of a band.
  Vec3d rgb(size_t band) const { return rgb_[band]; }
  double air_scattering_of(size_t band, const Columns& density) const {
    return air_[band] * density.air;
  }
  double aerosol_scattering_of(size_t band, const Columns& density) const {
    return kAerosolAlbedo * aerosol_[band] * density.aerosol;
  }
  double transmittance(size_t band, const Columns& along) const {
    return exp_of(
        -(air_[band] * along.air + aerosol_[band] * along.aerosol + ozone_[band] * along.ozone));
  }

  // What sunlight has met at a distance from the earth's centre, where the sun's centre is at an
  // angle with this cosine from the zenith; and the part of the sun above the horizon.
  struct Sunlight {
    Columns met;
    double part;
  };
  Sunlight sunlight(double radius, double cosine) const {
    const double horizon = -std::sqrt(std::max(0.0, 1 - square(kGround / radius)));
    const double part = std::clamp((cosine - horizon) / (2 * kSunRadius) + 0.5, 0.0, 1.0);
    return {part > 0 ? columns_to_top(radius, std::max(cosine, horizon)) : Columns(), part};
  }

  // The radiance, equal in all directions, of light scattered more than once, per solar irradiance
  // (tabulate_multiple()).
  Spectrum multiple(double radius, double cosine) const {
    const Place row(
        std::sqrt(std::clamp((radius - kGround) / (kTop - kGround), 0.0, 1.0)) * (kHeights - 1),
        kHeights);
    const Place column(
        std::sqrt(std::clamp((cosine - kLowest) / (1 - kLowest), 0.0, 1.0)) * (kSuns - 1), kSuns);
    Spectrum all;
    for (size_t b = 0; b < kBands; ++b)
      all[b] =
          row.of([&](size_t r) { return column.of([&](size_t c) { return multiple_[r][c][b]; }); });
    return all;
  }

  // Steps along a ray from a radius, at an angle with the cosine `up` from the zenith; the sun is
  // at angles with the cosines `sun_up` from the zenith and `along_sun` from the ray. Calls
  // f(densities, met before the middle of the step, radius, the sun's cosine, length). Returns what
  // the whole way meets, and whether it ends at the ground.
  struct Way {
    Columns met;
    bool ends_at_ground;
  };
  template <class F>
  static Way march(double radius, double up, double sun_up, double along_sun, int steps, F&& f) {
    const double to_centre = radius * up, squared = square(to_centre) - square(radius);
    const bool ends_at_ground = up < 0 && squared + square(kGround) > 0;
    const double length = ends_at_ground ? -to_centre - std::sqrt(squared + square(kGround))
                                         : -to_centre + std::sqrt(squared + square(kTop));
    Columns met;
    for (int i = 0; i < steps; ++i) {
      // Short steps first, where the air is dense and near.
      const double s0 = double(i) / steps, s1 = double(i + 1) / steps;
      const double t0 = length * s0 * s0, t1 = length * s1 * s1, t = (t0 + t1) / 2;
      const double r = std::sqrt(square(radius) + t * t + 2 * to_centre * t);
      const Columns density = densities(r - kGround);
      met.add(density, (t1 - t0) / 2);
      f(density, met, r, (radius * sun_up + t * along_sun) / r, t1 - t0);
      met.add(density, (t1 - t0) / 2);
    }
    return {met, ends_at_ground};
  }

 private:
  static constexpr size_t kRadii = 32, kCosines = 128;  // of the table of columns
  static constexpr size_t kHeights = 12, kSuns = 20;    // of multiple scattering
  static constexpr double kLowest = -0.2;               // the cosine of the lowest sun there
  static double square(double x) { return x * x; }
  // From the ground's horizon to the top.
  static double longest() { return std::sqrt(square(kTop) - square(kGround)); }

  // Columns from all radii to the top, by the distance to the top: Bruneton 2017, "Precomputed
  // Atmospheric Scattering: a New Implementation".
  void tabulate_columns() {
    columns_.resize(kRadii * kCosines);
    parallel_for(kRadii, [&](size_t i) {
      const double rho = longest() * double(i) / (kRadii - 1);
      const double radius = std::sqrt(square(kGround) + square(rho));
      for (size_t k = 0; k < kCosines; ++k) {
        const double nearest = kTop - radius, farthest = rho + longest();
        const double distance = nearest + (farthest - nearest) * double(k) / (kCosines - 1);
        const double cosine = distance == 0 ? 1
                                            : (square(longest()) - square(rho) - square(distance)) /
                                                  (2 * radius * distance);
        Columns& sum = columns_[i * kCosines + k];
        constexpr int kSteps = 80;
        for (int s = 0; s < kSteps; ++s) {
          const double t0 = distance * square(double(s) / kSteps);
          const double t1 = distance * square(double(s + 1) / kSteps), t = (t0 + t1) / 2;
          const double r = std::sqrt(square(radius) + t * t + 2 * radius * cosine * t);
          sum.add(densities(std::max(r, kGround) - kGround), t1 - t0);
        }
      }
    });
  }

  Columns columns_to_top(double radius, double cosine) const {
    const double rho = std::sqrt(std::max(0.0, square(radius) - square(kGround)));
    const double across = square(radius) * (square(cosine) - 1) + square(kTop);
    const double distance = -radius * cosine + std::sqrt(std::max(0.0, across));
    const double nearest = kTop - radius, farthest = rho + longest();
    const Place row(rho / longest() * (kRadii - 1), kRadii);
    const Place column((distance - nearest) / (farthest - nearest) * (kCosines - 1), kCosines);
    const auto mixed = [&](double Columns::* member) {
      return row.of([&](size_t r) {
        return column.of([&](size_t c) { return columns_[r * kCosines + c].*member; });
      });
    };
    return {mixed(&Columns::air), mixed(&Columns::aerosol), mixed(&Columns::ozone)};
  }

  // Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering Technique": light
  // scattered twice, and the geometric series of the part that is scattered again, both as if air
  // scattered evenly to all sides and were lit alike all around.
  void tabulate_multiple() {
    constexpr int kUps = 8, kAzimuths = 3, kSteps = 24;
    parallel_for(kHeights, [&](size_t i) {
      const double radius = kGround + 1 + (kTop - kGround - 2) * square(double(i) / (kHeights - 1));
      for (size_t k = 0; k < kSuns; ++k) {
        const double sun = kLowest + (1 - kLowest) * square(double(k) / (kSuns - 1));
        Spectrum twice{}, again{};
        for (int u = 0; u < kUps; ++u)
          for (int a = 0; a < kAzimuths; ++a) {
            const double up = -1 + 2 * (u + 0.5) / kUps;
            const double azimuth = (a + 0.5) / kAzimuths * pi;
            const double along_sun =
                up * sun + std::sqrt((1 - up * up) * (1 - sun * sun)) * exact_cos(azimuth);
            const auto [met, ends_at_ground] = march(
                radius, up, sun, along_sun, kSteps,
                [&](const Columns& density, const Columns& before, double r, double cosine,
                    double length) {
                  const Sunlight light = sunlight(r, cosine);
                  for (size_t b = 0; b < kBands; ++b) {
                    const double scattered =
                        (air_scattering_of(b, density) + aerosol_scattering_of(b, density)) *
                        transmittance(b, before) * length;
                    again[b] += scattered;
                    if (light.part > 0)
                      twice[b] += scattered * light.part * transmittance(b, light.met) / (4 * pi);
                  }
                });
            if (!ends_at_ground) continue;
            const double distance =
                -radius * up - std::sqrt(square(radius) * (up * up - 1) + square(kGround));
            const double cosine = (radius * sun + distance * along_sun) / kGround;
            if (cosine <= 0) continue;
            const Sunlight light = sunlight(kGround, cosine);
            for (size_t b = 0; b < kBands; ++b)
              twice[b] += transmittance(b, met) * transmittance(b, light.met) * light.part *
                          cosine * kAlbedo / pi;
          }
        for (size_t b = 0; b < kBands; ++b)
          multiple_[i][k][b] = twice[b] / (kUps * kAzimuths - again[b]);
      }
    });
  }

  Spectrum air_{}, aerosol_{}, ozone_{}, sun_{};
  std::array<Vec3d, kBands> rgb_;
  std::vector<Columns> columns_;
  std::array<std::array<Spectrum, kSuns>, kHeights> multiple_{};
};

// The light along a direction without the phase functions, which change too fast for a table.
struct Scattered {
  Vec3d air, aerosol, even;  // of the phase functions, and the same in all directions
  Vec3d through;             // the transmittance to the ground

  Scattered operator*(double s) const { return {air * s, aerosol * s, even * s, through * s}; }
  Scattered operator+(const Scattered& b) const {
    return {air + b.air, aerosol + b.aerosol, even + b.even, through + b.through};
  }
};

Scattered scattered(const Atmosphere& air, double elevation, double azimuth, double sun_elevation) {
  constexpr int kSteps = 48;
  const double up = exact_sin(elevation), sun_up = exact_sin(sun_elevation);
  const double along_sun =
      up * sun_up + exact_cos(elevation) * exact_cos(sun_elevation) * exact_cos(azimuth);
  Scattered sum;
  const auto [met, ends_at_ground] = Atmosphere::march(
      kGround + kObserver, up, sun_up, along_sun, kSteps,
      [&](const Columns& density, const Columns& before, double r, double cosine, double length) {
        const Atmosphere::Sunlight light = air.sunlight(r, cosine);
        const Spectrum multiple = air.multiple(r, cosine);
        for (size_t b = 0; b < kBands; ++b) {
          const double seen = air.transmittance(b, before) * length * air.sun()[b];
          const double lit = light.part > 0 ? light.part * air.transmittance(b, light.met) : 0;
          const double by_air = air.air_scattering_of(b, density) * seen;
          const double by_aerosol = air.aerosol_scattering_of(b, density) * seen;
          sum.air = sum.air + air.rgb(b) * (by_air * lit);
          sum.aerosol = sum.aerosol + air.rgb(b) * (by_aerosol * lit);
          sum.even = sum.even + air.rgb(b) * ((by_air + by_aerosol) * multiple[b]);
        }
      });
  if (!ends_at_ground) return sum;
  Vec3d all;
  for (size_t b = 0; b < kBands; ++b) {
    sum.through = sum.through + air.rgb(b) * (air.sun()[b] * air.transmittance(b, met));
    all = all + air.rgb(b) * air.sun()[b];
  }
  for (int c = 0; c < 3; ++c) sum.through[c] /= all[c];
  return sum;
}

// Scattered light above or below the horizon, dense near it, for azimuths from the sun.
class HalfSky {
 public:
  HalfSky(const Atmosphere& air, bool above, double sun_elevation)
      : horizon_(-exact_acos(kGround / (kGround + kObserver))),
        end_(above ? pi / 2 : -pi / 2),
        table_(kRows * kColumns) {
    constexpr double kJust = 1e-6;  // beyond the horizon
    parallel_for(kRows, [&](size_t i) {
      const double part = double(i) / (kRows - 1);
      const double elevation =
          horizon_ + (above ? kJust : -kJust) + (end_ - horizon_) * part * part;
      for (size_t k = 0; k < kColumns; ++k)
        table_[i * kColumns + k] =
            scattered(air, elevation, pi * double(k) / (kColumns - 1), sun_elevation);
    });
  }

  double horizon() const { return horizon_; }
  static constexpr size_t kColumns = 17;
  // For this elevation and all columns.
  std::array<Scattered, kColumns> row(double elevation) const {
    const double part = std::max(0.0, (elevation - horizon_) / (end_ - horizon_));
    const Place place(std::sqrt(part) * (kRows - 1), kRows);
    std::array<Scattered, kColumns> all;
    for (size_t k = 0; k < kColumns; ++k)
      all[k] = place.of([&](size_t i) { return table_[i * kColumns + k]; });
    return all;
  }

 private:
  static constexpr size_t kRows = 64;
  double horizon_, end_;
  std::vector<Scattered> table_;
};

// The irradiance of the sun on a surface that faces it. The reddest suns and the bluest skies are
// outside sRGB.
Vec3d irradiance_of_sun(const Atmosphere& air, double elevation) {
  const auto [met, part] = air.sunlight(kGround + kObserver, exact_sin(elevation));
  Vec3d sum;
  for (size_t b = 0; b < kBands; ++b)
    sum = sum + air.rgb(b) * (air.sun()[b] * air.transmittance(b, met));
  return max(sum, Vec3d());
}

// Adds the sun's disc, as far as it is above the horizon. Pixels at its edge are covered in part.
void add_sun(Image& image, Vec3d irradiance, double elevation, double horizon) {
  const double pixel = 2 * pi / image.width;
  const double cosine = exact_cos(elevation);
  const double limb = 1 - kLimbDarkening / 3;  // the mean over the disc
  const Vec3d middle = irradiance * (1 / (limb * pi * kSunRadius * kSunRadius));
  constexpr int kParts = 16;
  const auto row_of = [&](double e) { return int((pi / 2 - e) / pixel); };
  const int first = std::max(0, row_of(elevation + kSunRadius) - 1);
  const int last = std::min(image.height - 1, row_of(elevation - kSunRadius) + 1);
  parallel_for(size_t(last) + 1 - size_t(first), [&](size_t i) {
    const int y = first + int(i);
    for (int x = 0; x < image.width; ++x) {
      const double nearest = std::max(0.0, std::abs(x + 0.5 - image.width * 0.5) - 0.5) * pixel;
      double covered = 0;
      for (int v = 0; v < kParts; ++v) {
        const double e = pi / 2 - (y + (v + 0.5) / kParts) * pixel;
        const double half = exact_sin((e - elevation) / 2), across = exact_cos(e) * cosine;
        // The part of the radius at an azimuth from the sun, squared: by the chord.
        const auto radius = [&](double azimuth) {
          const double turn = exact_sin(azimuth / 2);
          return 4 * (half * half + across * turn * turn) / (kSunRadius * kSunRadius);
        };
        if (e < horizon || radius(nearest) >= 1) continue;
        for (int u = 0; u < kParts; ++u) {
          const double r = radius((x + (u + 0.5) / kParts - image.width * 0.5) * pixel);
          if (r < 1) covered += 1 - kLimbDarkening * (1 - std::sqrt(1 - r));
        }
      }
      if (covered > 0)
        image.at(x, y) = image.at(x, y) + Rgb(middle * (covered / (kParts * kParts)));
    }
  });
}

}  // namespace

Image clear_sky(double turbidity, double elevation) {
  const Atmosphere air(turbidity);
  const double sun = elevation * pi / 180;
  const HalfSky above(air, true, sun), below(air, false, sun);
  Image image(kSkyWidth, kSkyWidth / 2);
  const double pixel = 2 * pi / image.width, sun_sine = exact_sin(sun), sun_cosine = exact_cos(sun);
  std::vector<double> turns(size_t(image.width));
  for (int x = 0; x < image.width; ++x)
    turns[size_t(x)] = exact_cos((x + 0.5 - image.width * 0.5) * pixel);
  std::vector<Vec3d> from_row(size_t(image.height));  // of the ground's irradiance
  const auto elevation_of = [&](size_t y) { return pi / 2 - (double(y) + 0.5) * pixel; };
  const auto paint = [&](size_t y, const HalfSky& half, Vec3d ground) {
    const double e = elevation_of(y), sine = exact_sin(e), cosine = exact_cos(e);
    const auto row = half.row(e);
    Vec3d sum;
    for (int x = 0; x < image.width; ++x) {
      const double azimuth = std::abs(x + 0.5 - image.width * 0.5) * pixel;
      const Place place(azimuth / pi * (HalfSky::kColumns - 1), HalfSky::kColumns);
      const Scattered s = place.of([&](size_t k) { return row[k]; });
      const double to_sun = sine * sun_sine + cosine * sun_cosine * turns[size_t(x)];
      const Vec3d light = s.air * air_phase(to_sun) + s.aerosol * aerosol_phase(to_sun) + s.even +
                          s.through * ground;
      image.at(x, int(y)) = Rgb(max(light, Vec3d()));
      sum = sum + light;
    }
    from_row[y] = sum * (sine * cosine * pixel * pixel);
  };
  const double horizon = above.horizon();
  const auto rows = size_t(image.height);
  parallel_for(rows, [&](size_t y) {
    if (elevation_of(y) >= horizon) paint(y, above, Vec3d());
  });
  const Vec3d sunlight = irradiance_of_sun(air, sun);
  Vec3d irradiance = sunlight * std::max(0.0, sun_sine);
  for (size_t y = 0; y < rows; ++y)
    if (elevation_of(y) >= 0) irradiance = irradiance + from_row[y];
  parallel_for(rows, [&](size_t y) {
    if (elevation_of(y) < horizon) paint(y, below, irradiance * (kAlbedo / pi));
  });
  add_sun(image, sunlight, sun, horizon);
  return image;
}

}  // namespace raio::core
