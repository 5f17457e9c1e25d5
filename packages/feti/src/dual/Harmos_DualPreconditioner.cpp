// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DualPreconditioner.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_DualOperator.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_PivotedCholesky.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace Harmos::feti {
namespace {

// An entry of B on its way to the rank that inverts its group.
struct GroupEntry {
  long long group; ///< lowest row of the group
  long long row;
  double value;
  double weight; ///< 1/D of the copy
  int rank, place, dof;
};

// An entry of B_D on its way to the rank of its subdomain.
struct ScaledEntry {
  long long row;
  double value;
  int place, dof;
};

// Whether BBᵀ = I, seen on a vector without structure.
bool hasOrthonormalRows(const SubdomainSystem& system, const Constraints& constraints) {
  MultiVector x(constraints.rowMap(), 1), y(constraints.rowMap(), 1);
  {
    const auto view = x.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) = std::sin(1.0 + 1.3 * static_cast<double>(constraints.rowMap()->getGlobalElement(
                                            static_cast<LocalOrdinal>(r))));
  }
  const std::vector<double> overlap = constraints.toOverlap(x);
  std::vector<double> image(overlap.size(), 0.0), t;
  for (int i = 0; i < system.size(); ++i) {
    t.assign(static_cast<std::size_t>(system.matrix(i).rows()), 0.0);
    constraints.addBt(i, overlap.data(), t.data());
    constraints.addB(i, t.data(), image.data());
  }
  constraints.fromOverlap(image, y);
  y.update(-1.0, x, 1.0);
  std::vector<double> difference(1), norm(1);
  y.normInf(Teuchos::arrayViewFromVector(difference));
  x.normInf(Teuchos::arrayViewFromVector(norm));
  return difference[0] <= 1e-12 * norm[0];
}

// Entries of a subdomain sorted by dof: rows that share a copy stand together.
std::vector<Constraints::Entry> byDof(std::vector<Constraints::Entry> entries) {
  std::sort(entries.begin(), entries.end(),
            [](const auto& a, const auto& b) { return std::tie(a.dof, a.row) < std::tie(b.dof, b.row); });
  return entries;
}

// For each overlapping row the lowest row of its group: rows that share copies, directly or through others.
// The lowest number spreads from neighbour to neighbour until nothing changes.
std::vector<long long> groupOf(const Constraints& constraints,
                               const std::vector<std::vector<Constraints::Entry>>& entries) {
  using Vector = MultiVector;
  const Map& rows = *constraints.rowMap();
  // Tpetra combines by the largest magnitude: the lowest row has the highest rank.
  const auto top = static_cast<double>(constraints.dualDimension());
  Vector mine(constraints.rowMap(), 1), overlap(constraints.overlapMap(), 1);
  {
    const auto view = mine.getLocalViewHost(Tpetra::Access::OverwriteAll);
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, 0) = top - static_cast<double>(rows.getGlobalElement(static_cast<LocalOrdinal>(r)));
  }
  while (true) {
    overlap.doImport(mine, *constraints.importer(), Tpetra::INSERT);
    long long changes = 0;
    {
      const auto view = overlap.getLocalViewHost(Tpetra::Access::ReadWrite);
      for (const std::vector<Constraints::Entry>& list : entries)
        for (std::size_t begin = 0; begin < list.size();) {
          std::size_t end = begin;
          double highest = 0.0;
          for (; end < list.size() && list[end].dof == list[begin].dof; ++end)
            highest = std::max(highest, view(static_cast<std::size_t>(list[end].row), 0));
          for (; begin < end; ++begin) {
            double& label = view(static_cast<std::size_t>(list[begin].row), 0);
            changes += label != highest;
            label = highest;
          }
        }
    }
    if (globalSum(*rows.getComm(), changes) == 0)
      break;
    mine.doExport(overlap, *constraints.importer(), Tpetra::ABSMAX);
  }
  const auto view = overlap.getLocalViewHost(Tpetra::Access::ReadOnly);
  std::vector<long long> result;
  for (std::size_t r = 0; r < view.extent(0); ++r)
    result.push_back(std::llround(top - view(r, 0)));
  return result;
}

