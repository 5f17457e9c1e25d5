// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LinearLimit.hpp"

#include "Harmos_DualOperator.hpp"
#include "Harmos_Recovery.hpp"
#include "Harmos_ReplicatedCoarse.hpp"
#include "Harmos_RunOptions.hpp"

#include <cmath>

namespace Harmos {
namespace {

// Membranes that are pressed together, or pulled apart and the second one held at its right side.
void load(TestModel& model, int s, int n, bool closed, int pattern) {
  const double cell = 1.0 / (s * n * s * n);
  for (feti::Subdomain& subdomain : model.subdomains) {
    const int place = static_cast<int>(subdomain.number) % (s * s);
    const bool isSecond = subdomain.number >= s * s;
    const double size = closed ? (isSecond ? -1.0 : 0.3) : (isSecond ? 1.0 : -1.0);
    changeLoad(subdomain, [&](std::vector<double>& values) {
      for (std::size_t i = 0; i < values.size(); ++i) {
        const double weights[] = {1.0, i % 7 == 3 ? 5.0 : 0.1, place == 0 ? 4.0 : 0.2,
                                  1.0 + std::sin(0.7 * static_cast<double>(i))};
        values[i] = size * cell * weights[pattern];
      }
    });
    if (!closed && isSecond && place % s == s - 1)
      for (int j = 0; j <= n; ++j)
        subdomain.fixed.push_back({j * (n + 1) + n, 0.0});
  }
}

} // namespace

LinearLimit::LinearLimit(int s, int n, bool closed, int pattern)
    : contact(testModel(s, n)), linear(testModel(s, n, true)) {
  load(contact, s, n, closed, pattern);
  load(linear, s, n, closed, pattern);
  if (!closed)
    linear.rows.clear();
}

LimitProblem::LimitProblem(const TestModel& model) {
  feti::LocalInverseOptions options;
  options.keepSchur = true;
  system_ =
      Teuchos::rcp(new feti::SubdomainSystem(testComm(), model.subdomains, feti::DirichletForm::Primal));
  constraints_ = Teuchos::rcp(new feti::Constraints(*system_, model.rows));
  inverses_ =
      Teuchos::rcp(new feti::LocalInverses(feti::makeLocalInverses(*system_, *constraints_, options)));
  operator_ = Teuchos::rcp(new feti::DualOperator(*constraints_, *inverses_));
  coarse_ = Teuchos::rcp(new feti::ReplicatedCoarse(*system_, *constraints_));
  dual_ = Teuchos::rcp(new feti::DualProblem(*system_, *constraints_, *inverses_, *operator_, *coarse_));
  preconditioner_ = Teuchos::rcp(new feti::DualPreconditioner(*system_, *constraints_, *inverses_,
                                                              feti::PreconditionerKind::Dirichlet,
                                                              feti::PreconditionerScaling::Multiplicity));
}

run::RunReport LimitProblem::solve(double tolerance) {
  ParameterSpec deck("deck", "A deck.");
  run::RunOptions::addTo(deck);
  run::RunOptions options = run::RunOptions::fromDeck(deck.defaults());
  options.tolerance = tolerance;
  options.progressFrequency = 0;
  run::RunReport report;
  solution_ = feti::solveDualProblem(
      {system_, constraints_, inverses_, coarse_, dual_, preconditioner_, Teuchos::null}, options, nullptr,
      {}, Log(), report);
  return report;
}

feti::KktAudit LimitProblem::audit() const {
  return feti::audit(
      *system_, *constraints_,
      feti::recover(*system_, *constraints_, *inverses_, *coarse_, *dual_, *solution_.lambda, solution_.mu));
}

} // namespace Harmos
