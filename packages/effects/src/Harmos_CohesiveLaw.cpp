// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CohesiveLaw.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>
#include <string>

namespace Harmos::effects {
namespace {

// Openings that differ from the end by rounding errors have come there.
constexpr double rounding = 1e-9;

void require(double value, const std::string& name) {
  if (!(value > 0.0) || !std::isfinite(value))
    throw InputError("\"" + name + "\" is " + scientific(value) + "; give a positive number",
                     {{"parameter", name}});
}

} // namespace

CohesiveLaw::CohesiveLaw(const Options& options) : options_(options) {
  requirePositive();
  if (!isBrittle())
    requireNoSnap();
}

void CohesiveLaw::requirePositive() const {
  require(options_.normalStiffness, "Normal stiffness");
  require(options_.tangentialStiffness, "Tangential stiffness");
  require(options_.normalStrength, "Normal strength");
  require(options_.tangentialStrength, "Tangential strength");
  if (isBrittle())
    return;
  require(options_.fractureEnergy, "Fracture energy");
  require(options_.fractureEnergyII, "Fracture energy II");
  require(options_.exponent, "Mixed mode exponent");
}

// Both formulas are homogeneous in G_I and G_II. Between the pure modes the worst mixture is looked for;
// both sides are smooth there.
void CohesiveLaw::requireNoSnap() const {
  const auto refuse = [](const std::string& name, double given, double least, const std::string& where) {
    throw InputError("\"" + name + "\" is " + scientific(given, 3) +
                         ", but springs of this stiffness store " + scientific(least, 4) + " before failure" +
                         where + ", which would make the law snap back; increase the energy or the stiffness",
                     {{"parameter", name}});
  };
  const auto stored = [this](double share) { return 0.5 * onset(share) * onset(share); };
  if (!(options_.fractureEnergy > stored(0.0)))
    refuse("Fracture energy", options_.fractureEnergy, stored(0.0), "");
  if (!(options_.fractureEnergyII > stored(1.0)))
    refuse("Fracture energy II", options_.fractureEnergyII, stored(1.0), "");
  constexpr int samples = 1000;
  double worst = 0.0;
  for (int k = 1; k < samples; ++k) {
    const double share = static_cast<double>(k) / samples;
    worst = std::max(worst, stored(share) / fractureEnergy(share));
  }
  if (!(worst < 1.0))
    refuse("Fracture energy", options_.fractureEnergy, worst * options_.fractureEnergy,
           " where both modes act, with a \"Fracture energy II\" of " +
               scientific(worst * options_.fractureEnergyII, 4));
}

double CohesiveLaw::onset(double share) const {
  const double sigma = options_.normalStrength, tau = options_.tangentialStrength;
  return 1.0 / std::sqrt((1.0 - share) * options_.normalStiffness / (sigma * sigma) +
                         share * options_.tangentialStiffness / (tau * tau));
}

double CohesiveLaw::fractureEnergy(double share) const {
  if (isBrittle())
    return 0.5 * onset(share) * onset(share);
  const double first = options_.fractureEnergy, second = options_.fractureEnergyII, p = options_.exponent;
  if (options_.mixedMode == MixedMode::BenzeggaghKenane)
    return first + (second - first) * std::pow(share, p);
  if (p == 1.0) // as a rule, and asked for at each point
    return 1.0 / ((1.0 - share) / first + share / second);
  return std::pow(std::pow((1.0 - share) / first, p) + std::pow(share / second, p), -1.0 / p);
}

double CohesiveLaw::end(double share) const {
  return isBrittle() ? onset(share) : 2.0 * fractureEnergy(share) / onset(share);
}

double CohesiveLaw::damage(const Opening& opening) const {
  const double first = onset(opening.share), last = end(opening.share), size = opening.size;
  if (size <= first)
    return 0.0;
  if (isBrittle() || size >= (1.0 - rounding) * last)
    return 1.0;
  return last * (size - first) / (size * (last - first));
}

double CohesiveLaw::sizeAt(double damage, double share) const {
  const double first = onset(share), last = end(share);
  return first * last / (last - damage * (last - first));
}

double CohesiveLaw::dissipated(double damage, double share) const {
  const double first = onset(share), last = end(share);
  if (isBrittle())
    return damage * 0.5 * first * first;
  return 0.5 * first * last * (sizeAt(damage, share) - first) / (last - first);
}

} // namespace Harmos::effects
