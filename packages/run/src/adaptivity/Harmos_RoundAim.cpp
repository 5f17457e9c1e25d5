// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RoundAim.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::run {

void RoundAim::learnStretch(double cells, int dimension) {
  if (foretold_.cells > 0.0)
    stretch_ = std::clamp(stretch_ * std::pow(foretold_.cells / cells, 1.0 / dimension), 0.7, 1.4);
}

NextMesh RoundAim::nextAtRest(const std::vector<CellError>& cells, const std::vector<fem::Point>& places,
                              int dimension) {
  learnStretch(static_cast<double>(cells.size()), dimension);
  NextMesh next = finerAt(cells, places, dimension, stretch_);
  foretold_ = {next.cells, 0.0, false};
  return next;
}

NextMesh RoundAim::next(const std::vector<CellError>& cells, const Round& round) {
  constexpr double margin = 0.95, least = 0.35, growth = 3.0;
  const auto present = static_cast<double>(cells.size());
  learnStretch(present, round.dimension);
  if (foretold_.isOfTarget)
    excess_ = std::clamp(excess_ * round.error / foretold_.error, 1.0, 2.0);
  const double target = margin * target_ / excess_, aim = std::max(target, least * round.error);
  const double most = maximumCells_ > 0.0 ? std::min(maximumCells_, growth * present) : growth * present;
  NextMesh next = nextMesh(cells, {aim * round.scale, round.order, round.dimension, most, stretch_});
  foretold_ = {next.cells, aim, aim == target && next.cells < 0.99 * most};
  return next;
}

} // namespace Harmos::run