// B_D of one group; the entries of B stand in [begin, end).
template<class Iterator>
void scaleGroup(Iterator begin, Iterator end, std::vector<std::vector<ScaledEntry>>& sends) {
  std::map<long long, int> rows;
  std::map<std::tuple<int, int, int>, int> copies;
  for (Iterator e = begin; e != end; ++e) {
    rows.emplace(e->row, 0);
    copies.emplace(std::make_tuple(e->rank, e->place, e->dof), 0);
  }
  int count = 0;
  for (auto& row : rows)
    row.second = count++;
  count = 0;
  for (auto& copy : copies)
    copy.second = count++;
  const std::size_t m = rows.size(), n = copies.size();
  std::vector<char> isByDiagonal(m, m > static_cast<std::size_t>(DualPreconditioner::mostRows) ? 1 : 0);
  const auto addByDiagonal = [&] {
    std::vector<double> diagonal(m, 0.0);
    for (Iterator e = begin; e != end; ++e)
      diagonal[static_cast<std::size_t>(rows[e->row])] += e->value * e->value * e->weight;
    for (Iterator e = begin; e != end; ++e)
      if (const auto row = static_cast<std::size_t>(rows[e->row]); isByDiagonal[row] != 0)
        sends[static_cast<std::size_t>(e->rank)].push_back(
            {e->row, e->value * e->weight / diagonal[row], e->place, e->dof});
  };
  if (m > static_cast<std::size_t>(DualPreconditioner::mostRows))
    return addByDiagonal();
  std::vector<double> b(m * n, 0.0), weighted(m * n, 0.0), w(m * m, 0.0); // by columns
  for (Iterator e = begin; e != end; ++e) {
    const std::size_t place = static_cast<std::size_t>(copies[{e->rank, e->place, e->dof}]) * m +
                              static_cast<std::size_t>(rows[e->row]);
    b[place] += e->value;
    weighted[place] += e->value * e->weight;
  }
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t q = 0; q < m; ++q)
      for (std::size_t p = 0; p < m; ++p)
        w[q * m + p] += b[j * m + p] * weighted[j * m + q];
  const PivotedCholesky factor(std::move(w), static_cast<int>(m));
  // Rows that depend on others, as where a held edge is in contact with a coarser surface, would be none to
  // M: a residual there would never fall.
  for (std::size_t k = static_cast<std::size_t>(factor.rank()); k < m; ++k)
    isByDiagonal[static_cast<std::size_t>(factor.pivots()[k])] = 1;
  addByDiagonal();
  for (const auto& [copy, j] : copies) {
    const auto first = weighted.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(j) * m);
    const std::vector<double> column = factor.solve({first, first + static_cast<std::ptrdiff_t>(m)});
    double largest = 0.0;
    for (double value : column)
      largest = std::max(largest, std::abs(value));
    for (const auto& [row, p] : rows)
      if (const double value = column[static_cast<std::size_t>(p)];
          std::abs(value) > 100.0 * std::numeric_limits<double>::epsilon() * largest)
        sends[static_cast<std::size_t>(std::get<0>(copy))].push_back(
            {row, value, std::get<1>(copy), std::get<2>(copy)});
  }
}

std::vector<SubdomainSum::Group> makeGroups(const SubdomainSystem& system, const LocalInverses& inverses,
                                            const ScaledConstraints& scaled, PreconditionerKind kind) {
  std::vector<SubdomainSum::Group> groups;
  for (std::size_t c = 0; c < inverses.classes().size(); ++c) {
    const CongruenceClass& item = inverses.classes()[c];
    SubdomainSum::Group group;
    if (kind == PreconditionerKind::Dirichlet)
      group.op = inverses.inverse(c).schurComplement();
    else
      group.op = std::make_shared<SparseOperator>(system.matrix(item.members.front()), item.boundary);
    group.members = static_cast<int>(item.members.size());
    group.entries = boundaryEntries(scaled.entries, item);
    groups.push_back(std::move(group));
  }
  return groups;
}

} // namespace

