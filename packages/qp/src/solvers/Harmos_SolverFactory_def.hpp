// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AutoSolver_def.hpp"
#include "Harmos_DualPenaltySolver_def.hpp"
#include "Harmos_MprgpSolver_def.hpp"
#include "Harmos_PcpgSolver_def.hpp"
#include "Harmos_PdasSolver_def.hpp"
#include "Harmos_QpProblem_def.hpp"
#include "Harmos_SmalbeSolver_def.hpp"
#include "Harmos_SolverFactory.hpp"

#include <algorithm>
#include <cctype>

namespace Harmos::qp {

namespace Details {

inline std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

/// A method, and what goes on where it gives up.
template<template<class, class, class> class Method, class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> withFallback() {
  return Teuchos::rcp(new AutoSolver<Scalar, MV, OP>(Teuchos::rcp(new Method<Scalar, MV, OP>)));
}

} // namespace Details

template<class Scalar, class MV, class OP>
SolverFactory<Scalar, MV, OP>::SolverFactory() {
  addSolver("Auto", [] { return Teuchos::rcp(new AutoSolver<Scalar, MV, OP>); });
  addSolver("MPRGP", &Details::withFallback<MprgpSolver, Scalar, MV, OP>);
  addSolver("SMALBE", &Details::withFallback<SmalbeSolver, Scalar, MV, OP>);
  addSolver("Dual Penalty", &Details::withFallback<DualPenaltySolver, Scalar, MV, OP>);
  addSolver("PCPG", [] { return Teuchos::rcp(new PcpgSolver<Scalar, MV, OP>); });
  addSolver("PDAS", &Details::withFallback<PdasSolver, Scalar, MV, OP>);
}

template<class Scalar, class MV, class OP>
void SolverFactory<Scalar, MV, OP>::addSolver(const std::string& name, Maker maker) {
  if (isSupported(name))
    throw InputError("the solver \"" + name + "\" exists already; use another name");
  makers_.emplace_back(name, std::move(maker));
}

template<class Scalar, class MV, class OP>
std::vector<std::string> SolverFactory<Scalar, MV, OP>::supportedSolverNames() const {
  std::vector<std::string> names;
  for (const auto& [name, maker] : makers_)
    names.push_back(name);
  return names;
}

template<class Scalar, class MV, class OP>
const typename SolverFactory<Scalar, MV, OP>::Maker*
SolverFactory<Scalar, MV, OP>::find(const std::string& name) const {
  for (const auto& [known, maker] : makers_)
    if (Details::lowered(known) == Details::lowered(name))
      return &maker;
  return nullptr;
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>>
SolverFactory<Scalar, MV, OP>::create(const std::string& name,
                                      const Teuchos::RCP<Teuchos::ParameterList>& parameters) const {
  const Maker* maker = find(name);
  if (maker == nullptr) {
    const std::string nearest = nearestName(name, supportedSolverNames());
    std::string known;
    for (const std::string& candidate : supportedSolverNames())
      known += (known.empty() ? "\"" : ", \"") + candidate + "\"";
    throw InputError("unknown solver \"" + name + "\"" +
                     (nearest.empty() ? "." : "; did you mean \"" + nearest + "\"?") + " Known: " + known +
                     ".");
  }
  Teuchos::RCP<Solver> solver = (*maker)();
  solver->setParameters(parameters);
  return solver;
}

} // namespace Harmos::qp
