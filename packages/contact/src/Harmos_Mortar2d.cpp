// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MortarSamples.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>

namespace Harmos::contact {
namespace {

using fem::Point;

/// Along the surface of outward normal n, in the direction of its edges.
Point along(const Point& normal) {
  return {-normal[1], normal[0], 0.0};
}

// Root of a function with opposite signs at −1 and 1, which is near to linear: regula falsi (Illinois), which
// keeps the bracket, so that folds outside of it do no harm.
template<class Function>
double rootBetweenEnds(const Function& f, double atLow, double atHigh) {
  double low = -1.0, high = 1.0, x = 0.0;
  int side = 0;
  for (int k = 0; k < 100; ++k) {
    x = (low * atHigh - high * atLow) / (atHigh - atLow);
    const double value = f(x);
    if (value == 0.0 || high - low < 1e-15)
      return x;
    if ((value > 0.0) == (atHigh > 0.0)) {
      if (std::abs(high - x) < 1e-16)
        return x;
      high = x;
      atHigh = value;
      if (side == 1)
        atLow *= 0.5;
      side = 1;
    } else {
      if (std::abs(x - low) < 1e-16)
        return x;
      low = x;
      atLow = value;
      if (side == -1)
        atHigh *= 0.5;
      side = -1;
    }
  }
  return x;
}

// Place on a facet of the first surface whose normal meets y; its ends if y is beyond.
double placeFacing(const Facet& facet, const Point& y) {
  const auto ahead = [&](double x) {
    const Facet::State state = facet.at({x, 0.0});
    return dot(difference(y, state.position), along(facet.smoothNormal(state.basis)));
  };
  const double atLow = ahead(-1.0), atHigh = ahead(1.0);
  if (atLow <= 0.0)
    return -1.0;
  if (atHigh >= 0.0)
    return 1.0;
  return rootBetweenEnds(ahead, atLow, atHigh);
}

// Place on a facet of the second surface which the normal at x meets; the nearer end if it misses by
// rounding.
double placeMet(const Facet& opposite, const Point& x, const Point& normal) {
  const Point direction = along(normal);
  const auto ahead = [&](double y) { return dot(difference(opposite.at({y, 0.0}).position, x), direction); };
  const double atLow = ahead(-1.0), atHigh = ahead(1.0);
  if ((atLow > 0.0) == (atHigh > 0.0))
    return std::abs(atLow) < std::abs(atHigh) ? -1.0 : 1.0;
  return rootBetweenEnds(ahead, atLow, atHigh);
}

struct Stretch {
  double begin, end; // on the facet of the first surface
  int opposite;
};

MortarSample sampleAt(const Surface& second, const Facet& facet, double x, int opposite) {
  const Facet::State state = facet.at({x, 0.0});
  const Point normal = facet.smoothNormal(state.basis);
  const Facet other(second, opposite);
  const FacetPlace met = {placeMet(other, state.position, normal), 0.0};
  return {{x, 0.0},
          opposite,
          met,
          state.measure,
          dot(difference(other.at(met).position, state.position), normal)};
}

bool face(const Surface& second, const Facet& facet, const MortarSample& sample) {
  const Point one = facet.at(sample.place).areaNormal;
  const Point other = Facet(second, sample.opposite).at(sample.oppositePlace).areaNormal;
  return dot(one, other) < -leastFacing * norm(one) * norm(other);
}

} // namespace

std::vector<MortarSample> planeSamples(const Surface& first, int f, const Surface& second,
                                       const std::vector<int>& candidates, double reach) {
  const Facet facet(first, f);
  std::vector<Stretch> stretches;
  std::vector<double> cuts;
  for (int c : candidates) {
    const Facet opposite(second, c);
    // Surfaces that face each other run against each other.
    const Stretch stretch = {placeFacing(facet, opposite.position(1)),
                             placeFacing(facet, opposite.position(0)), c};
    if (!(stretch.begin < stretch.end))
      continue;
    stretches.push_back(stretch);
    cuts.push_back(stretch.begin);
    cuts.push_back(stretch.end);
  }
  std::sort(cuts.begin(), cuts.end());
  const int order = std::max(fem::shapeOf(first.facetType).order, fem::shapeOf(second.facetType).order);
  // Products of two basis functions, and some of the measure and the projection where they are no
  // polynomials.
  const fem::Quadrature rule = fem::quadratureOn(fem::CellType::Line2, 2 * order + 4);
  std::vector<MortarSample> samples;
  for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
    const double begin = cuts[k], end = cuts[k + 1], middle = 0.5 * (begin + end);
    if (end - begin < 1e-14)
      continue;
    int nearest = -1;
    double least = 0.0;
    for (const Stretch& stretch : stretches) {
      if (stretch.begin > begin || stretch.end < end)
        continue;
      const MortarSample sample = sampleAt(second, facet, middle, stretch.opposite);
      if (face(second, facet, sample) && (nearest < 0 || std::abs(sample.gap) < least)) {
        nearest = stretch.opposite;
        least = std::abs(sample.gap);
      }
    }
    if (nearest < 0)
      continue;
    std::vector<MortarSample> here;
    for (std::size_t q = 0; q < rule.points.size(); ++q) {
      here.push_back(sampleAt(second, facet, middle + 0.5 * (end - begin) * rule.points[q][0], nearest));
      here.back().weight *= 0.5 * (end - begin) * rule.weights[q];
      least = std::min(least, std::abs(here.back().gap));
    }
    if (least <= reach)
      samples.insert(samples.end(), here.begin(), here.end());
  }
  return samples;
}

} // namespace Harmos::contact