namespace {

// B_D without T.
ScaledConstraints rigidConstraints(const SubdomainSystem& system, const Constraints& constraints,
                                   PreconditionerScaling scaling) {
  const Teuchos::Comm<int>& comm = *system.comm();
  std::vector<std::vector<Constraints::Entry>> entries;
  if (scaling == PreconditionerScaling::Multiplicity && hasOrthonormalRows(system, constraints)) {
    for (int i = 0; i < system.size(); ++i)
      entries.push_back(constraints.entries(i));
    return {constraints.importer(), entries};
  }
  for (int i = 0; i < system.size(); ++i)
    entries.push_back(byDof(constraints.entries(i)));
  const std::vector<long long> group = groupOf(constraints, entries);

  // Each group is dealt with where its lowest row is owned.
  std::vector<long long> distinct = group;
  std::sort(distinct.begin(), distinct.end());
  distinct.erase(std::unique(distinct.begin(), distinct.end()), distinct.end());
  Teuchos::Array<GlobalOrdinal> lowest(distinct.begin(), distinct.end());
  Teuchos::Array<int> owners(lowest.size());
  constraints.rowMap()->getRemoteIndexList(lowest(), owners());
  std::vector<std::vector<GroupEntry>> sends(static_cast<std::size_t>(comm.getSize()));
  for (int i = 0; i < system.size(); ++i) {
    const std::vector<double>& diagonal = system.diagonal(i);
    for (const Constraints::Entry& entry : entries[static_cast<std::size_t>(i)]) {
      const long long label = group[static_cast<std::size_t>(entry.row)];
      const auto place = std::lower_bound(distinct.begin(), distinct.end(), label) - distinct.begin();
      const double weight = scaling == PreconditionerScaling::Stiffness
                                ? 1.0 / diagonal[static_cast<std::size_t>(entry.dof)]
                                : 1.0;
      sends[static_cast<std::size_t>(owners[place])].push_back(
          {label, static_cast<long long>(constraints.overlapMap()->getGlobalElement(entry.row)), entry.value,
           weight, comm.getRank(), i, entry.dof});
    }
  }
  std::vector<GroupEntry> arrived;
  for (const std::vector<GroupEntry>& part : exchangeItems(comm, sends))
    arrived.insert(arrived.end(), part.begin(), part.end());
  std::stable_sort(arrived.begin(), arrived.end(),
                   [](const GroupEntry& a, const GroupEntry& b) { return a.group < b.group; });
  std::vector<std::vector<ScaledEntry>> answers(static_cast<std::size_t>(comm.getSize()));
  agree(comm, [&] {
    for (auto begin = arrived.begin(); begin != arrived.end();) {
      const auto end = std::find_if(begin, arrived.end(),
                                    [&](const GroupEntry& entry) { return entry.group != begin->group; });
      scaleGroup(begin, end, answers);
      begin = end;
    }
  });

  const std::vector<std::vector<ScaledEntry>> scaled = exchangeItems(comm, answers);
  std::vector<long long> rows;
  for (const std::vector<ScaledEntry>& part : scaled)
    for (const ScaledEntry& entry : part)
      rows.push_back(entry.row);
  std::sort(rows.begin(), rows.end());
  rows.erase(std::unique(rows.begin(), rows.end()), rows.end());
  ScaledConstraints result;
  result.entries.resize(static_cast<std::size_t>(system.size()));
  for (const std::vector<ScaledEntry>& part : scaled)
    for (const ScaledEntry& entry : part)
      result.entries[static_cast<std::size_t>(entry.place)].push_back(
          {static_cast<int>(std::lower_bound(rows.begin(), rows.end(), entry.row) - rows.begin()), entry.dof,
           entry.value});
  for (std::vector<Constraints::Entry>& list : result.entries)
    std::sort(list.begin(), list.end(),
              [](const auto& a, const auto& b) { return std::tie(a.row, a.dof) < std::tie(b.row, b.dof); });
  const Teuchos::Array<GlobalOrdinal> touched(rows.begin(), rows.end());
  const auto map = Teuchos::rcp(
      new Map(Teuchos::OrdinalTraits<Tpetra::global_size_t>::invalid(), touched(), 0, system.comm()));
  result.importer = Teuchos::rcp(new Import(constraints.rowMap(), map));
  return result;
}

// T² = q/(q + C) of owned rows.
MultiVector sharesOfStiffness(const SubdomainSystem& system, const Constraints& constraints) {
  std::vector<double> overlap(localSize(*constraints.overlapMap()), 0.0);
  for (int i = 0; i < system.size(); ++i) {
    const std::vector<double>& diagonal = system.diagonal(i);
    for (const Constraints::Entry& entry : constraints.entries(i))
      overlap[static_cast<std::size_t>(entry.row)] +=
          entry.value * entry.value / diagonal[static_cast<std::size_t>(entry.dof)];
  }
  MultiVector shares(constraints.rowMap(), 1);
  constraints.fromOverlap(overlap, shares);
  const auto view = shares.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < view.extent(0); ++r) {
    const double compliance = constraints.compliance(static_cast<int>(r));
    view(r, 0) = compliance > 0.0 ? view(r, 0) / (view(r, 0) + compliance) : 1.0;
  }
  return shares;
}

} // namespace

