// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AnswerCheck.hpp"

#include "Harmos_DualOperator.hpp"
#include "Harmos_DualPreconditioner.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_KktAudit.hpp"
#include "Harmos_RowErrors.hpp"

#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <unordered_map>

namespace Harmos::run {
namespace {

// Nothing is to be had below: products with dense blocks in single precision, or rounding errors.
double leastTolerance(const RunReport& report) {
  return report.isSingle ? 1e-7 : 1e-15;
}

// An entry for each effect with rows; the place of each row's.
std::vector<int> groups(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                        const scene::ContactSetup& contact, std::vector<PairError>& pairs) {
  std::unordered_map<const scene::Effect*, std::size_t> places;
  for (std::size_t k = 0; k < scene.effects.size(); ++k)
    places[scene.effects[k].get()] = k;
  std::vector<double> rows(scene.effects.size(), 0.0);
  for (const scene::ContactSetup::Origin& origin : contact.origins)
    rows[places.at(origin.effect)] += 1.0;
  globalSum(comm, rows);
  const std::vector<std::string> paths = scene.effectPaths();
  std::vector<int> pairOf(rows.size(), -1);
  pairs.clear();
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (rows[k] > 0.0) {
      pairOf[k] = static_cast<int>(pairs.size());
      pairs.push_back({{}, paths[k]});
    }
  std::vector<int> result;
  for (const scene::ContactSetup::Origin& origin : contact.origins)
    result.push_back(pairOf[places.at(origin.effect)]);
  return result;
}

} // namespace

double firstBalancedTolerance() {
  // The few products from 0.1 to here cost less than a look at an answer that is too bad to be judged, and
  // where meshes are coarse, less than a second look.
  return 1e-3;
}

AnswerCheck::AnswerCheck(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                         const std::vector<scene::OwnedSubdomain>& owned, const feti::DualStages& stages,
                         const scene::ContactSetup& contact, const RunOptions& options, double time,
                         const Log& log, RunReport& report)
    : comm_(comm),
      scene_(scene),
      owned_(owned),
      stages_(stages),
      groupOf_(groups(comm, scene, contact, report.pairErrors)),
      options_(options),
      time_(time),
      log_(log),
      report_(report) {
  extension_ = stages.preconditioner;
  // Without one, a bound that costs nothing, and may be too large: residuals alone say little of badly shaped
  // cells.
  if (extension_.is_null())
    makeExtension(feti::PreconditionerKind::Lumped);
}

void AnswerCheck::makeExtension(feti::PreconditionerKind kind) {
  extension_ = Teuchos::rcp(new feti::DualPreconditioner(
      stages_.system, stages_.constraints, stages_.inverses, kind,
      options_.dual.scalingFor(scene_.hasSeveralMaterials(), scene_.materialContrast())));
  isBoundAlone_ = kind == feti::PreconditionerKind::Lumped;
}

void AnswerCheck::recover(const MultiVector& lambda, const std::vector<double>& mu) {
  torn_ = {}; // not two of them at once
  torn_ = feti::recover(stages_.system, stages_.constraints, stages_.inverses, stages_.coarse,
                        stages_.problem, lambda, mu);
  report_.audit = feti::audit(stages_.system, stages_.constraints, torn_);
  report_.audited = true;
  estimate();
  const auto made = Teuchos::rcp_dynamic_cast<const feti::DualPreconditioner>(extension_);
  const bool isLumped = !made.is_null() && made->kind() == feti::PreconditionerKind::Lumped;
  if (!(isBoundAlone_ && !auditAgrees(report_)) && !(isLumped && forceExcess() > 1.0))
    return;
  // A bound that is too large must not refuse an answer.
  makeExtension(feti::PreconditionerKind::Dirichlet);
  estimate();
}

// √(rᵀM⁻¹r), and M⁻¹r of each pair.
void AnswerCheck::estimate() {
  MultiVector jumps(stages_.constraints.rowMap(), 1), forces(stages_.constraints.rowMap(), 1);
  stages_.constraints.residual(torn_.displacement, *torn_.multiplier, jumps);
  feti::keepErrors(stages_.constraints, *torn_.multiplier, jumps);
  extension_->apply(jumps, forces);
  std::vector<double> product(1);
  jumps.dot(forces, Teuchos::arrayViewFromVector(product));
  report_.solverError = std::sqrt(std::max(product[0], 0.0));
  const std::vector<feti::ForceError> errors =
      feti::forceErrors(stages_.constraints, *torn_.multiplier, jumps, forces, groupOf_,
                        static_cast<int>(report_.pairErrors.size()));
  for (std::size_t k = 0; k < errors.size(); ++k)
    static_cast<feti::ForceError&>(report_.pairErrors[k]) = errors[k];
}

// The largest error of a pair's forces, as a multiple of what it may be.
double AnswerCheck::forceExcess() const {
  double largest = 0.0;
  for (const PairError& pair : report_.pairErrors)
    if (pair.error > 0.0)
      largest = std::max(largest, pair.error / allowedForceError(report_, pair));
  return largest;
}

std::optional<double> AnswerCheck::balance(double tolerance) {
  const double solver = report_.solverError;
  // Jumps are errors of the stresses too: an estimate from an answer whose own error is larger than what it
  // estimates is good for no more than the next step.
  if (!discretisation_ || (!trusted_ && solver <= options_.solverErrorShare * discretisation_->error)) {
    discretisation_ = estimateDiscretisationError(comm_, scene_, owned_, torn_.displacement, time_);
    trusted_ = solver <= discretisation_->error;
  }
  report_.discretisationError = discretisation_->error / discretisation_->norm;
  const double allowed = options_.solverErrorShare * discretisation_->error;
  report_.allowedError = allowed / discretisation_->norm;
  const bool enough = solver <= allowed;
  std::ostringstream text;
  text << "Tolerance " << scientific(tolerance, 1) << ": estimated error in the energy norm of the solver "
       << scientific(solver / discretisation_->norm, 1) << ", of the discretisation "
       << scientific(report_.discretisationError, 1) << (trusted_ ? "" : " at most")
       << (enough ? ": accepted" : "");
  log_.info(text.str());
  if (enough)
    return std::nullopt;
  // Errors fall about like residuals; a third and more, so that few checks are needed, and no more than a
  // hundredth, since the estimate of a bad answer is bad itself.
  return tolerance * std::clamp(0.7 * allowed / solver, 0.01, 1.0 / 3.0);
}

feti::Verdict AnswerCheck::judge(const MultiVector& lambda, const std::vector<double>& mu, double tolerance) {
  recover(lambda, mu);
  report_.reachedTolerance = tolerance;
  std::optional<double> next = improve(tolerance);
  const bool isEnough = !next;
  if (isEnough)
    next = improveForces(tolerance);
  if (next && *next < leastTolerance(report_))
    return {};
  return {next, isEnough};
}

// Forces of pairs that are measured by themselves.
std::optional<double> AnswerCheck::improveForces(double tolerance) {
  const double excess = forceExcess();
  if (!auditAgrees(report_) || !(excess > 1.0))
    return std::nullopt;
  const PairError* worst = nullptr;
  for (const PairError& pair : report_.pairErrors)
    if (worst == nullptr ||
        pair.error * allowedForceError(report_, *worst) > worst->error * allowedForceError(report_, pair))
      worst = &pair;
  log_.info("Estimated relative error of the forces of \"" + worst->path +
            "\": " + scientific(worst->relative(), 1) + " (force " + scientific(worst->force) +
            ", all forces " + scientific(report_.audit.forces) + "): continue with a smaller tolerance");
  // Errors fall about like residuals, and the estimate of a bad answer is bad itself.
  return tolerance * std::clamp(0.5 / excess, 0.01, 0.5);
}

std::optional<double> AnswerCheck::improve(double tolerance) {
  std::optional<double> next;
  if (options_.toleranceRule == ToleranceRule::Balanced) {
    report_.tolerance = tolerance;
    next = balance(tolerance);
  }
  if (!next && !auditAgrees(report_)) {
    log_.info("Audit contradicts the residuals (jump " + scientific(report_.audit.gluingJump) +
              ", penetration " + scientific(report_.audit.penetration) + ", displacements up to " +
              scientific(report_.audit.largestDisplacement) + "; error " + scientific(report_.solverError) +
              " of " + scientific(report_.audit.energyNorm) +
              " in the energy norm): continue with a smaller tolerance");
    // Errors fall about like residuals: where they alone are too large, no further than they ask for.
    const double share =
        std::max(feti::energyErrorShare(report_.tolerance), std::min(report_.allowedError, 0.1));
    const double allowed = share * report_.audit.energyNorm;
    const bool isErrorAlone = feti::auditAgrees(
        report_.audit, {feti::auditShare(report_.tolerance), report_.gapRounding, report_.localDefect});
    next = tolerance * (isErrorAlone ? std::clamp(0.5 * allowed / report_.solverError, 0.1, 0.5) : 0.1);
  }
  return next;
}

void AnswerCheck::exchange(qp::StateArchive<MultiVector>& archive) {
  std::vector<double> known;
  if (discretisation_)
    known = {discretisation_->error, discretisation_->norm};
  archive.numbers("discretisation error", known);
  archive.number("discretisation error trusted", trusted_);
  if (known.size() == 2)
    discretisation_ = DiscretisationError{known[0], known[1]};
}

feti::TornSolution AnswerCheck::finish(const MultiVector& lambda, const std::vector<double>& mu,
                                       bool isLastJudged) {
  if (!isLastJudged)
    recover(lambda, mu);
  return std::move(torn_);
}

} // namespace Harmos::run
