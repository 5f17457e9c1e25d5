// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DistributedFactor.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <Teuchos_BLAS.hpp>
#include <Teuchos_DefaultMpiComm.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace Harmos::feti {
namespace {

MPI_Comm rawOf(const Teuchos::Comm<int>& comm) {
  const auto* mpi = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm);
  if (mpi == nullptr)
    return MPI_COMM_SELF;
  return *mpi->getRawMpiComm();
}

std::shared_ptr<MPI_Comm> split(MPI_Comm world, int color, int key) {
  auto* part = new MPI_Comm(MPI_COMM_NULL);
  MPI_Comm_split(world, color, key, part);
  return {part, [](MPI_Comm* comm) {
            int isOver = 0;
            MPI_Finalized(&isOver);
            if (isOver == 0)
              MPI_Comm_free(comm);
            delete comm;
          }};
}

} // namespace

DistributedGraph::DistributedGraph(Teuchos::RCP<const Teuchos::Comm<int>> comm, int own,
                                   const std::vector<std::pair<int, int>>& entries, int groupRanks)
    : comm_(std::move(comm)), world_(rawOf(*comm_)) {
  const int ranks = comm_->getSize(), rank = comm_->getRank();
  groups_ = std::max(1, ranks / std::max(1, groupRanks));
  // Group g has the ranks r with r·groups / ranks = g.
  const auto groupOf = [&](int r) { return static_cast<int>(static_cast<long long>(r) * groups_ / ranks); };
  const auto firstOf = [&](int g) {
    return static_cast<int>((static_cast<long long>(g) * ranks + groups_ - 1) / groups_);
  };
  group_ = split(world_, groupOf(rank), rank);
  firstOfGroup_ = firstOf(groupOf(rank));
  MPI_Comm_rank(*group_, &groupRank_);
  MPI_Comm_size(*group_, &groupSize_);

  counts_.resize(static_cast<std::size_t>(ranks));
  MPI_Allgather(&own, 1, MPI_INT, counts_.data(), 1, MPI_INT, world_);
  firsts_ = {0};
  for (int count : counts_)
    firsts_.push_back(firsts_.back() + count);

  struct Place {
    int row, column;
  };
  std::vector<Place> mine;
  for (const auto& [row, column] : entries)
    mine.push_back({row, column});
  for (int k = 0; k < own; ++k)
    mine.push_back({first() + k, first() + k});
  entries_ = entries.size();
  for (int g = 0; g < groups_; ++g)
    targets_.push_back(firstOf(g) + rank % (firstOf(g + 1) - firstOf(g)));
  std::vector<std::vector<Place>> sends(static_cast<std::size_t>(ranks));
  for (int target : targets_)
    sends[static_cast<std::size_t>(target)] = mine;
  for (const std::vector<Place>& part : exchangeItems(*comm_, sends))
    for (const Place& place : part) {
      rows_.push_back(place.row + 1);
      columns_.push_back(place.column + 1);
    }
}

int DistributedGraph::mostOwn() const {
  return *std::max_element(counts_.begin(), counts_.end());
}

std::vector<double> DistributedGraph::share(const std::vector<double>& values,
                                            const std::vector<int>& leftOut, double unit) const {
  HARMOS_REQUIRE(values.size() == entries_, "values are those of the entries of the graph");
  std::vector<double> mine = values;
  for (int k = 0; k < own(); ++k)
    mine.push_back(std::binary_search(leftOut.begin(), leftOut.end(), first() + k) ? unit : 0.0);
  std::vector<std::vector<double>> sends(static_cast<std::size_t>(comm_->getSize()));
  for (int target : targets_)
    sends[static_cast<std::size_t>(target)] = mine;
  const std::vector<std::vector<double>> arrived = exchangeItems(*comm_, sends);
  std::vector<double> shared;
  for (std::size_t r = 0; r < arrived.size(); ++r) {
    const std::size_t begin = shared.size(), count = arrived[r].size();
    shared.insert(shared.end(), arrived[r].begin(), arrived[r].end());
    // What is left out has no entries but those that were added for its diagonal, at the end of each part.
    if (leftOut.empty() || count == 0)
      continue;
    for (std::size_t k = 0; k + static_cast<std::size_t>(counts_[r]) < count; ++k)
      if (std::binary_search(leftOut.begin(), leftOut.end(), rows_[begin + k] - 1) ||
          std::binary_search(leftOut.begin(), leftOut.end(), columns_[begin + k] - 1))
        shared[begin + k] = 0.0;
  }
  return shared;
}

std::vector<double> DistributedGraph::gather(const std::vector<double>& own) const {
  std::vector<double> all(static_cast<std::size_t>(order()));
  MPI_Allgatherv(own.data(), static_cast<int>(own.size()), MPI_DOUBLE, all.data(), counts_.data(),
                 firsts_.data(), MPI_DOUBLE, world_);
  return all;
}

