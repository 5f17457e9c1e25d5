// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Clusters.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_ClusterPartition.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace Harmos::feti {
namespace {

using Cluster = Clusters::Cluster;
using Join = Clusters::Join;
using Side = Clusters::Side;

// A dof whose copies are all on this rank: entries of its gluing rows, which are copies after each other.
struct Copies {
  std::vector<std::pair<int, int>> at; // subdomain and dof of each copy
  std::vector<int> rows;               // owned; row k has entries at the copies up to k + 1
  std::vector<std::vector<double>> values;
};

struct GluedEntry {
  long long number; // of the subdomain
  int subdomain, dof;
  double value;
};

// Entries of owned gluing rows in subdomains of this rank, by rising subdomain numbers. Without those between
// values that are prescribed in the matrices: no force belongs to them, and an average over them and others
// would move what is prescribed as long as forces of averages are not known well.
std::map<int, std::vector<GluedEntry>> gluingRows(const SubdomainSystem& system,
                                                  const Constraints& constraints) {
  std::map<int, std::vector<GluedEntry>> result;
  for (int i = 0; i < system.size(); ++i) {
    std::vector<char> isPrescribed(static_cast<std::size_t>(system.matrix(i).rows()), 0);
    for (const FixedDof& fixed : system.subdomain(i).fixed)
      isPrescribed[static_cast<std::size_t>(fixed.dof)] = 1;
    for (const Constraints::Entry& entry : constraints.entries(i)) {
      if (isPrescribed[static_cast<std::size_t>(entry.dof)] != 0)
        continue;
      const LocalOrdinal row =
          constraints.rowMap()->getLocalElement(constraints.overlapMap()->getGlobalElement(entry.row));
      if (row != Teuchos::OrdinalTraits<LocalOrdinal>::invalid() &&
          constraints.rowType(row) == RowType::Gluing)
        result[row].push_back({system.subdomain(i).number, i, entry.dof, entry.value});
    }
  }
  for (auto& item : result)
    std::sort(item.second.begin(), item.second.end(),
              [](const GluedEntry& a, const GluedEntry& b) { return a.number < b.number; });
  return result;
}

// Gluing rows sum up to zero: where entries of other ranks are missing they do not.
bool isComplete(const std::vector<GluedEntry>& row) {
  double sum = 0.0, sizes = 0.0;
  for (const GluedEntry& entry : row) {
    sum += entry.value;
    sizes += std::abs(entry.value);
  }
  return std::abs(sum) <= 1e-9 * sizes;
}

// Where ties join a soft body and one that is stiffer by orders of magnitude, motions of the stiff one within
// a cluster would be known to rounding errors of the displacements of the soft one, and its forces to these
// times its stiffness.
bool isOfOneStiffness(const std::vector<std::vector<double>>& diagonals, const Copies& dof) {
  constexpr double jump = 1e4;
  double least = std::numeric_limits<double>::infinity(), most = 0.0;
  for (const auto& [subdomain, local] : dof.at) {
    const double value = diagonals[static_cast<std::size_t>(subdomain)][static_cast<std::size_t>(local)];
    least = std::min(least, value);
    most = std::max(most, value);
  }
  return most <= jump * least;
}

// Those of one stiffness.
std::vector<Copies> wholeDofs(const SubdomainSystem& system, const Constraints& constraints) {
  std::vector<std::vector<double>> diagonals;
  for (int i = 0; i < system.size(); ++i)
    diagonals.push_back(system.diagonal(i));
  std::map<std::pair<int, int>, std::vector<std::pair<int, std::vector<GluedEntry>>>> byFirst;
  for (auto& [row, entries] : gluingRows(system, constraints))
    byFirst[{entries.front().subdomain, entries.front().dof}].emplace_back(row, entries);
  std::vector<Copies> result;
  for (const auto& [first, rows] : byFirst) {
    Copies dof;
    for (const GluedEntry& entry : rows.back().second)
      dof.at.emplace_back(entry.subdomain, entry.dof);
    bool isWhole = dof.at.size() == rows.size() + 1;
    for (std::size_t k = 0; k < rows.size() && isWhole; ++k) {
      const std::vector<GluedEntry>& entries = rows[k].second;
      isWhole = entries.size() == k + 2 && isComplete(entries);
      dof.rows.push_back(rows[k].first);
      std::vector<double>& values = dof.values.emplace_back();
      for (const GluedEntry& entry : entries)
        values.push_back(entry.value);
    }
    if (isWhole && isOfOneStiffness(diagonals, dof))
      result.push_back(std::move(dof));
  }
  return result;
}

// Dofs by the subdomains that have copies of them.
using Places = std::map<std::vector<int>, std::vector<Copies>>;

Places placesOf(std::vector<Copies> dofs) {
  Places places;
  for (Copies& dof : dofs) {
    std::vector<int> who;
    for (const auto& copy : dof.at)
      who.push_back(copy.first);
    places[who].push_back(std::move(dof));
  }
  return places;
}

// Orthonormal columns with the span of the given ones, in their order, each by two passes of Gram–Schmidt;
// what depends on those before is left out.
std::vector<double> orthonormalised(const std::vector<double>& columns, std::size_t rows) {
  constexpr double dependent = 1e-7; // of its length
  std::vector<double> result;
  for (std::size_t c = 0; c + rows <= columns.size(); c += rows) {
    std::vector<double> v(columns.begin() + static_cast<std::ptrdiff_t>(c),
                          columns.begin() + static_cast<std::ptrdiff_t>(c + rows));
    const auto length = [&] {
      double sum = 0.0;
      for (double entry : v)
        sum += entry * entry;
      return std::sqrt(sum);
    };
    const double before = length();
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t q = 0; q < result.size(); q += rows) {
        double product = 0.0;
        for (std::size_t k = 0; k < rows; ++k)
          product += result[q + k] * v[k];
        for (std::size_t k = 0; k < rows; ++k)
          v[k] -= product * result[q + k];
      }
    const double after = length();
    if (!(after > dependent * before))
      continue;
    for (double& entry : v)
      entry /= after;
    result.insert(result.end(), v.begin(), v.end());
  }
  return result;
}

