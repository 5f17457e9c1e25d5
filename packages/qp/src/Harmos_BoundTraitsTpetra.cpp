// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace Harmos::qp {
namespace {

using Traits = BoundTraits<Scalar, MultiVector>;
constexpr double infinity = std::numeric_limits<double>::infinity();

// The first column on the host.
class Reader {
 public:
  explicit Reader(const MultiVector& x) : view_(x.getLocalViewHost(Tpetra::Access::ReadOnly)) {}
  double operator[](std::size_t i) const { return view_(i, 0); }

 private:
  decltype(std::declval<const MultiVector&>().getLocalViewHost(Tpetra::Access::ReadOnly)) view_;
};

class Writer {
 public:
  explicit Writer(MultiVector& x) : view_(x.getLocalViewHost(Tpetra::Access::ReadWrite)) {}
  double& operator[](std::size_t i) const { return view_(i, 0); }

 private:
  decltype(std::declval<MultiVector&>().getLocalViewHost(Tpetra::Access::ReadWrite)) view_;
};

// A bound that may be absent.
class BoundReader {
 public:
  BoundReader(const MultiVector* bound, const MultiVector& instead, double absent)
      : present_(bound != nullptr), reader_(bound != nullptr ? *bound : instead), absent_(absent) {}
  double operator[](std::size_t i) const { return present_ ? reader_[i] : absent_; }

 private:
  bool present_;
  Reader reader_;
  double absent_;
};

double choppedEntry(double x, double g, double lower, double upper) {
  if (x <= lower)
    return x >= upper ? 0.0 : std::min(g, 0.0); // l = u leaves nothing to move
  if (x >= upper)
    return std::max(g, 0.0);
  return 0.0;
}

// Step at which x − αp meets a bound.
double stepToBound(double x, double p, double lower, double upper) {
  if (p > 0.0)
    return (x - lower) / p;
  if (p < 0.0)
    return (x - upper) / p;
  return infinity;
}

bool isReplicated(const MultiVector& x) {
  return !x.isDistributed();
}

void sum(const MultiVector& x, std::vector<double>& values) {
  if (!isReplicated(x))
    globalSum(*x.getMap()->getComm(), values);
}

// SplitMix64: well mixed bits of a counter (Steele, Lea, Flood: Fast splittable pseudorandom number
// generators, 2014).
std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

} // namespace

SplitSums Traits::split(const MultiVector& x, const MultiVector& gradient, const MultiVector* lower,
                        const MultiVector* upper, double stepLength, const MultiVector* image,
                        MultiVector& freeGradient, LocalActiveSet& active) {
  const Reader xs(x), gs(gradient), hs(image != nullptr ? *image : gradient);
  const BoundReader ls(lower, x, -infinity), us(upper, x, infinity);
  const Writer fs(freeGradient);
  const std::size_t n = x.getLocalLength();
  const bool fresh = active.size() != n;
  if (fresh)
    active.assign(n, 0);
  double freeNorm2 = 0, choppedNorm2 = 0, reducedNorm2 = 0, freeDotImage = 0;
  long long activeCount = 0, changed = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double xi = xs[i], gi = gs[i], l = ls[i], u = us[i];
    signed char state = 0;
    if (xi <= l || xi >= u) {
      state = xi <= l ? -1 : 1;
      const double beta = choppedEntry(xi, gi, l, u);
      choppedNorm2 += beta * beta;
      fs[i] = 0.0;
      ++activeCount;
    } else {
      const double reduced =
          gi > 0.0 ? std::min((xi - l) / stepLength, gi) : std::max((xi - u) / stepLength, gi);
      freeNorm2 += gi * gi;
      reducedNorm2 += reduced * gi;
      freeDotImage += gi * hs[i];
      fs[i] = gi;
    }
    if (fresh || active[i] != state)
      ++changed;
    active[i] = state;
  }
  std::vector<double> sums = {freeNorm2,
                              choppedNorm2,
                              reducedNorm2,
                              freeDotImage,
                              static_cast<double>(activeCount),
                              static_cast<double>(changed)};
  sum(x, sums);
  return {sums[0],
          sums[1],
          sums[2],
          sums[3],
          std::isfinite(sums[4]) ? static_cast<long long>(sums[4]) : 0,
          static_cast<long long>(sums[5])};
}

