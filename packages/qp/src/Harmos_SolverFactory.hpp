// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverManager.hpp"

#include <string>
#include <vector>

namespace Harmos::qp {

/// Makes solvers by name, letters' case ignored; mirrors Belos::SolverFactory.
template<class Scalar, class MV, class OP>
class SolverFactory {
 public:
  /// @throws InputError for an unknown name (the nearest is offered) or bad parameters.
  Teuchos::RCP<SolverManager<Scalar, MV, OP>>
  create(const std::string& name, const Teuchos::RCP<Teuchos::ParameterList>& parameters) const;

  std::vector<std::string> supportedSolverNames() const;
  bool isSupported(const std::string& name) const;

  /// The cheapest solver the structure admits: PCPG without bounds, MPRGP without equalities, SMALBE with
  /// both.
  static std::string automaticChoice(const Problem<Scalar, MV, OP>& problem);
};

} // namespace Harmos::qp
