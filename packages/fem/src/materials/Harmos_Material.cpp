// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Material.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Tensors.hpp"

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

// Cholesky; 0 where it is not positive definite.
VoigtMatrix inverseOf(const VoigtMatrix& c) {
  VoigtMatrix l{}, inverse{};
  for (std::size_t j = 0; j < 6; ++j)
    for (std::size_t i = j; i < 6; ++i) {
      double sum = c[i][j];
      for (std::size_t k = 0; k < j; ++k)
        sum -= l[i][k] * l[j][k];
      if (i == j && !(sum > 1e-14 * c[j][j]))
        return VoigtMatrix{};
      l[i][j] = i == j ? std::sqrt(sum) : sum / l[j][j];
    }
  for (std::size_t column = 0; column < 6; ++column) {
    Voigt x{};
    for (std::size_t i = 0; i < 6; ++i) {
      x[i] = i == column ? 1.0 : 0.0;
      for (std::size_t k = 0; k < i; ++k)
        x[i] -= l[i][k] * x[k];
      x[i] /= l[i][i];
    }
    for (std::size_t i = 6; i-- > 0;) {
      for (std::size_t k = i + 1; k < 6; ++k)
        x[i] -= l[k][i] * x[k];
      x[i] /= l[i][i];
    }
    for (std::size_t i = 0; i < 6; ++i)
      inverse[i][column] = x[i];
  }
  return inverse;
}

using Axes = std::array<std::array<double, 3>, 3>;

Axes axesOf(const std::array<std::array<double, 3>, 2>& two) {
  const auto &a = two[0], &b = two[1];
  return {a, b, {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]}};
}

// ε_material = T ε for strains of which shears are twice the tensor's: ε'_ij = a_ik a_jl ε_kl.
VoigtMatrix strainTurning(const Axes& a) {
  VoigtMatrix t{};
  for (std::size_t r = 0; r < 6; ++r)
    for (std::size_t s = 0; s < 6; ++s) {
      const auto [i, j] = voigtPairs[r];
      const auto [k, l] = voigtPairs[s];
      t[r][s] = (r < 3 ? 1.0 : 2.0) * 0.5 * (a[i][k] * a[j][l] + a[i][l] * a[j][k]);
    }
  return t;
}

// Energy equality gives C = Tᵀ C_material T.
VoigtMatrix turned(const VoigtMatrix& local, const VoigtMatrix& t) {
  VoigtMatrix result{};
  for (std::size_t a = 0; a < 6; ++a)
    for (std::size_t b = 0; b < 6; ++b) {
      double sum = 0.0;
      for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j)
          sum += t[i][a] * local[i][j] * t[j][b];
      result[a][b] = sum;
    }
  return result;
}

// Without stress across the plane.
VoigtMatrix planeStressOf(VoigtMatrix c) {
  for (std::size_t zero : {std::size_t{2}, std::size_t{4}, std::size_t{5}}) {
    const VoigtMatrix whole = c;
    for (std::size_t a = 0; a < 6; ++a)
      for (std::size_t b = 0; b < 6; ++b)
        c[a][b] =
            a == zero || b == zero ? 0.0 : whole[a][b] - whole[a][zero] * whole[zero][b] / whole[zero][zero];
  }
  return c;
}

} // namespace

Material Material::anisotropic(const VoigtMatrix& stiffness) {
  Material material;
  const VoigtMatrix s = inverseOf(stiffness);
  if (s == VoigtMatrix{})
    throw InputError("the stiffness of an anisotropic material is not positive definite; its energy must be "
                     "positive for every strain");
  material.young = {1.0 / s[0][0], 1.0 / s[1][1], 1.0 / s[2][2]};
  material.poisson = {-s[0][1] / s[0][0], -s[0][2] / s[0][0], -s[1][2] / s[1][1]};
  material.shear = {1.0 / s[3][3], 1.0 / s[5][5], 1.0 / s[4][4]};
  material.coupled = stiffness;
  return material;
}

