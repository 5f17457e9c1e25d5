// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_RunReport.hpp"

#include "Harmos_Log.hpp"
#include "Harmos_Version.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

namespace Harmos::run {
namespace {

// JSON has no NaN: a number that is not finite becomes null.
nlohmann::ordered_json number(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json numbers(const fem::Point& values) {
  return {number(values[0]), number(values[1]), number(values[2])};
}

// The keys of steps.csv.
nlohmann::ordered_json toJson(const StepRow& row) {
  nlohmann::ordered_json json;
  for (const auto& [name, value] : row.numbers())
    json[name] = number(value);
  for (const char* name :
       {"step", "products", "active_sets", "closed", "open", "sticking", "slipping", "broken"})
    json[name] = static_cast<long long>(json[name].get<double>());
  json["converged"] = row.converged;
  for (const Forces::Of& effect : row.forces)
    for (std::size_t d = 0; d < 3; ++d)
      json[effect.path + "/f" + "xyz"[d]] = number(effect.resultant.force[d]);
  for (const auto& [name, value] : row.further)
    json[name] = number(value);
  return json;
}

nlohmann::ordered_json auditJson(const RunReport& report) {
  if (!report.audited)
    return nullptr;
  nlohmann::ordered_json json = {{"equilibrium", number(report.audit.equilibrium)},
                                 {"gluing_jump", number(report.audit.gluingJump)},
                                 {"penetration", number(report.audit.penetration)},
                                 {"min_contact_multiplier", number(report.audit.minContactMultiplier)},
                                 {"complementarity", number(report.audit.complementarity)},
                                 {"largest_displacement", number(report.audit.largestDisplacement)},
                                 {"largest_contact_multiplier", number(report.audit.largestMultiplier)},
                                 {"largest_row_force", number(report.audit.largestRowForce)},
                                 {"balance", number(report.forces.balance)}};
  if (report.limited > 0) {
    json["slip_error"] = number(report.audit.slipError);
    json["limit_excess"] = number(report.audit.limitExcess);
    json["friction_work"] = number(report.audit.frictionWork);
  }
  if (report.bonds > 0) {
    json["spring_error"] = number(report.audit.springError);
    json["spring_energy"] = number(report.audit.springEnergy);
  }
  return json;
}

// What was run.
nlohmann::ordered_json headOf(const RunReport& report) {
  nlohmann::ordered_json json = {{"harmos", {{"version", version()}, {"git", gitHash()}}},
                                 {"deck", report.deck},
                                 {"scene", report.scene},
                                 {"bodies", report.bodies},
                                 {"ranks", report.ranks}};
  if (report.isFinite)
    json["kinematics"] = "finite";
  return json;
}

double ratio(double value, double scale) {
  return scale > 0.0 ? value / scale : value;
}

} // namespace

std::string toJson(const RunReport& report) {
  const qp::Result& result = report.result;
  const qp::Counters& counters = result.counters;
  nlohmann::ordered_json json = headOf(report);
  json["converged"] = report.converged;
  json["reason"] = report.reason;
  json["primal_dimension"] = report.primalDimension;
  json["dual_dimension"] = report.dualDimension;
  json["inequalities"] = report.inequalities;
  if (report.limited > 0)
    json["friction_rows"] = report.limited;
  json["kernel_dimension"] = report.kernelDimension;
  json["coarse_dimension"] = report.coarseDimension;
  json["coarse_problem"] = report.isCoarseDistributed ? "distributed" : "replicated";
  json["adaptive_vectors"] = report.adaptiveVectors;
  json["adaptive_seconds"] = report.adaptiveSeconds;
  json["subdomains"] = report.subdomains;
  json["clusters"] = report.clusters;
  json["outer_iterations"] = counters.outerIterations;
  json["hessian_applications"] = counters.hessianApplications;
  json["setup_applications"] = counters.setupApplications;
  json["cg_steps"] = counters.cgSteps;
  json["expansion_steps"] = counters.expansionSteps;
  json["proportioning_steps"] = counters.proportioningSteps;
  json["faces"] = counters.faces;
  json["fallbacks"] = counters.fallbacks;
  json["step_cuts"] = counters.stepCuts;
  json["confirmations"] = counters.confirmations;
  json["relative_projected_gradient"] = number(ratio(result.projectedGradientNorm, report.gradientScale));
  json["relative_equality_residual"] = number(ratio(result.equalityNorm, report.equalityScale));
  json["tolerance"] = report.tolerance;
  json["tolerance_rule"] = report.toleranceRule;
  json["reached_tolerance"] = report.reachedTolerance;
  json["estimated_errors"] = nlohmann::ordered_json::object();
  if (report.solverError > 0.0)
    json["estimated_errors"]["solver"] = number(ratio(report.solverError, report.audit.energyNorm));
  if (report.discretisationError > 0.0)
    json["estimated_errors"]["discretisation"] = number(report.discretisationError);
  if (!report.pairErrors.empty()) {
    double largest = 0.0;
    for (const PairError& pair : report.pairErrors)
      largest = pair.force > 0.0 ? std::max(largest, pair.relative()) : largest;
    json["estimated_errors"]["forces"] = number(largest);
  }
  json["stopping_rule"] = report.stoppingRule;
  json["tolerance_projected_gradient"] = number(report.tolerance * report.gradientScale);
  json["tolerance_equality_residual"] = number(report.tolerance * report.equalityScale);
  json["equality_residual"] = number(result.equalityNorm);
  json["d_norm"] = number(report.dNorm);
  json["hessian_norm"] = number(result.hessianNorm);
  json["penalty"] = number(result.penalty);
  json["energy"] = report.audited ? number(report.audit.energy) : nlohmann::ordered_json(nullptr);
  json["primal_energy"] =
      report.audited ? number(report.audit.primalEnergy) : nlohmann::ordered_json(nullptr);
  json["audit"] = auditJson(report);
  json["audit_agrees"] =
      report.audited ? nlohmann::ordered_json(auditAgrees(report)) : nlohmann::ordered_json(nullptr);
  json["forces"] = nlohmann::ordered_json::object();
  for (const Forces::Of& effect : report.forces.effects) {
    nlohmann::ordered_json& entry = json["forces"][effect.path];
    entry = {{"force", numbers(effect.resultant.force)}, {"moment", numbers(effect.resultant.moment)}};
    if (effect.hasFriction) {
      entry["normal"] = numbers(effect.normal);
      entry["tangential"] = numbers(effect.tangential);
    }
    if (effect.error)
      entry["estimated_error"] = number(*effect.error);
  }
  json["steps"] = nlohmann::ordered_json::array();
  for (const StepRow& row : report.steps)
    json["steps"].push_back(toJson(row));
  json["effects"] = report.effects;
  json["effect_costs"] = nlohmann::ordered_json::array();
  for (const scene::EffectCost& cost : report.effectCosts)
    json["effect_costs"].push_back({{"kind", cost.kind},
                                    {"effects", cost.effects},
                                    {"rows", cost.rows},
                                    {"seconds", cost.seconds},
                                    {"bytes", cost.bytes}});
  json["restarted_from"] = report.restartedFrom;
  json["checkpoints"] = report.checkpoints;
  json["dual_operator"] = report.dualOperator;
  json["local_solver"] = report.localSolver;
  json["attainable_accuracy"] = number(attainableAccuracy(report));
  json["local_condition"] = number(report.localCondition);
  json["dual_operator_mib"] = number(report.dualOperatorMiB);
  json["solver"] = report.solver;
  json["distinct_local_factorizations"] = report.distinctFactorizations;
  json["rounded_local_factorizations"] = report.roundedFactorizations;
  json["local_factorizations"] = report.factorisations;
  json["results"] = nlohmann::ordered_json::object();
  for (const auto& [name, value] : report.results)
    json["results"][name] = number(value);
  json["seconds"] = report.seconds;
  json["peak_memory_mib"] = report.peakMemoryMiB;
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

StepRow stepRow(const RunReport& report, const EnergyAccount& energy) {
  StepRow row;
  row.converged = report.converged;
  row.products = report.result.counters.hessianApplications;
  row.activeSets = report.result.counters.faces;
  row.energy = energy.stored();
  row.externalWork = energy.externalWork();
  const ContactCounts& counts = report.contactCounts;
  row.closed = counts.closed;
  row.open = counts.points - counts.closed;
  row.sticking = counts.sticking;
  row.slipping = counts.slipping;
  row.broken = counts.broken;
  row.dissipated = energy.dissipated();
  row.released = energy.released();
  row.forces = report.forces.effects;
  return row;
}

namespace {

double matrixRounding(const RunReport& report) {
  return 0.5 * std::numeric_limits<double>::epsilon() * report.localCondition;
}

} // namespace

double attainableAccuracy(const RunReport& report) {
  return std::max(matrixRounding(report), report.openingRounding);
}

std::string attainableText(const RunReport& report) {
  std::string text;
  if (const double share = matrixRounding(report); share > report.tolerance)
    text =
        "Attainable accuracy: rounding errors of a subdomain's matrix change its softest modes by at least " +
        scientific(share, 0) + " (relative); condition number at least " +
        scientific(report.localCondition, 0) + ", tolerance " + scientific(report.tolerance, 0) +
        ". Typical causes: a stiff body on a soft foundation, thin cells, material jumps; force imbalance " +
        scientific(report.forces.balance, 0);
  if (const double share = report.openingRounding; share > report.tolerance)
    text += (text.empty() ? "" : "\n") +
            ("Attainable accuracy: spring openings are much larger than the deformation of bodies; their "
             "rounding errors are " +
             scientific(share, 0) + " of the deformation, tolerance " + scientific(report.tolerance, 0) +
             ". Openings and forces of the springs are not affected");
  return text;
}

std::string doubtfulForces(const RunReport& report) {
  constexpr std::size_t most = 10;
  const double share = std::max(feti::allowedShare(report), 0.01);
  std::string names;
  std::size_t count = 0;
  for (const PairError& pair : report.pairErrors)
    if (pair.force > 0.0 && pair.relative() > share && count++ < most)
      names += (names.empty() ? "\"" : ", \"") + pair.path + "\" (" + scientific(pair.relative(), 0) + ")";
  if (count > most)
    names += " and " + std::to_string(count - most) + " more";
  return count == 0 ? ""
                    : "Forces with a large estimated relative error: " + names +
                          ". They are small relative to all forces of the scene; a smaller "
                          "\"Solver/Tolerance\" reduces the error down to rounding level";
}

std::string auditText(const RunReport& report) {
  const feti::KktAudit& audit = report.audit;
  std::ostringstream text;
  text << "Audit on the primal side (independent of the solver's residuals)\n"
       << "  equilibrium    |Ku - f + B'lambda|, rel.   " << scientific(audit.equilibrium) << "\n"
       << "  balance        |sum of all forces|, rel.   " << scientific(report.forces.balance) << "\n"
       << "  gluing jump    max |B_E u - c_E|           " << scientific(audit.gluingJump) << "\n";
  if (report.inequalities > 0)
    text << "  penetration    max (B_I u - c_I)+          " << scientific(audit.penetration) << "\n"
         << "  least contact multiplier                   " << scientific(audit.minContactMultiplier) << "\n"
         << "  complementarity |lambda_I'(B_I u - c_I)|   " << scientific(audit.complementarity) << "\n";
  if (report.limited > 0)
    text << "  slip           |inadmissible slip|         " << scientific(audit.slipError) << "\n"
         << "  friction beyond its limit                  " << scientific(audit.limitExcess) << "\n"
         << "  work of friction                           " << scientific(audit.frictionWork) << "\n";
  text << "  energy  u'Ku/2 - f'u + lambda'(Bu - c)     " << scientific(audit.energy, 12);
  return text.str();
}

std::string timingText(const RunReport& report, const std::vector<std::string>& stages) {
  std::ostringstream text;
  text << "Seconds (maximum over " << report.ranks << (report.ranks == 1 ? " rank)" : " ranks)") << std::fixed
       << std::setprecision(3);
  for (const std::string& stage : stages)
    text << "\n  " << std::left << std::setw(14) << stage << std::right << std::setw(10)
         << report.seconds.at(stage);
  text << "\n  " << std::left << std::setw(14) << "total" << std::right << std::setw(10)
       << report.seconds.at("total") << "\nPeak memory of all ranks: " << std::setprecision(0)
       << report.peakMemoryMiB << " MiB";
  return text.str();
}

} // namespace Harmos::run
