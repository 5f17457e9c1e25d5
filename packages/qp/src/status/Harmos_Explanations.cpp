// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Explanations.hpp"

#include "Harmos_Log.hpp"

#include <limits>

namespace Harmos::qp::Explanations {

std::string converged() {
  return "the convergence test passed";
}

std::string breakdown() {
  return "breakdown: a value is not finite or the Hessian has negative curvature; check that the operator is "
         "symmetric positive semidefinite and its data finite";
}

std::string interrupted() {
  return "stop requested";
}

std::string notFinite(const std::string& what) {
  return what + " contains a value that is not finite; check the data that it is computed from";
}

std::string limitsDoNotSettle(int updates) {
  return "the solution-dependent limits did not converge in " + std::to_string(updates) +
         " updates: strong friction can have several solutions or none nearby. Use smaller load steps or a "
         "smaller coefficient of friction";
}

std::string noOtherMethod(const std::string& why) {
  return why + ", and no other method takes such terms (soft bounds, or an application's own). Check for "
               "entries without any constraint, where the Hessian is singular, and for a tolerance below "
               "rounding errors, which go with the largest curvature";
}

std::string limit(const std::string& limit) {
  return "the limit of " + limit +
         " was reached. Raise it or loosen the tolerance; a residual that stagnates in the history points to "
         "an ill-conditioned Hessian or to infeasible constraints (in contact: a body pulled away from all "
         "supports)";
}

std::string stagnation(double projectedGradient, double attainable, double equalityDistance) {
  const double terms = attainable / std::numeric_limits<double>::epsilon();
  return "the projected gradient, " + scientific(projectedGradient) +
         ", is at the level of rounding errors, " + scientific(attainable) +
         (equalityDistance > 0.0 ? ", with a distance from the equalities of " + scientific(equalityDistance)
                                 : std::string()) +
         ", above the requested tolerance: its terms ‖A‖‖x‖ + ‖b‖ are of size " + scientific(terms) +
         ". Loosen the tolerance, or remove the cause of such large terms (parts far stiffer or softer than "
         "the rest, loads that cancel)";
}

std::string stoppedByTest(Reason reason) {
  return "a status test stopped the solver: " + toString(reason);
}

std::string infeasible(const Certificate& certificate) {
  if (certificate.entry >= 0)
    return "no x satisfies the bounds: the lower bound of entry " + std::to_string(certificate.entry) +
           " lies above the upper one by " + scientific(certificate.gap);
  return "no x satisfies the bounds and the equalities: a combination y of the equality rows, of norm 1, has "
         "yᵀ(Cx − c) >= " +
         scientific(certificate.gap) + " within the bounds" +
         (certificate.defect > 0.0
              ? " (for all x with a norm up to " + scientific(certificate.gap / certificate.defect) + ")"
              : std::string()) +
         " (in contact: a body is pulled away from all supports)";
}

std::string unbounded(const Certificate& certificate) {
  return "the cost is unbounded below along a feasible direction d of norm 1: bᵀd = " +
         scientific(certificate.gap) + "; curvature and equality rows along it are at most " +
         scientific(certificate.defect) + " (in contact: contradictory constraints or gaps)";
}

} // namespace Harmos::qp::Explanations
