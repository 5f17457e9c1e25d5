// SPDX-License-Identifier: BSD-3-Clause
/// (a) The QP layer on an application's Tpetra operator and bounds: a string over an obstacle.
#include "halves.hpp"

#include <BelosTpetraAdapter.hpp>
#include <Harmos_Qp.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include <sstream>

int main(int argc, char** argv) {
  using namespace Harmos;
  return runOnHalves(argc, argv, [](const Teuchos::RCP<const Teuchos::Comm<int>>& comm, int half) {
    const GlobalOrdinal n = 99;
    const double h = 1.0 / 100.0;
    const auto map = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(n), 0, comm));
    const auto matrix = Teuchos::rcp(new Tpetra::CrsMatrix<>(map, 3));
    for (GlobalOrdinal row = map->getMinGlobalIndex(); row <= map->getMaxGlobalIndex(); ++row)
      for (GlobalOrdinal column = std::max<GlobalOrdinal>(row - 1, 0); column <= std::min(row + 1, n - 1);
           ++column) {
        const double value = (row == column ? 2.0 : -1.0) / h;
        matrix->insertGlobalValues(row, 1, &value, &column);
      }
    matrix->fillComplete();
    const auto load = Teuchos::rcp(new MultiVector(map, 1)), depth = Teuchos::rcp(new MultiVector(map, 1)),
               u = Teuchos::rcp(new MultiVector(map, 1));
    load->putScalar(-h * (1.0 + half)); // each half has a load of its own
    depth->putScalar(-0.1);

    const auto problem = Teuchos::rcp(new qp::TpetraProblem(matrix, u, load));
    problem->setLowerBound(depth);
    problem->setProblem();
    const auto parameters = Teuchos::parameterList();
    parameters->set("Convergence Tolerance", 1e-10);
    const auto solver = qp::TpetraSolverFactory().create("MPRGP", parameters);
    solver->setProblem(problem);
    const qp::Result result = solver->solve();

    std::ostringstream text;
    text << "half " << half << ": " << qp::toString(result.reason) << ", " << result.history.back().active
         << " points of the string lie on the obstacle";
    return text.str();
  });
}
