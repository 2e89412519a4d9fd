#include "io/atoms/colors.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <gemmi/elem.hpp>
#include <string>

#include "base/srgb.h"

namespace raio::core {
namespace {

// Jmol's table; the first entry, for unknown elements, is grey.
constexpr auto kJmol = std::to_array<uint32_t>(
    {0xb4b4b4, 0xffffff, 0xd9ffff, 0xcc80ff, 0xc2ff00, 0xffb5b5, 0x909090, 0x3050f8, 0xff0d0d,
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

constexpr std::array<uint32_t, kDistinctColors> kDistinct = {
    0x56b4e9, 0xe69f00, 0x009e73, 0xf0e442, 0x0072b2, 0xd55e00, 0xcc79a7, 0x999999};

gemmi::Element gemmi_element(int number) {
  return gemmi::Element(static_cast<gemmi::El>(std::clamp(number, 0, kElements - 1)));
}

}  // namespace

float van_der_waals_radius(int element) { return gemmi_element(element).vdw_r(); }
float covalent_radius(int element) { return gemmi_element(element).covalent_r(); }
bool is_metal(int element) { return gemmi_element(element).is_metal(); }
std::string_view element_symbol(int element) { return gemmi_element(element).name(); }

int element_number(std::string_view symbol) {
  // Indexed by the letters as numbers from 1; a single letter has 0 as its second.
  constexpr size_t kLetters = 27;
  static const auto kNumbers = [] {
    std::array<uint8_t, kLetters * kLetters> numbers{};
    for (int i = kElements - 1; i > 0; --i) {
      const std::string_view name = gemmi_element(i).uname();
      if (name.size() <= 2)
        numbers[size_t(name[0] - 'A' + 1) * kLetters + (name.size() > 1 ? name[1] - 'A' + 1 : 0)] =
            uint8_t(i);
    }
    numbers[('D' - 'A' + 1) * kLetters] = numbers[('T' - 'A' + 1) * kLetters] = 1;
    return numbers;
  }();
  if (symbol.empty() || symbol.size() > 2) return 0;
  size_t key = 0;
  for (size_t k = 0; k < 2; ++k) {
    const char c = k < symbol.size() ? char(symbol[k] & ~32) : '@';
    if (c < '@' || c > 'Z' || (k == 0 && c == '@')) return 0;
    key = key * kLetters + size_t(c - '@');
  }
  return kNumbers[key];
}

Rgb element_color(int element) {
  return linear_from_srgb(size_t(element) < kJmol.size() ? kJmol[size_t(element)] : 0xeb0026u);
}

Rgb distinct_color(uint32_t n) { return linear_from_srgb(kDistinct[n % kDistinctColors]); }

}  // namespace raio::core
