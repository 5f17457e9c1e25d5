// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Material.hpp"

#include <cstddef>
#include <memory>

namespace Harmos::fem {

/// Of what displacements strains are.
enum class Strains {
  Small, ///< linear; stresses are those of the body at rest
  Finite ///< Green's, of any size; stresses are second Piola–Kirchhoff ones in laws, Cauchy's in results
};

/// What a material answers to a strain at a point.
struct MaterialResponse {
  double energy = 0.0;     ///< stored, per volume of the body at rest
  Voigt stress{};          ///< conjugate to the strain
  VoigtMatrix tangent{};   ///< its derivative, symmetric
  double across = 0.0;     ///< strain zz: as given, or in plane stress the one without stress
  double dissipated = 0.0; ///< per volume, since the run began
  bool yields = false;     ///< the state goes on from here, and the tangent is that of its going on
};

/// The law of a material at a point: what stress it answers to a strain, from the state with which the step
/// began. States are numbers, all zero of a body that nothing has happened to; the caller keeps them, before
/// the step and after it (see fem::MaterialStates).
///
/// A law of one's own is a class like PlasticLaw and a line in makeMaterialLaw(). Shear strains are twice the
/// tensor's; local.
class MaterialLaw {
 public:
  virtual ~MaterialLaw();

  /// Numbers of a point.
  virtual std::size_t stateSize() const { return 0; }
  /// @param strain small, or Green's; in plane stress without use of its entry zz. @param rise of the
  /// temperature. @param before state when the step began. @param after the state with this strain; both null
  /// of a law without. @return an energy that is no number where there is no answer.
  virtual MaterialResponse at(const Voigt& strain, double rise, const double* before,
                              double* after) const = 0;

  /// What results show of a state: a number from 0; of plastic laws the equivalent plastic strain.
  virtual double shownState(const double* /*state*/) const { return 0.0; }
};

/// Of a material. @param strains which ones it is given.
std::unique_ptr<MaterialLaw> makeMaterialLaw(const Material& material, Kinematics kinematics,
                                             Strains strains);

} // namespace Harmos::fem
