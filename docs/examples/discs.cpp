// SPDX-License-Identifier: BSD-3-Clause
/// A table with eight feet is pushed aside: which of them slip? See docs/qp.md.
#include <BelosTpetraAdapter.hpp>
#include <Harmos_Qp.hpp>
#include <Tpetra_Core.hpp>
#include <Tpetra_CrsMatrix.hpp>

#include <cmath>
#include <iostream>
#include <vector>

using namespace Harmos;

// Feet on the unit circle, the weight on some of them.
struct Foot {
  double x, y, bound;
};
std::vector<Foot> feet() {
  std::vector<Foot> result;
  for (int k = 0; k < 8; ++k) {
    const double angle = 0.25 * std::acos(-1.0) * k;
    result.push_back({std::cos(angle), std::sin(angle), k < 4 ? 1.0 : 0.4});
  }
  return result;
}

int main(int argc, char** argv) {
  Tpetra::ScopeGuard scope(&argc, &argv);
  const auto comm = Tpetra::getDefaultComm();
  const std::vector<Foot> all = feet();

  // Two forces a foot, both on one rank.
  const int ranks = comm->getSize(), rank = comm->getRank(), n = static_cast<int>(all.size());
  const int first = n * rank / ranks, mine = n * (rank + 1) / ranks - first;
  const auto map = Teuchos::rcp(
      new Map(static_cast<Tpetra::global_size_t>(2 * n), static_cast<std::size_t>(2 * mine), 0, comm));

  // min ½ Σ |λ_k|²: feet give way by one unit of length for one of force. They balance the push (3, 0) at (0,
  // 0.4).
  const auto compliance = Teuchos::rcp(new Tpetra::CrsMatrix<>(map, 1));
  const auto motions = Teuchos::rcp(new Map(3, 0, comm, Tpetra::LocallyReplicated));
  const auto balance =
      Teuchos::rcp(new MultiVector(map, 3)); // columns: what a motion of the table does at the feet
  std::vector<qp::Disc> discs;
  for (int k = 0; k < mine; ++k) {
    const Foot& foot = all[static_cast<std::size_t>(first + k)];
    const auto row = static_cast<std::size_t>(2 * k);
    const double columns[3][2] = {{1.0, 0.0}, {0.0, 1.0}, {-foot.y, foot.x}};
    for (std::size_t motion = 0; motion < 3; ++motion)
      for (std::size_t entry = 0; entry < 2; ++entry)
        balance->replaceLocalValue(static_cast<LocalOrdinal>(row + entry), motion, columns[motion][entry]);
    for (std::size_t entry = 0; entry < 2; ++entry) {
      const GlobalOrdinal column = map->getGlobalElement(static_cast<LocalOrdinal>(row + entry));
      const double one = 1.0;
      compliance->insertGlobalValues(column, 1, &one, &column);
    }
    // |λ_k| ≤ bound.
    discs.push_back({2 * k, 2 * k + 1, {0.0, 0.0}, foot.bound});
  }
  compliance->fillComplete();

  // Its transpose, applied to forces.
  class Balance : public Operator {
   public:
    Balance(Teuchos::RCP<const MultiVector> columns, Teuchos::RCP<const Map> range)
        : columns_(columns), range_(range) {}
    Teuchos::RCP<const Map> getDomainMap() const override { return columns_->getMap(); }
    Teuchos::RCP<const Map> getRangeMap() const override { return range_; }
    bool hasTransposeApply() const override { return true; }
    void apply(const MultiVector& x, MultiVector& y, Teuchos::ETransp mode, Scalar alpha,
               Scalar beta) const override {
      const bool isForward = mode == Teuchos::NO_TRANS;
      y.multiply(isForward ? Teuchos::TRANS : Teuchos::NO_TRANS, Teuchos::NO_TRANS, alpha, *columns_, x,
                 beta);
    }

   private:
    Teuchos::RCP<const MultiVector> columns_;
    Teuchos::RCP<const Map> range_;
  };
  const auto push = Teuchos::rcp(new MultiVector(motions, 1)),
             motion = Teuchos::rcp(new MultiVector(motions, 1));
  const double load[] = {4.5, 0.0, -0.4 * 4.5};
  for (std::size_t k = 0; k < 3; ++k)
    push->replaceLocalValue(static_cast<LocalOrdinal>(k), 0, load[k]);

  const auto force = Teuchos::rcp(new MultiVector(map, 1)), none = Teuchos::rcp(new MultiVector(map, 1));
  const auto problem = Teuchos::rcp(new qp::TpetraProblem(compliance, force, none));
  problem->setDiscs(std::make_shared<qp::LocalDiscs>(discs, force->getLocalLength()));
  problem->setEquality(Teuchos::rcp(new Balance(balance, motions)), push, motion);
  if (!problem->setProblem()) {
    std::cerr << problem->whyNotSet() << "\n";
    return 1;
  }
  const auto solver = qp::TpetraSolverFactory().create("Auto", Teuchos::parameterList());
  solver->setProblem(problem);
  const qp::Result result = solver->solve();
  const auto moved = motion->getLocalViewHost(Tpetra::Access::ReadOnly);
  if (comm->getRank() == 0)
    std::cout << result.method << ": " << qp::toString(result.reason) << "\n"
              << "slipping: " << result.history.back().active / 2 << " of " << n << " feet\n"
              << "the table turns by " << std::round(-1e4 * moved(2, 0)) / 1e4 << " and moves by ("
              << std::round(-1e4 * moved(0, 0)) / 1e4 << ", " << std::round(-1e4 * moved(1, 0)) / 1e4
              << ")\n";
  return result.converged() ? 0 : 1;
}
