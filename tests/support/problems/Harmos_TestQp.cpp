// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_TestQp.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <cmath>
#include <limits>

namespace Harmos {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double lowerOf(const SmallQp& qp, int i) {
  return qp.lower.empty() ? -infinity : qp.lower[static_cast<std::size_t>(i)];
}
double upperOf(const SmallQp& qp, int i) {
  return qp.upper.empty() ? infinity : qp.upper[static_cast<std::size_t>(i)];
}

std::vector<double> product(const Dense& m, const std::vector<double>& x) {
  std::vector<double> y(static_cast<std::size_t>(m.rows), 0.0);
  for (int j = 0; j < m.columns; ++j)
    for (int i = 0; i < m.rows; ++i)
      y[static_cast<std::size_t>(i)] += m(i, j) * x[static_cast<std::size_t>(j)];
  return y;
}

double beyond(const qp::SoftBound& bound, double x) {
  return x < bound.lower ? x - bound.lower : x > bound.upper ? x - bound.upper : 0.0;
}

} // namespace

double SmallQp::cost(const std::vector<double>& x) const {
  const std::vector<double> ax = product(a, x);
  double f = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    f += x[i] * (0.5 * ax[i] - b[i]);
  for (const qp::SoftBound& bound : soft)
    f += 0.5 * bound.curvature * std::pow(beyond(bound, x[static_cast<std::size_t>(bound.entry)]), 2);
  return f;
}

std::vector<double> bruteForce(const SmallQp& qp, std::vector<double>* multipliers) {
  const int n = qp.size(), m = qp.c.rows;
  std::vector<int> state(static_cast<std::size_t>(n), 0); // 0 free, 1 lower, 2 upper
  while (true) {
    bool admissible = true;
    for (int i = 0; i < n; ++i) {
      const int s = state[static_cast<std::size_t>(i)];
      admissible =
          admissible && !(s == 1 && lowerOf(qp, i) == -infinity) && !(s == 2 && upperOf(qp, i) == infinity);
    }
    if (admissible) {
      // Unknowns x, multipliers of C; rows of active entries say x_i = bound.
      Dense kkt(n + m, n + m);
      std::vector<double> rhs(static_cast<std::size_t>(n + m), 0.0);
      for (int i = 0; i < n; ++i) {
        const int s = state[static_cast<std::size_t>(i)];
        if (s != 0) {
          kkt(i, i) = 1.0;
          rhs[static_cast<std::size_t>(i)] = s == 1 ? lowerOf(qp, i) : upperOf(qp, i);
          continue;
        }
        for (int j = 0; j < n; ++j)
          kkt(i, j) = qp.a(i, j);
        for (int k = 0; k < m; ++k)
          kkt(i, n + k) = qp.c(k, i);
        rhs[static_cast<std::size_t>(i)] = qp.b[static_cast<std::size_t>(i)];
      }
      for (int k = 0; k < m; ++k) {
        for (int j = 0; j < n; ++j)
          kkt(n + k, j) = qp.c(k, j);
        rhs[static_cast<std::size_t>(n + k)] = qp.cRhs[static_cast<std::size_t>(k)];
      }
      const std::vector<double> solution = solveDense(kkt, rhs);
      if (!solution.empty()) {
        const std::vector<double> x(solution.begin(), solution.begin() + n);
        const std::vector<double> ax = product(qp.a, x);
        bool optimal = true;
        for (int i = 0; i < n && optimal; ++i) {
          const auto k = static_cast<std::size_t>(i);
          double g = ax[k] - qp.b[k];
          for (int r = 0; r < m; ++r)
            g += qp.c(r, i) * solution[static_cast<std::size_t>(n + r)];
          optimal = x[k] >= lowerOf(qp, i) - 1e-11 && x[k] <= upperOf(qp, i) + 1e-11 &&
                    !(state[k] == 1 && g < -1e-10) && !(state[k] == 2 && g > 1e-10);
        }
        if (optimal) {
          if (multipliers != nullptr)
            multipliers->assign(solution.begin() + n, solution.end());
          return x;
        }
      }
    }
    int i = 0;
    while (i < n && ++state[static_cast<std::size_t>(i)] == 3)
      state[static_cast<std::size_t>(i++)] = 0;
    if (i == n)
      return {};
  }
}

