// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AnswerJudge.hpp"

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_RowErrors.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace Harmos::feti {
namespace {

// Nothing is to be had below: products with dense blocks in single precision, or rounding errors.
double leastTolerance(Precision precision) {
  return precision == Precision::Single ? 1e-7 : 1e-15;
}

} // namespace

double AnswerJudge::firstBalancedTolerance() {
  // The few products from 0.1 to here cost less than a look at an answer that is too bad to be judged, and
  // where meshes are coarse, less than a second look.
  return 1e-3;
}

AnswerJudge::AnswerJudge(DualStages stages, AnswerCriteria criteria, PreconditionerScaling scaling,
                         Precision precision, const Log& log, AnswerQuality& quality)
    : stages_(std::move(stages)),
      criteria_(std::move(criteria)),
      scaling_(scaling),
      precision_(precision),
      log_(log),
      quality_(quality) {
  quality_.gapRounding = criteria_.boundRounding;
  quality_.pairErrors.clear();
  for (const std::string& name : criteria_.groups)
    quality_.pairErrors.push_back({{}, name});
  if (!criteria_.estimatesErrors)
    return;
  extension_ = stages_.preconditioner;
  // Without one, a bound that costs nothing, and may be too large: residuals alone say little of badly shaped
  // cells.
  if (extension_.is_null())
    makeExtension(PreconditionerKind::Lumped);
}

void AnswerJudge::makeExtension(PreconditionerKind kind) {
  extension_ = Teuchos::rcp(
      new DualPreconditioner(*stages_.system, *stages_.constraints, *stages_.inverses, kind, scaling_));
  isBoundAlone_ = kind == PreconditionerKind::Lumped;
  isSharp_ = kind == PreconditionerKind::Dirichlet;
  // Estimates of two answers are compared with each other: one way for both.
  if (!before_.jumps.is_null())
    before_.forces = forcesOf(*before_.forces.multiplier, *before_.jumps);
}

void AnswerJudge::recover(const MultiVector& lambda, const std::vector<double>& mu) {
  torn_ = {}; // not two of them at once
  torn_ = feti::recover(*stages_.system, *stages_.constraints, *stages_.inverses, *stages_.coarse,
                        *stages_.problem, lambda, mu);
  quality_.audit = feti::audit(*stages_.system, *stages_.constraints, torn_);
  quality_.gapRounding =
      criteria_.boundRounding + criteria_.roundingShare * quality_.audit.largestDisplacement;
  quality_.audited = true;
  if (extension_.is_null())
    return;
  last_.jumps = Teuchos::rcp(new MultiVector(stages_.constraints->rowMap(), 1));
  stages_.constraints->residual(torn_.displacement, *torn_.multiplier, *last_.jumps);
  keepErrors(*stages_.constraints, *torn_.multiplier, *last_.jumps);
  measureErrors();
}

// The sharper bound costs as much as ten products. It is asked for where it decides: not of answers that the
// audit refuses without it.
void AnswerJudge::sharpen() {
  const auto made = Teuchos::rcp_dynamic_cast<const DualPreconditioner>(extension_);
  const bool isLumped = !made.is_null() && made->kind() == PreconditionerKind::Lumped;
  if (!(isBoundAlone_ && !auditAgrees(quality_)) && !(isLumped && forceExcess(quality_) > 1.0))
    return;
  // A bound that is too large must not refuse an answer.
  makeExtension(PreconditionerKind::Dirichlet);
  measureErrors();
}

// Whether jumps, penetrations or forces out of balance alone refuse the answer.
bool AnswerJudge::isRefusedByAudit() const {
  return !auditAgrees(quality_.audit,
                      {auditShare(quality_.tolerance), quality_.gapRounding, quality_.localDefect});
}

// M⁻¹ of jumps.
RowForces AnswerJudge::forcesOf(const MultiVector& multiplier, const MultiVector& jumps,
                                double* energy) const {
  MultiVector forces(stages_.constraints->rowMap(), 1);
  extension_->apply(jumps, forces);
  if (energy != nullptr) {
    std::vector<double> product(1);
    jumps.dot(forces, Teuchos::arrayViewFromVector(product));
    *energy = product[0];
  }
  return rowForces(*stages_.constraints, multiplier, jumps, forces);
}

// √(rᵀM⁻¹r), and M⁻¹r of each pair.
void AnswerJudge::measureErrors() {
  double energy = 0.0;
  last_.forces = forcesOf(*torn_.multiplier, *last_.jumps, &energy);
  quality_.solverError = std::sqrt(std::max(energy, 0.0));
  const bool hasBefore = !before_.jumps.is_null();
  const std::vector<ForceError> errors =
      forceErrors(*stages_.constraints, last_.forces, hasBefore ? &before_.forces : nullptr,
                  {criteria_.groupOf, static_cast<int>(quality_.pairErrors.size()), criteria_.areaOf});
  for (std::size_t k = 0; k < errors.size(); ++k)
    static_cast<ForceError&>(quality_.pairErrors[k]) = errors[k];
}

std::optional<double> AnswerJudge::balance(double tolerance) {
  const double solver = quality_.solverError;
  // Jumps are errors of the stresses too: an estimate from an answer whose own error is larger than what it
  // estimates is good for no more than the next step.
  if (!discretisation_ || (!trusted_ && solver <= criteria_.solverErrorShare * discretisation_->error)) {
    discretisation_ = criteria_.estimate(torn_.displacement);
    trusted_ = solver <= discretisation_->error;
  }
  quality_.discretisationError = discretisation_->error / discretisation_->norm;
  const double allowed = criteria_.solverErrorShare * discretisation_->error;
  quality_.allowedError = allowed / discretisation_->norm;
  const bool enough = solver <= allowed;
  std::ostringstream text;
  text << "Tolerance " << scientific(tolerance, 1) << ": estimated error in the energy norm of the solver "
       << scientific(solver / discretisation_->norm, 1) << ", of the discretisation "
       << scientific(quality_.discretisationError, 1) << (trusted_ ? "" : " at most")
       << (enough ? ": accepted" : "");
  log_.info(text.str());
  if (enough)
    return std::nullopt;
  // Errors fall about like residuals; a third and more, so that few checks are needed, and no more than a
  // hundredth, since the estimate of a bad answer is bad itself.
  return tolerance * std::clamp(0.7 * allowed / solver, 0.01, 1.0 / 3.0);
}

Verdict AnswerJudge::judge(const MultiVector& lambda, const std::vector<double>& mu, double tolerance) {
  before_ = last_;
  recover(lambda, mu);
  if (!extension_.is_null() && (criteria_.rule == ToleranceRule::Balanced || !isRefusedByAudit()))
    sharpen();
  quality_.reachedTolerance = tolerance;
  std::optional<double> next = improve(tolerance);
  const bool isEnough = !next;
  if (isEnough)
    next = improveForces(tolerance);
  if (next && *next < leastTolerance(precision_))
    return {};
  return {next, isEnough && forceExcess(quality_) <= mostForceExcess};
}

// Forces of pairs that are measured by themselves.
std::optional<double> AnswerJudge::improveForces(double tolerance) {
  const double excess = forceExcess(quality_);
  if (!auditAgrees(quality_) || !(excess > 1.0))
    return std::nullopt;
  const PairError* const worst = worstPair(quality_);
  log_.info("Estimated relative error of the forces of \"" + worst->path + "\": " + forceErrorText(*worst) +
            " (force " + scientific(worst->force) + ", all forces " + scientific(quality_.audit.forces) +
            "): continue with a smaller tolerance");
  // Errors fall about like residuals, and the estimate of a bad answer is bad itself.
  return tolerance * std::clamp(0.5 / excess, 0.01, 0.5);
}

std::optional<double> AnswerJudge::improve(double tolerance) {
  std::optional<double> next;
  if (criteria_.rule == ToleranceRule::Balanced) {
    quality_.tolerance = tolerance;
    next = balance(tolerance);
  }
  if (!next && !auditAgrees(quality_)) {
    log_.info("Audit contradicts the residuals (jump " + scientific(quality_.audit.gluingJump) +
              ", penetration " + scientific(quality_.audit.penetration) + ", displacements up to " +
              scientific(quality_.audit.largestDisplacement) + "; error " + scientific(quality_.solverError) +
              " of " + scientific(quality_.audit.energyNorm) +
              " in the energy norm): continue with a smaller tolerance");
    // Errors fall about like residuals: where they alone are too large, no further than they ask for.
    const double share = std::max(energyErrorShare(quality_.tolerance), std::min(quality_.allowedError, 0.1));
    const double allowed = share * quality_.audit.energyNorm;
    next = tolerance * (!isRefusedByAudit() && quality_.solverError > 0.0
                            ? std::clamp(0.5 * allowed / quality_.solverError, 0.1, 0.5)
                            : 0.1);
  }
  return next;
}

void AnswerJudge::exchange(qp::StateArchive<MultiVector>& archive) {
  std::vector<double> known;
  if (discretisation_)
    known = {discretisation_->error, discretisation_->norm};
  archive.numbers("discretisation error", known);
  archive.number("discretisation error trusted", trusted_);
  if (known.size() == 2)
    discretisation_ = DiscretisationError{known[0], known[1]};
  bool isSharp = isSharp_;
  archive.number("bound sharpened", isSharp);
  if (isSharp && !isSharp_)
    makeExtension(PreconditionerKind::Dirichlet);
  bool hasForces = !last_.jumps.is_null();
  archive.number("forces judged", hasForces);
  if (!hasForces)
    return;
  for (Teuchos::RCP<MultiVector>* vector : {&last_.forces.multiplier, &last_.forces.error, &last_.jumps})
    if (vector->is_null())
      *vector = Teuchos::rcp(new MultiVector(stages_.constraints->rowMap(), 1));
  archive.vector("forces judged: multiplier", *last_.forces.multiplier);
  archive.vector("forces judged: error", *last_.forces.error);
  archive.vector("forces judged: jumps", *last_.jumps);
}

TornSolution AnswerJudge::finish(const MultiVector& lambda, const std::vector<double>& mu,
                                 bool isLastJudged) {
  if (!isLastJudged) {
    recover(lambda, mu);
    if (!extension_.is_null())
      sharpen();
  }
  return std::move(torn_);
}

double energyError(const DualStages& stages, PreconditionerScaling scaling, const TornSolution& answer) {
  Teuchos::RCP<const Operator> extension = stages.preconditioner;
  if (extension.is_null())
    extension = Teuchos::rcp(new DualPreconditioner(*stages.system, *stages.constraints, *stages.inverses,
                                                    PreconditionerKind::Lumped, scaling));
  MultiVector rows(stages.constraints->rowMap(), 1), forces(stages.constraints->rowMap(), 1);
  stages.constraints->residual(answer.displacement, *answer.multiplier, rows);
  keepErrors(*stages.constraints, *answer.multiplier, rows);
  extension->apply(rows, forces);
  std::vector<double> product(1);
  rows.dot(forces, Teuchos::arrayViewFromVector(product));
  return std::sqrt(std::max(0.0, product[0]));
}

} // namespace Harmos::feti