// Motions of the first subdomain of a place at its dofs, columns after each other. @param factorOf of each
// dof.
template<class FactorOf>
std::vector<double> motionsAt(const SubdomainSystem& system, const std::vector<Copies>& dofs,
                              FactorOf&& factorOf) {
  const Kernel& motions = *system.subdomain(dofs.front().at.front().first).motions;
  std::vector<double> columns;
  for (int k = 0; k < motions.columns; ++k)
    for (const Copies& dof : dofs)
      columns.push_back(motions.column(k)[dof.at.front().second] * factorOf(dof));
  return orthonormalised(columns, dofs.size());
}

// @param columns values at the dofs, after each other. @param factorOf of each dof.
template<class FactorOf>
Side sideOf(const std::vector<Copies>& dofs, std::size_t copy, const std::vector<double>& columns,
            FactorOf&& factorOf) {
  const std::size_t n = dofs.size();
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return dofs[a].at[copy].second < dofs[b].at[copy].second; });
  Side side{dofs.front().at[copy].first, {}, {}};
  for (std::size_t k : order)
    side.dofs.push_back(dofs[k].at[copy].second);
  for (std::size_t c = 0; c < columns.size(); c += n)
    for (std::size_t k : order)
      side.values.push_back(columns[c + k] * factorOf(dofs[k]));
  return side;
}

// The averages of one level of gluing rows of a place: those of the copy `level` + 1 with what is before it.
Join joinOf(const SubdomainSystem& system, const std::vector<Copies>& dofs, std::size_t level) {
  Join join;
  for (const Copies& dof : dofs)
    join.rows.push_back(dof.rows[level]);
  join.weights = motionsAt(system, dofs, [&](const Copies& dof) { return 1.0 / dof.values[level].front(); });
  join.count = static_cast<int>(join.weights.size() / dofs.size());
  for (std::size_t copy = 0; copy <= level + 1; ++copy)
    join.sides.push_back(
        sideOf(dofs, copy, join.weights, [&](const Copies& dof) { return dof.values[level][copy]; }));
  return join;
}