Dense randomOrthonormal(std::mt19937& random, int n, const std::vector<std::vector<double>>& first) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  Dense q(n, n);
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i)
      q(i, j) = static_cast<std::size_t>(j) < first.size()
                    ? first[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)]
                    : unit(random);
    for (int pass = 0; pass < 2; ++pass)
      for (int k = 0; k < j; ++k) {
        double dot = 0.0;
        for (int i = 0; i < n; ++i)
          dot += q(i, j) * q(i, k);
        for (int i = 0; i < n; ++i)
          q(i, j) -= dot * q(i, k);
      }
    double length = 0.0;
    for (int i = 0; i < n; ++i)
      length += q(i, j) * q(i, j);
    for (int i = 0; i < n; ++i)
      q(i, j) /= std::sqrt(length);
  }
  return q;
}

Dense withSpectrum(const Dense& q, int nullity, double condition) {
  const int n = q.rows;
  Dense a(n, n);
  for (int k = nullity; k < n; ++k) {
    const double value =
        std::pow(condition, n - nullity > 1 ? static_cast<double>(k - nullity) / (n - nullity - 1) : 0.0);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        a(i, j) += value * q(i, k) * q(j, k);
  }
  return a;
}

SmallQp randomQp(std::mt19937& random, int n, int equalities, bool bounds, double condition) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  SmallQp qp{withSpectrum(randomOrthonormal(random, n), 0, condition), {}, {}, {}, Dense(equalities, n), {}};
  std::vector<double> feasible;
  for (int i = 0; i < n; ++i) {
    qp.b.push_back(10.0 * unit(random));
    feasible.push_back(unit(random));
    if (!bounds)
      continue;
    // A third of the entries each: both bounds, lower only, none.
    const double kind = unit(random);
    qp.lower.push_back(kind < 0.33 ? feasible.back() - 0.3 * (1.0 + unit(random)) : -infinity);
    qp.upper.push_back(kind < -0.33 ? feasible.back() + 0.3 * (1.0 + unit(random)) : infinity);
  }
  for (double& value : qp.c.values)
    value = unit(random);
  qp.cRhs = product(qp.c, feasible);
  return qp;
}

SmallQp randomFrictionQp(std::mt19937& random, int n, int equalities, double condition) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  SmallQp qp = randomQp(random, n, 0, true, condition);
  std::vector<double> feasible;
  for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i)
    feasible.push_back(std::max(std::min(unit(random), qp.upper[i] - 0.01), qp.lower[i] + 0.01));
  for (int i = 0; i + 1 < n; ++i) {
    if (unit(random) > 0.0)
      continue;
    const double radius = std::pow(10.0, unit(random)), angle = 4.0 * unit(random);
    const double share = 0.5 * (1.0 + unit(random)) * 0.99 * radius; // of the way to the rim
    const auto first = static_cast<std::size_t>(i);
    qp.discs.push_back(
        {i,
         i + 1,
         {feasible[first] + share * std::cos(angle), feasible[first + 1] + share * std::sin(angle)},
         radius});
    for (std::size_t k : {first, first + 1}) {
      qp.lower[k] = -infinity;
      qp.upper[k] = infinity;
    }
    ++i;
  }
  qp.c = Dense(equalities, n);
  for (double& value : qp.c.values)
    value = unit(random);
  qp.cRhs = product(qp.c, feasible);
  return qp;
}

std::vector<double> bruteForceOfSides(const SmallQp& qp,
                                      const std::function<std::vector<double>(const SmallQp&)>& solve) {
  std::vector<double> best;
  double least = infinity;
  std::vector<int> sides(qp.soft.size(), -1);
  while (true) {
    SmallQp plain = qp;
    plain.soft.clear();
    bool isThere = true;
    for (std::size_t k = 0; k < sides.size(); ++k) {
      const qp::SoftBound& bound = qp.soft[k];
      const double centre = sides[k] < 0 ? bound.lower : bound.upper;
      if (sides[k] == 0)
        continue;
      isThere = isThere && std::isfinite(centre);
      plain.a(bound.entry, bound.entry) += bound.curvature;
      plain.b[static_cast<std::size_t>(bound.entry)] += bound.curvature * centre;
    }
    // The solution is the one whose entries are where their sides say.
    if (isThere) {
      const std::vector<double> x = solve(plain);
      double wrong = x.empty() ? infinity : 0.0;
      for (std::size_t j = 0; j < sides.size() && !x.empty(); ++j) {
        const qp::SoftBound& bound = qp.soft[j];
        const double at = x[static_cast<std::size_t>(bound.entry)];
        const double distance = sides[j] == 0 ? 0.0 : at - (sides[j] < 0 ? bound.lower : bound.upper);
        wrong = std::max(wrong, std::abs(beyond(bound, at) - distance));
      }
      if (wrong < least) {
        least = wrong;
        best = x;
      }
    }
    std::size_t k = 0;
    while (k < sides.size() && sides[k] == 1)
      sides[k++] = -1;
    if (k == sides.size())
      return least <= 1e-8 ? best : std::vector<double>();
    ++sides[k];
  }
}

