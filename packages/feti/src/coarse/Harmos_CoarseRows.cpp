// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseRows.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Map.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>
#include <tuple>

namespace Harmos::feti {
namespace {

struct CoarseEntry {
  long long row;
  double value;
  int column;
};

struct PartEntry {
  int row; // overlapping
  double value;
  std::size_t column; // of the part
};

// What subdomains add to rows of BR, and bounds of the rounding errors, by the columns of their part.
struct Addends {
  std::vector<int> rows;             // overlapping
  std::vector<double> values, sizes; // by columns for each of them
};

void addAddends(const RigidMotions& motions, const Constraints& constraints, int part, std::size_t member,
                int subdomain, Addends& to) {
  const Kernel& kernel = motions.kernel(subdomain);
  const std::vector<Constraints::Entry>& entries = constraints.entries(subdomain);
  std::vector<double> largest(static_cast<std::size_t>(kernel.columns), 0.0), values(largest), sizes(largest);
  for (int k = 0; k < kernel.columns; ++k)
    for (int j = 0; j < kernel.rows; ++j)
      largest[static_cast<std::size_t>(k)] =
          std::max(largest[static_cast<std::size_t>(k)], std::abs(kernel.column(k)[j]));
  const auto append = [&](std::vector<double>& all, const std::vector<double>& mine, bool absolute) {
    if (motions.areOfSubdomains()) {
      all.insert(all.end(), mine.begin(), mine.end());
      return;
    }
    const std::vector<double> moved = motions.ofPart(part, member, mine.data(), absolute);
    all.insert(all.end(), moved.begin(), moved.end());
  };
  for (std::size_t begin = 0; begin < entries.size();) {
    std::size_t end = begin;
    double size = 0.0;
    for (; end < entries.size() && entries[end].row == entries[begin].row; ++end)
      size += std::abs(entries[end].value);
    for (int k = 0; k < kernel.columns; ++k) {
      double value = 0.0;
      for (std::size_t e = begin; e < end; ++e)
        value += entries[e].value * kernel.column(k)[entries[e].dof];
      values[static_cast<std::size_t>(k)] = value;
      sizes[static_cast<std::size_t>(k)] = size * largest[static_cast<std::size_t>(k)];
    }
    to.rows.push_back(entries[begin].row);
    append(to.values, values, false);
    append(to.sizes, sizes, true);
    begin = end;
  }
}

// A motion along a surface leaves rounding errors there, which hold nothing; where nothing else holds it,
// they would be the largest entries of all. So do those of a cluster at rows within it, which are known to
// what it is closed to.
std::vector<PartEntry> entriesOfPart(const RigidMotions& motions, const Constraints& constraints, int part) {
  constexpr double unit = 1e2 * std::numeric_limits<double>::epsilon();
  constexpr double closed = 1e-11;
  const std::vector<int> members = motions.members(part);
  Addends addends;
  for (std::size_t m = 0; m < members.size(); ++m)
    addAddends(motions, constraints, part, m, members[m], addends);
  std::vector<std::size_t> order(addends.rows.size());
  std::iota(order.begin(), order.end(), 0);
  if (members.size() > 1)
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return addends.rows[a] < addends.rows[b]; });
  const double rounding = members.size() > 1 ? closed : unit;
  const auto place = static_cast<std::size_t>(part);
  const std::size_t columns = motions.places()[place + 1] - motions.places()[place];
  std::vector<PartEntry> result;
  for (auto first = order.begin(); first != order.end();) {
    const int row = addends.rows[*first];
    const auto last = std::find_if(first, order.end(), [&](std::size_t k) { return addends.rows[k] != row; });
    for (std::size_t c = 0; c < columns; ++c) {
      double value = 0.0, size = 0.0;
      for (auto k = first; k != last; ++k) {
        value += addends.values[*k * columns + c];
        size += addends.sizes[*k * columns + c];
      }
      if (std::abs(value) > rounding * size)
        result.push_back({row, value, c});
    }
    first = last;
  }
  return result;
}

} // namespace

CoarseRows::CoarseRows(const RigidMotions& motions, const Constraints& constraints) {
  const Teuchos::Comm<int>& comm = *motions.system().comm();
  // Each part makes its rows of G̃; the entries go to the ranks that own the dual rows.
  std::vector<std::vector<CoarseEntry>> sends(static_cast<std::size_t>(comm.getSize()));
  for (int p = 0; p < motions.parts(); ++p)
    for (const PartEntry& entry : entriesOfPart(motions, constraints, p))
      sends[static_cast<std::size_t>(constraints.overlapOwner(entry.row))].push_back(
          {static_cast<long long>(constraints.overlapMap()->getGlobalElement(entry.row)), entry.value,
           motions.ownColumns()[motions.places()[static_cast<std::size_t>(p)] + entry.column]});
  std::vector<std::pair<int, CoarseEntry>> owned; // with local rows
  for (const std::vector<CoarseEntry>& part : exchangeItems(comm, sends))
    for (const CoarseEntry& entry : part)
      owned.emplace_back(constraints.rowMap()->getLocalElement(static_cast<GlobalOrdinal>(entry.row)), entry);
  std::sort(owned.begin(), owned.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.column) < std::tie(b.first, b.second.column);
  });
  for (const auto& [row, entry] : owned) {
    offsets_.resize(static_cast<std::size_t>(row) + 1, columns_.size());
    columns_.push_back(entry.column);
    values_.push_back(entry.value);
  }
  offsets_.resize(localSize(*constraints.rowMap()) + 1, columns_.size());

  padPairs(constraints);
  makePattern();
}