Material Material::turnedTo(const std::array<double, 3>& first, const std::array<double, 3>& second) const {
  const auto dot = [](const auto& a, const auto& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
  std::array<std::array<double, 3>, 2> two = {first, second};
  for (std::size_t k = 0; k < 2; ++k) {
    const double before = std::sqrt(dot(two[k], two[k]));
    for (std::size_t d = 0; d < 3 && k > 0; ++d)
      two[k][d] = second[d] - dot(two[0], second) * two[0][d];
    const double length = std::sqrt(dot(two[k], two[k]));
    if (!(length > 1e-9 * before))
      throw InputError("the axes of a material are zero or parallel; give two directions");
    for (double& x : two[k])
      x /= length;
  }
  Material result = *this;
  result.axes = two;
  return result;
}

Material Material::isotropic(double young, double poisson) {
  Material material;
  material.young = {young, young, young};
  material.poisson = {poisson, poisson, poisson};
  const double shear = 0.5 * young / (1.0 + poisson);
  material.shear = {shear, shear, shear};
  return material;
}

namespace {

std::string faultOf(const Plasticity& plasticity) {
  if (!plasticity.curve)
    return !(plasticity.yieldStress > 0.0) || !std::isfinite(plasticity.yieldStress)
               ? "the yield stress is " + scientific(plasticity.yieldStress, 6) +
                     "; it must be positive and finite"
               : std::string();
  const auto& [strains, stresses] = *plasticity.curve;
  if (strains.size() != stresses.size() || strains.empty())
    return "its curve has " + std::to_string(strains.size()) + " plastic strains and " +
           std::to_string(stresses.size()) + " stresses; give as many of both";
  if (strains.front() != 0.0 || !(stresses.front() > 0.0))
    return "its curve begins at the plastic strain " + scientific(strains.front(), 6) + " and the stress " +
           scientific(stresses.front(), 6) + "; begin at 0 with the yield stress, which is positive";
  for (std::size_t k = 1; k < strains.size(); ++k)
    if (!(strains[k] > strains[k - 1]) || !(stresses[k] >= stresses[k - 1]))
      return "its curve does not go on from " + scientific(strains[k - 1], 6) + " to " +
             scientific(strains[k], 6) +
             "; plastic strains must rise, and stresses not fall: softening has no unique answer";
  return {};
}

} // namespace

void Material::check(const std::string& name) const {
  const auto fail = [&](const std::string& what, double value, const std::string& allowed) {
    throw InputError("material \"" + name + "\": " + what + " is " + scientific(value, 6) + "; " + allowed,
                     {{"material", name}});
  };
  static const std::array<const char*, 3> numbers = {"1", "2", "3"}, pairs = {"12", "13", "23"};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(young[k] > 0.0) || !std::isfinite(young[k]))
      fail(std::string("Young's modulus ") + numbers[k], young[k], "it must be positive and finite");
    if (!std::isfinite(poisson[k]))
      fail(std::string("Poisson's ratio ") + pairs[k], poisson[k], "it must be finite");
    if (!std::isfinite(expansion[k]))
      fail(std::string("the thermal expansion ") + numbers[k], expansion[k], "it must be finite");
  }
  if (poisson[0] == poisson[1] && poisson[0] == poisson[2] && young[0] == young[1] && young[0] == young[2] &&
      !(poisson[0] > -1.0 && poisson[0] < 0.5))
    fail("Poisson's ratio", poisson[0],
         "it must lie between -1 and 0.5, ends excluded; 0.5 itself is incompressible, which needs another "
         "method; take 0.4999");
  for (std::size_t k = 0; k < 3; ++k)
    if (!(shear[k] > 0.0) || !std::isfinite(shear[k]))
      fail(std::string("shear modulus ") + pairs[k], shear[k], "it must be positive and finite");
  if (plasticity) {
    std::string fault = faultOf(*plasticity);
    if (fault.empty() && (!(plasticity->isotropic >= 0.0) || !(plasticity->kinematic >= 0.0)))
      fault = "a hardening modulus is negative: softening has no unique answer";
    constexpr double rounding = 1e-12;
    const double ofIsotropic = 0.5 * young[0] / (1.0 + poisson[0]);
    for (std::size_t k = 0; k < 3 && fault.empty(); ++k)
      if (poisson[k] != poisson[0] || std::abs(shear[k] - ofIsotropic) > rounding * ofIsotropic)
        fault = "plasticity is of isotropic materials; use \"Type\" = \"isotropic\"";
    if (fault.empty() &&
        (law == Law::NeoHookean || axes || coupled || young[0] != young[1] || young[0] != young[2] ||
         expansion[0] != expansion[1] || expansion[0] != expansion[2]))
      fault = "plasticity is of isotropic materials that expand alike in all directions; use \"Type\" = "
              "\"isotropic\"";
    if (!fault.empty())
      throw InputError("material \"" + name + "\": " + fault, {{"material", name}});
  }
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
  if (axes || coupled) {
    Material straight = *this;
    straight.axes = std::nullopt;
    straight.coupled = std::nullopt;
    straight.angle = 0.0;
    const VoigtMatrix local = coupled ? *coupled : straight.stiffness(Kinematics::Solid);
    const double c = std::cos(angle), d = std::sin(angle);
    const Axes own = axes ? axesOf(*axes) : Axes{{{c, d, 0.0}, {-d, c, 0.0}, {0.0, 0.0, 1.0}}};
    const VoigtMatrix result = turned(local, strainTurning(own));
    return kinematics == Kinematics::PlaneStress ? planeStressOf(result) : result;
  }
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
    result = turned(local, t);
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
  if (axes) {
    const Axes a = axesOf(*axes);
    const auto entry = [&](std::size_t k, std::size_t l) {
      return expansion[0] * a[0][k] * a[0][l] + expansion[1] * a[1][k] * a[1][l] +
             expansion[2] * a[2][k] * a[2][l];
    };
    return {entry(0, 0), entry(1, 1), entry(2, 2), 2.0 * entry(0, 1), 2.0 * entry(1, 2), 2.0 * entry(0, 2)};
  }
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