double Traits::projectedGradientNorm(const MultiVector& x, const MultiVector& gradient,
                                     const MultiVector* lower, const MultiVector* upper) {
  const Reader xs(x), gs(gradient);
  const BoundReader ls(lower, x, -infinity), us(upper, x, infinity);
  double norm2 = 0.0;
  for (std::size_t i = 0; i < x.getLocalLength(); ++i) {
    const bool isActive = xs[i] <= ls[i] || xs[i] >= us[i];
    const double entry = isActive ? choppedEntry(xs[i], gs[i], ls[i], us[i]) : gs[i];
    norm2 += entry * entry;
  }
  std::vector<double> sums = {norm2};
  sum(x, sums);
  return std::sqrt(sums[0]);
}

void Traits::choppedGradient(const MultiVector& x, const MultiVector& gradient, const MultiVector* lower,
                             const MultiVector* upper, MultiVector& chopped) {
  const Reader xs(x), gs(gradient);
  const BoundReader ls(lower, x, -infinity), us(upper, x, infinity);
  const Writer bs(chopped);
  for (std::size_t i = 0; i < x.getLocalLength(); ++i)
    bs[i] = choppedEntry(xs[i], gs[i], ls[i], us[i]);
}

DirectionSums Traits::direction(const MultiVector& x, const MultiVector& gradient,
                                const MultiVector& direction, const MultiVector& image,
                                const MultiVector* lower, const MultiVector* upper) {
  const Reader xs(x), gs(gradient), ps(direction), hs(image);
  const BoundReader ls(lower, x, -infinity), us(upper, x, infinity);
  double gp = 0.0, php = 0.0, pp = 0.0, step = infinity;
  for (std::size_t i = 0; i < x.getLocalLength(); ++i) {
    const double p = ps[i];
    gp += gs[i] * p;
    php += p * hs[i];
    pp += p * p;
    step = std::min(step, stepToBound(xs[i], p, ls[i], us[i]));
  }
  std::vector<double> sums = {gp, php, pp};
  sum(x, sums);
  if (!isReplicated(x))
    step = globalMin(*x.getMap()->getComm(), step);
  return {sums[0], sums[1], sums[2], step};
}

void Traits::project(MultiVector& x, const MultiVector* lower, const MultiVector* upper) {
  if (lower != nullptr) {
    const Reader ls(*lower);
    const Writer xs(x);
    for (std::size_t i = 0; i < x.getLocalLength(); ++i)
      xs[i] = std::max(xs[i], ls[i]);
  }
  if (upper != nullptr) {
    const Reader us(*upper);
    const Writer xs(x);
    for (std::size_t i = 0; i < x.getLocalLength(); ++i)
      xs[i] = std::min(xs[i], us[i]);
  }
}

void Traits::stepToBoundary(MultiVector& x, const MultiVector& direction, double step,
                            const MultiVector* lower, const MultiVector* upper) {
  const Reader ps(direction);
  // A copy of the bounds' readers only: x itself is written.
  const std::size_t n = x.getLocalLength();
  const BoundReader ls(lower, direction, -infinity), us(upper, direction, infinity);
  const Writer xs(x);
  for (std::size_t i = 0; i < n; ++i) {
    const double l = ls[i], u = us[i], p = ps[i];
    if (p != 0.0 && stepToBound(xs[i], p, l, u) <= step)
      xs[i] = p > 0.0 ? l : u;
    else
      xs[i] = std::min(std::max(xs[i] - step * p, l), u);
  }
}

bool Traits::boundsAreConsistent(const MultiVector* lower, const MultiVector* upper) {
  const MultiVector* any = lower != nullptr ? lower : upper;
  if (any == nullptr)
    return true;
  const BoundReader ls(lower, *any, -infinity), us(upper, *any, infinity);
  double faults = 0.0;
  for (std::size_t i = 0; i < any->getLocalLength(); ++i)
    if (!(ls[i] <= us[i]) || ls[i] == infinity || us[i] == -infinity)
      faults += 1.0;
  std::vector<double> sums = {faults};
  sum(*any, sums);
  return sums[0] == 0.0;
}

void Traits::setRandom(MultiVector& x) {
  const Writer xs(x);
  for (std::size_t i = 0; i < x.getLocalLength(); ++i) {
    const auto global =
        static_cast<std::uint64_t>(x.getMap()->getGlobalElement(static_cast<LocalOrdinal>(i)));
    xs[i] = 2.0 * static_cast<double>(mix(global) >> 11) * 0x1.0p-53 - 1.0;
  }
}

} // namespace Harmos::qp