ScaledConstraints scaledConstraints(const SubdomainSystem& system, const Constraints& constraints,
                                    PreconditionerScaling scaling) {
  ScaledConstraints result = rigidConstraints(system, constraints, scaling);
  if (!constraints.hasCompliance())
    return result;
  MultiVector touched(result.importer->getTargetMap(), 1);
  touched.doImport(sharesOfStiffness(system, constraints), *result.importer, Tpetra::INSERT);
  const auto shares = touched.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::vector<Constraints::Entry>& list : result.entries)
    for (Constraints::Entry& entry : list)
      entry.value *= std::sqrt(shares(static_cast<std::size_t>(entry.row), 0));
  return result;
}

namespace {

SubdomainSum makeSum(const SubdomainSystem& system, const Constraints& constraints,
                     const LocalInverses& inverses, PreconditionerKind kind, PreconditionerScaling scaling) {
  HARMOS_REQUIRE(kind != PreconditionerKind::None, "there is no preconditioner to be made");
  const ScaledConstraints scaled = scaledConstraints(system, constraints, scaling);
  std::vector<SubdomainSum::Group> groups;
  std::shared_ptr<const ClusterInverse> joined;
  agree(*system.comm(), [&] {
    groups = makeGroups(system, inverses, scaled, kind);
    if (inverses.joined() == nullptr)
      return;
    std::vector<ClusterInverse::Group> members;
    for (std::size_t c = 0; c < groups.size(); ++c)
      members.push_back({inverses.classes()[c].members, inverses.classes()[c].boundary, groups[c].op.get()});
    joined = std::make_shared<const ClusterInverse>(inverses.joined()->sharedClusters(), members,
                                                    ClusterInverse::Role::Preconditioner);
  });
  return SubdomainSum(scaled.importer, std::move(groups), std::move(joined));
}

} // namespace

DualPreconditioner::DualPreconditioner(const SubdomainSystem& system, const Constraints& constraints,
                                       const LocalInverses& inverses, PreconditionerKind kind,
                                       PreconditionerScaling scaling)
    : SubdomainSum(makeSum(system, constraints, inverses, kind, scaling)),
      kind_(kind),
      clusters_(inverses.joined() != nullptr ? inverses.joined()->sharedClusters() : nullptr) {
  if (!constraints.hasCompliance())
    return;
  const MultiVector shares = sharesOfStiffness(system, constraints);
  const auto view = shares.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (std::size_t r = 0; r < view.extent(0); ++r) {
    const double compliance = constraints.compliance(static_cast<int>(r));
    ofRows_.push_back(compliance > 0.0 ? std::pow(1.0 - view(r, 0), 2) / compliance : 0.0);
  }
}

void DualPreconditioner::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp mode, Scalar alpha,
                               Scalar beta) const {
  SubdomainSum::apply(X, Y, mode, alpha, beta);
  if (clusters_)
    clusters_->removeJoined(Y);
  if (ofRows_.empty())
    return;
  const auto x = X.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto y = Y.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t r = 0; r < y.extent(0); ++r)
    for (std::size_t k = 0; k < y.extent(1); ++k)
      y(r, k) += alpha * ofRows_[r] * x(r, k);
}

} // namespace Harmos::feti
