// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Recovery.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_RowErrors.hpp"

#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Operator.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace Harmos::feti {
namespace {

// u ← u + Rα.
void addRigidMotion(const RigidMotions& motions, const std::vector<double>& alpha, TornVector& u) {
  const std::vector<double> amplitudes = motions.amplitudes(alpha);
  std::size_t place = 0;
  for (int i = 0; i < motions.system().size(); ++i)
    for (int k = 0; k < motions.kernel(i).columns; ++k, ++place) {
      const double factor = amplitudes[place];
      const double* column = motions.kernel(i).column(k);
      std::vector<double>& values = u[static_cast<std::size_t>(i)];
      for (std::size_t j = 0; j < values.size(); ++j)
        values[j] += factor * column[j];
    }
}

// f − Bᵀλ.
TornVector loadsLeft(const SubdomainSystem& system, const Constraints& constraints,
                     const MultiVector& lambda) {
  const std::vector<double> overlap = constraints.toOverlap(lambda);
  TornVector loads(static_cast<std::size_t>(system.size()));
  for (int i = 0; i < system.size(); ++i) {
    std::vector<double>& load = loads[static_cast<std::size_t>(i)];
    load.assign(system.rhs(i).size(), 0.0);
    constraints.addBt(i, overlap.data(), load.data());
    for (std::size_t j = 0; j < load.size(); ++j)
      load[j] = system.rhs(i)[j] - load[j];
  }
  return loads;
}

// x ← K⁺x of each subdomain, in parts of a class: many right-hand sides at once.
void solveLocally(const LocalInverses& inverses, TornVector& x) {
  constexpr std::size_t mostAtOnce = 32;
  std::vector<double> part;
  for (std::size_t c = 0; c < inverses.classes().size(); ++c) {
    const std::vector<int>& members = inverses.classes()[c].members;
    for (std::size_t begin = 0; begin < members.size(); begin += mostAtOnce) {
      const std::size_t count = std::min(mostAtOnce, members.size() - begin);
      const std::size_t n = x[static_cast<std::size_t>(members[begin])].size();
      part.clear();
      for (std::size_t m = 0; m < count; ++m) {
        const std::vector<double>& load = x[static_cast<std::size_t>(members[begin + m])];
        part.insert(part.end(), load.begin(), load.end());
      }
      inverses.inverse(c).apply(part.data(), static_cast<int>(count));
      for (std::size_t m = 0; m < count; ++m)
        std::copy(part.begin() + static_cast<std::ptrdiff_t>(m * n),
                  part.begin() + static_cast<std::ptrdiff_t>((m + 1) * n),
                  x[static_cast<std::size_t>(members[begin + m])].begin());
    }
  }
}

// v ← (I − RRᵀ)v for the R of the coarse problem.
void removeMotions(const RigidMotions& motions, TornVector& v) {
  std::vector<double> amplitudes;
  for (int i = 0; i < motions.system().size(); ++i)
    for (int k = 0; k < motions.kernel(i).columns; ++k) {
      const double* column = motions.kernel(i).column(k);
      const std::vector<double>& values = v[static_cast<std::size_t>(i)];
      amplitudes.push_back(std::inner_product(values.begin(), values.end(), column, 0.0));
    }
  std::vector<double> alpha = motions.motions(amplitudes);
  for (double& value : alpha)
    value = -value;
  addRigidMotion(motions, alpha, v);
}

// What of the answer joins subdomains to clusters. @param loads of all subdomains in balance, afterwards.
ClusterInverse::Amounts joiningAnswer(const ClusterInverse& joined, const LocalInverses& inverses,
                                      TornVector& loads) {
  removeMotions(joined.clusters().motions(), loads);
  TornVector u = loads;
  solveLocally(inverses, u);
  ClusterInverse::Amounts amounts = joined.none();
  for (std::size_t i = 0; i < loads.size(); ++i)
    joined.measure(static_cast<int>(i), u[i].data(), loads[i].data(), amounts);
  ClusterInverse::Amounts answer = joined.answer(amounts);
  for (std::size_t i = 0; i < loads.size(); ++i)
    joined.subtractForces(static_cast<int>(i), answer, loads[i].data());
  return answer;
}

// α of u = u₀ + Rα. @param solution λ and u₀.
std::vector<double> rigidMotion(const Constraints& constraints, const CoarseSpace& coarse,
                                const DualProblem& dual, const TornSolution& solution,
                                const std::vector<double>& mu) {
  // With the shifted λ, (F + C)λ − d = c + Cλ − Bu₀: no further product with F is needed.
  MultiVector residual(constraints.rowMap(), 1);
  constraints.residual(solution.displacement, *solution.multiplier, residual);
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
    const std::vector<char> isEquation = holdAsEquations(constraints, *solution.multiplier);
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
  return alpha;
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

  // u₀ = K⁺(f − Bᵀλ).
  const ClusterInverse* joined = inverses.joined();
  ClusterInverse::Amounts answer;
  solution.displacement = loadsLeft(system, constraints, *total);
  agree(comm, [&] {
    TornVector& u = solution.displacement;
    if (joined != nullptr)
      answer = joiningAnswer(*joined, inverses, u);
    // Gλ vanishes to the tolerance only, so that the loads are not quite in balance. K⁺ would answer the rest
    // by point forces where it holds the kernel, and u depend on the choice: R_iᵀ of the loads is taken out.
    for (int i = 0; i < system.size(); ++i)
      removeKernel(system.kernel(i), u[static_cast<std::size_t>(i)]);
    solveLocally(inverses, u);
    for (int i = 0; joined != nullptr && i < system.size(); ++i)
      joined->addMotion(i, answer, u[static_cast<std::size_t>(i)].data());
  });
  // The forces of averages are such of gluing rows.
  if (joined != nullptr)
    joined->clusters().addJoined(answer.averages, *total);
  if (coarse.kernelDimension() == 0)
    return solution;
  solution.rigidMotion = rigidMotion(constraints, coarse, dual, solution, mu);
  addRigidMotion(coarse.motions(), solution.rigidMotion, solution.displacement);
  return solution;
}

} // namespace Harmos::feti
