// SPDX-License-Identifier: BSD-3-Clause
/// (b) Contact of an application's own torn matrices, over load steps: one factorisation, warm starts.
#include "halves.hpp"
#include "torn_membrane.hpp"

#include <Harmos_FetiSolver.hpp>
#include <Teuchos_CommHelpers.hpp>

#include <sstream>

int main(int argc, char** argv) {
  using namespace Harmos;
  return runOnHalves(argc, argv, [](const Teuchos::RCP<const Teuchos::Comm<int>>& comm, int half) {
    const TornMembrane membrane;
    Teuchos::ParameterList parameters;
    parameters.sublist("Solver").set("Tolerance", 1e-8);
    feti::FetiSolver solver(comm, membrane.subdomains(*comm, 1.0 + half, -1.0), membrane.obstacle(*comm, 0.2),
                            parameters);
    const int before = solver.factorizations().factorizations;

    std::ostringstream text;
    text << "half " << half << ": points in contact";
    for (double pressure : {0.5, 1.0, 1.5, 2.0}) {
      std::vector<std::shared_ptr<const std::vector<double>>> loads;
      for (const feti::Subdomain& subdomain : membrane.subdomains(*comm, 1.0 + half, -pressure))
        loads.push_back(subdomain.load);
      solver.setLoads(loads);
      const feti::SolveReport& report = solver.solve();
      const feti::ContactState contact = solver.contact(); // of the rows that this rank owns
      int here = 0, everywhere = 0;
      for (double force : contact.force)
        here += force > 0.0 ? 1 : 0;
      Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, here, Teuchos::outArg(everywhere));
      text << (report.converged ? " " : " ?") << everywhere;
    }
    text << ", new factorisations " << solver.factorizations().factorizations - before;
    return text.str();
  });
}
