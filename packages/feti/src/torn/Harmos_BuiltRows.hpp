// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_GivenRows.hpp"
#include "Harmos_GluingRows.hpp"
#include "Harmos_RowConditions.hpp"
#include "Harmos_RowWeights.hpp"

#include <vector>

namespace Harmos::feti::Details {

/// An entry of a finished row on its way to the rank of its subdomain.
struct RowEntry {
  long long row;
  double value;
  int place; ///< of the subdomain among those of its rank
  int local; ///< dof
  int owner; ///< rank of the row
};

/// The rows of B, as Constraints has them, when each rank has got its share.
struct BuiltRows {
  GivenCounts counts;
  long long dualDimension = 0;
  std::vector<RowCondition> owned;                  ///< by rising numbers
  std::vector<std::vector<RowEntry>> entries, held; ///< with unknowns; at prescribed values; by sender
  // Of the rows that this rank gave:
  std::vector<MultiplierTerm> multipliers; ///< their forces by those of rows
  std::vector<char> isTaken;               ///< those that are no rows, see DofCopies::unite()
  std::vector<GivenRow> parts;             ///< not yet scaled
  double rounding2 = 0.0;                  ///< squares of what their scaled bounds are known to
};

/// @throws InputError on all ranks, see Constraints. @note Collective.
BuiltRows buildRows(const SubdomainSystem& system, const std::vector<ConstraintRow>& rows, bool hasWeights,
                    const Weights& weights);

} // namespace Harmos::feti::Details
