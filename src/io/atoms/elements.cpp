// The table of elements.
#include <algorithm>
#include <array>

#include "io/atoms/colors.h"

namespace raio::core {
namespace {

struct Data {
  std::string_view symbol;
  float van_der_waals, covalent;  // angstroms
  double mass;                    // atomic mass units
  bool is_metal = false;
};

// The numbers of gemmi 0.5.7.
constexpr auto kTable = std::to_array<Data>({{"X", 1, 0.5f, 0},
                                             {"H", 1.2f, 0.31f, 1.00794},
                                             {"He", 1.4f, 0.28f, 4.0026},
                                             {"Li", 1.82f, 1.28f, 6.941, true},
                                             {"Be", 1.53f, 0.96f, 9.012182, true},
                                             {"B", 1.92f, 0.84f, 10.811},
                                             {"C", 1.7f, 0.73f, 12.0107},
                                             {"N", 1.55f, 0.71f, 14.0067},
                                             {"O", 1.52f, 0.66f, 15.9994},
                                             {"F", 1.47f, 0.57f, 18.998403},
                                             {"Ne", 1.54f, 0.58f, 20.1797},
                                             {"Na", 2.27f, 1.66f, 22.98977, true},
                                             {"Mg", 1.73f, 1.41f, 24.305, true},
                                             {"Al", 1.84f, 1.21f, 26.981539, true},
                                             {"Si", 2.1f, 1.11f, 28.0855},
                                             {"P", 1.8f, 1.07f, 30.973761},
                                             {"S", 1.8f, 1.05f, 32.065},
                                             {"Cl", 1.75f, 1.02f, 35.453},
                                             {"Ar", 1.88f, 1.06f, 39.948},
                                             {"K", 2.75f, 2.03f, 39.0983, true},
                                             {"Ca", 2.31f, 1.76f, 40.078, true},
                                             {"Sc", 2.11f, 1.7f, 44.95591, true},
                                             {"Ti", 1.95f, 1.6f, 47.867, true},
                                             {"V", 1.06f, 1.53f, 50.9415, true},
                                             {"Cr", 1.13f, 1.39f, 51.9961, true},
                                             {"Mn", 1.19f, 1.39f, 54.93805, true},
                                             {"Fe", 1.26f, 1.32f, 55.845, true},
                                             {"Co", 1.13f, 1.26f, 58.9332, true},
                                             {"Ni", 1.63f, 1.24f, 58.6934, true},
                                             {"Cu", 1.4f, 1.32f, 63.546, true},
                                             {"Zn", 1.39f, 1.22f, 65.38, true},
                                             {"Ga", 1.87f, 1.22f, 69.723, true},
                                             {"Ge", 2.11f, 1.2f, 72.64, true},
                                             {"As", 1.85f, 1.19f, 74.9216},
                                             {"Se", 1.9f, 1.2f, 78.96},
                                             {"Br", 1.85f, 1.2f, 79.904},
                                             {"Kr", 2.02f, 1.16f, 83.798},
                                             {"Rb", 3.03f, 2.2f, 85.4678, true},
                                             {"Sr", 2.49f, 1.95f, 87.62, true},
                                             {"Y", 1.61f, 1.9f, 88.90585, true},
                                             {"Zr", 1.42f, 1.75f, 91.224, true},
                                             {"Nb", 1.33f, 1.64f, 92.9064, true},
                                             {"Mo", 1.75f, 1.54f, 95.95, true},
                                             {"Tc", 2, 1.47f, 98, true},
                                             {"Ru", 1.2f, 1.46f, 101.07, true},
                                             {"Rh", 1.22f, 1.42f, 102.9055, true},
                                             {"Pd", 1.63f, 1.39f, 106.42, true},
                                             {"Ag", 1.72f, 1.45f, 107.8682, true},
                                             {"Cd", 1.58f, 1.44f, 112.411, true},
                                             {"In", 1.93f, 1.42f, 114.818, true},
                                             {"Sn", 2.17f, 1.39f, 118.71, true},
                                             {"Sb", 2.06f, 1.39f, 121.76, true},
                                             {"Te", 2.06f, 1.38f, 127.6},
                                             {"I", 1.98f, 1.39f, 126.90447},
                                             {"Xe", 2.16f, 1.4f, 131.293},
                                             {"Cs", 3.43f, 2.44f, 132.905, true},
                                             {"Ba", 2.68f, 2.15f, 137.327, true},
                                             {"La", 1.83f, 2.07f, 138.905, true},
                                             {"Ce", 1.86f, 2.04f, 140.116, true},
                                             {"Pr", 1.62f, 2.03f, 140.908, true},
                                             {"Nd", 1.79f, 2.01f, 144.24, true},
                                             {"Pm", 1.76f, 1.99f, 145, true},
                                             {"Sm", 1.74f, 1.98f, 150.36, true},
                                             {"Eu", 1.96f, 1.98f, 151.964, true},
                                             {"Gd", 1.69f, 1.96f, 157.25, true},
                                             {"Tb", 1.66f, 1.94f, 158.925, true},
                                             {"Dy", 1.63f, 1.92f, 162.5, true},
                                             {"Ho", 1.61f, 1.92f, 164.93, true},
                                             {"Er", 1.59f, 1.89f, 167.259, true},
                                             {"Tm", 1.57f, 1.9f, 168.934, true},
                                             {"Yb", 1.54f, 1.87f, 173.05, true},
                                             {"Lu", 1.53f, 1.75f, 174.967, true},
                                             {"Hf", 1.4f, 1.87f, 178.49, true},
                                             {"Ta", 1.22f, 1.7f, 180.948, true},
                                             {"W", 1.26f, 1.62f, 183.84, true},
                                             {"Re", 1.3f, 1.51f, 186.207, true},
                                             {"Os", 1.58f, 1.44f, 190.23, true},
                                             {"Ir", 1.22f, 1.41f, 192.217, true},
                                             {"Pt", 1.75f, 1.36f, 195.084, true},
                                             {"Au", 1.66f, 1.36f, 196.967, true},
                                             {"Hg", 1.55f, 1.32f, 200.59, true},
                                             {"Tl", 1.96f, 1.45f, 204.383, true},
                                             {"Pb", 2.02f, 1.46f, 207.2, true},
                                             {"Bi", 2.07f, 1.48f, 208.98, true},
                                             {"Po", 1.97f, 1.4f, 209, true},
                                             {"At", 2.02f, 1.5f, 210},
                                             {"Rn", 2.2f, 1.5f, 222},
                                             {"Fr", 3.48f, 2.6f, 223, true},
                                             {"Ra", 2.83f, 2.21f, 226, true},
                                             {"Ac", 2.12f, 2.15f, 227, true},
                                             {"Th", 1.84f, 2.06f, 232.038, true},
                                             {"Pa", 1.6f, 2, 231.036, true},
                                             {"U", 1.86f, 1.96f, 238.029, true},
                                             {"Np", 1.71f, 1.9f, 237, true},
                                             {"Pu", 1.67f, 1.87f, 244, true},
                                             {"Am", 1.66f, 1.8f, 243, true},
                                             {"Cm", 1.65f, 1.69f, 247, true},
                                             {"Bk", 1.64f, 1.68f, 247, true},
                                             {"Cf", 1.63f, 1.68f, 251, true},
                                             {"Es", 1.62f, 1.65f, 252, true},
                                             {"Fm", 1.61f, 1.67f, 257, true},
                                             {"Md", 1.6f, 1.73f, 258, true},
                                             {"No", 1.59f, 1.76f, 259, true},
                                             {"Lr", 1.58f, 1.61f, 262, true},
                                             {"Rf", 1, 1.57f, 267, true},
                                             {"Db", 1, 1.49f, 268, true},
                                             {"Sg", 1, 1.43f, 271, true},
                                             {"Bh", 1, 1.41f, 272, true},
                                             {"Hs", 1, 1.34f, 270, true},
                                             {"Mt", 1, 1.29f, 276, true},
                                             {"Ds", 1, 1.28f, 281, true},
                                             {"Rg", 1, 1.21f, 280, true},
                                             {"Cn", 1, 1.22f, 285, true},
                                             {"Nh", 1, 1.5f, 284, true},
                                             {"Fl", 1, 1.5f, 289, true},
                                             {"Mc", 1, 1.5f, 288, true},
                                             {"Lv", 1, 1.5f, 293, true},
                                             {"Ts", 1, 1.5f, 294},
                                             {"Og", 1, 1.5f, 294}});
static_assert(kTable.size() == kElements);

const Data& data(int element) { return kTable[size_t(std::clamp(element, 0, kElements - 1))]; }

}  // namespace

float van_der_waals_radius(int element) { return data(element).van_der_waals; }
float covalent_radius(int element) { return data(element).covalent; }
double atomic_mass(int element) { return data(element).mass; }
bool is_metal(int element) { return data(element).is_metal; }
std::string_view element_symbol(int element) { return data(element).symbol; }

int element_number(std::string_view symbol) {
  // Indexed by the letters as numbers from 1; a single letter has 0 as its second.
  constexpr size_t kLetters = 27;
  static const auto kNumbers = [] {
    std::array<uint8_t, kLetters * kLetters> numbers{};
    for (int i = kElements - 1; i > 0; --i) {
      const std::string_view name = element_symbol(i);
      numbers[size_t(name[0] - 'A' + 1) * kLetters + (name.size() > 1 ? name[1] - 'a' + 1 : 0)] =
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

}  // namespace raio::core
