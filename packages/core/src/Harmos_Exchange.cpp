// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Exchange.hpp"

#include "Harmos_Agreement.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultMpiComm.hpp>
#include <Teuchos_DefaultSerialComm.hpp>

#include <algorithm>
#include <limits>
#include <mpi.h>

namespace Harmos {
namespace Details {
namespace {

// Offsets of the parts in one buffer; MPI counts in int.
std::vector<int> offsetsOf(const std::vector<int>& counts) {
  std::vector<int> offsets(counts.size() + 1, 0);
  long long sum = 0;
  for (std::size_t r = 0; r < counts.size(); ++r) {
    sum += counts[r];
    HARMOS_REQUIRE(sum <= std::numeric_limits<int>::max(),
                   "an exchange between ranks exceeds 2 GiB on one rank; use more ranks");
    offsets[r + 1] = static_cast<int>(sum);
  }
  return offsets;
}

} // namespace

std::vector<std::vector<char>> exchangeBytes(const Teuchos::Comm<int>& comm,
                                             const std::vector<std::vector<char>>& sends) {
  const auto ranks = static_cast<std::size_t>(comm.getSize());
  HARMOS_REQUIRE(sends.size() == ranks, "one part for each rank is needed");
  const auto* mpi = dynamic_cast<const Teuchos::MpiComm<int>*>(&comm);
  if (mpi == nullptr)
    return sends; // a serial communicator: what it sends, it receives
  const MPI_Comm raw = *mpi->getRawMpiComm();

  std::vector<int> sendCounts(ranks), receiveCounts(ranks), sendOffsets, receiveOffsets;
  agree(comm, [&] {
    for (std::size_t r = 0; r < ranks; ++r) {
      HARMOS_REQUIRE(sends[r].size() <= static_cast<std::size_t>(std::numeric_limits<int>::max()),
                     "an exchange between ranks exceeds 2 GiB on one rank; use more ranks");
      sendCounts[r] = static_cast<int>(sends[r].size());
    }
    sendOffsets = offsetsOf(sendCounts);
  });
  MPI_Alltoall(sendCounts.data(), 1, MPI_INT, receiveCounts.data(), 1, MPI_INT, raw);

  std::vector<char> outgoing, incoming;
  agree(comm, [&] {
    receiveOffsets = offsetsOf(receiveCounts);
    incoming.resize(static_cast<std::size_t>(receiveOffsets.back()));
    outgoing.reserve(static_cast<std::size_t>(sendOffsets.back()));
    for (const std::vector<char>& part : sends)
      outgoing.insert(outgoing.end(), part.begin(), part.end());
  });
  MPI_Alltoallv(outgoing.data(), sendCounts.data(), sendOffsets.data(), MPI_CHAR, incoming.data(),
                receiveCounts.data(), receiveOffsets.data(), MPI_CHAR, raw);

  std::vector<std::vector<char>> received(ranks);
  for (std::size_t r = 0; r < ranks; ++r)
    received[r].assign(incoming.begin() + receiveOffsets[r], incoming.begin() + receiveOffsets[r + 1]);
  return received;
}

} // namespace Details

namespace {

// The last number is a minimum, the others are sums.
class SumsThenMinimum : public Teuchos::ValueTypeReductionOp<int, double> {
 public:
  void reduce(const int count, const double in[], double inout[]) const override {
    for (int i = 0; i + 1 < count; ++i)
      inout[i] += in[i];
    inout[count - 1] = std::min(inout[count - 1], in[count - 1]);
  }
};

template<class T>
T reduce(const Teuchos::Comm<int>& comm, Teuchos::EReductionType type, T value) {
  T result = value;
  Teuchos::reduceAll<int, T>(comm, type, 1, &value, &result);
  return result;
}

} // namespace

long long globalSum(const Teuchos::Comm<int>& comm, long long value) {
  return reduce(comm, Teuchos::REDUCE_SUM, value);
}
double globalSum(const Teuchos::Comm<int>& comm, double value) {
  return reduce(comm, Teuchos::REDUCE_SUM, value);
}
double globalMax(const Teuchos::Comm<int>& comm, double value) {
  return reduce(comm, Teuchos::REDUCE_MAX, value);
}
long long globalMax(const Teuchos::Comm<int>& comm, long long value) {
  return reduce(comm, Teuchos::REDUCE_MAX, value);
}
double globalMin(const Teuchos::Comm<int>& comm, double value) {
  return reduce(comm, Teuchos::REDUCE_MIN, value);
}
long long globalMin(const Teuchos::Comm<int>& comm, long long value) {
  return reduce(comm, Teuchos::REDUCE_MIN, value);
}

void globalSum(const Teuchos::Comm<int>& comm, std::vector<double>& values) {
  if (values.empty())
    return;
  const std::vector<double> mine = values;
  Teuchos::reduceAll<int, double>(comm, Teuchos::REDUCE_SUM, static_cast<int>(mine.size()), mine.data(),
                                  values.data());
}

void globalMax(const Teuchos::Comm<int>& comm, std::vector<double>& values) {
  if (values.empty())
    return;
  const std::vector<double> mine = values;
  Teuchos::reduceAll<int, double>(comm, Teuchos::REDUCE_MAX, static_cast<int>(mine.size()), mine.data(),
                                  values.data());
}

void globalSumAndMin(const Teuchos::Comm<int>& comm, double* values, int count, double& least) {
  if (comm.getSize() == 1)
    return;
  constexpr int most = 15;
  HARMOS_REQUIRE(count <= most, "too many numbers for one combined reduction");
  double mine[most + 1], result[most + 1];
  std::copy(values, values + count, mine);
  mine[count] = least;
  Teuchos::reduceAll<int, double>(comm, SumsThenMinimum(), count + 1, mine, result);
  std::copy(result, result + count, values);
  least = result[count];
}

long long exclusiveScan(const Teuchos::Comm<int>& comm, long long value) {
  long long inclusive = value;
  Teuchos::scan<int, long long>(comm, Teuchos::REDUCE_SUM, 1, &value, &inclusive);
  return inclusive - value;
}

} // namespace Harmos