// A place that moves as a whole.
Clusters::Columns moveOf(const SubdomainSystem& system, const std::vector<Copies>& dofs) {
  const auto one = [](const Copies&) { return 1.0; };
  const std::vector<double> columns = motionsAt(system, dofs, one);
  Clusters::Columns move;
  move.count = static_cast<int>(columns.size() / dofs.size());
  for (std::size_t copy = 0; copy < dofs.front().at.size(); ++copy)
    move.sides.push_back(sideOf(dofs, copy, columns, one));
  return move;
}

// B₀R_i of a side, columns of R_i after each other.
std::vector<double> imageOf(const Side& side, const Kernel& kernel) {
  const std::size_t n = side.dofs.size(), columns = side.values.size() / n;
  std::vector<double> result;
  for (int k = 0; k < kernel.columns; ++k)
    for (std::size_t c = 0; c < columns; ++c) {
      double sum = 0.0;
      for (std::size_t j = 0; j < n; ++j)
        sum += side.values[c * n + j] * kernel.column(k)[side.dofs[j]];
      result.push_back(sum);
    }
  return result;
}

// A cluster that grows: a basis of the amplitudes of its members by which no join opens.
class Growth {
 public:
  /// @param bases see RigidMotions: T is told in the kernels that it is used with.
  Growth(const Cluster& cluster, const SubdomainSystem& system, const std::vector<int>& bases)
      : cluster_(cluster), system_(system), bases_(bases), place_() {
    for (std::size_t m = 0; m < cluster.members.size(); ++m)
      place_[cluster.members[m]] = m;
    for (const Join& join : cluster.joins)
      for (const Side& side : join.sides) {
        images_.push_back(imageOf(side, kernel(side.subdomain)));
        for (double value : images_.back())
          scale_ = std::max(scale_, std::abs(value));
      }
  }

  RigidMotions::Part grown() {
    for (std::size_t m : order())
      add(m);
    RigidMotions::Part part;
    part.members = cluster_.members;
    part.columns = basis_.columns;
    for (std::size_t m = 0; m < cluster_.members.size(); ++m) {
      const auto rows = static_cast<std::size_t>(kernel(cluster_.members[m]).columns);
      std::vector<double>& mine = part.coefficients.emplace_back();
      for (int c = 0; c < basis_.columns; ++c)
        mine.insert(mine.end(), basis_.column(c) + first_[m], basis_.column(c) + first_[m] + rows);
    }
    requireClosed();
    return part;
  }

 private:
  const Kernel& kernel(int subdomain) const {
    return system_.kernel(bases_[static_cast<std::size_t>(subdomain)]);
  }

  // Each hangs together with one before it.
  std::vector<std::size_t> order() const {
    std::vector<std::vector<std::size_t>> neighbours(cluster_.members.size());
    for (const Join& join : cluster_.joins)
      for (const Side& a : join.sides)
        for (const Side& b : join.sides)
          if (a.subdomain != b.subdomain)
            neighbours[place_.at(a.subdomain)].push_back(place_.at(b.subdomain));
    std::vector<std::size_t> result;
    std::vector<char> isKnown(cluster_.members.size(), 0);
    for (std::size_t start = 0; start < isKnown.size(); ++start) {
      if (isKnown[start] != 0)
        continue;
      isKnown[start] = 1;
      result.push_back(start);
      for (std::size_t k = result.size() - 1; k < result.size(); ++k)
        for (std::size_t other : neighbours[result[k]])
          if (isKnown[other] == 0) {
            isKnown[other] = 1;
            result.push_back(other);
          }
    }
    return result;
  }