std::vector<double> DistributedGraph::gather(const std::vector<double>& own,
                                             std::vector<double>& sums) const {
  if (sums.empty())
    return gather(own);
  const std::size_t more = sums.size();
  std::vector<double> mine = own, all(static_cast<std::size_t>(order()));
  mine.insert(mine.end(), sums.begin(), sums.end());
  std::vector<int> counts, firsts;
  for (std::size_t r = 0; r < counts_.size(); ++r) {
    counts.push_back(counts_[r] + static_cast<int>(more));
    firsts.push_back(firsts_[r] + static_cast<int>(r * more));
  }
  std::vector<double> parts(all.size() + counts_.size() * more);
  MPI_Allgatherv(mine.data(), static_cast<int>(mine.size()), MPI_DOUBLE, parts.data(), counts.data(),
                 firsts.data(), MPI_DOUBLE, world_);
  std::fill(sums.begin(), sums.end(), 0.0);
  for (std::size_t r = 0; r < counts_.size(); ++r) {
    const auto begin = parts.begin() + firsts[r], end = begin + counts_[r];
    std::copy(begin, end, all.begin() + firsts_[r]);
    for (std::size_t k = 0; k < more; ++k)
      sums[k] += end[static_cast<std::ptrdiff_t>(k)];
  }
  return all;
}

DistributedFactor::DistributedFactor(const DistributedGraph& graph, const std::vector<double>& values,
                                     const Options& options)
    : graph_(graph), leftOut_(options.leftOut), form_(options.form) {
  if (graph_.order() == 0)
    return;
  factor(values, options.threshold);
  // Groups need not come to the same end, see nullRows(). What is left out then leaves a definite matrix.
  const std::vector<int> found = nullRows();
  if (!found.empty()) {
    std::vector<int> all;
    std::set_union(leftOut_.begin(), leftOut_.end(), found.begin(), found.end(), std::back_inserter(all));
    leftOut_.swap(all);
    factor(values, 0.0);
  }
  if (options.threshold > 0.0)
    leaveOutWeakRows(values, options.threshold);
  entries_ = mumps_->statistics().factorEntries;
  constexpr double mebi = 1024.0 * 1024.0;
  bytes_ = mebi * mumps_->statistics().memoryMiB / graph_.groupSize();
  if (form_ == Form::Rows) {
    makeRows();
    mumps_.reset();
    bytes_ = 8.0 * static_cast<double>(inverse_.size());
  }
}

bool DistributedFactor::isLeftOut(int row) const {
  return std::binary_search(leftOut_.begin(), leftOut_.end(), row);
}

void DistributedFactor::factor(const std::vector<double>& values, double threshold) {
  double largest = 0.0;
  for (double value : values)
    largest = std::max(largest, std::abs(value));
  largest = globalMax(graph_.comm(), largest);
  std::vector<double> shared = graph_.share(values, leftOut_, largest > 0.0 ? largest : 1.0);
  agree(graph_.comm(), [&] {
    MumpsOptions options;
    options.symmetry = MumpsOptions::Symmetry::Symmetric;
    options.isDistributed = true;
    options.nullPivotThreshold = threshold;
    if (!graph_.ordering().empty())
      options.ordering = MumpsOptions::Ordering::Given;
    mumps_ = std::make_unique<Mumps>(graph_.group(), options);
    int hasOrdering = graph_.ordering().empty() ? 0 : 1; // the first rank's counts for the group
    MPI_Bcast(&hasOrdering, 1, MPI_INT, 0, graph_.group());
    mumps_->analyse(graph_.order(), graph_.rows(), graph_.columns(), {}, graph_.ordering());
    if (hasOrdering == 0)
      graph_.ordering() = mumps_->ordering();
    mumps_->factorize(std::move(shared));
  });
}

// On all ranks those of the group that has found most: pivots at the threshold are told by last bits, and one
// more that is left out does no harm, but one that is not spoils all.
std::vector<int> DistributedFactor::nullRows() const {
  std::vector<int> found = mumps_->nullPivots(); // on the first rank of a group
  struct {
    int count, rank;
  } mine{static_cast<int>(found.size()), 0}, most{};
  MPI_Comm_rank(graph_.world(), &mine.rank);
  MPI_Allreduce(&mine, &most, 1, MPI_2INT, MPI_MAXLOC, graph_.world());
  found.resize(static_cast<std::size_t>(most.count));
  if (most.count > 0)
    MPI_Bcast(found.data(), most.count, MPI_INT, most.rank, graph_.world());
  std::sort(found.begin(), found.end());
  return found;
}

// MUMPS looks for rows of nothing but rounding errors while it eliminates, and with some kernels of BLAS
// misses the last one. With Av = s for some s, v has the weak motion in it 1/pivot times: its entry j as the
// last pivot would be vᵀs/v_j².
void DistributedFactor::leaveOutWeakRows(const std::vector<double>& values, double threshold) {
  double largest = 0.0;
  for (double value : values)
    largest = std::max(largest, std::abs(value));
  largest = globalMax(graph_.comm(), largest);
  while (static_cast<int>(leftOut_.size()) < graph_.order()) {
    std::vector<double> s, none;
    for (int k = 0; k < graph_.own(); ++k)
      s.push_back(isLeftOut(graph_.first() + k) ? 0.0 : std::sin(1.0 + graph_.first() + k));
    const std::vector<double> v = solveByGroups(s, none);
    double product = 0.0;
    struct {
      double size;
      int row;
    } mine{0.0, 0}, most{};
    for (std::size_t k = 0; k < v.size(); ++k) {
      product += v[k] * s[k];
      if (std::abs(v[k]) > mine.size)
        mine = {std::abs(v[k]), graph_.first() + static_cast<int>(k)};
    }
    product = globalSum(graph_.comm(), product);
    MPI_Allreduce(&mine, &most, 1, MPI_DOUBLE_INT, MPI_MAXLOC, graph_.world());
    if (!(std::abs(product) <= threshold * largest * most.size * most.size))
      return;
    leftOut_.insert(std::lower_bound(leftOut_.begin(), leftOut_.end(), most.row), most.row);
    factor(values, 0.0);
  }
}

