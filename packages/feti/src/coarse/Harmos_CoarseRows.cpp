// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_CoarseRows.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <tuple>

namespace Harmos::feti {
namespace {

struct CoarseEntry {
  long long row;
  double value;
  int column;
};

} // namespace

CoarseRows::CoarseRows(const SubdomainSystem& system, const Constraints& constraints) {
  const Teuchos::Comm<int>& comm = *system.comm();
  // Each subdomain makes its rows of G̃; the entries go to the ranks that own the dual rows. A motion along a
  // surface leaves rounding errors there, which hold nothing; where nothing else holds it, they would be the
  // largest entries of all.
  constexpr double rounding = 1e2 * std::numeric_limits<double>::epsilon();
  std::vector<std::vector<CoarseEntry>> sends(static_cast<std::size_t>(comm.getSize()));
  for (int i = 0; i < system.size(); ++i) {
    const Kernel& kernel = system.kernel(i);
    const std::vector<Constraints::Entry>& entries = constraints.entries(i);
    std::vector<double> largest(static_cast<std::size_t>(kernel.columns), 0.0);
    for (int k = 0; k < kernel.columns; ++k)
      for (int j = 0; j < kernel.rows; ++j)
        largest[static_cast<std::size_t>(k)] =
            std::max(largest[static_cast<std::size_t>(k)], std::abs(kernel.column(k)[j]));
    for (std::size_t begin = 0; begin < entries.size();) {
      std::size_t end = begin;
      while (end < entries.size() && entries[end].row == entries[begin].row)
        ++end;
      double size = 0.0;
      for (std::size_t e = begin; e < end; ++e)
        size += std::abs(entries[e].value);
      for (int k = 0; k < kernel.columns; ++k) {
        double value = 0.0;
        for (std::size_t e = begin; e < end; ++e)
          value += entries[e].value * kernel.column(k)[entries[e].dof];
        if (std::abs(value) > rounding * size * largest[static_cast<std::size_t>(k)])
          sends[static_cast<std::size_t>(constraints.overlapOwner(entries[begin].row))].push_back(
              {static_cast<long long>(constraints.overlapMap()->getGlobalElement(entries[begin].row)), value,
               system.kernelOffset(i) + k});
      }
      begin = end;
    }
  }
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
