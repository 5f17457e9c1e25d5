// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_LocalMatrix.hpp"
#include "Harmos_MaterialLaw.hpp"
#include "Harmos_Mesh.hpp"

#include <memory>
#include <vector>

namespace Harmos::fem {

/// How volume changes enter.
enum class Dilatation {
  Full,     ///< as the displacements give it; locks as Poisson's ratio nears 1/2
  Projected ///< B-bar: in each cell projected onto constants (linear and P2 elements) or linear functions
            ///< (Q2) (Hughes: Generalization of selective integration procedures, Int. J. Numer. Meth. Engng.
            ///< 15, 1980); with Q2 the stable pair Q2/P-1. Without effect on linear triangles and tetrahedra,
            ///< which lock, and in plane stress, where nothing does
};

/// Points of the quadrature.
enum class Integration {
  Full,
  Reduced ///< 2 in each direction on serendipity quadrilaterals and hexahedra, 2 on wedges of 6 nodes, 9 on
          ///< those of 15, as other programs have it (C3D20R, CPS8R, C3D6, C3D15): softer in bending; a cell
          ///< alone, but the last one, has motions of no energy besides the rigid ones. Without effect on
          ///< other elements: on Lagrange elements of second order such motions spread over all cells
};

/// Elasticity on a mesh: what is integrated, and with what. dof = node · dimension + component.
struct Elasticity {
  Kinematics kinematics = Kinematics::PlaneStrain;
  Dilatation dilatation = Dilatation::Full;
  std::vector<Material> materials; ///< of each region
  Integration integration = Integration::Full;
  Strains strains = Strains::Small; ///< of stresses; matrices and loads of this page are those of small ones
};

/// By how much warmer a mesh is than when it was free of stress: all of it, and at its nodes besides, see
/// TemperatureField; null: none.
struct TemperatureRise {
  double uniform = 0.0;
  std::shared_ptr<const std::vector<double>> nodal = nullptr;
};

/// Degree of the quadrature of stiffness matrices: on curved or distorted cells none is exact; the full one
/// is that of affine ones, and for order 2 one more, for curved sides.
int stiffnessDegree(CellType type, Integration integration = Integration::Full);
/// That of a mesh: axisymmetric triangles of three nodes need more than the one point of plane ones, which
/// leaves a motion without energy.
int stiffnessDegree(const Mesh& mesh, Integration integration);

/// K = Σ ∫ B̄ᵀ C B̄, no boundary conditions; thickness one in the plane. Relative coordinates only: congruent
/// meshes give identical matrices.
/// @throws NumericalError for inverted cells; InternalError if a region has no material.
/// Guarded by tests/unit/fem/test_elasticity.cpp and tests/verification/test_elements.cpp.
LocalMatrix assembleElasticity(const Mesh& mesh, const Elasticity& elasticity);

/// f = ∫ B̄ᵀ C ε_T, the load of a temperature rise.
std::vector<double> assembleThermalLoad(const Mesh& mesh, const Elasticity& elasticity, double temperature);

/// The same of rises at the nodes, see TemperatureField.
std::vector<double> assembleThermalLoad(const Mesh& mesh, const Elasticity& elasticity,
                                        const std::vector<double>& temperatures);

/// ½∫ε_T:C:ε_T for a temperature of one degree. Local.
double thermalEnergy(const Mesh& mesh, const Elasticity& elasticity);
/// The same of rises at the nodes.
double thermalEnergy(const Mesh& mesh, const Elasticity& elasticity, const std::vector<double>& temperatures);

} // namespace Harmos::fem
