// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Errors.hpp"
#include "Harmos_FiniteElasticity.hpp"
#include "Harmos_LogarithmicStrain.hpp"
#include "Harmos_StructuredBlock.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace test_plasticity {

using namespace Harmos;
using fem::Kinematics;
using fem::Material;
using fem::MaterialResponse;
using fem::Strains;
using fem::Tensor;
using fem::Voigt;

namespace {

constexpr double young = 200.0, poisson = 0.3, yieldStress = 0.5, shear = 0.5 * young / (1.0 + poisson);

Material metal(double isotropic, double kinematic) {
  Material material = Material::isotropic(young, poisson);
  material.expansion = {1e-3, 1e-3, 1e-3};
  material.plasticity = fem::Plasticity{yieldStress, isotropic, kinematic, std::nullopt};
  return material;
}

Material curved() {
  Material material = metal(0.0, 5.0);
  material.plasticity->curve =
      std::array<std::vector<double>, 2>{std::vector<double>{0.0, 0.004, 0.02, 0.1}, {0.5, 0.7, 0.9, 1.2}};
  return material;
}

// A point that is strained in steps.
class Point {
 public:
  Point(const Material& material, Kinematics kinematics, Strains strains)
      : law_(fem::makeMaterialLaw(material, kinematics, strains)),
        before_(law_->stateSize(), 0.0),
        after_(before_) {}

  MaterialResponse at(const Voigt& strain, double rise = 0.0) {
    return law_->at(strain, rise, before_.data(), after_.data());
  }
  void commit() { before_ = after_; }
  double equivalent() const { return law_->shownState(before_.data()); }
  const std::vector<double>& state() const { return before_; }

 private:
  std::unique_ptr<fem::MaterialLaw> law_;
  std::vector<double> before_, after_;
};

} // namespace

