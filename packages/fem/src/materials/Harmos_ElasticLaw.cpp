// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ElasticLaw.hpp"

#include "Harmos_Tensors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::fem {
namespace {

// C = I + 2E.
Tensor rightCauchyGreen(const Voigt& strain) {
  Tensor c{};
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    c[i][j] = c[j][i] = i == j ? 1.0 + 2.0 * strain[r] : strain[r];
  }
  return c;
}

Tensor product(const Tensor& a, const Tensor& b) {
  Tensor c{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        c[i][j] += a[i][k] * b[k][j];
  return c;
}

// x − ln(1 + x).
double beyondLogarithm(double x) {
  constexpr double small = 1e-2;
  if (std::abs(x) > small)
    return x - std::log1p(x);
  double sum = 0.0, power = -x;
  constexpr int terms = 9; // x¹⁰ is rounding errors of x²
  for (int k = 2; k < terms; ++k) {
    power *= -x;
    sum += power / k;
  }
  return sum;
}

} // namespace

ElasticLaw::ElasticLaw(const Material& material, Kinematics kinematics, Strains strains)
    : kinematics_(kinematics),
      strains_(strains),
      law_(material.law),
      stiffness_(material.stiffness(kinematics)),
      lambda_(material.young[0] * material.poisson[0] /
              ((1.0 + material.poisson[0]) * (1.0 - 2.0 * material.poisson[0]))),
      shear_(0.5 * material.young[0] / (1.0 + material.poisson[0])),
      expansion_(material.thermalStrain()) {
  if (kinematics != Kinematics::PlaneStress)
    return;
  const VoigtMatrix whole = material.stiffness(Kinematics::Solid);
  for (const std::size_t r : {std::size_t{0}, std::size_t{1}, std::size_t{3}})
    acrossBy_[r] = -whole[2][r] / whole[2][2];
}

// In plane stress the entry across is of no use, and none.
MaterialResponse ElasticLaw::small(const Voigt& strain, double rise) const {
  Voigt elastic;
  for (std::size_t r = 0; r < 6; ++r)
    elastic[r] = strain[r] - rise * expansion_[r];
  MaterialResponse response = linear(elastic);
  response.across = strain[2];
  return response;
}

MaterialResponse ElasticLaw::at(const Voigt& strain, double rise) const {
  if (strains_ == Strains::Small)
    return small(strain, rise);
  if (rise == 0.0)
    return withoutRise(strain);
  Tensor free{}; // F_θ
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    free[i][j] = free[j][i] = i == j ? 1.0 + rise * expansion_[r] : 0.5 * rise * expansion_[r];
  }
  const double volume = determinant(free);
  if (!(volume > 0.0)) {
    MaterialResponse nothing;
    nothing.energy = std::numeric_limits<double>::quiet_NaN();
    return nothing;
  }
  const Tensor inverse = inverseTransposed(free, volume), square = product(free, free);
  VoigtMatrix turning{}; // E_e of E less that of the free expansion
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = 0; s < 6; ++s) {
      const auto [i, j] = voigtPairs[r];
      const auto [k, l] = voigtPairs[s];
      turning[r][s] =
          (r < 3 ? 1.0 : 2.0) * 0.5 * (inverse[i][k] * inverse[j][l] + inverse[i][l] * inverse[j][k]);
    }
  Voigt freely{}, elastic{};
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    freely[r] = i == j ? 0.5 * (square[i][j] - 1.0) : square[i][j];
  }
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = 0; s < 6; ++s)
      elastic[r] += turning[r][s] * (strain[s] - freely[s]);
  const MaterialResponse held = withoutRise(elastic);
  MaterialResponse response;
  response.energy = volume * held.energy;
  response.across =
      kinematics_ == Kinematics::PlaneStress ? freely[2] + square[2][2] * held.across : strain[2];
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t a = 0; a < 6; ++a) {
      response.stress[r] += volume * turning[a][r] * held.stress[a];
      for (std::size_t s = 0; s < 6; ++s)
        for (std::size_t b = 0; b < 6; ++b)
          response.tangent[r][s] += volume * turning[a][r] * held.tangent[a][b] * turning[b][s];
    }
  return response;
}

MaterialResponse ElasticLaw::withoutRise(const Voigt& strain) const {
  return law_ == Material::Law::NeoHookean ? neoHookean(strain) : linear(strain);
}

MaterialResponse ElasticLaw::linear(const Voigt& strain) const {
  MaterialResponse response;
  response.tangent = stiffness_;
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t s = 0; s < 6; ++s)
      response.stress[r] += stiffness_[r][s] * strain[s];
    response.energy += 0.5 * response.stress[r] * strain[r];
    response.across += acrossBy_[r] * strain[r];
  }
  if (kinematics_ != Kinematics::PlaneStress)
    response.across = strain[2];
  return response;
}

