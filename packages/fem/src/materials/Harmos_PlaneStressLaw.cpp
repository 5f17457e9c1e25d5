// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PlaneStressLaw.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::fem {

MaterialResponse PlaneStressLaw::at(const Voigt& strain, double rise, const double* before,
                                    double* after) const {
  Voigt whole = strain;
  whole[2] = before[stateSize() - 1];
  MaterialResponse response;
  constexpr int most = 50; // three or four are usual
  constexpr double known = 1e-14;
  bool isFound = false;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < most && !isFound; ++k) {
    response = law_->at(whole, rise, before, after);
    const double change = -response.stress[2] / response.tangent[2][2];
    if (!std::isfinite(response.energy) || !std::isfinite(change))
      break;
    const double size = std::abs(whole[0]) + std::abs(whole[1]) + std::abs(whole[2]) + std::abs(whole[3]);
    // Rounding errors no longer get smaller; logarithms have those of one.
    constexpr double ofOne = 4.0 * std::numeric_limits<double>::epsilon();
    isFound = std::abs(change) <= known * size ||
              (std::abs(change) >= last && std::abs(change) <= std::max(1e3 * known * size, ofOne));
    last = std::abs(change);
    if (!isFound)
      whole[2] += change;
  }
  after[stateSize() - 1] = whole[2];
  response.across = whole[2];
  if (!isFound)
    response.energy = std::numeric_limits<double>::quiet_NaN();
  const VoigtMatrix inSpace = response.tangent;
  response.stress[2] = response.stress[4] = response.stress[5] = 0.0;
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = 0; s < 6; ++s)
      response.tangent[r][s] = r == 2 || s == 2 || r > 3 || s > 3
                                   ? 0.0
                                   : inSpace[r][s] - inSpace[r][2] * inSpace[2][s] / inSpace[2][2];
  return response;
}

} // namespace Harmos::fem
