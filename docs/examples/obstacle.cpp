// SPDX-License-Identifier: BSD-3-Clause
/// A membrane over an obstacle: min ½xᵀAx − bᵀx, x ≥ l, on a Tpetra matrix; see docs/qp.md.
#include <BelosTpetraAdapter.hpp>
#include <Harmos_Qp.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include <cmath>
#include <iostream>

int main(int argc, char** argv) {
  using namespace Harmos;
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();

  // The Laplacian on n × n interior points of the unit square, fixed at its sides and pulled down.
  const GlobalOrdinal n = 64;
  const double h = 1.0 / static_cast<double>(n + 1);
  const auto map = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(n * n), 0, comm));
  const auto matrix = Teuchos::rcp(new Tpetra::CrsMatrix<>(map, 5));
  const auto load = Teuchos::rcp(new MultiVector(map, 1));
  const auto obstacle = Teuchos::rcp(new MultiVector(map, 1));
  load->putScalar(-8.0 * h * h);
  for (GlobalOrdinal row = map->getMinGlobalIndex(); row <= map->getMaxGlobalIndex(); ++row) {
    const GlobalOrdinal i = row % n, j = row / n;
    const auto couple = [&](bool inside, GlobalOrdinal column, double value) {
      if (inside)
        matrix->insertGlobalValues(row, 1, &value, &column);
    };
    couple(true, row, 4.0);
    couple(i > 0, row - 1, -1.0);
    couple(i < n - 1, row + 1, -1.0);
    couple(j > 0, row - n, -1.0);
    couple(j < n - 1, row + n, -1.0);
    const double x = h * static_cast<double>(i + 1) - 0.5, y = h * static_cast<double>(j + 1) - 0.5;
    obstacle->replaceGlobalValue(row, 0, -0.1 - x * x - y * y); // a hill
  }
  matrix->fillComplete();

  const auto u = Teuchos::rcp(new MultiVector(map, 1)); // the initial guess, and the answer
  const auto problem = Teuchos::rcp(new qp::TpetraProblem(matrix, u, load));
  problem->setLowerBound(obstacle);
  if (!problem->setProblem()) {
    std::cerr << problem->whyNotSet() << "\n";
    return 2;
  }
  const auto parameters = Teuchos::parameterList();
  parameters->set("Convergence Tolerance", 1e-8);
  const auto solver = qp::TpetraSolverFactory().create("Auto", parameters);
  solver->setProblem(problem);
  const qp::Result result = solver->solve();
  const double lowest = -u->getVector(0)->normInf();
  if (comm->getRank() == 0)
    std::cout << result.method << ": " << qp::toString(result.reason) << "\n"
              << "in contact: " << result.history.back().active << " of " << n * n << " points\n"
              << "lowest point: " << std::round(1e6 * lowest) / 1e6 << "\n";
  return result.converged() ? 0 : 1;
}