// Columns of A⁻ by blocks: the first rank of the group gets them, and sends them to whom they belong.
void DistributedFactor::makeRows() {
  constexpr int block = 32;
  const auto n = static_cast<std::size_t>(graph_.order());
  agree(graph_.comm(), [&] {
    inverse_.resize(n * static_cast<std::size_t>(graph_.own()));
    std::vector<double> columns;
    for (int member = 0; member < graph_.groupSize(); ++member) {
      const auto owner = static_cast<std::size_t>(graph_.firstOfGroup() + member);
      const int first = graph_.firsts()[owner], total = graph_.counts()[owner];
      for (int begin = 0; begin < total; begin += block) {
        const int count = std::min(block, total - begin);
        const std::size_t length = n * static_cast<std::size_t>(count);
        if (graph_.groupRank() == 0) {
          columns.assign(length, 0.0);
          for (int k = 0; k < count; ++k)
            if (!isLeftOut(first + begin + k))
              columns[static_cast<std::size_t>(k) * n + static_cast<std::size_t>(first + begin + k)] = 1.0;
        }
        mumps_->solve(columns.data(), count);
        double* const place =
            member == graph_.groupRank() ? inverse_.data() + static_cast<std::size_t>(begin) * n : nullptr;
        if (graph_.groupRank() == 0 && member == 0)
          std::copy(columns.begin(), columns.end(), place);
        else if (graph_.groupRank() == 0)
          MPI_Send(columns.data(), static_cast<int>(length), MPI_DOUBLE, member, begin, graph_.group());
        else if (place != nullptr)
          MPI_Recv(place, static_cast<int>(length), MPI_DOUBLE, 0, begin, graph_.group(), MPI_STATUS_IGNORE);
      }
    }
  });
}

std::vector<double> DistributedFactor::solve(const std::vector<double>& e) const {
  std::vector<double> none;
  return solve(e, none);
}

std::vector<double> DistributedFactor::solve(const std::vector<double>& e, std::vector<double>& sums) const {
  if (form_ == Form::Solves)
    return solveByGroups(e, sums);
  std::vector<double> all = graph_.gather(e, sums);
  for (int row : leftOut_)
    all[static_cast<std::size_t>(row)] = 0.0;
  std::vector<double> s(static_cast<std::size_t>(graph_.own()), 0.0);
  const int n = graph_.order();
  if (n > 0 && !s.empty())
    Teuchos::BLAS<int, double>().GEMV(Teuchos::TRANS, n, graph_.own(), 1.0, inverse_.data(), n, all.data(), 1,
                                      0.0, s.data(), 1);
  return s;
}

std::vector<double> DistributedFactor::solveByGroups(const std::vector<double>& e,
                                                     std::vector<double>& sums) const {
  std::vector<double> all = graph_.gather(e, sums);
  if (graph_.order() == 0)
    return {};
  for (int row : leftOut_)
    all[static_cast<std::size_t>(row)] = 0.0;
  std::vector<double> s(static_cast<std::size_t>(graph_.own()), 0.0);
  try {
    mumps_->solve(all.data(), 1);
  } catch (const std::exception&) {
    // Not the whole group need have failed: all get numbers that are none, by which a solver stops.
    std::fill(all.begin(), all.end(), std::numeric_limits<double>::quiet_NaN());
  }
  const auto begin = static_cast<std::ptrdiff_t>(graph_.firstOfGroup());
  std::vector<int> firsts(graph_.firsts().begin() + begin,
                          graph_.firsts().begin() + begin + graph_.groupSize());
  MPI_Scatterv(all.data(), graph_.counts().data() + begin, firsts.data(), MPI_DOUBLE, s.data(), graph_.own(),
               MPI_DOUBLE, 0, graph_.group());
  for (std::size_t k = 0; !leftOut_.empty() && k < s.size(); ++k)
    if (isLeftOut(graph_.first() + static_cast<int>(k)))
      s[k] = 0.0;
  return s;
}

double DistributedFactor::largestDiagonal() const {
  double largest = 0.0;
  const auto n = static_cast<std::size_t>(graph_.order());
  for (std::size_t k = 0; form_ == Form::Rows && k < static_cast<std::size_t>(graph_.own()); ++k)
    largest = std::max(largest, inverse_[k * n + static_cast<std::size_t>(graph_.first()) + k]);
  return largest;
}

} // namespace Harmos::feti
