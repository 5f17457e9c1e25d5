// SPDX-License-Identifier: BSD-3-Clause
/// A solver of one's own in the QP layer: projected gradients with a fixed step; see docs/developing.md.
#include <BelosTpetraAdapter.hpp>
#include <Harmos_BoundTraitsTpetra.hpp>
#include <Harmos_Errors.hpp>
#include <Harmos_NormEstimate_def.hpp>
#include <Harmos_Qp.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include <cmath>
#include <iostream>
#include <limits>

using namespace Harmos;

/// x ← Π(x − s/‖A‖ (Ax − b)), for bounds alone; converges for every s in (0, 2), at the rate of the condition
/// number (Goldstein 1964).
class FixedStepGradient : public qp::TpetraSolverManager {
  using Bounds = qp::BoundOps<Scalar, MultiVector>;

 public:
  std::string name() const override { return "Fixed Step Gradient"; }

  Teuchos::RCP<qp::TpetraSolverManager> clone() const override {
    const auto copy = Teuchos::rcp(new FixedStepGradient);
    if (!getCurrentParameters().is_null())
      copy->setParameters(Teuchos::rcp(new Teuchos::ParameterList(*getCurrentParameters())));
    return copy;
  }

  const ParameterSpec& parameterSpec() const override {
    static const ParameterSpec result = [] {
      ParameterSpec spec("Fixed Step Gradient", "Projected gradients for bounds alone.");
      addCommonParameters(spec);
      spec.real("Step factor", 1.0, Range::strictlyWithin(0.0, 2.0), "s: the step is s/‖A‖.");
      return spec;
    }();
    return result;
  }

 protected:
  void doSolve() override {
    if (problem_->hasEqualities())
      throw InputError(name() + " is for bounds alone, but the problem has equalities; use SMALBE");
    const Operator& a = *problem_->hessian();
    const MultiVector& b = *problem_->rhs();
    const qp::FeasibleSet<MultiVector> feasible = problem_->feasibleSet();
    qp::Counters& counters = result_.counters;

    double norm = problem_->hessianNorm();
    if (norm == 0.0) {
      MultiVector start(b.getMap(), 1);
      Bounds::setRandom(start);
      norm = 1.05 * qp::estimateNorm<Scalar, MultiVector>(
                        [&](const MultiVector& v, MultiVector& w) { a.apply(v, w); }, start, 12,
                        counters.setupApplications);
    }
    if (!(norm > 0.0))
      throw InputError(name() + " needs a Hessian that is not zero");
    const double step = parameters_->get<double>("Step factor") / norm;

    MultiVector& x = *problem_->solution();
    MultiVector gradient(b.getMap(), 1), old(b.getMap(), 1);
    qp::LocalActiveSet active;
    Bounds::project(x, feasible);
    for (int k = 0;; ++k) {
      a.apply(x, gradient);
      gradient.update(-1.0, b, 1.0);
      ++counters.hessianApplications;
      const qp::SplitSums sums = Bounds::split(x, gradient, feasible, step, nullptr, active);

      qp::IterationState<MultiVector> state;
      state.x = &x;
      state.projectedGradient = std::sqrt(sums.projectedNorm2());
      state.decrease = std::numeric_limits<double>::quiet_NaN(); // not known
      state.outer = 1;
      state.inner = firstInner_ + k;
      state.counters = &counters;
      record(state, k == 0 ? qp::StepKind::Start : qp::StepKind::Expansion, 0.0, 0.0, sums.active);
      const auto reason = judge(state);
      if (reason && (*reason != qp::Reason::Converged || accepted()))
        return stopFor(*reason, state);

      Bounds::projectedStep(x, old, gradient, step, feasible);
    }
  }
};

int main(int argc, char** argv) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();

  // A string of n points, fixed at its ends, pulled onto a table.
  const GlobalOrdinal n = 31;
  const double h = 1.0 / static_cast<double>(n + 1);
  const auto map = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(n), 0, comm));
  const auto matrix = Teuchos::rcp(new Tpetra::CrsMatrix<>(map, 3));
  for (GlobalOrdinal row = map->getMinGlobalIndex(); row <= map->getMaxGlobalIndex(); ++row)
    for (GlobalOrdinal column = std::max<GlobalOrdinal>(row - 1, 0); column <= std::min(row + 1, n - 1);
         ++column) {
      const double value = (row == column ? 2.0 : -1.0) / h;
      matrix->insertGlobalValues(row, 1, &value, &column);
    }
  matrix->fillComplete();
  const auto load = Teuchos::rcp(new MultiVector(map, 1)), table = Teuchos::rcp(new MultiVector(map, 1));
  load->putScalar(-h);
  table->putScalar(-0.1);

  qp::TpetraSolverFactory factory;
  factory.addSolver("Fixed Step Gradient", [] { return Teuchos::rcp(new FixedStepGradient); });
  std::vector<Teuchos::RCP<MultiVector>> answers;
  for (const char* method : {"fixed step gradient", "MPRGP"}) {
    answers.push_back(Teuchos::rcp(new MultiVector(map, 1)));
    const auto problem = Teuchos::rcp(new qp::TpetraProblem(matrix, answers.back(), load));
    problem->setLowerBound(table);
    problem->setProblem();
    const auto solver = factory.create(method, Teuchos::parameterList());
    solver->setProblem(problem);
    const qp::Result result = solver->solve();
    if (comm->getRank() == 0)
      std::cout << result.method << ": " << qp::toString(result.reason) << ", "
                << result.history.back().active << " points on the table, "
                << (result.counters.hessianApplications > 300 ? "more" : "less")
                << " than 300 products with A\n";
  }
  answers[0]->update(-1.0, *answers[1], 1.0);
  const double difference = answers[0]->getVector(0)->normInf();
  // Both gradients vanish to 1e-8‖b‖; the error of x is κ times as large at most, κ = 415.
  if (comm->getRank() == 0)
    std::cout << "the same answer: " << (difference < 1e-6 ? "yes" : "no") << "\n";
  return 0;
}
