// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ClusterInverse.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_LAPACK.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

namespace Harmos::feti {
namespace {

std::vector<double> part(const std::vector<double>& v, std::size_t begin, std::size_t end) {
  return {v.begin() + static_cast<std::ptrdiff_t>(begin), v.begin() + static_cast<std::ptrdiff_t>(end)};
}

// Sides of congruent subdomains are equal up to rounding errors of the averages, and a sign.
double signOf(const std::vector<double>& a, const std::vector<double>& b) {
  constexpr double equal = 1e-9;
  double largest = 0.0, difference = 0.0, sum = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    largest = std::max(largest, std::abs(a[k]));
    difference = std::max(difference, std::abs(a[k] - b[k]));
    sum = std::max(sum, std::abs(a[k] + b[k]));
  }
  return difference <= equal * largest ? 1.0 : sum <= equal * largest ? -1.0 : 0.0;
}

std::size_t placeOf(const std::vector<int>& boundary, int dof) {
  return static_cast<std::size_t>(std::lower_bound(boundary.begin(), boundary.end(), dof) - boundary.begin());
}

// (S + ρTTᵀ)⁻¹, whole. @param t the kernel of S, columns with `rows` entries after each other.
std::vector<double> invertedOnComplement(std::vector<double> s, int n, const std::vector<double>& t,
                                         const std::string& name) {
  const auto rows = static_cast<std::size_t>(n);
  double mean = 0.0, norm = 0.0;
  for (std::size_t k = 0; k < rows; ++k)
    mean += s[k * rows + k] / n;
  for (std::size_t c = 0; c < t.size(); c += rows)
    for (std::size_t j = 0; j < rows; ++j)
      for (std::size_t i = 0; i < rows; ++i)
        s[j * rows + i] += mean * t[c + i] * t[c + j];
  for (std::size_t j = 0; j < rows; ++j) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rows; ++i)
      sum += std::abs(s[j * rows + i]);
    norm = std::max(norm, sum);
  }
  Teuchos::LAPACK<int, double> lapack;
  int info = 0;
  double reciprocal = 0.0;
  std::vector<double> work(3 * rows);
  std::vector<int> integers(rows);
  lapack.POTRF('L', n, s.data(), n, &info);
  if (info == 0)
    lapack.POCON('L', n, s.data(), n, norm, &reciprocal, work.data(), integers.data(), &info);
  // A long chain of m subdomains has m⁻⁴.
  constexpr double singular = 1e-14;
  if (!(reciprocal > singular))
    throw NumericalError(name + " has a zero-energy mode outside its averages and its kernel of dimension " +
                         std::to_string(t.size() / std::max<std::size_t>(rows, 1)) +
                         ": the reciprocal condition number of S₀ is " + scientific(reciprocal) +
                         "; use smaller clusters (\"Decomposition/Clusters\")");
  lapack.POTRI('L', n, s.data(), n, &info);
  HARMOS_REQUIRE(info == 0, "dpotri failed");
  for (std::size_t j = 0; j < rows; ++j)
    for (std::size_t i = j + 1; i < rows; ++i)
      s[i * rows + j] = s[j * rows + i];
  return s;
}

} // namespace

ClusterInverse::ClusterInverse(std::shared_ptr<const Clusters> clusters, const std::vector<Group>& groups,
                               Role role)
    : clusters_(std::move(clusters)), role_(role) {
  const std::vector<std::vector<KnownSide>> sides = findMembers(groups);
  for (std::size_t g = 0; g < groups.size(); ++g)
    shared_.push_back(sharedOf(groups[g], sides[g]));
  std::map<std::vector<int>, std::size_t> known;
  for (std::size_t c = 0; c < clusters_->all().size(); ++c) {
    const auto [place, isNew] = known.emplace(signature(c), factors_.size());
    if (isNew)
      factors_.push_back(factorOf(c));
    factorOf_.push_back(place->second);
  }
}

ClusterInverse::Use ClusterInverse::useOf(const Clusters::Columns& join, const Clusters::Side& side,
                                          std::vector<KnownSide>& known) const {
  for (const KnownSide& other : known)
    if (other.dofs == side.dofs && other.columns == join.count)
      if (const double sign = signOf(other.values, side.values); sign != 0.0)
        return {other.first, join.first, join.count, sign, &side};
  const int first = known.empty() ? 0 : known.back().first + known.back().columns;
  known.push_back({side.dofs, side.values, first, join.count});
  return {first, join.first, join.count, 1.0, &side};
}

