// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>

namespace Harmos::qp {

using Traits = BoundTraits<Scalar, MultiVector>;

std::size_t Traits::length(const MultiVector& v) {
  return v.getLocalLength();
}

// Views keep the data on the host current; the memory is the vector's.
const double* Traits::read(const MultiVector& v) {
  return v.getLocalViewHost(Tpetra::Access::ReadOnly).data();
}

double* Traits::write(MultiVector& v) {
  return v.getLocalViewHost(Tpetra::Access::ReadWrite).data();
}

long long Traits::globalIndex(const MultiVector& v, std::size_t entry) {
  return v.getMap()->getGlobalElement(static_cast<LocalOrdinal>(entry));
}

// Replicated vectors have all entries on every rank: nothing is to be summed.
void Traits::sum(const MultiVector& like, double* sums, int count) {
  if (!like.isDistributed())
    return;
  std::vector<double> values(sums, sums + count);
  globalSum(*like.getMap()->getComm(), values);
  std::copy(values.begin(), values.end(), sums);
}

void Traits::sumAndMin(const MultiVector& like, double* sums, int count, double& least) {
  if (like.isDistributed())
    globalSumAndMin(*like.getMap()->getComm(), sums, count, least);
}

double Traits::maximum(const MultiVector& like, double value) {
  return like.getMap()->getComm()->getSize() > 1 ? globalMax(*like.getMap()->getComm(), value) : value;
}

std::vector<double> Traits::gather(const MultiVector& v) {
  const Map& map = *v.getMap();
  if (static_cast<Tpetra::global_size_t>(map.getMaxAllGlobalIndex() - map.getIndexBase()) + 1 !=
      map.getGlobalNumElements())
    throw InputError(
        "the equality rows are numbered with gaps; number them consecutively from the index base");
  std::vector<double> values(v.getGlobalLength(), 0.0);
  const double* const entries = read(v);
  for (std::size_t i = 0; i < length(v); ++i)
    values[static_cast<std::size_t>(globalIndex(v, i) - map.getIndexBase())] = entries[i];
  sum(v, values.data(), static_cast<int>(values.size()));
  return values;
}

void Traits::scatter(const std::vector<double>& values, MultiVector& v) {
  double* const entries = write(v);
  for (std::size_t i = 0; i < length(v); ++i)
    entries[i] = values[static_cast<std::size_t>(globalIndex(v, i) - v.getMap()->getIndexBase())];
}

template struct BoundOps<Scalar, MultiVector>;
template struct FaceOps<Scalar, MultiVector>;

} // namespace Harmos::qp
