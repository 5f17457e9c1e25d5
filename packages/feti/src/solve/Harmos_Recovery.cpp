// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Recovery.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_RowErrors.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::feti {
namespace {

void addRigidMotion(const SubdomainSystem& system, const std::vector<double>& alpha, TornVector& u) {
  std::size_t place = 0;
  for (int i = 0; i < system.size(); ++i)
    for (int k = 0; k < system.kernel(i).columns; ++k, ++place) {
      const double factor = alpha[place];
      const double* column = system.kernel(i).column(k);
      std::vector<double>& values = u[static_cast<std::size_t>(i)];
      for (std::size_t j = 0; j < values.size(); ++j)
        values[j] += factor * column[j];
    }
}

} // namespace

TornSolution recover(const SubdomainSystem& system, const Constraints& constraints,
                     const LocalInverses& inverses, const CoarseSpace& coarse, const DualProblem& dual,
                     const MultiVector& lambda, const std::vector<double>& mu) {
  const Teuchos::Comm<int>& comm = *system.comm();
  TornSolution solution;
  const Teuchos::RCP<MultiVector> total = Teuchos::rcp(new MultiVector(lambda, Teuchos::Copy));
  total->update(1.0, *dual.shift(), 1.0);
  solution.multiplier = total;

  // u₀ = K⁺(f − Bᵀλ), in parts of a class: many right-hand sides at once.
  const std::vector<double> overlap = constraints.toOverlap(*total);
  solution.displacement.resize(static_cast<std::size_t>(system.size()));
  agree(comm, [&] {
    constexpr std::size_t mostAtOnce = 32;
    std::vector<double> x;
    for (std::size_t c = 0; c < inverses.classes().size(); ++c) {
      const std::vector<int>& members = inverses.classes()[c].members;
      for (std::size_t begin = 0; begin < members.size(); begin += mostAtOnce) {
        const std::size_t count = std::min(mostAtOnce, members.size() - begin);
        const auto n = static_cast<std::size_t>(system.matrix(members[begin]).rows());
        x.resize(n * count);
        std::vector<double> load;
        for (std::size_t m = 0; m < count; ++m) {
          const int i = members[begin + m];
          load.assign(n, 0.0);
          constraints.addBt(i, overlap.data(), load.data());
          for (std::size_t j = 0; j < n; ++j)
            load[j] = system.rhs(i)[j] - load[j];
          // Gλ vanishes to the tolerance only, so that the loads are not quite in balance. K⁺ would answer
          // the rest by point forces where it holds the kernel, and u depend on the choice: R_iᵀ of the loads
          // is taken out.
          removeKernel(system.kernel(i), load);
          std::copy(load.begin(), load.end(), x.begin() + static_cast<std::ptrdiff_t>(m * n));
        }
        inverses.inverse(c).apply(x.data(), static_cast<int>(count));
        for (std::size_t m = 0; m < count; ++m)
          solution.displacement[static_cast<std::size_t>(members[begin + m])].assign(
              x.begin() + static_cast<std::ptrdiff_t>(m * n),
              x.begin() + static_cast<std::ptrdiff_t>((m + 1) * n));
      }
    }
  });
  if (coarse.kernelDimension() == 0)
    return solution;

  // With the shifted λ, (F + C)λ − d = c + Cλ − Bu₀: no further product with F is needed.
  MultiVector residual(constraints.rowMap(), 1);
  constraints.residual(solution.displacement, *total, residual);
  residual.scale(-1.0);
  MultiVector left(residual, Teuchos::Copy);
  if (!dual.equalityRows().is_null()) {
    MultiVector multiplier(dual.equalityRows()->getRangeMap(), 1);
    HARMOS_REQUIRE(mu.size() == multiplier.getLocalLength(), "mu has this rank's entries");
    std::copy(mu.begin(), mu.end(), multiplier.getLocalViewHost(Tpetra::Access::OverwriteAll).data());
    MultiVector image(left.getMap(), 1);
    dual.equalityRows()->apply(multiplier, image, Teuchos::TRANS);
    left.update(-1.0, image, 1.0);
  }
  std::vector<double> alpha = coarse.solve(coarse.multiply(left));

  // δ: least squares for G̃ᵀδ = c − B(u₀ + Rα) on the rows that hold as equations.
  MultiVector holds(constraints.rowMap(), 1);
  coarse.addTransposed(-1.0, alpha, residual);
  {
    const auto gap = residual.getLocalViewHost(Tpetra::Access::ReadWrite);
    const std::vector<char> isEquation = holdAsEquations(constraints, *total);
    const auto mask = holds.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t r = 0; r < gap.extent(0); ++r) {
      mask(r, 0) = isEquation[r];
      if (mask(r, 0) == 0.0)
        gap(r, 0) = 0.0;
    }
  }
  const std::vector<double> delta = coarse.minimumNormSolution(holds, coarse.multiply(residual));
  for (std::size_t k = 0; k < delta.size(); ++k)
    alpha[k] += delta[k];
  addRigidMotion(system, alpha, solution.displacement);
  solution.rigidMotion = alpha;
  return solution;
}

} // namespace Harmos::feti
