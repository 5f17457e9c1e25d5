// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CgOptions.hpp"

namespace Harmos::qp {

ParameterSpec CgOptions::parameterSpec() {
  const CgOptions defaults;
  ParameterSpec spec("PCPG",
                     "Projected conjugate gradients: for equalities alone, and on the faces of PDAS.");
  spec.choice(
      "Reorthogonalisation", "auto",
      {{"none", "a new direction is made conjugate to the last one alone"},
       {"full", "to all stored ones"},
       {"auto", "to all stored ones from where rounding errors are seen to spoil conjugacy"}},
      "Keeps the number of steps near that of exact arithmetic where the problem is ill-conditioned.");
  spec.integer("Stored directions", defaults.storedDirections, 1, 1000000,
               "Most directions that are kept, the first ones of a face: two vectors each.");
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
