// SPDX-License-Identifier: BSD-3-Clause
/// (g) Coulomb's friction between an application's own torn matrices and a slope: pressed on it and pulled
/// along it, in this order and in the other one.
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
  const int last = sheet.s * sheet.n;
  const double stiffness = 3.0; // sideways, of that downwards

  // Below the right side of a sheet is a slope. Each point has a row for its gap, and one for its slip, whose
  // limit is a multiple of the force of the first.
  using Kind = ConstraintRow::Kind;
  std::vector<ConstraintRow> given; // all on rank 0
  const auto add = [&](Kind kind, int j, double x, double y, double bound) {
    ConstraintRow row;
    row.kind = kind;
    row.number = j;
    row.terms.push_back({sheet.dof(last, j) + TornMembrane::second, x});
    row.terms.push_back({sheet.dof(last, j), y});
    row.bound = bound;
    given.push_back(row);
  };
  for (int j = 0; comm->getRank() == 0 && j <= last; ++j) {
    add(Kind::Inequality, j, 0.6, -0.8, 0.1 + std::pow(j * sheet.size() - 0.5, 2));
    add(Kind::Limited, j, 0.8, 0.6, 0.0);
    given.back().coefficient = 0.5;
    given.back().normal = j;
  }

  Teuchos::ParameterList parameters;
  parameters.sublist("Solver").set("Tolerance", 1e-8);
  feti::FetiSolver solver(comm, sheet.inTwoDirections(*comm, 0.0, 0.0, stiffness), given, parameters);
  for (bool pressFirst : {true, false}) {
    std::vector<ConstraintRow> rows = given;
    for (const auto& [press, pull] :
         {std::pair(pressFirst ? 1.0 : 0.0, pressFirst ? 0.0 : 0.5), std::pair(1.0, 0.5)}) {
      std::vector<std::shared_ptr<const std::vector<double>>> loads;
      for (const feti::Subdomain& subdomain : sheet.inTwoDirections(*comm, -press, pull, stiffness))
        loads.push_back(subdomain.load);
      solver.setLoads(loads);
      solver.setBounds(rows); // where they have slipped to before
      const feti::SolveReport& report = solver.solve();

      std::vector<double> mine(static_cast<std::size_t>(last + 1), 0.0), slip(mine.size());
      const feti::FrictionState state = solver.friction(); // of the rows that this rank owns
      for (std::size_t k = 0; k < state.row.size(); ++k)
        mine[static_cast<std::size_t>(state.row[k])] = state.slip[k];
      Teuchos::reduceAll(*comm, Teuchos::REDUCE_SUM, last + 1, mine.data(), slip.data());
      int touching = 0, slipping = 0;
      double pressure = 0.0, friction = 0.0;
      const std::vector<double> force = solver.rowForces(); // of the rows that this rank gave
      for (std::size_t k = 0; k < rows.size(); k += 2) {
        const double slipped = slip[k / 2];
        touching += force[k] > 0.0 ? 1 : 0;
        slipping += force[k] > 0.0 && std::abs(slipped) > 1e-6 ? 1 : 0;
        pressure += force[k];
        friction += force[k + 1];
        rows[k + 1].bound += slipped;
      }
      if (comm->getRank() == 0)
        std::printf(
            "press %.1f, pull %.1f: %s, %d of %d points touch, %d of them slip; forces %.4f and %.4f\n",
            press, pull, report.converged ? "converged" : report.reason.c_str(), touching, last + 1, slipping,
            pressure, friction);
    }
  }
}
