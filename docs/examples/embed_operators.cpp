// SPDX-License-Identifier: BSD-3-Clause
/// (d) Parts alone: the dual operator F as a Tpetra::Operator, here for its largest eigenvalue, and MUMPS
/// with a Schur complement as an Amesos2::Solver.
#include "halves.hpp"
#include "torn_membrane.hpp"

#include <Harmos_FetiSolver.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include <cmath>
#include <sstream>

int main(int argc, char** argv) {
  using namespace Harmos;
  return runOnHalves(argc, argv, [](const Teuchos::RCP<const Teuchos::Comm<int>>& comm, int half) {
    const TornMembrane membrane;
    const feti::FetiSolver feti(comm, membrane.subdomains(*comm, 1.0 + half, -1.0), {});
    const Teuchos::RCP<const feti::DualOperator> f = feti.dualOperator(); // a Tpetra::Operator
    MultiVector x(f->getDomainMap(), 1), y(f->getRangeMap(), 1);
    {
      const auto view = x.getLocalViewHost(Tpetra::Access::OverwriteAll);
      for (std::size_t k = 0; k < view.extent(0); ++k)
        view(k, 0) = 1.0 + static_cast<double>(f->getDomainMap()->getGlobalElement(static_cast<int>(k)) % 3);
    }
    double eigenvalue = 0.0;
    std::vector<double> norm(1);
    for (int k = 0; k < 200; ++k) { // power method
      x.norm2(Teuchos::arrayViewFromVector(norm));
      x.scale(1.0 / norm[0]);
      f->apply(x, y);
      std::vector<double> product(1);
      x.dot(y, Teuchos::arrayViewFromVector(product));
      eigenvalue = product[0];
      Tpetra::deep_copy(x, y);
    }

    // A spring chain of a rank's own, condensed to its ends: S = k/5 (1 −1; −1 1).
    const auto self = Teuchos::rcp(new Teuchos::MpiComm<int>(MPI_COMM_SELF));
    const auto map = Teuchos::rcp(new Map(6, 0, self));
    const auto chain = Teuchos::rcp(new feti::CrsMatrix(map, 3));
    for (GlobalOrdinal i = 0; i < 5; ++i)
      for (GlobalOrdinal row : {i, i + 1})
        for (GlobalOrdinal column : {i, i + 1}) {
          const double value = row == column ? 1.0 : -1.0;
          chain->insertGlobalValues(row, 1, &value, &column);
        }
    chain->fillComplete();
    const auto b = Teuchos::rcp(new MultiVector(map, 1)), u = Teuchos::rcp(new MultiVector(map, 1));
    const auto mumps = feti::makeMumpsSolver(chain, u, b); // Teuchos::RCP<Amesos2::Solver<…>>
    const auto extras = Teuchos::rcp_dynamic_cast<feti::MumpsExtras>(mumps);
    extras->setSchurRows({0, 5});
    mumps->symbolicFactorization().numericFactorization();

    std::ostringstream text;
    text << "half " << half << ": largest eigenvalue of F " << std::round(1e3 * eigenvalue) / 1e3
         << ", stiffness of the chain " << std::round(1e6 * extras->schurComplement()[0]) / 1e6;
    return text.str();
  });
}
