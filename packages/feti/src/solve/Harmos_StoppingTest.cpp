// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StoppingTest.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_Qp.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace Harmos::feti::Details {
namespace {

// Of a residual, in rounding errors of what it is made of; ten for sums.
constexpr double attainable = 10.0 * std::numeric_limits<double>::epsilon();

double norm(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

// The largest mean diagonal of a K_i: force over displacement of a dof. Collective.
double stiffnessScale(const SubdomainSystem& system) {
  std::set<const LocalMatrix*> known;
  double largest = 0.0;
  for (int i = 0; i < system.size(); ++i)
    if (known.insert(&system.matrix(i)).second) {
      double sum = 0.0;
      for (double entry : system.diagonal(i))
        sum += entry;
      largest = std::max(largest, sum / std::max(1, system.matrix(i).rows()));
    }
  return globalMax(*system.comm(), largest);
}

// ‖·‖ of what rows give way by. Collective.
double openings(const Constraints& constraints, const MultiVector& shift, const MultiVector& lambda) {
  double sum = 0.0;
  const auto difference = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto shifted = shift.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r < difference.extent(0); ++r) {
    const int row = static_cast<int>(r);
    const double force = difference(r, 0) + shifted(r, 0);
    sum += std::pow(constraints.giving(row, force) + constraints.compliance(row) * force, 2);
  }
  return std::sqrt(globalSum(*constraints.rowMap()->getComm(), sum));
}

} // namespace

qp::Status GradientTest::checkStatus(const qp::IterationState<MultiVector>& state) {
  lastRounding_ = 0.0;
  if (qp::StatusTestProjectedGradient<MultiVector>::checkStatus(state) == qp::Status::Passed || !rounding_)
    return getStatus();
  const double asked = limit();
  lastRounding_ = rounding_(*state.x);
  return judge(state.projectedGradient, std::max(asked, lastRounding_));
}

StoppingTest stoppingTest(const DualStages& stages, const SolverOptions& options, double tolerance,
                          bool judgeEquality, SolveReport& report) {
  const DualProblem& dual = *stages.problem;
  report.dNorm = norm(dual.d());
  report.gradientScale = options.stoppingRule == StoppingRule::Paper ? report.dNorm : norm(*dual.rhs());
  // Bodies that are moved as a whole and strained by nothing have no forces, and residuals of rounding
  // errors, of which no share is to be had: those of d, and what forces they stand for.
  const double rounding = attainable * report.dNorm + stages.constraints->boundRounding();
  if (report.gradientScale <= rounding)
    report.gradientScale = std::max(report.gradientScale, rounding / tolerance);
  StoppingTest result;
  GradientTest::Rounding ofOpenings;
  if (stages.constraints->hasSoft() || stages.constraints->hasCompliance())
    ofOpenings = [&constraints = *stages.constraints, &dual](const MultiVector& lambda) {
      return attainable * openings(constraints, *dual.shift(), lambda);
    };
  result.gradient = Teuchos::rcp(new GradientTest(tolerance, report.gradientScale, std::move(ofOpenings)));
  std::vector<Teuchos::RCP<qp::StatusTest<MultiVector>>> tests = {result.gradient};
  if (!dual.equalityRows().is_null()) {
    using EqualityTest = qp::StatusTestEqualityResidual<MultiVector>;
    const double negligible = stiffnessScale(*stages.system) * rounding;
    Teuchos::RCP<const MultiVector> shift;
    switch (options.stoppingRule) {
    case StoppingRule::Scaled:
      report.equalityScale = norm(*dual.shift());
      shift = dual.shift();
      break;
    case StoppingRule::Paper:
      report.equalityScale = dual.scaledLoadNorm();
      break;
    case StoppingRule::Permon:
      report.equalityScale = norm(*dual.rhs());
      break;
    }
    result.equality = Teuchos::rcp(new EqualityTest(tolerance, report.equalityScale, shift, negligible));
    if (judgeEquality)
      tests.push_back(result.equality);
  }
  using Combo = qp::StatusTestCombo<MultiVector>;
  result.test = Teuchos::rcp(new Combo(Combo::Type::Sequence, tests));
  return result;
}

} // namespace Harmos::feti::Details
