// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactFields.hpp"
#include "Harmos_Decomposition.hpp"

#include <Teuchos_Comm.hpp>

#include <string>
#include <vector>

namespace Harmos::run {

/// What is drawn: values at the nodes of this rank's subdomains.
struct ResultFields {
  const feti::TornVector* displacement = nullptr;
  const feti::TornVector* velocity = nullptr;                       ///< null: none
  int components = 1;                                               ///< of the displacement at a node
  const std::vector<std::vector<fem::Voigt>>* stress = nullptr;     ///< null: none
  const std::vector<std::vector<double>>* plasticStrain = nullptr;  ///< equivalent; null: none
  const std::vector<std::vector<fem::Voigt>>* cellStress = nullptr; ///< of cells; null: none
  const std::vector<std::vector<double>>* cellError = nullptr;      ///< estimated, of cells; null: none
  const ContactFields* contact = nullptr;                           ///< null without contact
  ContactFieldKinds kinds;                                          ///< that this has
};

/// Writes the result for ParaView by io::VtkHdfWriter, one part a subdomain: the file does not depend on the
/// number of ranks.
///
/// Point data: displacement (a scalar for membranes, else a vector); of transient runs velocity; stress (xx,
/// yy, zz, xy, yz, xz) and von_mises; where materials yield equivalent_plastic_strain; with contact also
/// contact_pressure, gap, active_set; with friction also friction_traction, slip (vectors), friction_state;
/// with adhesion also bound (1 where it acts), damage, jump, interface_traction (vectors). Cell data:
/// subdomain, body, region, and on request cell_stress and estimated_error (in the energy norm).
///
/// Arrays are made when they are written and then let go of: cells with their types and offsets, stresses
/// with those of von Mises, all else one by one.
/// @throws InputError on all ranks if the file cannot be written; what was there before is then untouched.
/// @note Collective.
/// Guarded by tests/regression/test_result_file.py (VTK's own reader).
void writeResult(const Teuchos::Comm<int>& comm, const std::string& path,
                 const std::vector<scene::OwnedSubdomain>& owned, const ResultFields& fields);

} // namespace Harmos::run
