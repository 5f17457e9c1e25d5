// SPDX-License-Identifier: BSD-3-Clause
/// A torn membrane that lies on an obstacle, held by nothing: pressed down it comes to rest, pulled up it
/// leaves, and the report says which subdomains do.
#include "torn_membrane.hpp"

#include <Harmos_Feti.hpp>
#include <Tpetra_Core.hpp>

#include <iostream>

namespace {

std::string solve(const Teuchos::RCP<const Teuchos::Comm<int>>& comm, double pressure) {
  const TornMembrane membrane;
  std::vector<Harmos::feti::Subdomain> subdomains = membrane.subdomains(*comm, 1.0, pressure);
  for (Harmos::feti::Subdomain& subdomain : subdomains)
    subdomain.fixed.clear();
  Harmos::feti::FetiSolver solver(comm, subdomains, membrane.obstacle(*comm, 0.2));
  return solver.solve().reason;
}

} // namespace

int main(int argc, char** argv) {
  const Tpetra::ScopeGuard guard(&argc, &argv);
  const Teuchos::RCP<const Teuchos::Comm<int>> comm = Tpetra::getDefaultComm();
  std::string text;
  try {
    text = "down: " + solve(comm, -1.0) + "\nup: " + solve(comm, 1.0) + "\n";
    Teuchos::ParameterList parameters;
    parameters.sublist("Solver").set("Tolerence", 1e-8);
    const Harmos::feti::FetiSolver solver(comm, {}, {}, parameters);
  } catch (const Harmos::InputError& error) {
    text += std::string("refused: ") + error.what() + "\n";
  }
  if (comm->getRank() == 0)
    std::cout << text;
  return 0;
}
