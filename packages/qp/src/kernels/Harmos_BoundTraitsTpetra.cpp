// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BoundTraitsTpetra.hpp"

#include "Harmos_DiscKernels.hpp"
#include "Harmos_TpetraViews.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace Harmos::qp {
namespace {

using Traits = BoundTraits<Scalar, MultiVector>;
constexpr double infinity = std::numeric_limits<double>::infinity();

const std::vector<Disc>& discsOf(const Set& set) {
  static const std::vector<Disc> none;
  return set.hasDiscs() ? set.discs->discs() : none;
}

void add(const SplitSums& part, SplitSums& sums) {
  sums.freeNorm2 += part.freeNorm2;
  sums.choppedNorm2 += part.choppedNorm2;
  sums.reducedNorm2 += part.reducedNorm2;
  sums.xNorm2 += part.xNorm2;
  sums.active += part.active;
  sums.changed += part.changed;
  sums.longestStep = std::min(sums.longestStep, part.longestStep);
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

SplitSums Traits::split(const MultiVector& x, const MultiVector& gradient,
                        const FeasibleSet<MultiVector>& feasible, double stepLength, MultiVector* direction,
                        LocalActiveSet& active) {
  SplitSums local;
  {
    const Reader xs(x), gs(gradient);
    const BoxReader box(feasible, x);
    const bool fresh = active.size() != xs.size();
    if (fresh)
      active.assign(xs.size(), 0);
    const auto pass = [&](double* p) {
      overOthers(feasible, xs.size(), [&](std::size_t k, std::size_t n) {
        add(Kernels::split(n, xs.data() + k, gs.data() + k, box.at(k), stepLength,
                           p == nullptr ? nullptr : p + k, active.data() + k, fresh),
            local);
      });
      Kernels::split(discsOf(feasible), xs.data(), gs.data(), stepLength, p, active.data(), fresh, local);
    };
    if (direction != nullptr)
      pass(Writer(*direction).data());
    else
      pass(nullptr);
  }
  return reduced(x, local);
}

ResidualSums Traits::localResidualSums(const MultiVector& w, const MultiVector& z, const MultiVector& image,
                                       const MultiVector& x) {
  const Reader ws(w), zs(z), hs(image), xs(x);
  return Kernels::residualSums(ws.size(), ws.data(), zs.data(), hs.data(), xs.data());
}

ResidualSums Traits::residualSums(const MultiVector& w, const MultiVector& z, const MultiVector& image,
                                  const MultiVector& x) {
  const ResidualSums local = localResidualSums(w, z, image, x);
  double sums[] = {local.residualNorm2, local.preconditionedDotImage, local.iterateNorm2};
  reduce(w, sums, 3);
  return {sums[0], sums[1], sums[2]};
}

CurvatureSums Traits::localCurvature(const MultiVector& gradient, const MultiVector& direction,
                                     const MultiVector& image, const LocalActiveSet& active) {
  const Reader gs(gradient), ps(direction), hs(image);
  return Kernels::curvature(gs.size(), gs.data(), ps.data(), hs.data(),
                            active.empty() ? nullptr : active.data());
}

CurvatureSums Traits::curvature(const MultiVector& gradient, const MultiVector& direction,
                                const MultiVector& image, const LocalActiveSet& active) {
  const CurvatureSums local = localCurvature(gradient, direction, image, active);
  double sums[] = {local.gradientDotDirection, local.directionDotImage, local.directionNorm2,
                   local.freeDotImage, local.freeImageNorm2};
  reduce(gradient, sums, 5);
  return {sums[0], sums[1], sums[2], sums[3], sums[4]};
}

SplitSums Traits::advance(MultiVector& x, MultiVector& gradient, const MultiVector& direction,
                          const MultiVector& image, double step, double beta, bool toBoundary,
                          const FeasibleSet<MultiVector>& feasible, double stepLength, MultiVector& next,
                          LocalActiveSet& active) {
  SplitSums local;
  {
    const Writer xs(x), gs(gradient), ns(next);
    // The direction may be `next` itself, which is viewed for writing.
    const Reader hs(image);
    const BoxReader box(feasible, image);
    const auto pass = [&](const double* p) {
      overOthers(feasible, xs.size(), [&](std::size_t k, std::size_t n) {
        add(Kernels::advance(n, xs.data() + k, gs.data() + k, p + k, hs.data() + k, step, beta, toBoundary,
                             box.at(k), stepLength, ns.data() + k, active.data() + k),
            local);
      });
      Kernels::advance(discsOf(feasible), xs.data(), gs.data(), p, hs.data(), step, beta, stepLength,
                       ns.data(), active.data(), local);
    };
    if (&direction == &next)
      pass(ns.data());
    else
      pass(Reader(direction).data());
  }
  return reduced(x, local);
}

double Traits::conjugate(const MultiVector& x, const MultiVector& z, double beta,
                         const FeasibleSet<MultiVector>& feasible, MultiVector& direction) {
  const Reader xs(x), zs(z);
  const BoxReader box(feasible, x);
  const Writer ps(direction);
  double local = Kernels::conjugate(discsOf(feasible), xs.data(), zs.data(), beta, ps.data());
  overOthers(feasible, xs.size(), [&](std::size_t k, std::size_t n) {
    local =
        std::min(local, Kernels::conjugate(n, xs.data() + k, zs.data() + k, beta, box.at(k), ps.data() + k));
  });
  return least(x, local);
}

double Traits::choppedDirection(const MultiVector& x, const MultiVector& gradient,
                                const FeasibleSet<MultiVector>& feasible, MultiVector& direction) {
  const Reader xs(x), gs(gradient);
  const BoxReader box(feasible, x);
  const Writer ps(direction);
  double local = Kernels::choppedDirection(discsOf(feasible), xs.data(), gs.data(), ps.data());
  overOthers(feasible, xs.size(), [&](std::size_t k, std::size_t n) {
    local =
        std::min(local, Kernels::choppedDirection(n, xs.data() + k, gs.data() + k, box.at(k), ps.data() + k));
  });
  return least(x, local);
}

void Traits::projectedStep(MultiVector& x, MultiVector& xOld, const MultiVector& direction, double step,
                           const FeasibleSet<MultiVector>& feasible) {
  const Reader ps(direction);
  const BoxReader box(feasible, direction);
  const Writer xs(x), os(xOld);
  overOthers(feasible, ps.size(), [&](std::size_t k, std::size_t n) {
    Kernels::projectedStep(n, xs.data() + k, os.data() + k, ps.data() + k, step, box.at(k));
  });
  Kernels::projectedStep(discsOf(feasible), xs.data(), os.data(), ps.data(), step);
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
                                     const FeasibleSet<MultiVector>& feasible) {
  LocalActiveSet active;
  return std::sqrt(split(x, gradient, feasible, 1.0, nullptr, active).projectedNorm2());
}

void Traits::project(MultiVector& x, const FeasibleSet<MultiVector>& feasible) {
  if (feasible.isEverything())
    return;
  const Writer xs(x);
  if (const MultiVector* bound = feasible.anyBound()) {
    const BoxReader box(feasible, *bound);
    overOthers(feasible, xs.size(), [&](std::size_t k, std::size_t n) {
      for (std::size_t i = k; i < k + n; ++i)
        xs[i] = std::max(box.l[i], std::min(box.u[i], xs[i]));
    });
  }
  Kernels::project(discsOf(feasible), xs.data());
}

void Traits::maskActive(MultiVector& v, const LocalActiveSet& active) {
  const Writer vs(v);
  for (std::size_t i = 0; i < active.size(); ++i)
    if (active[i] != 0 && active[i] != LocalActiveSet::slips)
      vs[i] = 0.0;
  Kernels::maskSlips(active.slipping, vs.data());
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

void Traits::addCurvature(const LocalActiveSet& active, double f, const MultiVector& x, bool fromCentre,
                          MultiVector& y) {
  if (!active.slipping.empty())
    Kernels::addCurvature(active.slipping, f, Reader(x).data(), fromCentre, Writer(y).data());
}

void Traits::addAtSlips(const LocalActiveSet& active, const std::function<double(double)>& f,
                        const MultiVector& x, MultiVector& y) {
  const Reader xs(x);
  const Writer ys(y);
  for (const Slip& slip : active.slipping)
    for (int entry : {slip.first, slip.second})
      ys[static_cast<std::size_t>(entry)] += f(slip.curvature) * xs[static_cast<std::size_t>(entry)];
}

SlipSums Traits::slipSums(const LocalActiveSet& active, double q, const MultiVector& w) {
  double sums[5] = {0.0, 0.0, 0.0, 0.0, 0.0};
  {
    const Reader ws(w);
    for (const Slip& slip : active.slipping) {
      const double along = slip.normal[0] * ws[static_cast<std::size_t>(slip.second)] -
                           slip.normal[1] * ws[static_cast<std::size_t>(slip.first)];
      sums[0] += along * along;
      sums[1] += std::pow(q / (q + slip.curvature) * along, 2);
      sums[2] += std::pow((q + slip.curvature) * slip.radius, 2);
    }
    for (const Spring& spring : active.springs) {
      const double entry = ws[static_cast<std::size_t>(spring.entry)];
      sums[3] += entry * entry;
      sums[4] += std::pow(q / (q + spring.curvature) * entry, 2);
    }
  }
  reduce(w, sums, 5);
  return {sums[0], sums[1], sums[3], sums[4], sums[2]};
}

void Traits::slipsToVectors(const LocalActiveSet& active, MultiVector& normals, MultiVector& curvatures) {
  normals.putScalar(0.0);
  curvatures.putScalar(0.0);
  const Writer ns(normals), ks(curvatures);
  for (const Slip& slip : active.slipping) {
    ns[static_cast<std::size_t>(slip.first)] = slip.normal[0];
    ns[static_cast<std::size_t>(slip.second)] = slip.normal[1];
    ks[static_cast<std::size_t>(slip.first)] = slip.curvature;
    ks[static_cast<std::size_t>(slip.second)] = slip.radius;
  }
}

void Traits::vectorsToSlips(const FeasibleSet<MultiVector>& feasible, const MultiVector& normals,
                            const MultiVector& curvatures, LocalActiveSet& active) {
  const Reader ns(normals), ks(curvatures);
  active.slipping.clear();
  for (const Disc& disc : discsOf(feasible)) {
    const auto first = static_cast<std::size_t>(disc.first), second = static_cast<std::size_t>(disc.second);
    if (active[first] == LocalActiveSet::slips)
      active.slipping.push_back({disc.first,
                                 disc.second,
                                 {disc.centre[0], disc.centre[1]},
                                 ks[second],
                                 {ns[first], ns[second]},
                                 ks[first]});
  }
}

void Traits::moveToBounds(MultiVector& x, const FeasibleSet<MultiVector>& feasible,
                          const LocalActiveSet& active) {
  if (feasible.isEverything() || active.empty())
    return;
  const Writer xs(x);
  if (const MultiVector* bound = feasible.anyBound()) {
    const BoxReader box(feasible, *bound);
    for (std::size_t i = 0; i < active.size(); ++i)
      if (active[i] == -1 || active[i] == 1)
        xs[i] = active[i] < 0 ? box.l[i] : box.u[i];
  }
  Kernels::moveToRims(discsOf(feasible), active.data(), xs.data());
  Kernels::moveToTangents(active.slipping, xs.data());
}

ActiveSetChange Traits::updateActiveSet(const MultiVector& x, const MultiVector& gradient,
                                        const FeasibleSet<MultiVector>& feasible, double xNoise,
                                        double gradientNoise, LocalActiveSet& set, const DiscUpdate& discs) {
  double sums[7] = {0, 0, 0, 0, 0, 0, 0};
  {
    const Reader xs(x), gs(gradient);
    const BoxReader box(feasible, x);
    if (set.size() != xs.size())
      set.assign(xs.size(), 0);
    const auto update = [&](std::size_t i) {
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
    };
    overOthers(feasible, set.size(), [&](std::size_t k, std::size_t n) {
      for (std::size_t i = k; i < k + n; ++i)
        update(i);
    });
    const Kernels::DiscChange change =
        Kernels::update(discsOf(feasible), xs.data(), gs.data(), discs, xNoise, gradientNoise, set);
    sums[0] += static_cast<double>(2 * change.active);
    sums[1] += static_cast<double>(change.changed);
    sums[2] += change.violation2;
    sums[3] += change.wrong2;
    sums[6] = static_cast<double>(set.slipping.size());
    for (const Slip& slip : set.slipping) {
      std::uint64_t turned[2];
      std::memcpy(turned, slip.normal, sizeof turned);
      const std::uint64_t bits =
          mix(2 * globalIndex(x, static_cast<std::size_t>(slip.first)) + 1 + turned[0]);
      sums[4] += static_cast<double>(bits >> 32);
      sums[5] += static_cast<double>(mix(bits + turned[1]) & 0xffffffffULL);
    }
  }
  reduce(x, sums, 7);
  return {
      static_cast<long long>(sums[0]), static_cast<long long>(sums[1]), sums[2], sums[3], {sums[4], sums[5]},
      static_cast<long long>(sums[6])};
}

BoxInfimum Traits::boxInfimum(const MultiVector& w, const FeasibleSet<MultiVector>& feasible) {
  const Reader ws(w);
  const BoxReader box(feasible, w);
  double sums[3] = {0, 0, 0};
  overOthers(feasible, ws.size(), [&](std::size_t k, std::size_t n) {
    for (std::size_t i = k; i < k + n; ++i) {
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
  });
  Kernels::addInfimum(discsOf(feasible), ws.data(), sums[0], sums[2]);
  reduce(w, sums, 3);
  return {sums[0], std::sqrt(sums[1]), std::sqrt(sums[2])};
}

double Traits::projectOntoRecessionCone(MultiVector& d, const FeasibleSet<MultiVector>& feasible) {
  double removed = 0.0;
  if (const MultiVector* bound = feasible.anyBound()) {
    const Writer ds(d);
    const BoxReader box(feasible, *bound);
    overOthers(feasible, ds.size(), [&](std::size_t k, std::size_t n) {
      for (std::size_t i = k; i < k + n; ++i) {
        double& entry = ds[i];
        if ((entry < 0.0 && box.l[i] > -infinity) || (entry > 0.0 && box.u[i] < infinity)) {
          removed += entry * entry;
          entry = 0.0;
        }
      }
    });
  }
  if (feasible.hasDiscs())
    removed += Kernels::clear(discsOf(feasible), Writer(d).data());
  reduce(d, &removed, 1);
  return std::sqrt(removed);
}

bool Traits::isFit(const MultiVector& like, const LocalDiscs& discs) {
  return discs.length() == like.getLocalLength();
}

bool Traits::isFit(const MultiVector& like, const LocalSoftBounds& bounds) {
  return bounds.length() == like.getLocalLength();
}

void Traits::read(const MultiVector& v, const std::function<void(const double*)>& use) {
  use(Reader(v).data());
}

void Traits::write(MultiVector& v, const std::function<void(double*)>& use) {
  use(Writer(v).data());
}

void Traits::sum(const MultiVector& like, double* sums, int count) {
  reduce(like, sums, count);
}

BoundFault Traits::findBoundFault(const MultiVector& like, const FeasibleSet<MultiVector>& feasible) {
  BoundFault fault;
  if (feasible.isEverything())
    return fault;
  const BoxReader box(feasible, like);
  const double none = infinity;
  double first = none, l = 0.0, u = 0.0;
  const auto report = [&](std::size_t i, double lower, double upper) {
    const auto entry = static_cast<double>(globalIndex(like, i));
    if (entry >= first)
      return;
    first = entry;
    l = lower;
    u = upper;
  };
  overOthers(feasible, like.getLocalLength(), [&](std::size_t k, std::size_t n) {
    for (std::size_t i = k; i < k + n; ++i)
      if (!(box.l[i] <= box.u[i]) || box.l[i] == infinity || box.u[i] == -infinity)
        return report(i, box.l[i], box.u[i]);
  });
  for (const Disc& disc : discsOf(feasible)) {
    bool isSound =
        std::isfinite(disc.radius) && std::isfinite(disc.centre[0]) && std::isfinite(disc.centre[1]);
    for (int entry : {disc.first, disc.second})
      isSound = isSound && box.l[static_cast<std::size_t>(entry)] == -infinity &&
                box.u[static_cast<std::size_t>(entry)] == infinity;
    if (!isSound || disc.radius < 0.0)
      report(static_cast<std::size_t>(std::min(disc.first, disc.second)),
             isSound ? -disc.radius : std::numeric_limits<double>::quiet_NaN(), disc.radius);
  }
  const double found = least(like, first);
  if (found == none)
    return fault;
  double values[] = {first == found ? l : 0.0, first == found ? u : 0.0};
  reduce(like, values, 2);
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
    throw InputError(
        "the equality rows are numbered with gaps; number them consecutively from the index base");
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
