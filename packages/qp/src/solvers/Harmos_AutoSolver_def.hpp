// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_AutoSolver.hpp"
#include "Harmos_FixedPointSolver_def.hpp"
#include "Harmos_PcpgSolver_def.hpp"
#include "Harmos_PdasSolver_def.hpp"
#include "Harmos_SmalbeSolver_def.hpp"

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
const ParameterSpec& AutoSolver<Scalar, MV, OP>::spec() {
  static const ParameterSpec result = [] {
    ParameterSpec spec("Auto", "The solver that the structure calls for.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(CgOptions::parameterSpec());
    spec.expert().list(PdasSolver<Scalar, MV, OP>::methodSpec());
    spec.expert().list(SmalbeSolver<Scalar, MV, OP>::methodSpec());
    spec.expert().list(MprgpOptions::parameterSpec());
    return spec;
  }();
  return result;
}

template<class Scalar, class MV, class OP>
const ParameterSpec& AutoSolver<Scalar, MV, OP>::parameterSpec() const {
  static const ParameterSpec ofPdas = [] {
    ParameterSpec spec("PDAS", "The primal-dual active set solver.");
    SolverManager<Scalar, MV, OP>::addCommonParameters(spec);
    spec.expert().list(PdasSolver<Scalar, MV, OP>::methodSpec());
    spec.expert().list(CgOptions::parameterSpec());
    spec.expert().list(SmalbeSolver<Scalar, MV, OP>::methodSpec());
    spec.expert().list(MprgpOptions::parameterSpec());
    return spec;
  }();
  if (first_.is_null())
    return spec();
  return first_->name() == "PDAS" ? ofPdas : first_->parameterSpec();
}

template<class Scalar, class MV, class OP>
std::string AutoSolver<Scalar, MV, OP>::choice(const Problem<Scalar, MV, OP>& problem) {
  if (!problem.kind().isSet)
    return "PDAS";
  if (problem.blocks().empty())
    return "PCPG";
  const bool cheapFaces = !problem.hasEqualities() || !problem.faceGram().is_null();
  if (problem.hasPreconditioner() && cheapFaces)
    return "PDAS";
  return problem.hasEqualities() ? "SMALBE" : "MPRGP";
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> AutoSolver<Scalar, MV, OP>::make(const std::string& method) {
  if (method == "PCPG")
    return Teuchos::rcp(new PcpgSolver<Scalar, MV, OP>);
  if (method == "SMALBE")
    return Teuchos::rcp(new SmalbeSolver<Scalar, MV, OP>);
  if (method == "PDAS")
    return Teuchos::rcp(new PdasSolver<Scalar, MV, OP>);
  return Teuchos::rcp(new MprgpSolver<Scalar, MV, OP>);
}

template<class Scalar, class MV, class OP>
bool AutoSolver<Scalar, MV, OP>::canBeOrthonormal() const {
  const Problem<Scalar, MV, OP>& problem = *this->problem_;
  if (!problem.hasEqualities() || problem.equalityStructure() != EqualityStructure::General)
    return true;
  const int most = this->parameters_->sublist("Expert").template get<int>("Orthonormalised Rows");
  return Belos::MultiVecTraits<Scalar, MV>::GetGlobalLength(*problem.equalityValues()) <= most;
}

// Null: there is none.
template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> AutoSolver<Scalar, MV, OP>::successorOfPdas() const {
  const Problem<Scalar, MV, OP>& problem = *this->problem_;
  if (!problem.kind().isCost)
    return Teuchos::rcp(new FixedPointSolver<Scalar, MV, OP>(Teuchos::rcp(new AutoSolver(make("PDAS")))));
  if (!problem.kind().isSet)
    return Teuchos::null;
  return make(problem.hasEqualities() ? "SMALBE" : "MPRGP");
}

template<class Scalar, class MV, class OP>
std::vector<typename AutoSolver<Scalar, MV, OP>::Stage> AutoSolver<Scalar, MV, OP>::plan() const {
  constexpr double share = 0.25;
  const Problem<Scalar, MV, OP>& problem = *this->problem_;
  const Teuchos::RCP<Solver> first = first_.is_null() ? make(choice(problem)) : first_->clone();
  std::vector<Stage> stages = {{first}};
  if (problem.blocks().empty())
    return stages;
  if (first->name() != "PDAS") {
    if (problem.kind().isCost && problem.kind().isPiecewiseLinear)
      return stages;
    if (!problem.kind().isCost)
      stages[0].solver = Teuchos::rcp(new FixedPointSolver<Scalar, MV, OP>(first));
    if (!canBeOrthonormal())
      return stages;
    stages[0].share = share;
    stages.push_back({make("PDAS"), 1.0, true});
  }
  if (const Teuchos::RCP<Solver> last = successorOfPdas(); !last.is_null())
    stages.push_back({last});
  return stages;
}

// Empty: it does not.
template<class Scalar, class MV, class OP>
std::string AutoSolver<Scalar, MV, OP>::whyHandOver(const Stage& stage) const {
  if (!stage.solver->gaveUp().empty())
    return stage.solver->gaveUp();
  const Result& result = this->result_;
  const bool isSpent = stage.share < 1.0 && result.reason == Reason::IterationLimit &&
                       result.lastRecord().inner < this->maximumIterations();
  return isSpent ? "slow convergence" : "";
}

template<class Scalar, class MV, class OP>
void AutoSolver<Scalar, MV, OP>::doSolve() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const std::vector<Stage> stages = plan();
  std::size_t k = 0;
  this->describeDelegation(
      [&k, this](StateArchive<MV>& archive) { archive.number(this->stateName("stage"), k); });
  this->resumeDelegation();
  for (;; ++k) {
    const Stage& stage = stages[k];
    if (stage.isFromZero) {
      MVT::MvInit(*this->problem_->solution(), 0.0);
      if (this->problem_->hasEqualities())
        MVT::MvInit(*this->problem_->multiplier(), 0.0);
    }
    const int done = this->result_.history.empty() ? this->firstInner_ : this->result_.lastRecord().inner;
    const int budget = done + static_cast<int>(stage.share * (this->maximumIterations() - done));
    Teuchos::RCP<StatusTest<MV>> spent;
    if (stage.share < 1.0)
      spent = Teuchos::rcp(new StatusTestMaxIterations<MV>(budget));
    stage.solver->setSuccessor(k + 1 < stages.size());
    this->delegate(*stage.solver, {Teuchos::null, spent});
    const std::string why = k + 1 < stages.size() ? whyHandOver(stage) : "";
    if (why.empty())
      return;
    ++this->result_.counters.safeguards;
    const Teuchos::RCP<Solver>& next = stages[k + 1].solver;
    this->log_.detail(
        stage.solver->name() + ": " + why + "; fallback to " +
        (next->name() == stage.solver->name() ? "fixed-point updates of the limits" : next->name()));
  }
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<SolverManager<Scalar, MV, OP>> AutoSolver<Scalar, MV, OP>::clone() const {
  const auto copy = Teuchos::rcp(new AutoSolver(first_));
  if (!this->parameters_.is_null())
    copy->setParameters(Teuchos::rcp(new Teuchos::ParameterList(*this->parameters_)));
  return copy;
}

} // namespace Harmos::qp