  void add(std::size_t m) {
    const int more = kernel(cluster_.members[m]).columns;
    Kernel wider{basis_.rows + more, basis_.columns + more, {}};
    for (int c = 0; c < basis_.columns; ++c) {
      wider.values.insert(wider.values.end(), basis_.column(c), basis_.column(c) + basis_.rows);
      wider.values.insert(wider.values.end(), static_cast<std::size_t>(more), 0.0);
    }
    for (int c = 0; c < more; ++c) {
      wider.values.insert(wider.values.end(), static_cast<std::size_t>(wider.rows), 0.0);
      wider.values[wider.values.size() - static_cast<std::size_t>(more - c)] = 1.0;
    }
    first_[m] = basis_.rows;
    basis_ = std::move(wider);
    int rows = 0;
    const std::vector<double> opening = openingOf(rows, [&](const Join& join) {
      bool touches = false, isThere = true;
      for (const Side& side : join.sides) {
        touches = touches || side.subdomain == cluster_.members[m];
        isThere = isThere && first_.count(place_.at(side.subdomain)) > 0;
      }
      return touches && isThere;
    });
    if (rows == 0 || basis_.columns == 0)
      return;
    // Columns of the basis have length one; motions of long clusters that open a join open it by a small part
    // of that.
    constexpr double zero = 1e-10;
    basis_ =
        combinationsThatVanish(basis_, padded(opening, rows), std::max(rows, basis_.columns), zero * scale_);
  }

  // B₀R of the basis at joins, its columns after each other.
  template<class Which>
  std::vector<double> openingOf(int& rows, Which&& which) const {
    std::vector<std::size_t> chosen, firstImage;
    std::size_t image = 0;
    rows = 0;
    for (std::size_t j = 0; j < cluster_.joins.size(); ++j) {
      if (which(cluster_.joins[j])) {
        chosen.push_back(j);
        firstImage.push_back(image);
        rows += cluster_.joins[j].count;
      }
      image += cluster_.joins[j].sides.size();
    }
    std::vector<double> result(static_cast<std::size_t>(rows) * static_cast<std::size_t>(basis_.columns),
                               0.0);
    for (int c = 0; c < basis_.columns; ++c) {
      std::size_t row = static_cast<std::size_t>(c) * static_cast<std::size_t>(rows);
      for (std::size_t j = 0; j < chosen.size(); ++j) {
        const Join& join = cluster_.joins[chosen[j]];
        const auto columns = static_cast<std::size_t>(join.count);
        for (std::size_t s = 0; s < join.sides.size(); ++s) {
          const std::vector<double>& a = images_[firstImage[j] + s];
          const double* alpha = basis_.column(c) + first_.at(place_.at(join.sides[s].subdomain));
          for (std::size_t k = 0; k * columns < a.size(); ++k)
            for (std::size_t q = 0; q < columns; ++q)
              result[row + q] += a[k * columns + q] * alpha[k];
        }
        row += columns;
      }
    }
    return result;
  }

  // Rows of zeros where there are fewer than columns.
  std::vector<double> padded(const std::vector<double>& image, int rows) const {
    if (rows >= basis_.columns)
      return image;
    std::vector<double> result;
    for (int c = 0; c < basis_.columns; ++c) {
      const auto begin = image.begin() + static_cast<std::ptrdiff_t>(c) * rows;
      result.insert(result.end(), begin, begin + rows);
      result.insert(result.end(), static_cast<std::size_t>(basis_.columns - rows), 0.0);
    }
    return result;
  }

  void requireClosed() const {
    constexpr double closed = 1e-9; // ten times what was taken for zero
    int rows = 0;
    double largest = 0.0;
    for (double value : openingOf(rows, [](const Join&) { return true; }))
      largest = std::max(largest, std::abs(value));
    if (!(largest <= closed * scale_)) {
      const std::string number = std::to_string(system_.subdomain(cluster_.members.front()).number);
      throw NumericalError("the cluster of " + std::to_string(cluster_.members.size()) +
                               " subdomains from subdomain " + number +
                               " on has an inaccurate kernel: it opens joins by " +
                               scientific(largest / std::max(scale_, 1e-300)) +
                               "; use smaller clusters (\"Decomposition/Clusters\")",
                           {{"subdomain", number}});
    }
  }

  const Cluster& cluster_;
  const SubdomainSystem& system_;
  const std::vector<int>& bases_;
  std::map<int, std::size_t> place_;        // of subdomains among the members
  std::vector<std::vector<double>> images_; // of all sides of all joins
  double scale_ = 0.0;
  Kernel basis_;
  std::map<std::size_t, int> first_; // row of the basis, of members that are there
};