void addSoftBounds(std::mt19937& random, SmallQp& qp, double least, double most) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  double mean = 0.0;
  for (int i = 0; i < qp.size(); ++i)
    mean += qp.a(i, i) / qp.size();
  std::vector<char> isTaken(static_cast<std::size_t>(qp.size()), 0);
  for (const qp::Disc& disc : qp.discs)
    isTaken[static_cast<std::size_t>(disc.first)] = isTaken[static_cast<std::size_t>(disc.second)] = 1;
  for (int i = 0; i < qp.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool isBounded = (!qp.lower.empty() && std::isfinite(qp.lower[k])) ||
                           (!qp.upper.empty() && std::isfinite(qp.upper[k]));
    const double kind = unit(random), at = unit(random), width = 0.5 * (1.0 + unit(random));
    const double share =
        std::exp(std::log(least) + 0.5 * (1.0 + unit(random)) * (std::log(most) - std::log(least)));
    if (isBounded || isTaken[k] != 0 || unit(random) > 0.2)
      continue;
    qp.soft.push_back({i, kind > 0.6 ? -infinity : at,
                       kind < -0.4  ? infinity
                       : kind < 0.2 ? at
                                    : at + width,
                       share * mean});
  }
}

Dense jacobi(const Dense& matrix) {
  Dense result(matrix.rows, matrix.rows);
  for (int i = 0; i < matrix.rows; ++i)
    result(i, i) = 1.0 / matrix(i, i);
  return result;
}

void orthonormalizeRows(SmallQp& qp) {
  for (int k = 0; k < qp.c.rows; ++k) {
    for (int pass = 0; pass < 2; ++pass)
      for (int r = 0; r < k; ++r) {
        double dot = 0.0;
        for (int j = 0; j < qp.size(); ++j)
          dot += qp.c(k, j) * qp.c(r, j);
        for (int j = 0; j < qp.size(); ++j)
          qp.c(k, j) -= dot * qp.c(r, j);
        qp.cRhs[static_cast<std::size_t>(k)] -= dot * qp.cRhs[static_cast<std::size_t>(r)];
      }
    double norm = 0.0;
    for (int j = 0; j < qp.size(); ++j)
      norm += qp.c(k, j) * qp.c(k, j);
    norm = std::sqrt(norm);
    for (int j = 0; j < qp.size(); ++j)
      qp.c(k, j) /= norm;
    qp.cRhs[static_cast<std::size_t>(k)] /= norm;
  }
}

Teuchos::RCP<MultiVector> toVector(const std::vector<double>& values, const Teuchos::RCP<const Map>& map) {
  const auto result = Teuchos::rcp(new MultiVector(map, 1));
  const auto view = result->getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t i = 0; i < view.extent(0); ++i)
    view(i, 0) = values[static_cast<std::size_t>(map->getGlobalElement(static_cast<LocalOrdinal>(i)))];
  return result;
}

std::vector<double> fromVector(const MultiVector& vector) {
  std::vector<double> values(vector.getGlobalLength(), 0.0);
  const auto view = vector.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t i = 0; i < view.extent(0); ++i)
    values[static_cast<std::size_t>(vector.getMap()->getGlobalElement(static_cast<LocalOrdinal>(i)))] =
        view(i, 0);
  if (vector.isDistributed())
    globalSum(*vector.getMap()->getComm(), values);
  return values;
}

void DenseOperator::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
                          Scalar beta) const {
  const std::vector<double> x = fromVector(X);
  std::vector<double> y(Y.getGlobalLength(), 0.0);
  for (int i = 0; i < matrix_.rows; ++i)
    for (int j = 0; j < matrix_.columns; ++j) {
      if (mode == Teuchos::NO_TRANS)
        y[static_cast<std::size_t>(i)] += matrix_(i, j) * x[static_cast<std::size_t>(j)];
      else
        y[static_cast<std::size_t>(j)] += matrix_(i, j) * x[static_cast<std::size_t>(i)];
    }
  const auto image = toVector(y, Y.getMap());
  if (beta == 0.0)
    Y.scale(alpha, *image);
  else
    Y.update(alpha, *image, beta);
}