// What part each subdomain has in its cluster. @return the distinct sides of each group.
std::vector<std::vector<ClusterInverse::KnownSide>>
ClusterInverse::findMembers(const std::vector<Group>& groups) {
  const RigidMotions& motions = clusters_->motions();
  members_.resize(static_cast<std::size_t>(motions.system().size()));
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t m = 0; m < groups[g].members.size(); ++m) {
      Member& member = members_[static_cast<std::size_t>(groups[g].members[m])];
      member.group = g;
      member.place = m;
    }
  std::vector<std::vector<KnownSide>> known(groups.size());
  for (std::size_t c = 0; c < clusters_->all().size(); ++c) {
    const Clusters::Cluster& cluster = clusters_->all()[c];
    std::size_t amplitude = 0;
    for (int i : cluster.members) {
      members_[static_cast<std::size_t>(i)].cluster = c;
      members_[static_cast<std::size_t>(i)].amplitude = amplitude;
      if (role_ == Role::Inverse)
        amplitude += static_cast<std::size_t>(motions.kernel(i).columns);
    }
    const auto addUses = [&](const Clusters::Columns& columns) {
      for (const Clusters::Side& side : columns.sides) {
        Member& member = members_[static_cast<std::size_t>(side.subdomain)];
        member.uses.push_back(useOf(columns, side, known[member.group]));
      }
    };
    if (role_ == Role::Inverse)
      std::for_each(cluster.joins.begin(), cluster.joins.end(), addUses);
    else
      std::for_each(cluster.moves.begin(), cluster.moves.end(), addUses);
  }
  return known;
}

ClusterInverse::Shared ClusterInverse::sharedOf(const Group& group,
                                                const std::vector<KnownSide>& known) const {
  Shared shared;
  shared.boundary = group.boundary;
  shared.members = group.members;
  const std::size_t b = group.boundary.size();
  for (const KnownSide& side : known)
    shared.joined += side.columns;
  const Kernel& kernel = clusters_->motions().kernel(group.members.front());
  shared.motions = role_ == Role::Inverse ? kernel.columns : 0;
  shared.width = shared.joined + shared.motions;
  const auto joined = static_cast<std::size_t>(shared.joined);
  std::vector<double> sides(b * joined, 0.0);
  for (const KnownSide& side : known)
    for (std::size_t q = 0; q < static_cast<std::size_t>(side.columns); ++q)
      for (std::size_t k = 0; k < side.dofs.size(); ++k)
        sides[(static_cast<std::size_t>(side.first) + q) * b + placeOf(group.boundary, side.dofs[k])] =
            side.values[q * side.dofs.size() + k];
  shared.w.resize(b * joined);
  group.op->apply(sides.data(), shared.w.data(), shared.joined);
  for (int k = 0; k < shared.motions; ++k)
    for (int dof : group.boundary)
      shared.w.push_back(kernel.column(k)[dof]);
  const int n = static_cast<int>(b);
  Teuchos::BLAS<int, double> blas;
  shared.f.assign(joined * joined, 0.0);
  shared.g.assign(static_cast<std::size_t>(shared.motions) * joined, 0.0);
  if (joined > 0)
    blas.GEMM(Teuchos::TRANS, Teuchos::NO_TRANS, shared.joined, shared.joined, n, 1.0, sides.data(), n,
              shared.w.data(), n, 0.0, shared.f.data(), shared.joined);
  if (joined > 0 && shared.motions > 0)
    blas.GEMM(Teuchos::TRANS, Teuchos::NO_TRANS, shared.motions, shared.joined, n, 1.0,
              shared.w.data() + b * joined, n, sides.data(), n, 0.0, shared.g.data(), shared.motions);
  // Faces at the rim of a body have other dofs than those within, and all of them are columns of W: where
  // most members use few of these it is better to take them one after the other.
  constexpr double many = 1.5;
  double used = 0.0;
  for (int i : group.members)
    for (const Use& use : members_[static_cast<std::size_t>(i)].uses)
      used += use.columns;
  shared.isSelective = shared.joined * static_cast<double>(group.members.size()) > many * used;
  return shared;
}

