// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualProblem.hpp"

#include "Harmos_DualOperator.hpp"

#include "Harmos_ProjectedOperator.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace Harmos::feti {
namespace {

struct KernelLoad {
  std::vector<double> e;        ///< Rᵀf, a vector of motions
  std::vector<double> rounding; ///< its rounding errors, at most
};

// ẽ = Rᵀf. Loads that balance themselves, such as those of a warm body, leave rounding
// errors, for which there need be no forces that hold them: those are taken for zero.
KernelLoad kernelLoad(const SubdomainSystem& system, const RigidMotions& motions) {
  // Of sums of n terms, those of the load vector too: ε√n, and n is some thousands.
  constexpr double unit = 1e2 * std::numeric_limits<double>::epsilon();
  // R itself is known to so much: KR = 0 was verified to that, and loads of warm bodies are K times
  // something.
  constexpr double kernelRounding = 1e-12;
  // Entries of R that are zero are so to rounding errors of a column's largest: what holds some components of
  // a body leaves motions that are made by orthogonalisation.
  constexpr double entryRounding = 10.0 * std::numeric_limits<double>::epsilon();
  std::vector<double> sums, bounds, rounding; // of amplitudes
  for (int i = 0; i < system.size(); ++i) {
    const Kernel& kernel = motions.kernel(i);
    for (int k = 0; k < kernel.columns; ++k) {
      double sum = 0.0, sizes = 0.0, largest = 0.0, forces = 0.0;
      for (std::size_t j = 0; j < system.rhs(i).size(); ++j) {
        const double motion = kernel.column(k)[j], force = system.rhs(i)[j];
        sum += motion * force;
        sizes += std::abs(motion * force);
        largest = std::max(largest, std::abs(motion));
        forces += std::abs(force);
      }
      const double ofEntries = entryRounding * largest * forces;
      sums.push_back(sum);
      bounds.push_back(unit * sizes + ofEntries);
      rounding.push_back(kernelRounding * sizes + ofEntries);
    }
  }
  KernelLoad load = {motions.motions(sums), motions.motions(rounding, true)};
  bounds = motions.motions(bounds, true);
  for (std::size_t k = 0; k < load.e.size(); ++k)
    if (!(std::abs(load.e[k]) > bounds[k]))
      load.e[k] = 0.0;
  return load;
}

double lengthOf(const MultiVector& x) {
  std::vector<double> result(1);
  x.norm2(Teuchos::arrayViewFromVector(result));
  return result[0];
}

bool isZero(const std::vector<double>& v) {
  return std::all_of(v.begin(), v.end(), [](double entry) { return entry == 0.0; });
}

// BK⁺f of clusters, where that of their subdomains is known.
void addCorrection(const SubdomainSystem& system, const Constraints& constraints,
                   const ClusterInverse& joined, const ClusterInverse::Amounts& answer,
                   std::vector<double>& overlap) {
  for (int i = 0; i < system.size(); ++i) {
    std::vector<double> u(system.rhs(i).size(), 0.0);
    joined.addCorrection(i, answer, u.data());
    constraints.addB(i, u.data(), overlap.data());
  }
}

// d̃ = BK⁺f − c. Each distinct load of a class is solved for once, loads of zero not at all.
void applyInverseToLoads(const SubdomainSystem& system, const Constraints& constraints,
                         const LocalInverses& inverses, MultiVector& d) {
  std::vector<double> overlap(localSize(*constraints.overlapMap()), 0.0);
  const ClusterInverse* joined = inverses.joined();
  agree(*system.comm(), [&] {
    ClusterInverse::Amounts amounts = joined ? joined->none() : ClusterInverse::Amounts();
    for (std::size_t c = 0; c < inverses.classes().size(); ++c) {
      // In the order of the subdomains, not of addresses: sums are to be the same in every run.
      std::map<const std::vector<double>*, std::size_t> places;
      std::vector<std::pair<const std::vector<double>*, std::vector<int>>> byLoad;
      for (int i : inverses.classes()[c].members) {
        const auto [place, isNew] = places.emplace(&system.rhs(i), byLoad.size());
        if (isNew)
          byLoad.push_back({&system.rhs(i), {}});
        byLoad[place->second].second.push_back(i);
      }
      for (const auto& [load, members] : byLoad) {
        if (isZero(*load))
          continue;
        std::vector<double> x = *load;
        inverses.inverse(c).apply(x.data(), 1);
        for (int i : members) {
          constraints.addB(i, x.data(), overlap.data());
          if (joined != nullptr)
            joined->measure(i, x.data(), load->data(), amounts);
        }
      }
    }
    if (joined != nullptr)
      addCorrection(system, constraints, *joined, joined->answer(amounts), overlap);
  });
  constraints.fromOverlap(overlap, d);
  const auto view = d.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) -= constraints.bound(static_cast<int>(r));
}

