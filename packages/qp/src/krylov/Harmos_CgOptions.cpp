// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CgOptions.hpp"

namespace Harmos::qp {

ParameterSpec CgOptions::parameterSpec() {
  const CgOptions defaults;
  ParameterSpec spec("PCPG",
                     "Projected conjugate gradients: for equalities alone, and on the faces of PDAS.");
  spec.choice("Reorthogonalisation", "auto",
              {{"none", "a new direction is made conjugate to the last one"},
               {"full", "to all stored directions"},
               {"auto", "to all stored directions once rounding errors spoil the conjugacy"}},
              "Conjugacy of the directions. More of it keeps the number of steps of ill-conditioned problems "
              "near that of exact arithmetic.");
  spec.integer("Stored directions", defaults.storedDirections, 1, 1000000,
               "Largest number of stored directions, the first ones of a face, of two vectors each.");
  return spec;
}

CgOptions CgOptions::fromList(const Teuchos::ParameterList& list) {
  CgOptions options;
  const std::string when = list.get<std::string>("Reorthogonalisation");
  options.reorthogonalisation = when == "none"   ? Reorthogonalisation::None
                                : when == "full" ? Reorthogonalisation::Full
                                                 : Reorthogonalisation::Auto;
  options.storedDirections = list.get<int>("Stored directions");
  return options;
}

} // namespace Harmos::qp