// Clusters with one signature have one F₀ and one S₀.
std::vector<int> ClusterInverse::signature(std::size_t cluster) const {
  const Clusters::Cluster& item = clusters_->all()[cluster];
  std::vector<int> result = {columnsOf(item)};
  for (int i : item.members) {
    const Member& member = members_[static_cast<std::size_t>(i)];
    result.insert(result.end(), {-1, static_cast<int>(member.group)});
    for (const Use& use : member.uses)
      result.insert(result.end(), {use.column, use.average, use.columns, use.sign > 0.0 ? 1 : 0});
  }
  return result;
}

std::vector<double> ClusterInverse::gTimes(std::size_t cluster, const std::vector<double>& mu) const {
  std::vector<double> result;
  for (int i : clusters_->all()[cluster].members) {
    const Member& member = members_[static_cast<std::size_t>(i)];
    const Shared& shared = shared_[member.group];
    const auto rows = static_cast<std::size_t>(shared.motions);
    const std::size_t begin = result.size();
    result.resize(begin + rows, 0.0);
    for (const Use& use : member.uses)
      for (int q = 0; q < use.columns; ++q) {
        const double factor = use.sign * mu[static_cast<std::size_t>(use.average + q)];
        for (std::size_t k = 0; k < rows; ++k)
          result[begin + k] += factor * shared.g[static_cast<std::size_t>(use.column + q) * rows + k];
      }
  }
  return result;
}

std::vector<double> ClusterInverse::gTransposedTimes(std::size_t cluster,
                                                     const std::vector<double>& alpha) const {
  const Clusters::Cluster& item = clusters_->all()[cluster];
  std::vector<double> result(static_cast<std::size_t>(columnsOf(item)), 0.0);
  for (int i : item.members) {
    const Member& member = members_[static_cast<std::size_t>(i)];
    const Shared& shared = shared_[member.group];
    const auto rows = static_cast<std::size_t>(shared.motions);
    for (const Use& use : member.uses)
      for (int q = 0; q < use.columns; ++q) {
        double sum = 0.0;
        for (std::size_t k = 0; k < rows; ++k)
          sum += shared.g[static_cast<std::size_t>(use.column + q) * rows + k] * alpha[member.amplitude + k];
        result[static_cast<std::size_t>(use.average + q)] += use.sign * sum;
      }
  }
  return result;
}

// T: the motions of the whole cluster, column after column.
std::vector<double> ClusterInverse::motionsOf(std::size_t cluster) const {
  const RigidMotions& motions = clusters_->motions();
  const std::size_t first = motions.places()[cluster], end = motions.places()[cluster + 1];
  std::vector<double> t, whole(motions.places().back(), 0.0);
  for (std::size_t c = first; c < end; ++c) {
    whole[c] = 1.0;
    const std::vector<double> amplitudes = motions.amplitudes(whole);
    for (int i : clusters_->all()[cluster].members) {
      const std::vector<double> mine =
          part(amplitudes, motions.amplitudePlaces()[static_cast<std::size_t>(i)],
               motions.amplitudePlaces()[static_cast<std::size_t>(i) + 1]);
      t.insert(t.end(), mine.begin(), mine.end());
    }
    whole[c] = 0.0;
  }
  return t;
}

