// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AnswerQuality.hpp"

#include "Harmos_Log.hpp"

#include <algorithm>

namespace Harmos::feti {
namespace {

double balancedShare(const AnswerQuality& quality) {
  return std::min(quality.allowedError, 0.1);
}

} // namespace

double allowedShare(const AnswerQuality& quality) {
  return std::max(auditShare(quality.tolerance), balancedShare(quality));
}

double allowedForceError(const AnswerQuality& quality, const PairError& pair) {
  constexpr double leastForce = 1e-5;
  // As auditAgrees() has it for forces out of balance.
  constexpr double rounding = 1e-13;
  const KktAudit& audit = quality.audit;
  return allowedShare(quality) * std::max(pair.force, leastForce * audit.forces) +
         rounding * audit.displacementForce + quality.gapRounding * audit.unitForce;
}

double forceExcess(const AnswerQuality& quality) {
  double largest = 0.0;
  for (const PairError& pair : quality.pairErrors)
    if (pair.error > 0.0)
      largest = std::max(largest, pair.error / allowedForceError(quality, pair));
  return largest;
}

std::string rowForceText(const AnswerQuality& quality) {
  const KktAudit& audit = quality.audit;
  const bool isAtRest = audit.forces <= quality.gapRounding * audit.unitForce;
  if (quality.mostRowForce == 0.0 || isAtRest || audit.largestRowForce <= quality.mostRowForce * audit.forces)
    return "";
  return "the row force of a contact or tie is " + scientific(audit.largestRowForce) +
         ", the forces on bodies are only " + scientific(audit.forces) +
         ": at some place both sides move together, so that the row nearly vanishes. Exclude that place from "
         "one of the surfaces";
}

bool auditAgrees(const AnswerQuality& quality) {
  if (!rowForceText(quality).empty())
    return false;
  const double energyShare = std::max(energyErrorShare(quality.tolerance), balancedShare(quality));
  return auditAgrees(quality.audit, {allowedShare(quality), quality.gapRounding, quality.localDefect,
                                     quality.solverError, energyShare});
}

} // namespace Harmos::feti