std::shared_ptr<const qp::LocalDiscs> localDiscs(const std::vector<qp::Disc>& discs, const Map& map) {
  if (discs.empty())
    return nullptr;
  std::vector<qp::Disc> mine;
  for (const qp::Disc& disc : discs) {
    const auto first = map.getLocalElement(disc.first), second = map.getLocalElement(disc.second);
    if (map.isNodeLocalElement(first))
      mine.push_back({first, second, {disc.centre[0], disc.centre[1]}, disc.radius});
  }
  return std::make_shared<qp::LocalDiscs>(mine, localSize(map));
}

namespace {

std::shared_ptr<const qp::LocalSoftBounds> localSoftBounds(const std::vector<qp::SoftBound>& bounds,
                                                           const Map& map) {
  if (bounds.empty())
    return nullptr;
  std::vector<qp::SoftBound> mine;
  for (qp::SoftBound bound : bounds)
    if (const auto entry = map.getLocalElement(bound.entry); map.isNodeLocalElement(entry)) {
      bound.entry = entry;
      mine.push_back(bound);
    }
  return std::make_shared<qp::LocalSoftBounds>(mine, localSize(map));
}

// The last entry that belongs to a limit that follows.
int lastOf(const qp::FollowingLimit& limit, const SmallQp& qp) {
  return limit.isDisc ? qp.discs[static_cast<std::size_t>(limit.place)].second : limit.place;
}

std::shared_ptr<const qp::FollowingLimits> localLimits(const SmallQp& qp, const Map& map) {
  if (qp.follows.empty())
    return nullptr;
  const auto result = std::make_shared<qp::FollowingLimits>();
  int discs = 0; // of this rank
  std::vector<int> place;
  for (const qp::Disc& disc : qp.discs)
    place.push_back(map.isNodeGlobalElement(disc.first) ? discs++ : -1);
  for (qp::FollowingLimit limit : qp.follows) {
    if (!map.isNodeGlobalElement(limit.source))
      continue;
    limit.source = map.getLocalElement(limit.source);
    limit.place =
        limit.isDisc ? place[static_cast<std::size_t>(limit.place)] : map.getLocalElement(limit.place);
    result->push_back(limit);
  }
  return result;
}

} // namespace

DistributedQp::DistributedQp(const SmallQp& qp, qp::EqualityStructure structure) {
  const auto comm = testComm();
  map = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(qp.size()), 0, comm));
  if (!qp.discs.empty() || !qp.follows.empty()) {
    // As even as whole discs, and what follows, allow.
    const auto begin = [&](int rank) {
      int entry = rank * qp.size() / comm->getSize();
      for (const qp::Disc& disc : qp.discs)
        entry += disc.second == entry ? 1 : 0;
      for (const qp::FollowingLimit& limit : qp.follows)
        if (const int last = lastOf(limit, qp); entry > limit.source && entry <= last)
          entry = last + 1;
      return entry;
    };
    const int rank = comm->getRank();
    map = Teuchos::rcp(new Map(static_cast<Tpetra::global_size_t>(qp.size()),
                               static_cast<std::size_t>(begin(rank + 1) - begin(rank)), 0, comm));
  }
  solution = Teuchos::rcp(new MultiVector(map, 1));
  problem = Teuchos::rcp(
      new qp::TpetraProblem(Teuchos::rcp(new DenseOperator(qp.a, map, map)), solution, toVector(qp.b, map)));
  if (!qp.lower.empty())
    problem->setLowerBound(toVector(qp.lower, map));
  if (!qp.upper.empty())
    problem->setUpperBound(toVector(qp.upper, map));
  problem->setDiscs(localDiscs(qp.discs, *map));
  problem->setFollowingLimits(localLimits(qp, *map));
  problem->setSoftBounds(localSoftBounds(qp.soft, *map));
  if (qp.c.rows > 0) {
    const auto rows = Teuchos::rcp(
        new Map(static_cast<Tpetra::global_size_t>(qp.c.rows), 0, comm, Tpetra::LocallyReplicated));
    multiplier = Teuchos::rcp(new MultiVector(rows, 1));
    problem->setEquality(Teuchos::rcp(new DenseOperator(qp.c, map, rows)), toVector(qp.cRhs, rows),
                         multiplier, structure);
  }
  problem->setProblem();
}

void DistributedQp::precondition(const Dense& inverse) const {
  problem->setPreconditioner(Teuchos::rcp(new DenseOperator(inverse, map, map)));
  problem->setProblem();
}

} // namespace Harmos
