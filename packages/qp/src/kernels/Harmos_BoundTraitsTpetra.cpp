// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"

#include "Harmos_BoundKernels.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace Harmos::qp {
namespace {

using Traits = BoundTraits<Scalar, MultiVector>;
constexpr double infinity = std::numeric_limits<double>::infinity();

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

class BoxReader {
 public:
  BoxReader(const MultiVector* lower, const MultiVector* upper, const MultiVector& instead)
      : l(lower, instead, -infinity), u(upper, instead, infinity) {}
  operator Kernels::Bounds() const { return {l.data(), u.data()}; }
  BoundReader l, u;
};

// Replicated vectors have all entries on every rank: nothing is to be summed.
void reduce(const MultiVector& x, double* sums, int count) {
  if (!x.isDistributed())
    return;
  std::vector<double> values(sums, sums + count);
  globalSum(*x.getMap()->getComm(), values);
  std::copy(values.begin(), values.end(), sums);
}

void reduce(const MultiVector& x, double* sums, int count, double& least) {
  if (x.isDistributed())
    globalSumAndMin(*x.getMap()->getComm(), sums, count, least);
}

double least(const MultiVector& x, double value) {
  return x.isDistributed() ? globalMin(*x.getMap()->getComm(), value) : value;
}

SplitSums reduced(const MultiVector& x, SplitSums local) {
  double sums[] = {local.freeNorm2,
                   local.choppedNorm2,
                   local.reducedNorm2,
                   local.xNorm2,
                   static_cast<double>(local.active),
                   static_cast<double>(local.changed)};
  reduce(x, sums, 6, local.longestStep);
  local.freeNorm2 = sums[0];
  local.choppedNorm2 = sums[1];
  local.reducedNorm2 = sums[2];
  local.xNorm2 = sums[3];
  local.active = static_cast<long long>(sums[4]);
  local.changed = static_cast<long long>(sums[5]);
  return local;
}

// SplitMix64: well mixed bits of a counter (Steele, Lea, Flood: Fast splittable pseudorandom number
// generators, 2014).
std::uint64_t mix(std::uint64_t z) {
  z += 0x9e3779b97f4a7c15ULL;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::uint64_t globalIndex(const MultiVector& x, std::size_t i) {
  return static_cast<std::uint64_t>(x.getMap()->getGlobalElement(static_cast<LocalOrdinal>(i)));
}

} // namespace

SplitSums Traits::split(const MultiVector& x, const MultiVector& gradient, const MultiVector* lower,
                        const MultiVector* upper, double stepLength, MultiVector* direction,
                        LocalActiveSet& active) {
  SplitSums local;
  {
    const Reader xs(x), gs(gradient);
    const BoxReader box(lower, upper, x);
    const bool fresh = active.size() != xs.size();
    if (fresh)
      active.assign(xs.size(), 0);
    const auto pass = [&](double* p) {
      local = Kernels::split(xs.size(), xs.data(), gs.data(), box, stepLength, p, active.data(), fresh);
    };
    if (direction != nullptr)
      pass(Writer(*direction).data());
    else
      pass(nullptr);
  }
  return reduced(x, local);
}

ResidualSums Traits::residualSums(const MultiVector& w, const MultiVector& z, const MultiVector& image,
                                  const MultiVector& x) {
  const Reader ws(w), zs(z), hs(image), xs(x);
  const ResidualSums local = Kernels::residualSums(ws.size(), ws.data(), zs.data(), hs.data(), xs.data());
  double sums[] = {local.residualNorm2, local.preconditionedDotImage, local.iterateNorm2};
  reduce(w, sums, 3);
  return {sums[0], sums[1], sums[2]};
}

CurvatureSums Traits::curvature(const MultiVector& gradient, const MultiVector& direction,
                                const MultiVector& image, const LocalActiveSet& active) {
  const Reader gs(gradient), ps(direction), hs(image);
  const CurvatureSums local = Kernels::curvature(gs.size(), gs.data(), ps.data(), hs.data(),
                                                 active.empty() ? nullptr : active.data());
  double sums[] = {local.gradientDotDirection, local.directionDotImage, local.directionNorm2,
                   local.freeDotImage, local.freeImageNorm2};
  reduce(gradient, sums, 5);
  return {sums[0], sums[1], sums[2], sums[3], sums[4]};
}

SplitSums Traits::advance(MultiVector& x, MultiVector& gradient, const MultiVector& direction,
                          const MultiVector& image, double step, double beta, bool toBoundary,
                          const MultiVector* lower, const MultiVector* upper, double stepLength,
                          MultiVector& next, LocalActiveSet& active) {
  SplitSums local;
  {
    const Writer xs(x), gs(gradient), ns(next);
    // The direction may be `next` itself, which is viewed for writing.
    const Reader hs(image);
    const BoxReader box(lower, upper, image);
    const auto pass = [&](const double* p) {
      local = Kernels::advance(xs.size(), xs.data(), gs.data(), p, hs.data(), step, beta, toBoundary, box,
                               stepLength, ns.data(), active.data());
    };
    if (&direction == &next)
      pass(ns.data());
    else
      pass(Reader(direction).data());
  }
  return reduced(x, local);
}

double Traits::conjugate(const MultiVector& x, const MultiVector& z, double beta, const MultiVector* lower,
                         const MultiVector* upper, MultiVector& direction) {
  const Reader xs(x), zs(z);
  const BoxReader box(lower, upper, x);
  const double local =
      Kernels::conjugate(xs.size(), xs.data(), zs.data(), beta, box, Writer(direction).data());
  return least(x, local);
}

double Traits::choppedDirection(const MultiVector& x, const MultiVector& gradient, const MultiVector* lower,
                                const MultiVector* upper, MultiVector& direction) {
  const Reader xs(x), gs(gradient);
  const BoxReader box(lower, upper, x);
  const double local =
      Kernels::choppedDirection(xs.size(), xs.data(), gs.data(), box, Writer(direction).data());
  return least(x, local);
}

void Traits::projectedStep(MultiVector& x, MultiVector& xOld, const MultiVector& direction, double step,
                           const MultiVector* lower, const MultiVector* upper) {
  const Reader ps(direction);
  const BoxReader box(lower, upper, direction);
  Kernels::projectedStep(ps.size(), Writer(x).data(), Writer(xOld).data(), ps.data(), step, box);
}

ChangeSums Traits::change(const MultiVector& x, const MultiVector& xOld, const MultiVector& gradient,
                          const MultiVector& gradientOld) {
  const Reader xs(x), os(xOld), gs(gradient), gos(gradientOld);
  const ChangeSums local = Kernels::change(xs.size(), xs.data(), os.data(), gs.data(), gos.data());
  double sums[] = {local.cost, local.moved2, local.gradientNorm2};
  reduce(x, sums, 3);
  return {sums[0], sums[1], sums[2]};
}

double Traits::projectedGradientNorm(const MultiVector& x, const MultiVector& gradient,
                                     const MultiVector* lower, const MultiVector* upper) {
  LocalActiveSet active;
  return std::sqrt(split(x, gradient, lower, upper, 1.0, nullptr, active).projectedNorm2());
}

void Traits::project(MultiVector& x, const MultiVector* lower, const MultiVector* upper) {
  if (lower == nullptr && upper == nullptr)
    return;
  const Writer xs(x);
  const BoxReader box(lower, upper, lower != nullptr ? *lower : *upper);
  for (std::size_t i = 0; i < xs.size(); ++i)
    xs[i] = std::max(box.l[i], std::min(box.u[i], xs[i]));
}

void Traits::maskActive(MultiVector& v, const LocalActiveSet& active) {
  const Writer vs(v);
  for (std::size_t i = 0; i < active.size(); ++i)
    if (active[i] != 0)
      vs[i] = 0.0;
}

void Traits::activeToVector(const LocalActiveSet& active, MultiVector& v) {
  v.putScalar(0.0);
  const Writer vs(v);
  for (std::size_t i = 0; i < active.size(); ++i)
    vs[i] = active[i];
}

void Traits::vectorToActive(const MultiVector& v, LocalActiveSet& active) {
  const Reader vs(v);
  active.resize(v.getLocalLength());
  for (std::size_t i = 0; i < active.size(); ++i)
    active[i] = static_cast<signed char>(vs[i]);
}

void Traits::moveToBounds(MultiVector& x, const MultiVector* lower, const MultiVector* upper,
                          const LocalActiveSet& active) {
  if (lower == nullptr && upper == nullptr)
    return;
  const Writer xs(x);
  const BoxReader box(lower, upper, lower != nullptr ? *lower : *upper);
  for (std::size_t i = 0; i < active.size(); ++i)
    if (active[i] != 0)
      xs[i] = active[i] < 0 ? box.l[i] : box.u[i];
}

ActiveSetChange Traits::updateActiveSet(const MultiVector& x, const MultiVector& gradient,
                                        const MultiVector* lower, const MultiVector* upper, double xNoise,
                                        double gradientNoise, LocalActiveSet& set) {
  double sums[6] = {0, 0, 0, 0, 0, 0};
  {
    const Reader xs(x), gs(gradient);
    const BoxReader box(lower, upper, x);
    if (set.size() != xs.size())
      set.assign(xs.size(), 0);
    for (std::size_t i = 0; i < set.size(); ++i) {
      const double l = box.l[i], u = box.u[i];
      signed char state = set[i];
      if (l == u)
        state = -1;
      else if (state != 0) {
        // The multiplier of a lower bound is to be positive, that of an upper one negative.
        const double wrong = std::max(state < 0 ? -gs[i] : gs[i], 0.0);
        sums[3] += wrong * wrong;
        if (wrong > gradientNoise)
          state = 0;
      } else {
        const double below = std::max(l - xs[i], 0.0), above = std::max(xs[i] - u, 0.0);
        sums[2] += below * below + above * above;
        if (below > xNoise)
          state = -1;
        else if (above > xNoise)
          state = 1;
      }
      if (state != set[i])
        sums[1] += 1.0;
      set[i] = state;
      if (state != 0) {
        sums[0] += 1.0;
        // 32 bits an entry, so that sums over two million entries are exact.
        const std::uint64_t bits = mix(2 * globalIndex(x, i) + (state < 0 ? 0 : 1));
        sums[4] += static_cast<double>(bits >> 32);
        sums[5] += static_cast<double>(bits & 0xffffffffULL);
      }
    }
  }
  reduce(x, sums, 6);
  return {
      static_cast<long long>(sums[0]), static_cast<long long>(sums[1]), sums[2], sums[3], {sums[4], sums[5]}};
}

BoxInfimum Traits::boxInfimum(const MultiVector& w, const MultiVector* lower, const MultiVector* upper) {
  const Reader ws(w);
  const BoxReader box(lower, upper, w);
  double sums[3] = {0, 0, 0};
  for (std::size_t i = 0; i < ws.size(); ++i) {
    if (ws[i] == 0.0)
      continue;
    const double corner = ws[i] > 0.0 ? box.l[i] : box.u[i];
    if (std::isinf(corner)) {
      sums[1] += ws[i] * ws[i];
    } else {
      sums[0] += ws[i] * corner;
      sums[2] += corner * corner;
    }
  }
  reduce(w, sums, 3);
  return {sums[0], std::sqrt(sums[1]), std::sqrt(sums[2])};
}

double Traits::projectOntoRecessionCone(MultiVector& d, const MultiVector* lower, const MultiVector* upper) {
  double removed = 0.0;
  if (lower != nullptr || upper != nullptr) {
    const Writer ds(d);
    const BoxReader box(lower, upper, lower != nullptr ? *lower : *upper);
    for (std::size_t i = 0; i < ds.size(); ++i) {
      double& entry = ds[i];
      if ((entry < 0.0 && box.l[i] > -infinity) || (entry > 0.0 && box.u[i] < infinity)) {
        removed += entry * entry;
        entry = 0.0;
      }
    }
  }
  reduce(d, &removed, 1);
  return std::sqrt(removed);
}

BoundFault Traits::findBoundFault(const MultiVector* lower, const MultiVector* upper) {
  const MultiVector* any = lower != nullptr ? lower : upper;
  BoundFault fault;
  if (any == nullptr)
    return fault;
  const BoxReader box(lower, upper, *any);
  const double none = infinity;
  double first = none, l = 0.0, u = 0.0;
  for (std::size_t i = 0; i < any->getLocalLength() && first == none; ++i)
    if (!(box.l[i] <= box.u[i]) || box.l[i] == infinity || box.u[i] == -infinity) {
      first = static_cast<double>(globalIndex(*any, i));
      l = box.l[i];
      u = box.u[i];
    }
  const double found = least(*any, first);
  if (found == none)
    return fault;
  double values[] = {first == found ? l : 0.0, first == found ? u : 0.0};
  reduce(*any, values, 2);
  return {true, static_cast<long long>(found), values[0], values[1]};
}

void Traits::setRandom(MultiVector& x) {
  const Writer xs(x);
  for (std::size_t i = 0; i < xs.size(); ++i)
    xs[i] = 2.0 * static_cast<double>(mix(globalIndex(x, i)) >> 11) * 0x1.0p-53 - 1.0;
}

std::vector<double> Traits::gather(const MultiVector& v) {
  const Map& map = *v.getMap();
  if (static_cast<Tpetra::global_size_t>(map.getMaxAllGlobalIndex() - map.getIndexBase()) + 1 !=
      map.getGlobalNumElements())
    throw InputError("the equality rows are numbered with gaps; number them through from the index base");
  std::vector<double> values(v.getGlobalLength(), 0.0);
  {
    const Reader vs(v);
    const auto base = static_cast<std::uint64_t>(v.getMap()->getIndexBase());
    for (std::size_t i = 0; i < vs.size(); ++i)
      values[globalIndex(v, i) - base] = vs[i];
  }
  reduce(v, values.data(), static_cast<int>(values.size()));
  return values;
}

void Traits::scatter(const std::vector<double>& values, MultiVector& v) {
  const Writer vs(v);
  const auto base = static_cast<std::uint64_t>(v.getMap()->getIndexBase());
  for (std::size_t i = 0; i < vs.size(); ++i)
    vs[i] = values[globalIndex(v, i) - base];
}

double Traits::maximum(const MultiVector& like, double value) {
  return like.getMap()->getComm()->getSize() > 1 ? globalMax(*like.getMap()->getComm(), value) : value;
}

} // namespace Harmos::qp