// Subdomains with one matrix and kernels of one dimension have the same space of motions, and use one basis.
std::vector<int> basesOf(const SubdomainSystem& system) {
  std::map<std::pair<const LocalMatrix*, int>, int> known;
  std::vector<int> result;
  for (int i = 0; i < system.size(); ++i)
    result.push_back(known.emplace(std::pair(&system.matrix(i), system.kernel(i).columns), i).first->second);
  return result;
}

std::vector<std::array<double, 3>> centresOf(const SubdomainSystem& system) {
  std::vector<std::array<double, 3>> result;
  for (int i = 0; i < system.size(); ++i)
    if (system.subdomain(i).centre)
      result.push_back(*system.subdomain(i).centre);
  if (result.size() < static_cast<std::size_t>(system.size()))
    result.clear();
  return result;
}

// The sum of a hash of each cluster, whatever ranks they are on; small enough for a double to hold it.
double fingerprintOf(const SubdomainSystem& system, const std::vector<Cluster>& clusters) {
  constexpr unsigned long long prime = 1099511628211ULL, offset = 14695981039346656037ULL; // FNV-1a
  constexpr long long most = 1LL << 30;
  long long sum = 0;
  for (const Cluster& cluster : clusters) {
    unsigned long long hash = offset;
    for (int i : cluster.members)
      hash = (hash ^ static_cast<unsigned long long>(system.subdomain(i).number + 1)) * prime;
    sum += static_cast<long long>((hash >> 20) % static_cast<unsigned long long>(most));
  }
  return 1.0 + static_cast<double>(globalSum(*system.comm(), sum) % (most * most / 4));
}

// Pairs of subdomains that meet at a face of so few dofs that it has not all motions.
std::set<std::pair<int, int>> poorFaces(const SubdomainSystem& system, const Places& places) {
  std::set<std::pair<int, int>> result;
  const auto one = [](const Copies&) { return 1.0; };
  for (const auto& [who, dofs] : places) {
    const int motions = system.subdomain(who.front()).motions->columns;
    // Many dofs of one place have all motions but in degenerate cases, which need no more averages.
    constexpr std::size_t enough = 24;
    if (who.size() == 2 && dofs.size() < enough &&
        motionsAt(system, dofs, one).size() < static_cast<std::size_t>(motions) * dofs.size())
      result.emplace(std::min(who[0], who[1]), std::max(who[0], who[1]));
  }
  return result;
}

bool hasPair(const std::set<std::pair<int, int>>& pairs, const std::vector<int>& who) {
  if (pairs.empty())
    return false;
  for (int a : who)
    for (int b : who)
      if (a < b && pairs.count({a, b}) > 0)
        return true;
  return false;
}

// Not where one subdomain alone has all copies, as of ties that close a ring: that joins nothing.
bool isChosen(ClusterOptions::Joins joins, const std::vector<int>& who) {
  if (std::all_of(who.begin(), who.end(), [&](int i) { return i == who.front(); }))
    return false;
  return joins == ClusterOptions::Joins::All || (joins == ClusterOptions::Joins::Faces) == (who.size() == 2);
}

