// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PlasticLaw.hpp"

#include "Harmos_LogarithmicStrain.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::fem {
namespace {

constexpr std::size_t entries = 9; // of F_p⁻¹

HardeningCurve curveOf(const Plasticity& plasticity) {
  if (plasticity.curve)
    return {(*plasticity.curve)[0], (*plasticity.curve)[1], 0.0};
  return {{0.0}, {plasticity.yieldStress}, plasticity.isotropic};
}

// Of a stress, or a strain whose shears are the tensor's.
double normOf(const Voigt& t) {
  return std::sqrt(t[0] * t[0] + t[1] * t[1] + t[2] * t[2] + 2.0 * (t[3] * t[3] + t[4] * t[4] + t[5] * t[5]));
}

} // namespace

PlasticLaw::PlasticLaw(const Material& material, Strains strains)
    : strains_(strains),
      bulk_(material.young[0] / (3.0 * (1.0 - 2.0 * material.poisson[0]))),
      shear_(0.5 * material.young[0] / (1.0 + material.poisson[0])),
      kinematic_(material.plasticity->kinematic),
      expansion_(material.expansion[0]),
      curve_(curveOf(*material.plasticity)) {}

std::size_t PlasticLaw::stateSize() const {
  return strains_ == Strains::Small ? 6 + 1 : entries + 6 + 1;
}

PlasticLaw::Return PlasticLaw::returned(const Voigt& trial, const Voigt& kinematic, double equivalent) const {
  constexpr double third = 1.0 / 3.0;
  const double root = std::sqrt(2.0 * third), volume = trial[0] + trial[1] + trial[2];
  Return result;
  Voigt apart; // dev σ − ⅔Kα of the trial
  for (std::size_t r = 0; r < 6; ++r) {
    const double deviator = r < 3 ? trial[r] - third * volume : 0.5 * trial[r];
    result.stress[r] = 2.0 * shear_ * deviator + (r < 3 ? bulk_ * volume : 0.0);
    apart[r] =
        2.0 * shear_ * deviator - 2.0 * third * kinematic_ * (r < 3 ? kinematic[r] : 0.5 * kinematic[r]);
  }
  const double size = normOf(apart);
  double theta = 1.0, thetaAlong = 0.0;
  result.equivalent = equivalent;
  constexpr double beyond = 1.0 + 1e-10; // rounding errors of a state that a step has ended with
  if (size > beyond * root * curve_.stress(equivalent)) {
    const HardeningCurve::Flow flow = curve_.flow(equivalent, size, 2.0 * shear_ + 2.0 * third * kinematic_);
    result.yields = true;
    result.equivalent += root * flow.amount;
    theta = 1.0 - 2.0 * shear_ * flow.amount / size;
    thetaAlong = 1.0 / (1.0 + third * (flow.slope + kinematic_) / shear_) - (1.0 - theta);
    for (std::size_t r = 0; r < 6; ++r) {
      apart[r] /= size; // n
      result.stress[r] -= 2.0 * shear_ * flow.amount * apart[r];
      result.flow[r] = (r < 3 ? 1.0 : 2.0) * flow.amount * apart[r];
    }
  }
  double square = 0.0; // |α|²
  for (std::size_t r = 0; r < 6; ++r) {
    const double elastic = trial[r] - result.flow[r], moved = kinematic[r] + result.flow[r];
    result.energy += 0.5 * result.stress[r] * elastic;
    square += (r < 3 ? 1.0 : 0.5) * moved * moved;
    for (std::size_t s = 0; s < 6; ++s) {
      const double identity = r == s ? (r < 3 ? 1.0 : 0.5) : 0.0, ones = r < 3 && s < 3 ? 1.0 : 0.0;
      result.tangent[r][s] = bulk_ * ones + 2.0 * shear_ * theta * (identity - third * ones) -
                             2.0 * shear_ * thetaAlong * apart[r] * apart[s];
    }
  }
  result.energy += third * kinematic_ * square;
  return result;
}

MaterialResponse PlasticLaw::small(const Voigt& strain, double rise, const double* before,
                                   double* after) const {
  Voigt trial, plastic;
  for (std::size_t r = 0; r < 6; ++r) {
    plastic[r] = before[r];
    trial[r] = strain[r] - plastic[r] - (r < 3 ? expansion_ * rise : 0.0);
  }
  const Return answer = returned(trial, plastic, before[6]);
  for (std::size_t r = 0; r < 6; ++r)
    after[r] = plastic[r] + answer.flow[r];
  after[6] = answer.equivalent;
  return {answer.energy, answer.stress, answer.tangent, strain[2], curve_.work(after[6]), answer.yields};
}

MaterialResponse PlasticLaw::finite(const Voigt& strain, double rise, const double* before,
                                    double* after) const {
  const double stretch = 1.0 + expansion_ * rise; // free
  MaterialResponse response;
  Tensor inverse{};
  for (std::size_t k = 0; k < entries; ++k)
    inverse[k / 3][k % 3] = ((k / 3 == k % 3 ? 1.0 : 0.0) + before[k]) / stretch;
  const LogarithmicStrain logarithm(strain, inverse);
  if (!logarithm.isSound() || !(stretch > 0.0)) {
    std::copy_n(before, stateSize(), after);
    response.energy = std::numeric_limits<double>::quiet_NaN();
    return response;
  }
  Voigt kinematic;
  std::copy_n(before + entries, 6, kinematic.begin());
  const Return answer = returned(logarithm.strain(), kinematic, before[entries + 6]);
  response.stress = answer.stress;
  response.tangent = answer.tangent;
  logarithm.pullBack(response.stress, response.tangent);
  const double volume = stretch * stretch * stretch;
  for (std::size_t r = 0; r < 6; ++r) {
    response.stress[r] *= volume;
    for (double& entry : response.tangent[r])
      entry *= volume;
  }
  Tensor flow{}; // −Δγn
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    flow[i][j] = flow[j][i] = (i == j ? -1.0 : -0.5) * answer.flow[r];
    after[entries + r] = kinematic[r] + answer.flow[r];
  }
  std::copy_n(before, entries, after);
  if (answer.yields) {
    const Tensor turn = exponentialOf(flow);
    for (std::size_t k = 0; k < entries; ++k) {
      double entry = k / 3 == k % 3 ? -1.0 : 0.0;
      for (std::size_t a = 0; a < 3; ++a)
        entry += stretch * inverse[k / 3][a] * turn[a][k % 3];
      after[k] = entry;
    }
  }
  after[entries + 6] = answer.equivalent;
  response.energy = volume * answer.energy;
  response.across = strain[2];
  response.dissipated = volume * curve_.work(answer.equivalent);
  response.yields = answer.yields;
  return response;
}

MaterialResponse PlasticLaw::at(const Voigt& strain, double rise, const double* before, double* after) const {
  return strains_ == Strains::Small ? small(strain, rise, before, after)
                                    : finite(strain, rise, before, after);
}

} // namespace Harmos::fem
