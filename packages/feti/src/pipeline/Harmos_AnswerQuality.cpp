// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AnswerQuality.hpp"

#include "Harmos_Log.hpp"

#include <algorithm>

namespace Harmos::feti {
namespace {

double balancedShare(const AnswerQuality& quality) {
  return std::min(quality.allowedError, 0.1);
}

// Forces below are taken for this.
double leastForce(const AnswerQuality& quality) {
  return 1e-5 * quality.audit.forces;
}

// As auditAgrees() has it for forces out of balance.
double roundingOfForces(const AnswerQuality& quality) {
  constexpr double rounding = 1e-13;
  return rounding * quality.audit.displacementForce + quality.gapRounding * quality.audit.unitForce;
}

} // namespace

double allowedShare(const AnswerQuality& quality) {
  return std::max(auditShare(quality.tolerance), balancedShare(quality));
}

double allowedForceError(const AnswerQuality& quality, const PairError& pair) {
  return allowedShare(quality) * std::max(pair.force, leastForce(quality)) + roundingOfForces(quality);
}

double allowedTractionError(const AnswerQuality& quality, const PairError& pair) {
  constexpr double ofOneNode = 3.0;
  const double share = allowedShare(quality), least = leastForce(quality);
  const double traction =
      pair.force > 0.0 ? pair.traction * std::max(1.0, least / pair.force) : least / pair.smallestArea;
  return ofOneNode * share * traction + roundingOfForces(quality) / pair.smallestArea;
}

double forceExcess(const AnswerQuality& quality, const PairError& pair) {
  const double ofForces = pair.error > 0.0 ? pair.error / allowedForceError(quality, pair) : 0.0;
  return pair.tractionError > 0.0
             ? std::max(ofForces, pair.tractionError / allowedTractionError(quality, pair))
             : ofForces;
}

double forceExcess(const AnswerQuality& quality) {
  double largest = 0.0;
  for (const PairError& pair : quality.pairErrors)
    largest = std::max(largest, forceExcess(quality, pair));
  return largest;
}

const PairError* worstPair(const AnswerQuality& quality) {
  const PairError* worst = nullptr;
  for (const PairError& pair : quality.pairErrors)
    if (worst == nullptr || forceExcess(quality, pair) > forceExcess(quality, *worst))
      worst = &pair;
  return worst;
}

std::string forceErrorText(const PairError& pair) {
  return scientific(pair.relative(), 1) + (pair.traction > 0.0 ? ", of its largest traction at one node " +
                                                                     scientific(pair.relativeTraction(), 1)
                                                               : "");
}

std::string wrongForcesText(const AnswerQuality& quality) {
  const PairError* const worst = worstPair(quality);
  if (worst == nullptr || !(forceExcess(quality, *worst) > mostForceExcess))
    return "";
  return "the forces of \"" + worst->path + "\" have an estimated relative error of " +
         forceErrorText(*worst) + ", and the solver did not reach a smaller tolerance; they are " +
         scientific(worst->force) + " where all forces of the scene are " + scientific(quality.audit.forces) +
         ". Give \"Solver/Tolerance\" a smaller value, or look for parts that nothing holds";
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
