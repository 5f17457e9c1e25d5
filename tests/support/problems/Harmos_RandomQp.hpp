// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_TestQp.hpp"

#include <limits>
#include <random>
#include <vector>

namespace Harmos {

constexpr double infinity = std::numeric_limits<double>::infinity();

double norm(const std::vector<double>& x);
double distance(const std::vector<double>& x, const std::vector<double>& y);
std::vector<double> product(const Dense& m, const std::vector<double>& x);
/// Cx − c.
std::vector<double> equalityResidual(const SmallQp& qp, const std::vector<double>& x);
/// Ax − b + Cᵀμ.
std::vector<double> lagrangianGradient(const SmallQp& qp, const std::vector<double>& x,
                                       const std::vector<double>& mu);
/// inf yᵀ(Cx − c) over l ≤ x ≤ u, |x_i| ≤ radius.
double farkasInfimum(const SmallQp& qp, const std::vector<double>& y, double radius);

/// A problem built around a solution: b = Ax − y + Cᵀμ with multipliers y of the right sign.
struct BuiltQp {
  SmallQp qp;
  std::vector<double> x;
};

/// @param nullity of A; its other eigenvalues lie in [1, 100]. @param degenerate active entries with a zero
/// multiplier among others.
BuiltQp builtQp(std::mt19937& random, int n, int equalities, int nullity, bool degenerate);

/// Appends rows that are combinations of those there, with consistent right-hand sides, scaled by 1e-3…1e3.
void addDependentRows(std::mt19937& random, SmallQp& qp, int count);

/// @param kind 0: a pair of bounds crosses; 1: dependent rows contradict each other, no bounds; 2: the
/// equalities miss a two-sided box; 3: they miss an orthant.
SmallQp infeasibleQp(std::mt19937& random, int n, int kind);

/// A semidefinite problem with a feasible direction d, Ad = 0, Cd = 0, bᵀd > 0.
SmallQp unboundedQp(std::mt19937& random, int n, int equalities, bool bounds);

/// Points with a normal entry above zero and one or two tangential ones behind it, whose limit is the factor
/// times the normal one; free entries after them. The equalities are met by a point within the cones: there
/// is a solution for factors that are not large.
SmallQp followingQp(std::mt19937& random, int points, int tangents, int freeEntries, int equalities,
                    double factor);

/// Discs with all their rim at hand, that turn while they are pushed: the friction of a body's points has to
/// balance, and the last one to slip sticks. Pairs of a normal and a tangential entry.
SmallQp turningBodiesQp(std::mt19937& random, int bodies, int points, double factor);

} // namespace Harmos