ClusterInverse::Factor ClusterInverse::factorOf(std::size_t cluster) const {
  const Clusters::Cluster& item = clusters_->all()[cluster];
  Factor factor;
  factor.averages = columnsOf(item);
  std::map<std::pair<int, int>, double> entries; // of the lower triangle of F₀
  for (int i : item.members) {
    const Member& member = members_[static_cast<std::size_t>(i)];
    const Shared& shared = shared_[member.group];
    factor.amplitudes += shared.motions;
    for (const Use& a : member.uses)
      for (const Use& b : member.uses)
        for (int p = 0; p < a.columns; ++p)
          for (int q = 0; q < b.columns; ++q)
            if (a.average + p >= b.average + q)
              entries[{a.average + p, b.average + q}] +=
                  a.sign * b.sign *
                  shared.f[static_cast<std::size_t>(b.column + q) * static_cast<std::size_t>(shared.joined) +
                           static_cast<std::size_t>(a.column + p)];
  }
  std::vector<int> rows, columns;
  std::vector<double> values;
  for (const auto& [place, value] : entries) {
    rows.push_back(place.first);
    columns.push_back(place.second);
    values.push_back(value);
  }
  const std::string name =
      "the cluster of " + std::to_string(item.members.size()) + " subdomains from subdomain " +
      std::to_string(clusters_->motions().system().subdomain(item.members.front()).number) + " on";
  factor.f0 = SparseCholesky(factor.averages, rows, columns, values);
  if (role_ == Role::Inverse && factor.f0.rank() < factor.averages)
    throw NumericalError(name + " has linearly dependent averages: the factor of B₀K⁺B₀ᵀ has rank " +
                         std::to_string(factor.f0.rank()) + " of " + std::to_string(factor.averages));
  // A cluster without joins moves as its subdomains do: S₀ is zero.
  if (factor.amplitudes == 0 || factor.averages == 0)
    return factor;
  const auto n = static_cast<std::size_t>(factor.amplitudes);
  std::vector<double> s, unit(n, 0.0);
  for (std::size_t k = 0; k < n; ++k) {
    unit[k] = 1.0;
    const std::vector<double> column =
        gTimes(cluster, factor.f0.solveLt(factor.f0.solveL(gTransposedTimes(cluster, unit))));
    s.insert(s.end(), column.begin(), column.end());
    unit[k] = 0.0;
  }
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < j; ++i)
      s[j * n + i] = s[i * n + j] = 0.5 * (s[j * n + i] + s[i * n + j]);
  factor.inverse.emplace(invertedOnComplement(std::move(s), factor.amplitudes, motionsOf(cluster), name),
                         factor.amplitudes, Precision::Double, 1);
  return factor;
}

void ClusterInverse::solveCluster(std::size_t cluster, std::vector<double>& averages,
                                  std::vector<double>& amplitudes) const {
  const Factor& factor = factors_[factorOf_[cluster]];
  if (factor.averages == 0) {
    std::fill(amplitudes.begin(), amplitudes.end(), 0.0);
    return;
  }
  const auto solve = [&](const std::vector<double>& v) { return factor.f0.solveLt(factor.f0.solveL(v)); };
  averages = solve(averages);
  if (!factor.inverse)
    return;
  const std::vector<double> pull = gTimes(cluster, averages);
  for (std::size_t k = 0; k < pull.size(); ++k)
    amplitudes[k] -= pull[k];
  std::vector<double> alpha(amplitudes.size());
  factor.inverse->apply(amplitudes.data(), alpha.data(), 1);
  const std::vector<double> more = solve(gTransposedTimes(cluster, alpha));
  for (std::size_t k = 0; k < more.size(); ++k)
    averages[k] += more[k];
  amplitudes = std::move(alpha);
}

double ClusterInverse::bytes() const {
  double sum = 0.0;
  for (const Shared& shared : shared_)
    sum += 8.0 * static_cast<double>(shared.w.size() + shared.f.size() + shared.g.size() +
                                     shared.members.size() * static_cast<std::size_t>(shared.width));
  for (const Factor& factor : factors_)
    sum += 16.0 * factor.f0.entries() + (factor.inverse ? factor.inverse->bytes() : 0.0);
  return sum;
}

void ClusterInverse::gather(std::size_t group, const double* t, int columns) const {
  const Shared& shared = shared_[group];
  const int b = static_cast<int>(shared.boundary.size());
  const std::size_t vectors = shared.members.size() * static_cast<std::size_t>(columns);
  shared.amounts.resize(static_cast<std::size_t>(shared.width) * vectors);
  const auto multiply = [&](int first, int count, const double* of, int number, double* to) {
    if (count > 0 && number > 0)
      Teuchos::BLAS<int, double>().GEMM(Teuchos::TRANS, Teuchos::NO_TRANS, count, number, b, 1.0,
                                        shared.w.data() + static_cast<std::ptrdiff_t>(first) * b, b, of, b,
                                        0.0, to + first, shared.width);
  };
  if (!shared.isSelective)
    return multiply(0, shared.width, t, static_cast<int>(vectors), shared.amounts.data());
  for (std::size_t v = 0; v < vectors; ++v) {
    const double* mine = t + v * static_cast<std::size_t>(b);
    double* to = shared.amounts.data() + v * static_cast<std::size_t>(shared.width);
    for (const Use& use : usesOf(shared, v))
      multiply(use.column, use.columns, mine, 1, to);
    multiply(shared.joined, shared.motions, mine, 1, to);
  }
}