// Some eigenvalues the same, nearly so, and far apart: ½ ln A and its derivatives against central
// differences.
TEST(LogarithmicStrain, derivatives) {
  const Tensor inverse = {{{0.9, 0.1, 0.0}, {0.05, 1.1, -0.1}, {0.0, 0.2, 1.0}}},
               none = {{{1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, {0.0, 0.0, 1.0}}};
  const Voigt weights = {0.3, -0.2, 0.7, 0.4, -0.5, 0.6}; // T
  const std::vector<Voigt> strains = {{0, 0, 0, 0, 0, 0},
                                      {0.2, 0.2, -0.1, 0, 0, 0},
                                      {0.2, 0.2 + 1e-9, 0.2, 1e-8, 0, 0},
                                      {0.3, -0.2, 0.1, 0.25, -0.15, 0.2},
                                      {2.0, -0.4, 0.0, 0.3, 0.1, 0.0}};
  constexpr double h = 1e-5;
  for (const Tensor& g : {none, inverse})
    for (const Voigt& strain : strains) {
      const auto stressAt = [&](const Voigt& at) {
        Voigt stress = weights;
        fem::VoigtMatrix tangent{};
        fem::LogarithmicStrain(at, g).pullBack(stress, tangent);
        return std::pair(stress, tangent);
      };
      const auto productAt = [&](const Voigt& at) { // T : H
        const Voigt logarithm = fem::LogarithmicStrain(at, g).strain();
        double sum = 0.0;
        for (std::size_t r = 0; r < 6; ++r)
          sum += weights[r] * logarithm[r];
        return sum;
      };
      const auto [stress, tangent] = stressAt(strain);
      for (std::size_t r = 0; r < 6; ++r) {
        Voigt more = strain, less = strain;
        more[r] += h;
        less[r] -= h;
        EXPECT_NEAR(stress[r], (productAt(more) - productAt(less)) / (2.0 * h),
                    1e-7 * (1.0 + std::abs(stress[r])));
        for (std::size_t s = 0; s < 6; ++s)
          EXPECT_NEAR(tangent[s][r], (stressAt(more).first[s] - stressAt(less).first[s]) / (2.0 * h),
                      1e-7 * (1.0 + std::abs(tangent[s][r])));
      }
    }
}

// From a state that has yielded, to one that yields again: stress is the derivative of what is stored and
// dissipated in the step, the tangent that of the stress. Errors of differences as of elastic laws.
TEST(Plasticity, stress_and_tangent_are_derivatives) {
  for (const Material& material : {metal(0.0, 0.0), metal(8.0, 0.0), metal(3.0, 6.0), curved()})
    for (const Strains strains : {Strains::Small, Strains::Finite})
      for (const Kinematics kinematics :
           {Kinematics::Solid, Kinematics::PlaneStrain, Kinematics::PlaneStress}) {
        const bool isSolid = kinematics == Kinematics::Solid;
        const double size = strains == Strains::Small ? 0.01 : 0.2, h = 1e-4 * size;
        const auto scaled = [&](Voigt v) {
          for (std::size_t r = 0; r < 6; ++r)
            v[r] *= isSolid || r < 2 || r == 3 ? size : 0.0;
          return v;
        };
        Point point(material, kinematics, strains);
        EXPECT_TRUE(point.at(scaled({0.6, -0.5, 0.1, 0.7, 0.2, -0.3}), 2.0).yields);
        point.commit();
        const Voigt strain = scaled({-0.2, 0.5, 0.2, -0.4, 0.5, 0.1});
        const MaterialResponse response = point.at(strain, 2.0);
        EXPECT_TRUE(response.yields);
        for (std::size_t r = 0; r < (isSolid ? 6U : 4U); ++r) {
          if (kinematics == Kinematics::PlaneStress && r == 2)
            continue;
          Voigt more = strain, less = strain;
          more[r] += h;
          less[r] -= h;
          const MaterialResponse above = point.at(more, 2.0), below = point.at(less, 2.0);
          EXPECT_NEAR(response.stress[r],
                      (above.energy + above.dissipated - below.energy - below.dissipated) / (2.0 * h),
                      1e-6 * yieldStress);
          for (std::size_t s = 0; s < 4; ++s)
            EXPECT_NEAR(response.tangent[s][r], (above.stress[s] - below.stress[s]) / (2.0 * h), 1e-7 * young)
                << s << r;
        }
      }
}

// Shear to and fro, with both kinds of hardening: τ = ⅓(Kγ_p) ± (σ_y + He)/√3, e = Σ|Δγ_p|/√3. Exactly,
// whatever the steps.
TEST(Plasticity, cyclic_shear) {
  constexpr double isotropic = 4.0, kinematic = 7.0, turn = 0.01;
  for (const int steps : {1, 7}) {
    Point point(metal(isotropic, kinematic), Kinematics::Solid, Strains::Small);
    double from = 0.0, plastic = 0.0, equivalent = 0.0, stress = 0.0;
    for (const double to : {turn, -turn, 1.5 * turn}) {
      for (int k = 1; k <= steps; ++k)
        stress = (point.at({0, 0, 0, from + (to - from) * k / steps, 0, 0}), point.commit(),
                  point.at({0, 0, 0, from + (to - from) * k / steps, 0, 0}).stress[3]);
      const double sign = to > from ? 1.0 : -1.0, root = std::sqrt(3.0);
      // G(γ − γ_p) = Kγ_p/3 + s(σ_y + H(e + s(γ_p − γ_p0)/√3))/√3.
      const double next =
          (shear * to - sign * (yieldStress + isotropic * equivalent) / root + isotropic / 3.0 * plastic) /
          (shear + kinematic / 3.0 + isotropic / 3.0);
      equivalent += std::abs(next - plastic) / root;
      plastic = next;
      EXPECT_NEAR(stress, shear * (to - plastic), 1e-12);
      EXPECT_NEAR(point.equivalent(), equivalent, 1e-14);
      from = to;
    }
  }
}

// The yield stress of a bar follows the curve: axial stress over axial plastic strain, whatever the steps.
TEST(Plasticity, bar_along_a_curve) {
  Material material = curved();
  material.plasticity->kinematic = 0.0;
  Point point(material, Kinematics::PlaneStress, Strains::Small);
  double across = 0.0;
  for (const double along : {0.002, 0.004, 0.01, 0.05}) {
    MaterialResponse response;
    for (int k = 0; k < 40; ++k) { // to no stress across the bar
      response = point.at({along, across, 0, 0, 0, 0});
      across -= response.stress[1] / response.tangent[1][1];
    }
    point.commit();
    const double plastic = along - response.stress[0] / young;
    EXPECT_NEAR(point.equivalent(), std::max(0.0, plastic), 1e-12);
    const auto& curve = *material.plasticity->curve;
    std::size_t k = 1;
    while (curve[0][k] < plastic)
      ++k;
    const double bears = curve[1][k - 1] + (curve[1][k] - curve[1][k - 1]) * (plastic - curve[0][k - 1]) /
                                               (curve[0][k] - curve[0][k - 1]);
    EXPECT_NEAR(response.stress[0], along < yieldStress / young ? young * along : bears, 1e-11);
  }
}

// Small strains: both kinds of strains agree to first order.
TEST(Plasticity, finite_tends_to_small) {
  std::vector<double> errors;
  for (const double size : {1e-2, 1e-3, 1e-4}) {
    Material material = metal(8.0, 3.0);
    material.plasticity->yieldStress = 0.3 * young * size;
    Point small(material, Kinematics::Solid, Strains::Small),
        finite(material, Kinematics::Solid, Strains::Finite);
    double error = 0.0;
    for (const Voigt& direction :
         {Voigt{0.6, -0.5, 0.1, 0.7, 0.2, -0.3}, Voigt{-0.2, 0.5, 0.2, -0.4, 0.5, 0.1}}) {
      Voigt strain;
      for (std::size_t r = 0; r < 6; ++r)
        strain[r] = size * direction[r];
      const MaterialResponse one = small.at(strain), other = finite.at(strain);
      for (std::size_t r = 0; r < 6; ++r)
        error = std::max(error, std::abs(one.stress[r] - other.stress[r]) / (young * size));
      small.commit();
      finite.commit();
    }
    errors.push_back(error);
  }
  for (std::size_t k = 1; k < errors.size(); ++k) {
    EXPECT_GT(errors[k - 1] / errors[k], 8.0);
    EXPECT_LT(errors[k - 1] / errors[k], 12.0);
  }
}

// Flow keeps the volume, and a step that goes nowhere changes nothing.
TEST(Plasticity, flow_keeps_volume_and_stays) {
  Point point(metal(8.0, 3.0), Kinematics::Solid, Strains::Finite);
  for (int k = 1; k <= 5; ++k) {
    const double s = 0.1 * k;
    const MaterialResponse response = point.at({s, -0.3 * s, 0.1 * s, 0.8 * s, -0.5 * s, 0.2 * s});
    point.commit();
    Tensor inverse{};
    for (std::size_t e = 0; e < 9; ++e)
      inverse[e / 3][e % 3] = (e / 3 == e % 3 ? 1.0 : 0.0) + point.state()[e];
    EXPECT_NEAR(fem::determinant(inverse), 1.0, 1e-13);
    const MaterialResponse again = point.at({s, -0.3 * s, 0.1 * s, 0.8 * s, -0.5 * s, 0.2 * s});
    EXPECT_NEAR(again.dissipated, response.dissipated, 1e-12 * response.dissipated);
  }
}

// Strains of far regions, of any smallness, have an answer in plane stress, and materials with axes no
// plasticity.
TEST(Plasticity, small_strains_and_wrong_materials) {
  for (const Strains strains : {Strains::Small, Strains::Finite})
    for (const double size : {0.0, 1e-15, 1e-12, 1e-9, 1e-7, 1e-6, 1e-4}) {
      Point point(metal(8.0, 3.0), Kinematics::PlaneStress, strains);
      const MaterialResponse response = point.at({size, -0.4 * size, 0, 0.7 * size, 0, 0});
      EXPECT_TRUE(std::isfinite(response.energy)) << size;
      EXPECT_NEAR(response.stress[0], young / (1.0 - poisson * poisson) * (1.0 - 0.4 * poisson) * size,
                  (1e-13 + 10.0 * size * size) * young)
          << size;
    }
  Material other = metal(8.0, 3.0);
  other.shear[1] *= 1.1;
  EXPECT_THROW(other.check("other"), InputError);
}

// Of meshes: forces are derivatives of what is stored and dissipated, tangents those of forces; B-bar, F-bar,
// and without.
TEST(Plasticity, forces_and_tangents_of_meshes) {
  for (const Strains strains : {Strains::Small, Strains::Finite})
    for (const fem::CellType type : {fem::CellType::Quadrilateral4, fem::CellType::Triangle6,
                                     fem::CellType::Hexahedron8, fem::CellType::Tetrahedron10})
      for (const fem::Dilatation dilatation : {fem::Dilatation::Full, fem::Dilatation::Projected}) {
        const bool isSolid = fem::shapeOf(type).dimension == 3;
        fem::StructuredBlock::Options options;
        options.cellType = type;
        options.size = {1.0, 0.8, 0.6};
        const fem::Mesh mesh = *fem::StructuredBlock(options).subdomain(0).mesh;
        fem::Elasticity elasticity;
        elasticity.kinematics = isSolid ? Kinematics::Solid : Kinematics::PlaneStrain;
        elasticity.dilatation = dilatation;
        elasticity.strains = strains;
        elasticity.materials = {metal(8.0, 3.0)};
        const auto displacementOf = [&](double size, double phase) {
          std::vector<double> u;
          for (int node = 0; node < mesh.numberOfNodes(); ++node) {
            const fem::Point x = mesh.local(node);
            const std::array<double, 3> all = {std::sin(2.0 * x[1] + phase) + x[0],
                                               std::cos(x[0] + phase) * x[1],
                                               0.5 * std::sin(x[0] + x[2] + phase)};
            for (int d = 0; d < mesh.dimension(); ++d)
              u.push_back(size * all[static_cast<std::size_t>(d)]);
          }
          return u;
        };
        const double size = strains == Strains::Small ? 0.02 : 0.1;
        fem::MaterialStates before = fem::initialStates(mesh, elasticity), after = before;
        EXPECT_TRUE(
            fem::finiteForces(mesh, elasticity, displacementOf(size, 0.3), {}, &before, &after).yielding > 0);
        before = after;
        const std::vector<double> u = displacementOf(size, 1.0), direction = displacementOf(1.0, 0.7);
        const fem::FiniteForces forces = fem::finiteForces(mesh, elasticity, u, {}, &before);
        std::vector<double> image(u.size()), more = u, less = u;
        const double h = 1e-5 * size;
        for (std::size_t k = 0; k < u.size(); ++k) {
          more[k] += h * direction[k];
          less[k] -= h * direction[k];
        }
        const fem::FiniteForces above = fem::finiteForces(mesh, elasticity, more, {}, &before),
                                below = fem::finiteForces(mesh, elasticity, less, {}, &before);
        double work = 0.0, largest = 0.0;
        for (std::size_t k = 0; k < u.size(); ++k) {
          work += forces.internal[k] * direction[k];
          largest = std::max(largest, std::abs(forces.internal[k]));
        }
        EXPECT_NEAR(work, (above.energy + above.dissipated - below.energy - below.dissipated) / (2.0 * h),
                    1e-6 * largest);
        if (strains == Strains::Finite)
          continue; // strains alone feel that tangent
        fem::assembleStrainTangent(mesh, elasticity, u, {}, &before).multiply(direction.data(), image.data());
        for (std::size_t k = 0; k < u.size(); ++k)
          EXPECT_NEAR(image[k], (above.internal[k] - below.internal[k]) / (2.0 * h), 1e-7 * young);
      }
}

} // namespace test_plasticity
