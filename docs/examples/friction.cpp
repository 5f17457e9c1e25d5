// SPDX-License-Identifier: BSD-3-Clause
/// (f) Friction with a given bound between an application's own torn matrices and a wall: pulled, and let go.
#include "torn_membrane.hpp"

#include <Harmos_FetiSolver.hpp>
#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_Core.hpp>

#include <cmath>
#include <cstdio>

using namespace Harmos;

int main(int argc, char** argv) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();
  const TornMembrane sheet;
  // The right side of a sheet rubs on a wall: at each point two rows with one disc, of the bound times the
  // length of the point. In the plane it is one row, without a disc.
  std::vector<ConstraintRow> rows; // all on rank 0
  const int last = sheet.s * sheet.n;
  for (int j = 0; comm->getRank() == 0 && j <= last; ++j)
    for (int component : {0, 1}) {
      ConstraintRow row;
      row.kind = ConstraintRow::Kind::Limited;
      row.number = 2 * j + component;
      row.terms = {{sheet.dof(last, j) + component * TornMembrane::second, 1.0}};
      row.limit = (0.3 + 0.6 * j * sheet.size()) * sheet.size() * (j == 0 || j == last ? 0.5 : 1.0);
      row.disc = j;
      rows.push_back(row);
    }

  Teuchos::ParameterList parameters;
  parameters.sublist("Solver").set("Tolerance", 1e-8);
  feti::FetiSolver solver(comm, sheet.inTwoDirections(*comm, 0.0, 0.0), rows, parameters);
  for (double load : {1.0, 1.2, 0.0}) {
    std::vector<std::shared_ptr<const std::vector<double>>> loads;
    for (const feti::Subdomain& subdomain : sheet.inTwoDirections(*comm, load, -0.5 * load))
      loads.push_back(subdomain.load);
    solver.setLoads(loads);
    solver.setBounds(rows); // where they stuck or slipped to before
    const feti::SolveReport& report = solver.solve();

    std::vector<double> mine(2 * static_cast<std::size_t>(last + 1), 0.0), slip(mine.size());
    const feti::FrictionState state = solver.friction(); // of the rows that this rank owns
    for (std::size_t k = 0; k < state.row.size(); ++k)
      mine[static_cast<std::size_t>(state.row[k])] = state.slip[k];
    Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, static_cast<int>(mine.size()), mine.data(), slip.data());
    int slipping = 0;
    for (std::size_t k = 0; k < slip.size(); k += 2)
      slipping += std::hypot(slip[k], slip[k + 1]) > 1e-6 ? 1 : 0;
    for (ConstraintRow& row : rows)
      row.bound += slip[static_cast<std::size_t>(row.number)];
    if (comm->getRank() == 0)
      std::printf("load %.1f: %s, %d of %d points slip, %.5f is lost\n", load,
                  report.converged ? "converged" : report.reason.c_str(), slipping, last + 1,
                  solver.audit().frictionWork);
  }
}
