// Letters of names in other scripts than Latin.
#include <gtest/gtest.h>

#include <filesystem>

#include "screen.h"

namespace raio::core::view {
namespace {

bool has(ImWchar letter) {
  return ImGui::GetIO().FontDefault->FindGlyphNoFallback(letter) != nullptr;
}

TEST(Letters, AreLoadedOnceANameHasThem) {
  constexpr ImWchar kOmega = 0x3c9, kBall = 0x7403;
  Screen screen([] {});
  if (ImGui::GetIO().Fonts->ConfigData.empty() || ImGui::GetIO().FontGlobalScale != 1 || !has(0xf6))
    GTEST_SKIP() << "no font is installed";
  show_letters("Kugel, sph\xc3\xa8re");
  EXPECT_FALSE(wants_letters()) << "those of Western Europe are there";
  EXPECT_FALSE(has(kOmega));
  show_letters("\xcf\x89-\xe7\x90\x83.nff");
  EXPECT_TRUE(wants_letters());
  apply_look({}, 1);
  ImGui::GetIO().Fonts->Build();
  EXPECT_FALSE(wants_letters());
  EXPECT_TRUE(has(kOmega));
  show_letters("\xcf\x89");
  EXPECT_FALSE(wants_letters()) << "again";
  if (!std::filesystem::exists("/usr/share/fonts/truetype/wqy/wqy-microhei.ttc"))
    GTEST_SKIP() << "fonts-wqy-microhei is not installed";
  EXPECT_TRUE(has(kBall));
}

TEST(Letters, AnyBytesAreAName) {
  Screen screen([] {});
  for (const char* name : {"\xff", "\xe7\x90", "\xf0\x9f\x94\xb4", "\xc0\x80", "\xef\xbf\xbd"})
    show_letters(name);
  apply_look({}, 1);
  EXPECT_FALSE(wants_letters());
  EXPECT_TRUE(ImGui::GetIO().Fonts->Build());
}

}  // namespace
}  // namespace raio::core::view
