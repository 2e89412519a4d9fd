// Radii, masses and colours of elements, and colours for values without one of their own. All
// colours are linear.
#pragma once

#include <cstdint>
#include <string_view>

#include "base/vec.h"

namespace raio::core {

/// Atomic numbers from 1 to 118; 0 is unknown.
inline constexpr int kElements = 119;

/// Van der Waals and covalent radii in angstroms, after gemmi's tables (Bondi 1964 and Cordero 2008
/// among others).
float van_der_waals_radius(int element);
float covalent_radius(int element);
/// In atomic mass units.
double atomic_mass(int element);
bool is_metal(int element);
std::string_view element_symbol(int element);
/// The atomic number of a symbol in any case; 0 if there is none.
int element_number(std::string_view symbol);

/// Jmol's colour of an element (https://jmol.sourceforge.net/jscolors/).
Rgb element_color(int element);

inline constexpr uint32_t kDistinctColors = 8;

/// The n-th of eight colours that people with colour blindness can tell apart, repeated. Okabe and
/// Ito 2008, "Color Universal Design".
Rgb distinct_color(uint32_t n);

}  // namespace raio::core
