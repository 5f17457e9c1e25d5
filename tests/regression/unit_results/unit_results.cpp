// SPDX-License-Identifier: BSD-3-Clause
/// What solvers of the QP layer and of FETI come to, to the last bit: a line for each iteration, a line for
/// each answer. Uses interfaces alone that are as old as version 0.1.0.
#include "torn_membrane.hpp"

#include <Harmos_FetiSolver.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_MultiVector.hpp>

#include <cstdio>
#include <functional>
#include <string>

using namespace Harmos;

namespace {

using Change = std::function<void(Teuchos::ParameterList&)>;

void print(const feti::SolveReport& report) {
  const qp::Result& result = report.result;
  for (const qp::IterationRecord& row : result.history)
    std::printf("%d %d %d %a %a %a %a %lld %d %a\n", row.outer, row.inner, static_cast<int>(row.step),
                row.projectedGradient, row.equalityResidual, row.penalty, row.precision, row.active,
                row.hessianApplications, row.decrease);
  const qp::Counters& c = result.counters;
  std::printf("%s %d: %d %d %d %d %d %d %d %d %d %d %d %d %d %d, %a %a %a\n", report.solver.c_str(),
              report.converged ? 1 : 0, c.outerIterations, c.hessianApplications, c.setupApplications,
              c.cgSteps, c.expansionSteps, c.proportioningSteps, c.faces, c.fallbacks, c.stepCuts,
              c.confirmations, c.activeSetUpdates, c.safeguards, c.preconditionerApplications,
              c.preconditionerSetups, result.projectedGradientNorm, result.equalityNorm, result.hessianNorm);
}

void print(const feti::FetiSolver& solver) {
  double sum = 0.0, weight = 0.0;
  for (const std::vector<double>& part : solver.displacement())
    for (double value : part) {
      weight = weight < 1.0 ? weight + 0.0137 : 0.0;
      sum += weight * value;
    }
  std::printf("%a %a %a %a\n", sum, solver.audit().energy, solver.audit().gluingJump,
              solver.audit().equilibrium);
}

// Three load steps of the membrane.
void solve(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, const std::string& name, bool contact,
           bool held, const Change& change) {
  std::printf("# %s\n", name.c_str());
  const TornMembrane membrane;
  const auto subdomains = [&](double pressure) {
    std::vector<feti::Subdomain> result = membrane.subdomains(*comm, 1.0, pressure);
    if (!held)
      for (feti::Subdomain& subdomain : result)
        subdomain.fixed.clear();
    return result;
  };
  Teuchos::ParameterList parameters;
  parameters.sublist("Solver").set("Tolerance", 1e-7);
  change(parameters);
  feti::FetiSolver solver(comm, subdomains(-1.0),
                          contact ? membrane.obstacle(*comm, 0.1) : std::vector<ConstraintRow>(), parameters);
  for (double pressure : {1.0, 1.3, 0.2}) {
    std::vector<std::shared_ptr<const std::vector<double>>> loads;
    for (const feti::Subdomain& subdomain : subdomains(-pressure))
      loads.push_back(subdomain.load);
    solver.setLoads(loads);
    const feti::SolveReport& report = solver.solve();
    print(report);
    if (solver.hasSolution())
      print(solver);
  }
}

Change method(
    const std::string& name, const std::string& preconditioner = "none",
    const Change& more = [](Teuchos::ParameterList&) {}) {
  return [=](Teuchos::ParameterList& list) {
    list.sublist("Solver").set("Method", name);
    list.sublist("Dual operator").set("Preconditioner", preconditioner);
    more(list);
  };
}

template<class T>
Change set(const std::string& sublist, const std::string& name, const T& value) {
  return [=](Teuchos::ParameterList& list) {
    list.sublist("Solver").sublist("Expert").sublist(sublist).set(name, value);
  };
}

} // namespace

int main(int argc, char** argv) {
  const Tpetra::ScopeGuard guard(&argc, &argv);
  const Teuchos::RCP<const Teuchos::Comm<int>> comm = Tpetra::getDefaultComm();
  for (const char* preconditioner : {"none", "lumped", "Dirichlet"}) {
    const std::string with = std::string(", ") + preconditioner;
    solve(comm, "PCPG" + with, false, true, method("PCPG", preconditioner));
    solve(comm, "SMALBE" + with, true, true, method("SMALBE", preconditioner));
    solve(comm, "PDAS" + with, true, true, method("PDAS", preconditioner));
    solve(comm, "PDAS, floating" + with, true, false, method("PDAS", preconditioner));
    solve(comm, "SMALBE, floating" + with, true, false, method("SMALBE", preconditioner));
    solve(comm, "penalty" + with, true, true, method("Dual Penalty", preconditioner));
  }
  for (const char* rule : {"penalty", "both"})
    solve(comm, std::string("SMALBE by ") + rule, true, true,
          method("SMALBE", "none", set("SMALBE", "Update rule", std::string(rule))));
  solve(comm, "SMALBE, absolute", true, true,
        method("SMALBE", "none", set("SMALBE", "Parameter scaling", std::string("absolute"))));
  solve(comm, "SMALBE, two outer iterations", true, true,
        method("SMALBE", "none", set("SMALBE", "Maximum outer iterations", 2)));
  // Each way on which PDAS hands over.
  solve(comm, "PDAS, two sets", true, true, method("PDAS", "none", set("PDAS", "Maximum active sets", 2)));
  solve(comm, "PDAS, no patience", true, true,
        method("PDAS", "Dirichlet", set("PDAS", "Active sets without progress", 1)));
  solve(comm, "PDAS, no share", true, true, method("PDAS", "none", [](Teuchos::ParameterList& list) {
          list.sublist("Solver").set("Maximum iterations", 120);
          list.sublist("Solver").sublist("Expert").sublist("PDAS").set("Share of iterations", 0.02);
        }));
  for (const char* form : {"implicit", "condensed"})
    solve(comm, form, true, true, method("Auto", "Dirichlet", [=](Teuchos::ParameterList& list) {
            list.sublist("Dual operator").set("Form", std::string(form));
            list.sublist("Decomposition").set("Dirichlet", std::string("dual"));
          }));
  return 0;
}