void ClusterInverse::solve(int columns) const {
  std::vector<double> averages, amplitudes;
  for (std::size_t x = 0; x < static_cast<std::size_t>(columns); ++x)
    for (std::size_t c = 0; c < clusters_->all().size(); ++c) {
      const Clusters::Cluster& cluster = clusters_->all()[c];
      averages.assign(static_cast<std::size_t>(columnsOf(cluster)), 0.0);
      amplitudes.clear();
      const auto amountsOf = [&](const Member& member) {
        const Shared& shared = shared_[member.group];
        return shared.amounts.data() +
               (x * shared.members.size() + member.place) * static_cast<std::size_t>(shared.width);
      };
      for (int i : cluster.members) {
        const Member& member = members_[static_cast<std::size_t>(i)];
        const Shared& shared = shared_[member.group];
        const double* mine = amountsOf(member);
        for (const Use& use : member.uses)
          for (int q = 0; q < use.columns; ++q)
            averages[static_cast<std::size_t>(use.average + q)] += use.sign * mine[use.column + q];
        amplitudes.insert(amplitudes.end(), mine + shared.joined, mine + shared.width);
      }
      solveCluster(c, averages, amplitudes);
      for (int i : cluster.members) {
        const Member& member = members_[static_cast<std::size_t>(i)];
        const Shared& shared = shared_[member.group];
        double* mine = amountsOf(member);
        std::fill(mine, mine + shared.joined, 0.0);
        for (const Use& use : member.uses)
          for (int q = 0; q < use.columns; ++q)
            mine[use.column + q] = use.sign * averages[static_cast<std::size_t>(use.average + q)];
        for (int k = 0; k < shared.motions; ++k)
          mine[shared.joined + k] = -amplitudes[member.amplitude + static_cast<std::size_t>(k)];
      }
    }
}

void ClusterInverse::add(std::size_t group, double* u, int columns) const {
  const Shared& shared = shared_[group];
  const int b = static_cast<int>(shared.boundary.size());
  const std::size_t vectors = shared.members.size() * static_cast<std::size_t>(columns);
  const auto subtract = [&](int first, int count, const double* amounts, int number, double* from) {
    if (count > 0 && number > 0)
      Teuchos::BLAS<int, double>().GEMM(Teuchos::NO_TRANS, Teuchos::NO_TRANS, b, number, count, -1.0,
                                        shared.w.data() + static_cast<std::ptrdiff_t>(first) * b, b,
                                        amounts + first, shared.width, 1.0, from, b);
  };
  if (!shared.isSelective)
    return subtract(0, shared.width, shared.amounts.data(), static_cast<int>(vectors), u);
  for (std::size_t v = 0; v < vectors; ++v) {
    const double* mine = shared.amounts.data() + v * static_cast<std::size_t>(shared.width);
    double* from = u + v * static_cast<std::size_t>(b);
    for (const Use& use : usesOf(shared, v))
      subtract(use.column, use.columns, mine, 1, from);
    subtract(shared.joined, shared.motions, mine, 1, from);
  }
}

ClusterInverse::Amounts ClusterInverse::none() const {
  return {std::vector<double>(clusters_->averagePlaces().back(), 0.0),
          std::vector<double>(clusters_->motions().amplitudePlaces().back(), 0.0)};
}