// Both rows of a disc get entries at the same columns, for slips are sums of them.
void CoarseRows::padPairs(const Constraints& constraints) {
  if (constraints.pairs().empty())
    return;
  std::vector<std::vector<int>> missing(offsets_.size() - 1);
  const auto columnsOf = [this](int row) {
    const auto r = static_cast<std::size_t>(row);
    return std::pair(columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r]),
                     columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r + 1]));
  };
  for (const auto& [first, second] : constraints.pairs())
    for (const auto& [row, other] : {std::pair(first, second), std::pair(second, first)}) {
      const auto [begin, end] = columnsOf(row);
      const auto [otherBegin, otherEnd] = columnsOf(other);
      std::set_difference(otherBegin, otherEnd, begin, end,
                          std::back_inserter(missing[static_cast<std::size_t>(row)]));
    }
  std::vector<std::size_t> offsets = {0};
  std::vector<int> columns;
  std::vector<double> values;
  std::vector<std::pair<int, double>> row;
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r) {
    row.clear();
    for (std::size_t k = offsets_[r]; k < offsets_[r + 1]; ++k)
      row.emplace_back(columns_[k], values_[k]);
    for (int column : missing[r])
      row.emplace_back(column, 0.0);
    std::sort(row.begin(), row.end());
    for (const auto& [column, value] : row) {
      columns.push_back(column);
      values.push_back(value);
    }
    offsets.push_back(columns.size());
  }
  offsets_.swap(offsets);
  columns_.swap(columns);
  values_.swap(values);
}

// Rows of an interface touch the same motions: what they fill is looked
// up once for all of them.
void CoarseRows::makePattern() {
  std::map<std::vector<int>, std::size_t> patterns; // and where the places of their pairs begin
  std::vector<std::pair<int, int>> mine;
  std::vector<int> touched, before;
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r) {
    touched.assign(columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r]),
                   columns_.begin() + static_cast<std::ptrdiff_t>(offsets_[r + 1]));
    if (r > 0 && touched == before) {
      firstPlace_.push_back(firstPlace_.back());
      continue;
    }
    const auto [known, isNew] = patterns.emplace(touched, mine.size());
    firstPlace_.push_back(known->second);
    if (isNew)
      for (std::size_t i = 0; i < touched.size(); ++i)
        for (std::size_t j = 0; j <= i; ++j) // columns of a row rise
          mine.emplace_back(touched[i], touched[j]);
    before.swap(touched);
  }
  places_ = mine;
  std::sort(places_.begin(), places_.end());
  places_.erase(std::unique(places_.begin(), places_.end()), places_.end());
  for (const auto& pair : mine)
    gramPlaces_.push_back(
        static_cast<int>(std::lower_bound(places_.begin(), places_.end(), pair) - places_.begin()));
}

template<class Real>
std::vector<Real> CoarseRows::gram(const double* mask, const std::vector<qp::Slip>& slipping,
                                   double q) const {
  std::vector<Real> values(places_.size(), 0.0);
  std::vector<double> along;
  for (const qp::Slip& slip : slipping) {
    const double weight = q > 0.0 ? std::sqrt(q / (q + slip.curvature)) : 1.0;
    const auto first = static_cast<std::size_t>(slip.first), second = static_cast<std::size_t>(slip.second);
    along.clear();
    for (std::size_t k = 0; k < offsets_[first + 1] - offsets_[first]; ++k)
      along.push_back(weight * (-slip.normal[1] * values_[offsets_[first] + k] +
                                slip.normal[0] * values_[offsets_[second] + k]));
    std::size_t pair = firstPlace_[first];
    for (std::size_t i = 0; i < along.size(); ++i)
      for (std::size_t j = 0; j <= i; ++j, ++pair)
        values[static_cast<std::size_t>(gramPlaces_[pair])] += static_cast<Real>(along[i]) * along[j];
  }
  for (std::size_t r = 0; r + 1 < offsets_.size(); ++r) {
    if (mask != nullptr && mask[r] == 0.0)
      continue;
    const double weight = mask == nullptr ? 1.0 : mask[r];
    std::size_t pair = firstPlace_[r];
    for (std::size_t i = offsets_[r]; i < offsets_[r + 1]; ++i)
      for (std::size_t j = offsets_[r]; j <= i; ++j, ++pair)
        values[static_cast<std::size_t>(gramPlaces_[pair])] +=
            weight * (static_cast<Real>(values_[i]) * values_[j]);
  }
  return values;
}

template std::vector<double> CoarseRows::gram(const double*, const std::vector<qp::Slip>&, double) const;
template std::vector<long double> CoarseRows::gram(const double*, const std::vector<qp::Slip>&, double) const;

} // namespace Harmos::feti