// C_zz of S_zz = 0: μ(C_zz − 1) + ½λ(ln det C₂ + ln C_zz) = 0, whose left side rises and is concave: Newton
// comes from below after its first iteration.
double ElasticLaw::stretchWithoutStress(const Voigt& strain) const {
  const double area =
      (1.0 + 2.0 * strain[0]) * (1.0 + 2.0 * strain[1]) - strain[3] * strain[3]; // det of the plane part
  if (!(area > 0.0))
    return std::numeric_limits<double>::quiet_NaN();
  double c = std::min(1.0, 1.0 / area);
  constexpr int most = 100; // a dozen are usual
  for (int k = 0; k < most; ++k) {
    const double value = shear_ * (c - 1.0) + 0.5 * lambda_ * (std::log(area) + std::log(c));
    const double change = -value / (shear_ + 0.5 * lambda_ / c);
    c = std::max(c + change, 0.1 * c);
    if (std::abs(change) <= std::numeric_limits<double>::epsilon() * c)
      break;
  }
  return c;
}

MaterialResponse ElasticLaw::neoHookean(const Voigt& given) const {
  MaterialResponse response;
  Voigt strain = given;
  const bool isPlaneStress = kinematics_ == Kinematics::PlaneStress;
  if (isPlaneStress)
    strain[2] = 0.5 * (stretchWithoutStress(given) - 1.0);
  response.across = strain[2];
  Tensor twice = rightCauchyGreen(strain); // 2E
  for (std::size_t a = 0; a < 3; ++a)
    twice[a][a] = 2.0 * strain[a];
  const double beyond = determinantBeyondOne(twice), det = 1.0 + beyond;
  if (!(det > 0.0)) {
    response.energy = std::numeric_limits<double>::quiet_NaN();
    return response;
  }
  const Tensor inverse = inverseTransposed(rightCauchyGreen(strain), det);
  const Tensor apart = product(inverse, twice); // I − C⁻¹
  const double logJ = 0.5 * std::log1p(beyond), mu = shear_ - lambda_ * logJ;
  // tr E − ln J, of which the first digits cancel.
  const double higher = beyond - twice[0][0] - twice[1][1] - twice[2][2];
  response.energy = 0.5 * shear_ * (beyondLogarithm(beyond) - higher) + 0.5 * lambda_ * logJ * logJ;
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    response.stress[r] = shear_ * apart[i][j] + lambda_ * logJ * inverse[i][j];
    for (std::size_t s = 0; s < 6; ++s) {
      const auto [k, l] = voigtPairs[s];
      response.tangent[r][s] = lambda_ * inverse[i][j] * inverse[k][l] +
                               mu * (inverse[i][k] * inverse[j][l] + inverse[i][l] * inverse[j][k]);
    }
  }
  if (!isPlaneStress)
    return response;
  const VoigtMatrix whole = response.tangent;
  response.stress[2] = 0.0;
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = 0; s < 6; ++s)
      response.tangent[r][s] =
          r == 2 || s == 2 || r > 3 || s > 3 ? 0.0 : whole[r][s] - whole[r][2] * whole[2][s] / whole[2][2];
  return response;
}

namespace {

// Cholesky, of rows that are not zero.
bool isPositiveDefinite(VoigtMatrix c) {
  constexpr double least = 1e-6;
  for (std::size_t j = 0; j < 6; ++j) {
    const double whole = c[j][j];
    if (whole == 0.0)
      continue;
    for (std::size_t k = 0; k < j; ++k)
      c[j][j] -= c[j][k] * c[j][k];
    if (!(c[j][j] > least * whole))
      return false;
    c[j][j] = std::sqrt(c[j][j]);
    for (std::size_t i = j + 1; i < 6; ++i) {
      for (std::size_t k = 0; k < j; ++k)
        c[i][j] -= c[i][k] * c[j][k];
      c[i][j] /= c[j][j];
    }
  }
  return true;
}

} // namespace

VoigtMatrix strainTangent(const MaterialResponse& response, const Voigt& strain, Kinematics kinematics) {
  const Tensor c = rightCauchyGreen(strain);
  const Tensor inverse = inverseTransposed(c, determinant(c));
  Tensor stress{};
  for (std::size_t r = 0; r < 6; ++r)
    stress[voigtPairs[r][0]][voigtPairs[r][1]] = stress[voigtPairs[r][1]][voigtPairs[r][0]] =
        response.stress[r];
  std::array<Tensor, 6> basis{}, turned;
  for (std::size_t r = 0; r < 6; ++r) {
    const auto [i, j] = voigtPairs[r];
    basis[r][i][j] = basis[r][j][i] = r < 3 ? 1.0 : 0.5;
    turned[r] = product(stress, product(basis[r], inverse)); // S B C⁻¹
  }
  VoigtMatrix result = response.tangent;
  const bool isPlaneStress = kinematics == Kinematics::PlaneStress;
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = 0; s < 6; ++s) {
      if (isPlaneStress && (r == 2 || s == 2 || r > 3 || s > 3))
        continue;
      for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k)
          result[r][s] += 0.5 * (basis[r][i][k] * turned[s][k][i] + basis[s][i][k] * turned[r][k][i]);
    }
  if (!response.yields)
    return isPositiveDefinite(result) ? result : response.tangent;
  // Of flow, whose modulus stresses may be above: what is added leaves rigid motions free.
  double largest = 0.0;
  for (std::size_t r = 0; r < 6; ++r)
    largest = std::max(largest, result[r][r]);
  for (double share = 1e-3; !isPositiveDefinite(result) && share < 1.0; share *= 4.0)
    for (std::size_t r = 0; r < 6; ++r)
      result[r][r] += result[r][r] != 0.0 ? share * largest : 0.0;
  return result;
}

} // namespace Harmos::fem