void ClusterInverse::measure(int subdomain, const double* u, const double* f, Amounts& amounts) const {
  const Member& member = members_[static_cast<std::size_t>(subdomain)];
  double* averages = amounts.averages.data() + clusters_->averagePlaces()[member.cluster];
  for (const Use& use : member.uses) {
    const std::size_t n = use.side->dofs.size();
    for (int q = 0; q < use.columns; ++q)
      for (std::size_t k = 0; k < n; ++k)
        averages[use.average + q] +=
            use.side->values[static_cast<std::size_t>(q) * n + k] * u[use.side->dofs[k]];
  }
  const RigidMotions& motions = clusters_->motions();
  const Kernel& kernel = motions.kernel(subdomain);
  double* mine = amounts.amplitudes.data() + motions.amplitudePlaces()[static_cast<std::size_t>(subdomain)];
  for (int k = 0; k < kernel.columns; ++k)
    for (int j = 0; j < kernel.rows; ++j)
      mine[k] += kernel.column(k)[j] * f[j];
}

ClusterInverse::Amounts ClusterInverse::answer(const Amounts& amounts) const {
  Amounts result = none();
  const RigidMotions& motions = clusters_->motions();
  for (std::size_t c = 0; c < clusters_->all().size(); ++c) {
    const std::size_t begin = clusters_->averagePlaces()[c];
    std::vector<double> averages = part(amounts.averages, begin, clusters_->averagePlaces()[c + 1]),
                        amplitudes;
    for (int i : clusters_->all()[c].members) {
      const auto place = static_cast<std::size_t>(i);
      const std::vector<double> mine =
          part(amounts.amplitudes, motions.amplitudePlaces()[place], motions.amplitudePlaces()[place + 1]);
      amplitudes.insert(amplitudes.end(), mine.begin(), mine.end());
    }
    solveCluster(c, averages, amplitudes);
    std::copy(averages.begin(), averages.end(), result.averages.begin() + static_cast<std::ptrdiff_t>(begin));
    for (int i : clusters_->all()[c].members) {
      const auto place = static_cast<std::size_t>(i);
      const std::size_t first = members_[place].amplitude;
      for (int k = 0; k < motions.kernel(i).columns; ++k)
        result.amplitudes[motions.amplitudePlaces()[place] + static_cast<std::size_t>(k)] =
            amplitudes[first + static_cast<std::size_t>(k)];
    }
  }
  return result;
}

void ClusterInverse::subtractForces(int subdomain, const Amounts& answer, double* f) const {
  const Member& member = members_[static_cast<std::size_t>(subdomain)];
  const double* mu = answer.averages.data() + clusters_->averagePlaces()[member.cluster];
  for (const Use& use : member.uses) {
    const std::size_t n = use.side->dofs.size();
    for (int q = 0; q < use.columns; ++q)
      for (std::size_t k = 0; k < n; ++k)
        f[use.side->dofs[k]] -= use.side->values[static_cast<std::size_t>(q) * n + k] * mu[use.average + q];
  }
}

void ClusterInverse::addMotion(int subdomain, const Amounts& answer, double* u) const {
  const RigidMotions& motions = clusters_->motions();
  const Kernel& kernel = motions.kernel(subdomain);
  const double* mine =
      answer.amplitudes.data() + motions.amplitudePlaces()[static_cast<std::size_t>(subdomain)];
  for (int k = 0; k < kernel.columns; ++k)
    for (int j = 0; j < kernel.rows; ++j)
      u[j] += mine[k] * kernel.column(k)[j];
}

void ClusterInverse::addCorrection(int subdomain, const Amounts& answer, double* u) const {
  const Member& member = members_[static_cast<std::size_t>(subdomain)];
  const Shared& shared = shared_[member.group];
  const std::size_t b = shared.boundary.size();
  const auto subtract = [&](int column, double factor) {
    const double* w = shared.w.data() + static_cast<std::size_t>(column) * b;
    for (std::size_t k = 0; k < b; ++k)
      u[shared.boundary[k]] -= factor * w[k];
  };
  const double* mu = answer.averages.data() + clusters_->averagePlaces()[member.cluster];
  for (const Use& use : member.uses)
    for (int q = 0; q < use.columns; ++q)
      subtract(use.column + q, use.sign * mu[use.average + q]);
  const double* alpha =
      answer.amplitudes.data() + clusters_->motions().amplitudePlaces()[static_cast<std::size_t>(subdomain)];
  for (int k = 0; k < shared.motions; ++k)
    subtract(shared.joined + k, -alpha[k]);
}

} // namespace Harmos::feti
