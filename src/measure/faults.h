// Finds out what is wrong with a program by its picture: known faults are imitated one by one, and
// the imitation that comes nearest to the picture names the fault.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "measure/imitation.h"

namespace raio::core {

struct KnownFault {
  std::string_view name;   // a word: "no-shadows"
  std::string_view with;   // after "with": "no shadows"
  std::string_view check;  // what to examine in the program, a sentence
  bool of_file;            // changes the finished picture only
  /// Adds the fault; false if it would have no effect.
  bool (*add)(Imitation&);
};

/// All of them. Among faults with equal pictures the likelier comes first.
std::span<const KnownFault> known_faults();

/// A fault that explains much of the difference between two pictures.
struct Cause {
  const KnownFault* fault = nullptr;
  // Of the picture and the imitation with all causes before this one, and with this one, too; of
  // 255, as in ImageDifference.
  double rmse_before = 0, rmse = 0;
  // Other faults that explain it as well.
  std::vector<const KnownFault*> equals;

  /// The share of the squared error that it explains.
  double share() const { return 1 - (rmse / rmse_before) * (rmse / rmse_before); }
};

inline constexpr double kLeastShare = 0.5;  // that a cause explains
inline constexpr size_t kMaxCauses = 3;

/// The causes of the difference between two pictures of the same size, the most important first:
/// each explains at least kLeastShare of what those before it leave. Empty if there are none.
/// `reference` is the picture of `right`. With `only_of_file` it need not be, and only faults of
/// the finished picture are tried. Throws Stopped.
std::vector<Cause> causes_of_difference(const Imitation& right, const Image& reference,
                                        const Image& picture, bool only_of_file = false);

}  // namespace raio::core