std::vector<Cluster> clustersOf(const SubdomainSystem& system, const Constraints& constraints,
                                const ClusterOptions& options) {
  const Places places = placesOf(wholeDofs(system, constraints));
  std::vector<SubdomainLink> links;
  for (const auto& [who, dofs] : places)
    for (std::size_t a = 0; a < who.size(); ++a)
      for (std::size_t b = a + 1; b < who.size(); ++b)
        if (isChosen(options.joins, who) && who[a] != who[b])
          links.push_back(
              {std::min(who[a], who[b]), std::max(who[a], who[b]), static_cast<int>(dofs.size())});
  std::vector<Cluster> clusters;
  std::vector<std::size_t> clusterOf(static_cast<std::size_t>(system.size()));
  for (std::vector<int>& members :
       partitionIntoClusters(system.size(), links, centresOf(system),
                             options.kind == ClusterOptions::Kind::Size ? options.size : 0)) {
    for (int i : members)
      clusterOf[static_cast<std::size_t>(i)] = clusters.size();
    std::sort(members.begin(), members.end(),
              [&](int a, int b) { return system.subdomain(a).number < system.subdomain(b).number; });
    clusters.push_back({std::move(members), {}, 0, {}, 0});
  }
  const std::set<std::pair<int, int>> poor = options.joins == ClusterOptions::Joins::Faces
                                                 ? poorFaces(system, places)
                                                 : std::set<std::pair<int, int>>();
  for (const auto& [who, dofs] : places) {
    const auto of = [&](int i) { return clusterOf[static_cast<std::size_t>(i)]; };
    if (!std::all_of(who.begin(), who.end(), [&, first = who.front()](int i) { return of(i) == of(first); }))
      continue;
    Cluster& cluster = clusters[of(who.front())];
    if (who.size() == 2 &&
        who.front() != who.back()) { // edges and corners that move along bring hardly a product
      cluster.moves.push_back(moveOf(system, dofs));
      cluster.moves.back().first = cluster.motions;
      cluster.motions += cluster.moves.back().count;
    }
    const bool isJoin = isChosen(options.joins, who) || hasPair(poor, who);
    for (std::size_t level = 0; isJoin && level + 1 < who.size(); ++level) {
      cluster.joins.push_back(joinOf(system, dofs, level));
      cluster.joins.back().first = cluster.averages;
      cluster.averages += cluster.joins.back().count;
    }
  }
  return clusters;
}

} // namespace

std::shared_ptr<const Clusters> makeClusters(const SubdomainSystem& system, const Constraints& constraints,
                                             const ClusterOptions& options) {
  using Kind = ClusterOptions::Kind;
  return options.kind == Kind::Auto || options.kind == Kind::None
             ? nullptr
             : std::make_shared<const Clusters>(system, constraints, options);
}

Clusters::Clusters(const SubdomainSystem& system, const Constraints& constraints,
                   const ClusterOptions& options) {
  std::vector<RigidMotions::Part> parts;
  std::vector<int> bases = basesOf(system);
  agree(*system.comm(), [&] {
    clusters_ = clustersOf(system, constraints, options);
    for (const Cluster& cluster : clusters_) {
      parts.push_back(Growth(cluster, system, bases).grown());
      averagePlaces_.push_back(averagePlaces_.back() + static_cast<std::size_t>(cluster.averages));
    }
  });
  motions_.emplace(system, std::move(parts), std::move(bases));
  fingerprint_ = fingerprintOf(system, clusters_);
}

void Clusters::removeJoined(MultiVector& v) const {
  const auto view = v.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t x = 0; x < view.extent(1); ++x)
    for (const Cluster& cluster : clusters_)
      for (const Join& join : cluster.joins) {
        const std::size_t n = join.rows.size();
        for (std::size_t c = 0; c < join.weights.size(); c += n) {
          double sum = 0.0;
          for (std::size_t k = 0; k < n; ++k)
            sum += join.weights[c + k] * view(static_cast<std::size_t>(join.rows[k]), x);
          for (std::size_t k = 0; k < n; ++k)
            view(static_cast<std::size_t>(join.rows[k]), x) -= sum * join.weights[c + k];
        }
      }
}

void Clusters::addJoined(const std::vector<double>& mu, MultiVector& v) const {
  HARMOS_REQUIRE(mu.size() == averagePlaces_.back(), "a number for each average of this rank");
  const auto view = v.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t c = 0; c < clusters_.size(); ++c)
    for (const Join& join : clusters_[c].joins) {
      const std::size_t n = join.rows.size();
      for (std::size_t q = 0; q < static_cast<std::size_t>(join.count); ++q)
        for (std::size_t k = 0; k < n; ++k)
          view(static_cast<std::size_t>(join.rows[k]), 0) +=
              join.weights[q * n + k] * mu[averagePlaces_[c] + static_cast<std::size_t>(join.first) + q];
    }
}

} // namespace Harmos::feti
