// How far apart two pictures are.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "io/image/image.h"
#include "noise.h"

namespace raio::core {
namespace {

using tests::noise;

TEST(Compare, EqualPictures) {
  const Image a = noise(5, 5);
  const ImageDifference d = compare(a, a);
  EXPECT_EQ(d.rmse, 0);
  EXPECT_TRUE(std::isinf(d.psnr_db) && d.psnr_db > 0);
  EXPECT_EQ(d.largest, 0);
  EXPECT_EQ(d.above_8, 0);
  EXPECT_TRUE(std::isinf(compare(Image(), Image()).psnr_db));
}

TEST(Compare, FiguresByHand) {
  Image a(2, 2), b(2, 2);
  b.at(0, 0).x = 8 / 255.f;
  b.at(1, 0).y = 9 / 255.f;
  b.at(1, 1).z = 5;  // displayed as 255
  const ImageDifference d = compare(a, b);
  EXPECT_EQ(d.largest, 255);
  EXPECT_EQ(d.above_8, 0.5);
  const double mean_square = (8 * 8 + 9 * 9 + 255 * 255) / 12.0;
  EXPECT_DOUBLE_EQ(d.rmse, std::sqrt(mean_square));
  EXPECT_DOUBLE_EQ(d.psnr_db, 10 * std::log10(255 * 255 / mean_square));
  // Pictures with equal displayed bytes are equal.
  Image above(1, 1), far_above(1, 1);
  above.at(0, 0) = Rgb(1);
  far_above.at(0, 0) = Rgb(1000);
  EXPECT_EQ(compare(above, far_above).rmse, 0);
}

TEST(Compare, DifferentSizesAreRefused) {
  EXPECT_THROW(compare(Image(2, 3), Image(3, 2)), std::invalid_argument);
  EXPECT_THROW(difference_image(Image(2, 3), Image(3, 2)), std::invalid_argument);
}

TEST(DifferenceImage, ShowsDifferencesOverFaintGrey) {
  Image a(2, 1), b(2, 1);
  a.at(0, 0) = b.at(0, 0) = Rgb(1, 1, 1);
  a.at(1, 0) = Rgb(0, 10 / 255.f, 0);
  b.at(1, 0) = Rgb(20 / 255.f, 10 / 255.f, std::numeric_limits<float>::quiet_NaN());
  const Image d = difference_image(a, b);
  EXPECT_NEAR(d.at(0, 0).x, d.at(0, 0).z, 1e-6);
  EXPECT_GT(d.at(0, 0).x, 0.1f);
  EXPECT_LT(d.at(0, 0).x, 0.4f);
  EXPECT_NEAR(d.at(1, 0).x - d.at(1, 0).y, 160 / 255.f, 1e-6);
  EXPECT_EQ(d.at(1, 0).z, d.at(1, 0).y);
}

}  // namespace
}  // namespace raio::core
