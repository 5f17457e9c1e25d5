// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RowConditions.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>
#include <utility>

namespace Harmos::feti {
namespace {

// Places of the rows of each disc among those that are sorted.
std::vector<std::array<int, 2>> pairsOf(const std::vector<RowCondition>& rows) {
  std::map<long long, std::vector<int>> places;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].disc >= 0)
      places[rows[r].disc].push_back(static_cast<int>(r));
  std::vector<std::array<int, 2>> pairs;
  for (const auto& item : places) {
    HARMOS_REQUIRE(item.second.size() == 2, "a disc has not two rows on the rank that owns them");
    pairs.push_back({item.second[0], item.second[1]});
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

// By local rows; of a disc its first row. Inequalities have the lowest numbers, and keep them.
std::vector<RowConditions::Follower> followersAmong(const std::vector<RowCondition>& rows,
                                                    const std::vector<std::array<int, 2>>& discs) {
  std::vector<RowConditions::Follower> result;
  std::unordered_map<long long, int> placeOf;
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (rows[r].type == RowType::Inequality)
      placeOf.emplace(rows[r].number, static_cast<int>(r));
  std::size_t disc = 0;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const bool isFirst = disc < discs.size() && discs[disc][0] == static_cast<int>(r);
    const RowCondition& row = rows[r];
    if (row.normal >= 0 && row.softness < 0.0 && (row.disc < 0 || isFirst)) {
      const int normal = placeOf.at(row.normal);
      if (rows[static_cast<std::size_t>(normal)].softness >= 0.0)
        throw InputError("a limit follows the force of inequality " + std::to_string(row.normal) +
                             ", which is soft and can pull; give softness to both rows or to none",
                         {{"row", std::to_string(row.normal)}});
      // λ = scale · that of the scaled row
      const double factor = row.coefficient * rows[static_cast<std::size_t>(normal)].scale / row.scale;
      result.push_back({static_cast<int>(r), isFirst ? static_cast<int>(disc) : -1, normal, factor});
    }
    disc += isFirst ? 1 : 0;
  }
  return result;
}

} // namespace

RowConditions::RowConditions(const Teuchos::Comm<int>& comm, std::vector<RowCondition> rows,
                             long long inequalities, long long limited, double rounding2)
    : rows_(std::move(rows)), pairs_(pairsOf(rows_)), inequalities_(inequalities), limited_(limited) {
  count(comm);
  if (limited_ > 0) {
    agree(comm, [&] { followers_ = followersAmong(rows_, discs_); });
    followerCount_ = globalSum(comm, static_cast<long long>(followers_.size()));
  }
  boundRounding_ = std::sqrt(globalSum(comm, rounding2));
}

// What there is on any rank; and discs, which soft pairs are not.
void RowConditions::count(const Teuchos::Comm<int>& comm) {
  long long isSoftOne = 0, isCompliantOne = 0, open = 0, softLimited = 0;
  for (const RowCondition& row : rows_) {
    isCompliantOne |= row.compliance > 0.0 ? 1 : 0;
    open += row.status == ConstraintRow::Status::Open ? 1 : 0;
    if (row.softness >= 0.0) {
      isSoftOne = 1;
      softLimited += row.type == RowType::Limited ? 1 : 0;
    }
  }
  openCount_ = globalSum(comm, open);
  hasCompliance_ = globalMax(comm, isCompliantOne) > 0;
  hasSoft_ = globalMax(comm, isSoftOne) > 0;
  softLimited_ = hasSoft_ ? globalSum(comm, softLimited) : 0;
  for (const std::array<int, 2>& pair : pairs_)
    if (!isSoft(pair[0]))
      discs_.push_back(pair);
  discCount_ = limited_ > 0 ? globalSum(comm, static_cast<long long>(discs_.size())) : 0;
}

bool RowConditions::areOfOneKind(const RowConditions& other) const {
  return pairs_ == other.pairs_ &&
         std::equal(rows_.begin(), rows_.end(), other.rows_.begin(), other.rows_.end(),
                    [](const RowCondition& a, const RowCondition& b) {
                      return a.number == b.number && a.type == b.type && a.scale == b.scale &&
                             a.compliance == b.compliance;
                    });
}

void RowConditions::change(const Teuchos::Comm<int>& comm, const std::vector<Change>& changes,
                           double rounding2) {
  std::vector<double> sums = {0.0, rounding2}; // open contacts
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    rows_[r].bound = changes[r].bound;
    rows_[r].status = changes[r].status;
    sums[0] += changes[r].status == ConstraintRow::Status::Open ? 1.0 : 0.0;
  }
  globalSum(comm, sums);
  openCount_ = static_cast<long long>(sums[0]);
  boundRounding_ = std::sqrt(sums[1]);
}

std::vector<double> RowConditions::limits(const MultiVector& lambda) const {
  std::vector<double> result;
  for (const RowCondition& row : rows_)
    result.push_back(row.limit);
  if (followers_.empty())
    return result;
  const auto forces = lambda.getLocalViewHost(Tpetra::Access::ReadOnly);
  for (const Follower& follower : followers_) {
    const double limit =
        follower.factor * std::max(0.0, forces(static_cast<std::size_t>(follower.normal), 0));
    result[static_cast<std::size_t>(follower.row)] = limit;
    if (follower.disc >= 0)
      result[static_cast<std::size_t>(discs_[static_cast<std::size_t>(follower.disc)][1])] = limit;
  }
  return result;
}

} // namespace Harmos::feti
