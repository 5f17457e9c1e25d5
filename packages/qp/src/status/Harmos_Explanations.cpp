// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Explanations.hpp"

#include "Harmos_Log.hpp"

#include <limits>

namespace Harmos::qp::Explanations {

std::string converged() {
  return "the convergence test passed";
}

std::string breakdown() {
  return "a number is not finite or the Hessian has a negative curvature: is the operator symmetric positive "
         "semidefinite, and are its data finite?";
}

std::string interrupted() {
  return "stop requested";
}

std::string notFinite(const std::string& what) {
  return what + " holds a number that is not finite; look where it was made";
}

std::string limitsDoNotSettle(int updates) {
  return "limits that follow the solution have not settled in " + std::to_string(updates) +
         " solutions: with friction as strong as this there may be several answers, or none nearby; smaller "
         "steps of the load, or a smaller coefficient of friction, help";
}

std::string noOtherMethod(const std::string& why) {
  return why + ", and no other method takes soft bounds; is the Hessian singular along entries that nothing "
               "holds, or is the tolerance below rounding errors?";
}

std::string limit(const std::string& limit) {
  return "the limit of " + limit +
         " was reached; raise it, loosen the tolerance, or look at the history for a residual that no longer "
         "falls (a badly conditioned Hessian, or constraints that cannot be met together: in the dual "
         "problem "
         "of contact, a body that is pulled away from all that could hold it)";
}

std::string stagnation(double projectedGradient, double attainable, double equalityDistance) {
  const double terms = attainable / std::numeric_limits<double>::epsilon();
  return "the projected gradient, " + scientific(projectedGradient) +
         ", is at the level of rounding errors, " + scientific(attainable) +
         (equalityDistance > 0.0 ? ", with a distance from the equalities of " + scientific(equalityDistance)
                                 : std::string()) +
         ", and cannot be reduced to the tolerance asked for: it is a difference of terms ‖A‖‖x‖ + ‖b‖ of "
         "the size of " +
         scientific(terms) +
         ". Loosen the tolerance, or find what makes these so large (parts far stiffer or softer than the "
         "rest, "
         "loads that cancel)";
}

std::string stoppedByTest(Reason reason) {
  return "a status test stopped the solver: " + toString(reason);
}

std::string infeasible(const Certificate& certificate) {
  if (certificate.entry >= 0)
    return "no x meets the bounds: the lower bound of entry " + std::to_string(certificate.entry) +
           " lies above the upper one by " + scientific(certificate.gap);
  return "no x meets the bounds and the equalities: a combination y of the equality rows, with norm 1, has "
         "yᵀ(Cx − c) >= " +
         scientific(certificate.gap) + " within the bounds" +
         (certificate.defect > 0.0
              ? " (for all x with a norm up to " + scientific(certificate.gap / certificate.defect) + ")"
              : std::string()) +
         " (in the dual problem of contact: a body is pulled away from all that could hold it)";
}

std::string unbounded(const Certificate& certificate) {
  return "the cost falls without end along a feasible direction d, with norm 1: bᵀd = " +
         scientific(certificate.gap) + ", and curvature and equality rows vanish along it to " +
         scientific(certificate.defect) +
         " (in the dual problem of contact: constraints or gaps that contradict each other)";
}

} // namespace Harmos::qp::Explanations
