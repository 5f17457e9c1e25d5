// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BlockOps.hpp"
#include "Harmos_BoundOps.hpp"
#include "Harmos_BoundTraits.hpp"
#include "Harmos_CoulombLimits.hpp"
#include "Harmos_QpProblem.hpp"

#include <BelosMultiVecTraits.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace Harmos::qp {

template<class Scalar, class MV, class OP>
Problem<Scalar, MV, OP>::Problem(Teuchos::RCP<const OP> hessian, Teuchos::RCP<MV> solution,
                                 Teuchos::RCP<const MV> rhs)
    : hessian_(hessian), rhs_(rhs), solution_(solution) {}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setHessian(Teuchos::RCP<const OP> hessian) {
  hessian_ = hessian;
  known_.hessianNorm = 0.0;
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
  terms_.lower = lower;
  refuse("setProblem() was not called after setLowerBound()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setUpperBound(Teuchos::RCP<const MV> upper) {
  terms_.upper = upper;
  refuse("setProblem() was not called after setUpperBound()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setDiscs(std::shared_ptr<const LocalDiscs> discs) {
  terms_.discs = std::move(discs);
  refuse("setProblem() was not called after setDiscs()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setFollowingLimits(std::shared_ptr<const FollowingLimits> limits) {
  terms_.following = std::move(limits);
  refuse("setProblem() was not called after setFollowingLimits()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setSoftBounds(std::shared_ptr<const LocalSoftBounds> bounds) {
  terms_.soft = std::move(bounds);
  refuse("setProblem() was not called after setSoftBounds()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::addBlock(std::shared_ptr<NonsmoothBlock> block) {
  terms_.others.push_back(std::move(block));
  refuse("setProblem() was not called after addBlock()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::follow() {
  for (const auto& block : blocks_)
    block->follow(BoundTraits<Scalar, MV>::read(*solution_), nullptr, {});
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::moveToLimits(const ActiveFace& face) {
  for (const auto& block : blocks_)
    block->moveToLimits(face, BoundTraits<Scalar, MV>::write(*solution_));
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::limits(MV& radii) const {
  Belos::MultiVecTraits<Scalar, MV>::MvInit(radii, 0.0);
  for (const auto& block : blocks_)
    block->putLimits(BoundTraits<Scalar, MV>::write(radii));
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setLimits(const MV& radii) {
  for (const auto& block : blocks_)
    block->takeLimits(BoundTraits<Scalar, MV>::read(radii));
}

template<class Scalar, class MV, class OP>
Teuchos::RCP<Problem<Scalar, MV, OP>> Problem<Scalar, MV, OP>::frozen() const {
  const auto copy = Teuchos::rcp(new Problem(*this));
  copy->terms_.following = nullptr;
  copy->makeBlocks();
  return copy;
}

// What follows must not be what others hold.
template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::ownLimits() {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (terms_.lower != own_.lower)
    terms_.lower = own_.lower = MVT::CloneCopy(*terms_.lower);
  if (!terms_.upper.is_null() && terms_.upper != own_.upper)
    terms_.upper = own_.upper = MVT::CloneCopy(*terms_.upper);
  if (terms_.discs && terms_.discs != own_.discs)
    terms_.discs = own_.discs = std::make_shared<LocalDiscs>(*terms_.discs);
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::makeBlocks() {
  blocks_ = BlockOps<Scalar, MV>::setsOf(feasibleSet());
  if (terms_.soft)
    blocks_.push_back(std::make_shared<SoftIntervals>(*terms_.soft));
  blocks_.insert(blocks_.end(), terms_.others.begin(), terms_.others.end());
  if (terms_.following)
    blocks_.push_back(
        std::make_shared<CoulombLimits<Scalar, MV>>(terms_.following, own_.lower, own_.upper, own_.discs));
}

template<class Scalar, class MV, class OP>
NonsmoothBlock::Kind Problem<Scalar, MV, OP>::kind() const {
  NonsmoothBlock::Kind result;
  for (const auto& block : blocks_) {
    const NonsmoothBlock::Kind its = block->kind();
    result.isSet = result.isSet && its.isSet;
    result.isPiecewiseLinear = result.isPiecewiseLinear && its.isPiecewiseLinear;
    result.isCost = result.isCost && its.isCost;
  }
  return result;
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setEquality(Teuchos::RCP<const OP> rows, Teuchos::RCP<const MV> values,
                                          Teuchos::RCP<MV> multiplier, EqualityStructure structure) {
  equalities_.rows = rows;
  equalities_.values = values;
  equalities_.multiplier = multiplier;
  equalities_.structure = structure;
  refuse("setProblem() was not called after setEquality()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setHessianNorm(double norm) {
  known_.hessianNorm = norm;
  refuse("setProblem() was not called after setHessianNorm()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setUnprojectedHessian(Teuchos::RCP<const OP> hessian) {
  known_.unprojectedHessian = hessian;
  refuse("setProblem() was not called after setUnprojectedHessian()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setPreconditioner(Teuchos::RCP<const OP> preconditioner) {
  known_.preconditioner = preconditioner;
  refuse("setProblem() was not called after setPreconditioner()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setFacePreconditioner(Teuchos::RCP<FacePreconditioner<MV, OP>> maker) {
  known_.facePreconditioner = maker;
  refuse("setProblem() was not called after setFacePreconditioner()");
}

template<class Scalar, class MV, class OP>
void Problem<Scalar, MV, OP>::setNullSpace(Teuchos::RCP<const MV> kernel) {
  known_.nullSpace = kernel;
  refuse("setProblem() was not called after setNullSpace()");
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::refuse(const std::string& fault) {
  set_ = false;
  fault_ = fault;
  return false;
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::isOnAnyRank(bool is) const {
  return BoundTraits<Scalar, MV>::maximum(*solution_, is ? 1.0 : 0.0) > 0.0;
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::areFollowable() const {
  const LocalDiscs* const discs = terms_.discs.get();
  const auto length = static_cast<int>(BoundTraits<Scalar, MV>::length(*solution_));
  return std::all_of(terms_.following->begin(), terms_.following->end(), [&](const FollowingLimit& limit) {
    const bool isPlace = limit.isDisc
                             ? discs != nullptr && limit.place < static_cast<int>(discs->discs().size())
                             : !terms_.upper.is_null() && limit.place < length;
    return limit.place >= 0 && isPlace && limit.source >= 0 && limit.source < length && limit.factor >= 0.0 &&
           std::isfinite(limit.factor);
  });
}

// Whether what is neither bound nor disc is alone on its entries. Local.
template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::areDisjoint() const {
  const std::size_t length = BoundTraits<Scalar, MV>::length(*solution_);
  const Blocks sets = BlockOps<Scalar, MV>::setsOf(feasibleSet());
  std::vector<char> isTaken = BlockOps<Scalar, MV>::marked(sets, length);
  if (hasFollowingLimits()) // whose radii need not be there yet
    for (const FollowingLimit& limit : *terms_.following)
      if (!limit.isDisc)
        isTaken[static_cast<std::size_t>(limit.place)] = 1;
  for (std::size_t k = sets.size(); k < blocks_.size(); ++k) {
    std::vector<char> marked(length, 0);
    blocks_[k]->mark(marked.data());
    for (std::size_t i = 0; i < length; ++i) {
      if (marked[i] != 0 && isTaken[i] != 0)
        return false;
      isTaken[i] = static_cast<char>(isTaken[i] | marked[i]);
    }
  }
  return true;
}

template<class Scalar, class MV, class OP>
std::string Problem<Scalar, MV, OP>::faultOfVectors() const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  if (hessian_.is_null() || rhs_.is_null() || solution_.is_null())
    return "the Hessian, the right-hand side or the solution vector is missing";
  if (MVT::GetNumberVecs(*rhs_) != 1 || MVT::GetNumberVecs(*solution_) != 1)
    return "the right-hand side and the solution must have one column each";
  const auto length = MVT::GetGlobalLength(*solution_);
  if (MVT::GetGlobalLength(*rhs_) != length)
    return "the right-hand side and the solution differ in length";
  for (const Teuchos::RCP<const MV>& bound : {terms_.lower, terms_.upper})
    if (!bound.is_null() && MVT::GetGlobalLength(*bound) != length)
      return "a bound and the solution differ in length";
  if (!known_.nullSpace.is_null() && MVT::GetGlobalLength(*known_.nullSpace) != length)
    return "the null space and the solution differ in length";
  if (!(known_.hessianNorm >= 0.0))
    return "the given norm of the Hessian is negative or not a number";
  return "";
}

template<class Scalar, class MV, class OP>
std::string Problem<Scalar, MV, OP>::faultOfTerms() const {
  const std::size_t length = BoundTraits<Scalar, MV>::length(*solution_);
  if (isOnAnyRank(hasDiscs()) && isOnAnyRank(!hasDiscs()))
    return "discs are given on some ranks only; give empty ones on the others";
  if (hasDiscs() && isOnAnyRank(terms_.discs->length() != length))
    return "discs do not match the length of the solution on a rank";
  const bool isSoft = terms_.soft != nullptr;
  if (isOnAnyRank(isSoft) && isOnAnyRank(!isSoft))
    return "soft bounds are given on some ranks only; give empty ones on the others";
  if (isSoft && isOnAnyRank(terms_.soft->length() != length))
    return "soft bounds do not match the length of the solution on a rank";
  if (isSoft && isOnAnyRank(!terms_.soft->areSound()))
    return "a soft bound is not a number, its lower end exceeds the upper one, or its curvature is negative "
           "or not finite";
  const BoundFault fault = BoundOps<Scalar, MV>::findBoundFault(*solution_, feasibleSet());
  if (fault.found && !(fault.lower > fault.upper))
    return "the bounds of entry " + std::to_string(fault.entry) +
           " are not numbers, a lower one is +infinity or an upper one -infinity, or the entry is in a disc "
           "and also has bounds, or its disc has a centre or radius that is not finite";
  return "";
}

template<class Scalar, class MV, class OP>
std::string Problem<Scalar, MV, OP>::faultOfLimits() const {
  if (isOnAnyRank(hasFollowingLimits()) && isOnAnyRank(!hasFollowingLimits()))
    return "solution-dependent limits are given on some ranks only; give empty ones on the others";
  if (hasFollowingLimits() && (terms_.lower.is_null() || isOnAnyRank(!areFollowable())))
    return "a solution-dependent limit belongs to no interval or disc, depends on an entry without lower "
           "bound, or has a factor that is negative or not a number";
  return "";
}

template<class Scalar, class MV, class OP>
std::string Problem<Scalar, MV, OP>::faultOfEqualities() const {
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  const auto& [rows, values, multiplier, structure] = equalities_;
  if (!rows.is_null() && (values.is_null() || multiplier.is_null()))
    return "equality rows need their right-hand side and a multiplier vector";
  if (!rows.is_null() && MVT::GetGlobalLength(*values) != MVT::GetGlobalLength(*multiplier))
    return "the right-hand side of the equalities and the multiplier differ in length";
  if (!known_.unprojectedHessian.is_null() &&
      (rows.is_null() || structure != EqualityStructure::OrthonormalInvariant))
    return "a Hessian that is not yet projected needs equality rows with A = PFP; declare them with "
           "EqualityStructure::OrthonormalInvariant";
  return "";
}

template<class Scalar, class MV, class OP>
bool Problem<Scalar, MV, OP>::setProblem() {
  for (auto find : {&Problem::faultOfVectors, &Problem::faultOfTerms, &Problem::faultOfLimits,
                    &Problem::faultOfEqualities})
    if (const std::string fault = (this->*find)(); !fault.empty())
      return refuse(fault);
  if (hasFollowingLimits())
    ownLimits();
  makeBlocks();
  if (isOnAnyRank(!areDisjoint()))
    return refuse("an entry with a soft bound, or a block of its own, has another bound, a disc or a "
                  "solution-dependent limit");
  set_ = true;
  fault_.clear();
  return true;
}

} // namespace Harmos::qp
