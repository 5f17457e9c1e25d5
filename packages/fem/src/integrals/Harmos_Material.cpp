// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Material.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::fem {
namespace {

// The 3×3 block of the compliance that couples normal stresses, in the material's axes.
std::array<std::array<double, 3>, 3> normalCompliance(const Material& m) {
  const auto& e = m.young;
  const double c12 = -m.poisson[0] / e[0], c13 = -m.poisson[1] / e[0], c23 = -m.poisson[2] / e[1];
  return {{{1.0 / e[0], c12, c13}, {c12, 1.0 / e[1], c23}, {c13, c23, 1.0 / e[2]}}};
}

double determinant(const std::array<std::array<double, 3>, 3>& s) {
  return s[0][0] * (s[1][1] * s[2][2] - s[1][2] * s[2][1]) -
         s[0][1] * (s[1][0] * s[2][2] - s[1][2] * s[2][0]) +
         s[0][2] * (s[1][0] * s[2][1] - s[1][1] * s[2][0]);
}

} // namespace

Material Material::isotropic(double young, double poisson) {
  Material material;
  material.young = {young, young, young};
  material.poisson = {poisson, poisson, poisson};
  const double shear = 0.5 * young / (1.0 + poisson);
  material.shear = {shear, shear, shear};
  return material;
}

void Material::check(const std::string& name) const {
  const auto fail = [&](const std::string& what, double value, const std::string& allowed) {
    throw InputError("material \"" + name + "\": " + what + " is " + scientific(value, 6) + "; " + allowed,
                     {{"material", name}});
  };
  static const std::array<const char*, 3> axes = {"1", "2", "3"}, pairs = {"12", "13", "23"};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(young[k] > 0.0) || !std::isfinite(young[k]))
      fail(std::string("Young's modulus ") + axes[k], young[k], "it must be positive and finite");
    if (!std::isfinite(poisson[k]))
      fail(std::string("Poisson's ratio ") + pairs[k], poisson[k], "it must be finite");
    if (!std::isfinite(expansion[k]))
      fail(std::string("the thermal expansion ") + axes[k], expansion[k], "it must be finite");
  }
  if (poisson[0] == poisson[1] && poisson[0] == poisson[2] && young[0] == young[1] && young[0] == young[2] &&
      !(poisson[0] > -1.0 && poisson[0] < 0.5))
    fail("Poisson's ratio", poisson[0],
         "it must lie between -1 and 0.5, ends excluded; 0.5 itself is incompressible, which needs another "
         "method; take 0.4999");
  for (std::size_t k = 0; k < 3; ++k)
    if (!(shear[k] > 0.0) || !std::isfinite(shear[k]))
      fail(std::string("shear modulus ") + pairs[k], shear[k], "it must be positive and finite");
  // Leading minors of the compliance, made free of units.
  const auto s = normalCompliance(*this);
  const double minor = 1.0 - s[0][1] * s[0][1] / (s[0][0] * s[1][1]);
  const double whole = determinant(s) / (s[0][0] * s[1][1] * s[2][2]);
  if (!(minor > 0.0) || !(whole > 0.0))
    fail("the determinant of the compliance", whole,
         "Poisson's ratios are too large for these moduli: the energy must be positive definite "
         "(|nu_12| < sqrt(E_1/E_2) and so on)");
}

VoigtMatrix Material::stiffness(Kinematics kinematics) const {
  const auto s = normalCompliance(*this);
  const double det = determinant(s);
  VoigtMatrix local{};
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t b = 0; b < 3; ++b) {
      const std::size_t r = (b + 1) % 3, q = (b + 2) % 3, u = (a + 1) % 3, v = (a + 2) % 3;
      local[a][b] = (s[r][u] * s[q][v] - s[r][v] * s[q][u]) / det;
    }
  local[3][3] = shear[0]; // xy
  local[4][4] = shear[2]; // yz
  local[5][5] = shear[1]; // xz

  VoigtMatrix result = local;
  if (angle != 0.0) {
    // ε_material = T ε: energy equality gives C = Tᵀ C_material T.
    const double c = std::cos(angle), d = std::sin(angle);
    VoigtMatrix t{};
    t[0] = {c * c, d * d, 0, c * d, 0, 0};
    t[1] = {d * d, c * c, 0, -c * d, 0, 0};
    t[2][2] = 1.0;
    t[3] = {-2 * c * d, 2 * c * d, 0, c * c - d * d, 0, 0};
    t[4][4] = c;
    t[4][5] = -d;
    t[5][4] = d;
    t[5][5] = c;
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = 0; b < 6; ++b) {
        double sum = 0.0;
        for (std::size_t i = 0; i < 6; ++i)
          for (std::size_t j = 0; j < 6; ++j)
            sum += t[i][a] * local[i][j] * t[j][b];
        result[a][b] = sum;
      }
  }
  if (kinematics == Kinematics::PlaneStress) {
    const VoigtMatrix whole = result;
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = 0; b < 6; ++b)
        result[a][b] = whole[a][b] - whole[a][2] * whole[2][b] / whole[2][2];
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t zero : {std::size_t{2}, std::size_t{4}, std::size_t{5}})
        result[a][zero] = result[zero][a] = 0.0;
  }
  return result;
}

Voigt Material::thermalStrain() const {
  const double c = std::cos(angle), d = std::sin(angle);
  return {c * c * expansion[0] + d * d * expansion[1],
          d * d * expansion[0] + c * c * expansion[1],
          expansion[2],
          2.0 * c * d * (expansion[0] - expansion[1]),
          0.0,
          0.0};
}

bool nearlyIncompressible(const Material& material) {
  constexpr double limit = 0.4;
  return std::any_of(material.poisson.begin(), material.poisson.end(),
                     [](double ratio) { return ratio > limit; });
}

} // namespace Harmos::fem
