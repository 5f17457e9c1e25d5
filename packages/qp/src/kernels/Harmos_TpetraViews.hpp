// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundKernels.hpp"
#include "Harmos_BoundTraitsTpetra.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <limits>
#include <vector>

namespace Harmos::qp {

// What the definitions of BoundTraits for Tpetra share.

// The first column on the host. Views keep the data on the host current; the pointers live as long as they.
class Reader {
 public:
  explicit Reader(const MultiVector& x) : view_(x.getLocalViewHost(Tpetra::Access::ReadOnly)) {}
  const double* data() const { return view_.data(); }
  std::size_t size() const { return view_.extent(0); }
  double operator[](std::size_t i) const { return view_(i, 0); }

 private:
  decltype(std::declval<const MultiVector&>().getLocalViewHost(Tpetra::Access::ReadOnly)) view_;
};

class Writer {
 public:
  explicit Writer(MultiVector& x) : view_(x.getLocalViewHost(Tpetra::Access::ReadWrite)) {}
  double* data() const { return view_.data(); }
  std::size_t size() const { return view_.extent(0); }
  double& operator[](std::size_t i) const { return view_(i, 0); }

 private:
  decltype(std::declval<MultiVector&>().getLocalViewHost(Tpetra::Access::ReadWrite)) view_;
};

// A bound that may be absent; `instead` only gives it something to view.
class BoundReader {
 public:
  BoundReader(const MultiVector* bound, const MultiVector& instead, double absent)
      : present_(bound != nullptr), reader_(bound != nullptr ? *bound : instead), absent_(absent) {}
  const double* data() const { return present_ ? reader_.data() : nullptr; }
  double operator[](std::size_t i) const { return present_ ? reader_[i] : absent_; }

 private:
  bool present_;
  Reader reader_;
  double absent_;
};

using Set = FeasibleSet<MultiVector>;

class BoxReader {
 public:
  BoxReader(const Set& set, const MultiVector& instead)
      : l(set.lower, instead, -std::numeric_limits<double>::infinity()),
        u(set.upper, instead, std::numeric_limits<double>::infinity()) {}
  // From an entry on.
  Kernels::Bounds at(std::size_t begin) const {
    return {l.data() == nullptr ? nullptr : l.data() + begin,
            u.data() == nullptr ? nullptr : u.data() + begin};
  }
  BoundReader l, u;
};

// The entries in no disc, in ranges: pass(begin, length).
template<class Pass>
void overOthers(const Set& set, std::size_t n, Pass&& pass) {
  if (!set.hasDiscs())
    return pass(std::size_t{0}, n);
  HARMOS_REQUIRE(set.discs->length() == n, "discs are those of another vector");
  for (const auto& [begin, end] : set.discs->others())
    pass(begin, end - begin);
}

// Replicated vectors have all entries on every rank: nothing is to be summed.
inline void reduce(const MultiVector& x, double* sums, int count) {
  if (!x.isDistributed())
    return;
  std::vector<double> values(sums, sums + count);
  globalSum(*x.getMap()->getComm(), values);
  std::copy(values.begin(), values.end(), sums);
}

} // namespace Harmos::qp