// A dependent column of R is a rigid motion that the kept ones and the constraints leave free: its load must
// be balanced by λ̃ all the same.
struct Unbalanced {
  long long subdomain; ///< the first one of those that move
  double residual;
};
std::optional<Unbalanced> unbalanced(const SubdomainSystem& system, const CoarseSpace& coarse,
                                     const MultiVector& shift, const KernelLoad& load) {
  const Teuchos::Comm<int>& comm = *system.comm();
  std::vector<double> residual = coarse.multiply(shift);
  const double tolerance = 1e-10 * coarse.norm(load.e) + coarse.norm(load.rounding);
  const std::vector<char> isDependent = coarse.dependentMotions();
  double largest = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k) {
    residual[k] = isDependent[k] ? load.e[k] - residual[k] : 0.0;
    if (!(std::abs(residual[k]) <= tolerance))
      largest = std::isfinite(residual[k]) ? std::max(largest, std::abs(residual[k]))
                                           : std::numeric_limits<double>::infinity();
  }
  largest = globalMax(comm, largest);
  if (largest == 0.0)
    return std::nullopt;
  // Which columns are dependent is a matter of chance, the motion r − A⁻Ar is not: it is that of whole
  // bodies.
  MultiVector forces(shift.getMap(), 1);
  coarse.addTransposed(1.0, residual, forces);
  const std::vector<double> others = coarse.solve(coarse.multiply(forces));
  // What hardly anything holds is left out, too: forces that hold the others act on it by as little, and that
  // is none of its own load.
  const double own2 = std::pow(coarse.norm(residual), 2);
  coarse.addTransposed(-1.0, others, forces);
  if (own2 <= 2.0 * lengthOf(forces) * lengthOf(shift))
    return std::nullopt;
  constexpr double moved = 1e-6; // of the largest
  double most = 0.0;
  for (std::size_t k = 0; k < residual.size(); ++k)
    most = std::max(most, std::abs(residual[k] - others[k]));
  most = globalMax(comm, most);
  for (std::size_t k = 0; k < residual.size(); ++k)
    residual[k] -= others[k];
  const std::vector<double> amplitudes = coarse.motions().amplitudes(residual);
  long long first = system.globalSubdomains() - 1;
  const std::vector<std::size_t>& places = coarse.motions().amplitudePlaces();
  for (int i = 0; i < system.size(); ++i)
    for (std::size_t place = places[static_cast<std::size_t>(i)];
         place < places[static_cast<std::size_t>(i) + 1]; ++place)
      if (std::abs(amplitudes[place]) > moved * most)
        first = std::min(first, system.subdomain(i).number);
  return Unbalanced{globalMin(comm, first), largest};
}

void requireBalance(const SubdomainSystem& system, const CoarseSpace& coarse, const MultiVector& shift,
                    const KernelLoad& load) {
  const std::optional<Unbalanced> found = unbalanced(system, coarse, shift, load);
  if (!found)
    return;
  const std::string owner = std::to_string(found->subdomain);
  throw NumericalError("unbalanced load on subdomain " + owner +
                           ": a rigid-body mode without any constraint carries a load of " +
                           scientific(found->residual) +
                           "; prescribe displacements on its body or balance the load",
                       {{"subdomain", owner}, {"residual", scientific(found->residual)}});
}

// λ̃ and A⁻ẽ once more for what is left of ẽ: where weights differ by orders of magnitude G̃G̃ᵀ is badly
// conditioned; so it is where bodies are thin and touch at few places.
void refine(const CoarseSpace& coarse, const std::vector<double>& e, std::vector<double>& s,
            MultiVector& shift) {
  std::vector<double> left = coarse.multiply(shift);
  for (std::size_t k = 0; k < left.size(); ++k)
    left[k] = e[k] - left[k];
  const std::vector<double> correction = coarse.solve(left);
  coarse.addTransposed(1.0, correction, shift);
  for (std::size_t k = 0; k < s.size(); ++k)
    s[k] += correction[k];
}

} // namespace

