// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_Types.hpp"

namespace Harmos::qp {

/// Bounds on Tpetra vectors, on the host.
template<>
struct BoundTraits<Scalar, MultiVector> {
  static SplitSums split(const MultiVector& x, const MultiVector& gradient,
                         const FeasibleSet<MultiVector>& feasible, double stepLength, MultiVector* direction,
                         LocalActiveSet& active);
  static CurvatureSums curvature(const MultiVector& gradient, const MultiVector& direction,
                                 const MultiVector& image, const LocalActiveSet& active);
  static ResidualSums residualSums(const MultiVector& w, const MultiVector& z, const MultiVector& image,
                                   const MultiVector& x);
  static CurvatureSums localCurvature(const MultiVector& gradient, const MultiVector& direction,
                                      const MultiVector& image, const LocalActiveSet& active);
  static ResidualSums localResidualSums(const MultiVector& w, const MultiVector& z, const MultiVector& image,
                                        const MultiVector& x);
  static SplitSums advance(MultiVector& x, MultiVector& gradient, const MultiVector& direction,
                           const MultiVector& image, double step, double beta, bool toBoundary,
                           const FeasibleSet<MultiVector>& feasible, double stepLength, MultiVector& next,
                           LocalActiveSet& active);
  static double conjugate(const MultiVector& x, const MultiVector& z, double beta,
                          const FeasibleSet<MultiVector>& feasible, MultiVector& direction);
  static double choppedDirection(const MultiVector& x, const MultiVector& gradient,
                                 const FeasibleSet<MultiVector>& feasible, MultiVector& direction);
  static void projectedStep(MultiVector& x, MultiVector& xOld, const MultiVector& direction, double step,
                            const FeasibleSet<MultiVector>& feasible);
  static ChangeSums change(const MultiVector& x, const MultiVector& xOld, const MultiVector& gradient,
                           const MultiVector& gradientOld);
  static double projectedGradientNorm(const MultiVector& x, const MultiVector& gradient,
                                      const FeasibleSet<MultiVector>& feasible);
  static void project(MultiVector& x, const FeasibleSet<MultiVector>& feasible);
  static void projectSmoothly(const MultiVector& v, const FeasibleSet<MultiVector>& feasible, double width,
                              MultiVector& x, MultiVector& slope, std::vector<Slip>& rims);
  static void multiply(const MultiVector& w, MultiVector& v);
  static void maskActive(MultiVector& v, const LocalActiveSet& active);
  static void activeToVector(const LocalActiveSet& active, MultiVector& v);
  static void vectorToActive(const MultiVector& v, LocalActiveSet& active);
  static void addCurvature(const LocalActiveSet& active, double f, const MultiVector& x, bool fromCentre,
                           MultiVector& y);
  static void addAtSlips(const LocalActiveSet& active, const std::function<double(double)>& f,
                         const MultiVector& x, MultiVector& y);
  static SlipSums slipSums(const LocalActiveSet& active, double q, const MultiVector& w);
  static void slipsToVectors(const LocalActiveSet& active, MultiVector& normals, MultiVector& curvatures);
  static void vectorsToSlips(const FeasibleSet<MultiVector>& feasible, const MultiVector& normals,
                             const MultiVector& curvatures, LocalActiveSet& active);
  static void moveToBounds(MultiVector& x, const FeasibleSet<MultiVector>& feasible,
                           const LocalActiveSet& active);
  static ActiveSetChange updateActiveSet(const MultiVector& x, const MultiVector& gradient,
                                         const FeasibleSet<MultiVector>& feasible, double xNoise,
                                         double gradientNoise, LocalActiveSet& set,
                                         const DiscUpdate& discs = {});
  static void follow(const MultiVector& x, const MultiVector* gradient, const FollowUpdate& how,
                     const std::vector<FollowingLimit>& limits, MultiVector& lower, MultiVector* upper,
                     LocalDiscs* discs);
  static FollowChange updateFollowing(const MultiVector& x, const MultiVector& gradient,
                                      const FeasibleSet<MultiVector>& feasible,
                                      const std::vector<FollowingLimit>& limits, double stepLength,
                                      double gradientNoise, const LocalActiveSet& before,
                                      LocalActiveSet& set);
  static void addFollowing(const std::vector<FollowingEntry>& following, const MultiVector& x,
                           MultiVector& y);
  static void moveToFollowing(const std::vector<FollowingEntry>& following, const MultiVector& lower,
                              MultiVector& x);
  static void moveToLimits(MultiVector& x, const FeasibleSet<MultiVector>& feasible,
                           const std::vector<FollowingLimit>& limits, const LocalActiveSet& active);
  static void limitsToVector(const std::vector<FollowingLimit>& limits,
                             const FeasibleSet<MultiVector>& feasible, MultiVector& radii);
  static void vectorToLimits(const std::vector<FollowingLimit>& limits, const MultiVector& radii,
                             MultiVector& lower, MultiVector* upper, LocalDiscs* discs);
  static long long changed(const MultiVector& like, const LocalActiveSet& before, const LocalActiveSet& set);
  static void projectOntoCones(MultiVector& x, const FeasibleSet<MultiVector>& feasible,
                               const std::vector<FollowingLimit>& limits);
  static Kernels::SecondOrderCones conesOf(const FeasibleSet<MultiVector>& feasible, const MultiVector& like,
                                           const std::vector<FollowingLimit>* limits);
  static std::vector<double> localEntries(const MultiVector& v);
  static void setLocalEntries(const std::vector<double>& entries, MultiVector& v);
  static BoxInfimum coneInfimum(const MultiVector& w, const FeasibleSet<MultiVector>& feasible,
                                const std::vector<FollowingLimit>& limits);
  static BoxInfimum boxInfimum(const MultiVector& w, const FeasibleSet<MultiVector>& feasible);
  static double projectOntoRecessionCone(MultiVector& d, const FeasibleSet<MultiVector>& feasible);
  static bool isFit(const MultiVector& like, const LocalDiscs& discs);
  static bool isFit(const MultiVector& like, const LocalSoftBounds& bounds);
  static void read(const MultiVector& v, const std::function<void(const double*)>& use);
  static void write(MultiVector& v, const std::function<void(double*)>& use);
  static void sum(const MultiVector& like, double* sums, int count);
  static BoundFault findBoundFault(const MultiVector& like, const FeasibleSet<MultiVector>& feasible);
  static void setRandom(MultiVector& x);
  static std::vector<double> gather(const MultiVector& v);
  static void scatter(const std::vector<double>& values, MultiVector& v);
  static double maximum(const MultiVector& like, double value);
};

} // namespace Harmos::qp
