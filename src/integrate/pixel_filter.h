// Pixel filters, sampled by importance: the place of each sample has the filter as its density, so
// all samples count alike (Ernst, Stamminger and Greiner 2006, "Filter Importance Sampling").
#pragma once

#include <array>

namespace raio::core {

/// Steps of the filter's cumulative distribution in filter_places().
inline constexpr int kFilterSteps = 512;
/// The sides of its support in pixels.
inline constexpr int kFilterSide = 3;

/// The inverse of the cumulative distribution of PixelFilter::blackman_harris at k / kFilterSteps,
/// along one axis: -1 to 2, where the pixel extends from 0 to 1. The sampler interpolates linearly.
const std::array<float, kFilterSteps + 1>& filter_places();

}  // namespace raio::core