DualProblem::DualProblem(const SubdomainSystem& system, const Constraints& constraints,
                         const LocalInverses& inverses, const DualOperator& dualOperator,
                         const CoarseSpace& coarse) {
  const Teuchos::RCP<const Map>& map = constraints.rowMap();
  d_ = Teuchos::rcp(new MultiVector(map, 1));
  applyInverseToLoads(system, constraints, inverses, *d_);
  setupApplications_ = 1;

  shift_ = Teuchos::rcp(new MultiVector(map, 1));
  projectedD_ = Teuchos::rcp(new MultiVector(map, 1));
  const KernelLoad load = kernelLoad(system, coarse.motions());
  if (coarse.dimension() > 0) {
    std::vector<double> s = coarse.solve(load.e);
    coarse.addTransposed(1.0, s, *shift_);
    if (constraints.hasWeights() || unbalanced(system, coarse, *shift_, load))
      refine(coarse, load.e, s, *shift_);
    requireBalance(system, coarse, *shift_, load);
    scaledLoadNorm_ = coarse.norm(s);
    MultiVector image(map, 1);
    dualOperator.apply(*shift_, image);
    dualOperator.rethrowFailure();
    d_->update(-1.0, image, 1.0);
    ++setupApplications_;
    hessian_ = Teuchos::rcp(new ProjectedOperator(dualOperator, coarse));
    hessianOnKernel_ = Teuchos::rcp(new ProjectedOperator(dualOperator, coarse, true));
    unprojectedHessian_ = Teuchos::rcpFromRef(static_cast<const Operator&>(dualOperator));
    equalityRows_ = coarse.equalityRows();
  } else {
    requireBalance(system, coarse, *shift_, load);
    hessian_ = Teuchos::rcpFromRef(static_cast<const Operator&>(dualOperator));
  }
  if (inverses.joined() != nullptr) {
    inverses.joined()->clusters().removeJoined(*d_);
    clusters_ = inverses.joined()->clusters().fingerprint();
  }
  projectedD_->update(1.0, *d_, 0.0);
  coarse.project(*projectedD_);

  makeBounds(constraints);
}

Teuchos::RCP<MultiVector> DualProblem::total(const MultiVector& lambda) const {
  const auto result = Teuchos::rcp(new MultiVector(lambda, Teuchos::Copy));
  result->update(1.0, *shift_, 1.0);
  return result;
}

void DualProblem::makeBounds(const Constraints& constraints) {
  constexpr double none = std::numeric_limits<double>::infinity();
  const auto makeBound = [&](auto&& boundOf) {
    const auto bound = Teuchos::rcp(new MultiVector(constraints.rowMap(), 1));
    const auto shift = shift_->getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto view = bound->getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) = boundOf(static_cast<int>(r), shift(r, 0));
    return bound;
  };
  std::vector<double> limits = constraints.limits(*shift_);
  for (const Constraints::Follower& follower : constraints.followers())
    limits[static_cast<std::size_t>(follower.row)] = none;
  const auto limitOf = [&](int row) { return limits[static_cast<std::size_t>(row)]; };
  if (constraints.inequalities() > 0 || constraints.hasIntervals())
    lowerBound_ = makeBound([&](int row, double shift) {
      return constraints.isSoft(row)                           ? -none
             : constraints.rowType(row) == RowType::Inequality ? -shift
             : constraints.isInterval(row)                     ? -shift - limitOf(row)
                                                               : -none;
    });
  if (constraints.hasIntervals())
    upperBound_ = makeBound(
        [&](int row, double shift) { return constraints.isInterval(row) ? -shift + limitOf(row) : none; });
  const auto shift = shift_->getLocalViewHost(Tpetra::Access::ReadOnly);
  if (constraints.hasSoft()) {
    std::vector<qp::SoftBound> soft;
    for (std::size_t r = 0; r < shift.extent(0); ++r)
      if (const int row = static_cast<int>(r); constraints.isSoft(row))
        soft.push_back({row, -shift(r, 0),
                        constraints.rowType(row) == RowType::Inequality ? none : -shift(r, 0),
                        constraints.softness(row)});
    soft_ = std::make_shared<const qp::LocalSoftBounds>(std::move(soft), shift.extent(0));
  }
  if (constraints.hasFollowers()) {
    qp::FollowingLimits following;
    for (const Constraints::Follower& follower : constraints.followers())
      following.push_back({follower.disc >= 0 ? follower.disc : follower.row, follower.disc >= 0,
                           follower.normal, follower.factor,
                           -shift(static_cast<std::size_t>(follower.row), 0)});
    following_ = std::make_shared<const qp::FollowingLimits>(std::move(following));
  }
  if (!constraints.hasDiscs())
    return;
  constexpr double open = 1e100;
  std::vector<qp::Disc> discs;
  for (const auto& [first, second] : constraints.discs()) {
    const double centre[] = {-shift(static_cast<std::size_t>(first), 0),
                             -shift(static_cast<std::size_t>(second), 0)};
    const double limit = limitOf(first);
    discs.push_back({first, second, {centre[0], centre[1]}, std::isinf(limit) ? open : limit});
  }
  discs_ = std::make_shared<const qp::LocalDiscs>(std::move(discs), shift.extent(0));
}

} // namespace Harmos::feti
