// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BoundTraits.hpp"
#include "Harmos_QpProblem.hpp"

#include <BelosMultiVecTraits.hpp>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
Problem<Scalar, MV, OP>::Problem(Teuchos::RCP<const OP> hessian, Teuchos::RCP<MV> solution,
                                 Teuchos::RCP<const MV> rhs)
    : hessian_(hessian), rhs_(rhs), solution_(solution) {}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setHessian(Teuchos::RCP<const OP> hessian) {
  hessian_ = hessian;
  hessianNorm_ = 0.0;
  refuse("setProblem() was not called after setHessian()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setRhs(Teuchos::RCP<const MV> rhs) {
  rhs_ = rhs;
  refuse("setProblem() was not called after setRhs()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setSolution(Teuchos::RCP<MV> solution) {
  solution_ = solution;
  refuse("setProblem() was not called after setSolution()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setLowerBound(Teuchos::RCP<const MV> lower) {
  lower_ = lower;
  refuse("setProblem() was not called after setLowerBound()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setUpperBound(Teuchos::RCP<const MV> upper) {
  upper_ = upper;
  refuse("setProblem() was not called after setUpperBound()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setDiscs(std::shared_ptr<const LocalDiscs> discs) {
  discs_ = std::move(discs);
  refuse("setProblem() was not called after setDiscs()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setEquality(Teuchos::RCP<const OP> rows, Teuchos::RCP<const MV> values,
                                          Teuchos::RCP<MV> multiplier, EqualityStructure structure) {
  equality_ = rows;
  equalityValues_ = values;
  multiplier_ = multiplier;
  structure_ = structure;
  refuse("setProblem() was not called after setEquality()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setHessianNorm(double norm) {
  hessianNorm_ = norm;
  refuse("setProblem() was not called after setHessianNorm()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setPreconditioner(Teuchos::RCP<const OP> preconditioner) {
  preconditioner_ = preconditioner;
  refuse("setProblem() was not called after setPreconditioner()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setFacePreconditioner(Teuchos::RCP<FacePreconditioner<MV, OP>> maker) {
  facePreconditioner_ = maker;
  refuse("setProblem() was not called after setFacePreconditioner()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setNullSpace(Teuchos::RCP<const MV> kernel) {
  nullSpace_ = kernel;
  refuse("setProblem() was not called after setNullSpace()");
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::refuse(const std::string& fault) {
  set_ = false;
  fault_ = fault;
  return false;
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::setProblem() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (hessian_.is_null() || rhs_.is_null() || solution_.is_null())
    return refuse("the Hessian, the right-hand side or the solution vector is missing");
  if (MVT::GetNumberVecs(*rhs_) != 1 || MVT::GetNumberVecs(*solution_) != 1)
    return refuse("the right-hand side and the solution must have one column each");
  const auto length = MVT::GetGlobalLength(*solution_);
  if (MVT::GetGlobalLength(*rhs_) != length)
    return refuse("the right-hand side and the solution differ in length");
  for (const Teuchos::RCP<const MV>& bound : {lower_, upper_})
    if (!bound.is_null() && MVT::GetGlobalLength(*bound) != length)
      return refuse("a bound and the solution differ in length");
  const auto onAnyRank = [&](bool is) {
    return BoundTraits<Scalar, MV>::maximum(*solution_, is ? 1.0 : 0.0) > 0.0;
  };
  if (onAnyRank(hasDiscs()) && onAnyRank(!hasDiscs()))
    return refuse(
        "discs are given on some ranks and not on the others: give empty ones where there are none");
  if (hasDiscs() && onAnyRank(!BoundTraits<Scalar, MV>::isFit(*solution_, *discs_)))
    return refuse("discs are those of a vector of another length on a rank");
  const BoundFault fault = BoundTraits<Scalar, MV>::findBoundFault(*solution_, feasibleSet());
  if (fault.found && !(fault.lower > fault.upper))
    return refuse(
        "the bounds of entry " + std::to_string(fault.entry) +
        " are not numbers, or a lower one is +infinity or an upper one -infinity; or it is in a disc "
        "and has bounds of its own, or in one whose centre or radius is not a finite number");
  if (!nullSpace_.is_null() && MVT::GetGlobalLength(*nullSpace_) != length)
    return refuse("the null space and the solution differ in length");
  if (!equality_.is_null() && (equalityValues_.is_null() || multiplier_.is_null()))
    return refuse("equality rows need their right-hand side and a multiplier vector");
  if (!equality_.is_null() && MVT::GetGlobalLength(*equalityValues_) != MVT::GetGlobalLength(*multiplier_))
    return refuse("the right-hand side of the equalities and the multiplier differ in length");
  if (!(hessianNorm_ >= 0.0))
    return refuse("the given norm of the Hessian is negative or not a number");
  set_ = true;
  fault_.clear();
  return true;
}

} // namespace Harmos::qp
