#include "io/atoms/colors.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <gemmi/elem.hpp>
#include <string>

#include "base/srgb.h"

namespace raio {
namespace {

constexpr auto kJmol = std::to_array<uint32_t>(
    {0xff1493, 0xffffff, 0xd9ffff, 0xcc80ff, 0xc2ff00, 0xffb5b5, 0x909090, 0x3050f8, 0xff0d0d,
     0x90e050, 0xb3e3f5, 0xab5cf2, 0x8aff00, 0xbfa6a6, 0xf0c8a0, 0xff8000, 0xffff30, 0x1ff01f,
     0x80d1e3, 0x8f40d4, 0x3dff00, 0xe6e6e6, 0xbfc2c7, 0xa6a6ab, 0x8a99c7, 0x9c7ac7, 0xe06633,
     0xf090a0, 0x50d050, 0xc88033, 0x7d80b0, 0xc28f8f, 0x668f8f, 0xbd80e3, 0xffa100, 0xa62929,
     0x5cb8d1, 0x702eb0, 0x00ff00, 0x94ffff, 0x94e0e0, 0x73c2c9, 0x54b5b5, 0x3b9e9e, 0x248f8f,
     0x0a7d8c, 0x006985, 0xc0c0c0, 0xffd98f, 0xa67573, 0x668080, 0x9e63b5, 0xd47a00, 0x940094,
     0x429eb0, 0x57178f, 0x00c900, 0x70d4ff, 0xffffc7, 0xd9ffc7, 0xc7ffc7, 0xa3ffc7, 0x8fffc7,
     0x61ffc7, 0x45ffc7, 0x30ffc7, 0x1fffc7, 0x00ff9c, 0x00e675, 0x00d452, 0x00bf38, 0x00ab24,
     0x4dc2ff, 0x4da6ff, 0x2194d6, 0x267dab, 0x266696, 0x175487, 0xd0d0e0, 0xffd123, 0xb8b8d0,
     0xa6544d, 0x575961, 0x9e4fb5, 0xab5c00, 0x754f45, 0x428296, 0x420066, 0x007d00, 0x70abfa,
     0x00baff, 0x00a1ff, 0x008fff, 0x0080ff, 0x006bff, 0x545cf2, 0x785ce3, 0x8a4fe3, 0xa136d4,
     0xb31fd4, 0xb31fba, 0xb30da6, 0xbd0d87, 0xc70066, 0xcc0059, 0xd1004f, 0xd90045, 0xe00038,
     0xe6002e, 0xeb0026});

constexpr auto kDistinct = std::to_array<uint32_t>(
    {0x56b4e9, 0xe69f00, 0x009e73, 0xf0e442, 0x0072b2, 0xd55e00, 0xcc79a7, 0x999999});

Rgb linear(uint32_t display) {
  const auto part = [&](int shift) {
    return linear_from_srgb(float(display >> shift & 255) / 255);
  };
  return {part(16), part(8), part(0)};
}

gemmi::Element gemmi_element(int number) {
  return gemmi::Element(static_cast<gemmi::El>(std::clamp(number, 0, kElements - 1)));
}

}  // namespace

float van_der_waals_radius(int element) { return gemmi_element(element).vdw_r(); }
float covalent_radius(int element) { return gemmi_element(element).covalent_r(); }
std::string_view element_symbol(int element) { return gemmi_element(element).name(); }

int element_number(std::string_view symbol) {
  std::string word(symbol);
  for (char& c : word) c = char(std::toupper(uint8_t(c)));
  if (word == "D" || word == "T") return 1;
  for (int i = 1; i < kElements; ++i)
    if (word == gemmi_element(i).uname()) return i;
  return 0;
}

Rgb element_color(int element) {
  return linear(size_t(element) < kJmol.size() ? kJmol[size_t(element)] : 0xeb0026);
}

Rgb distinct_color(uint32_t n) { return linear(kDistinct[n % kDistinct.size()]); }

std::optional<Rgb> map_color(std::string_view map, float part) {
  const char* const maps[] = {kViridis, kPlasma, kCividis, kCoolwarm};
  const auto at = std::ranges::find(kColormaps, map);
  if (at == std::end(kColormaps)) return std::nullopt;
  const auto place = size_t(std::clamp(part, 0.0f, 1.0f) * 255 + 0.5f);
  return linear(
      uint32_t(std::stoul(std::string(maps[at - kColormaps] + 6 * place, 6), nullptr, 16)));
}

}  // namespace raio
