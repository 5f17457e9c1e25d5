// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PlanCosts.hpp"

#include "Harmos_CgOptions.hpp"
#include "Harmos_Decomposition.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace Harmos::plan {
namespace {

using feti::DualForm;

// What a rank has, and what it is expected to do with it.
struct RankLoad {
  long long subdomains = 0;
  long long classes = 0;
  std::vector<feti::FormPrediction> predictions = // in the order of feti::dualForms()
      std::vector<feti::FormPrediction>(feti::dualForms().size());
  double recoverySeconds = 0.0; // of K⁺ applied to all dofs
  double largestBoundary = 0.0, largestRows = 0.0, largestStiffness = 0.0;
  double sharedBytes = 0.0; // of meshes and matrices, each once
  double assembledBytes = 0.0;
  double ownBytes = 0.0, rows = 0.0, nodes = 0.0, cells = 0.0, links = 0.0;
  double constraintEntries = 0.0, touchedRows = 0.0, ownedRows = 0.0;
  double coarseEntries = 0.0, coarsePairs = 0.0, motions = 0.0;
  std::vector<std::array<double, 3>> centres;
};

struct Class {
  int matrix = 0, members = 0;
  std::vector<int> boundary;
};

RankLoad loadOf(const PlanSurvey& survey, const feti::LocalInverseOptions& options,
                const feti::MachineRates& rates, const scene::Share& share) {
  RankLoad load;
  load.subdomains = share.end - share.begin;
  std::map<long long, Class> classes;
  std::set<int> meshes, stiffnesses, matrices;
  for (long long number = share.begin; number < share.end; ++number) {
    const auto place = static_cast<std::size_t>(number);
    const SurveyedSubdomain& s = survey.subdomains[place];
    Class& item = classes[options.share ? s.matrix : number];
    item.matrix = s.matrix;
    ++item.members;
    item.boundary.insert(item.boundary.end(), survey.boundaries[place].begin(),
                         survey.boundaries[place].end());
    if (meshes.insert(s.mesh).second)
      load.sharedBytes += survey.meshBytes[static_cast<std::size_t>(s.mesh)];
    if (stiffnesses.insert(s.stiffness).second) {
      load.assembledBytes += survey.stiffnessBytes[static_cast<std::size_t>(s.stiffness)];
      load.largestStiffness =
          std::max(load.largestStiffness, survey.stiffnessBytes[static_cast<std::size_t>(s.stiffness)]);
    }
    if (matrices.insert(s.matrix).second)
      load.sharedBytes += survey.matrixBytes[static_cast<std::size_t>(s.matrix)];
    load.ownBytes += s.ownBytes;
    load.rows += s.rows;
    load.nodes += s.nodes;
    load.cells += s.cells;
    load.links += static_cast<double>(s.cells) * s.nodesPerCell;
    load.constraintEntries += s.constraintEntries;
    load.touchedRows += s.touchedRows;
    load.ownedRows += s.ownedRows;
    load.coarseEntries += s.coarseEntries;
    load.coarsePairs += s.coarsePairs;
    load.motions += s.kernelColumns;
    if (s.hasCentre)
      load.centres.push_back(s.centre);
    load.largestRows = std::max(load.largestRows, static_cast<double>(s.rows));
  }
  load.sharedBytes += load.assembledBytes;
  load.classes = static_cast<long long>(classes.size());
  for (auto& [key, item] : classes) {
    std::sort(item.boundary.begin(), item.boundary.end());
    item.boundary.erase(std::unique(item.boundary.begin(), item.boundary.end()), item.boundary.end());
    feti::FactorizationEstimate estimate = survey.matrices[static_cast<std::size_t>(item.matrix)];
    estimate.boundary = static_cast<int>(item.boundary.size());
    for (std::size_t k = 0; k < load.predictions.size(); ++k)
      load.predictions[k] += feti::predict(feti::dualForms()[k], estimate, item.members, options.precision,
                                           rates, options.expectsRoundedProducts());
    const feti::DualForms plain = {DualForm::Implicit, feti::PreconditionerKind::None};
    load.recoverySeconds += feti::predict(plain, estimate, item.members, options.precision, rates,
                                          options.expectsRoundedProducts())
                                .productSeconds;
    load.largestBoundary = std::max(load.largestBoundary, static_cast<double>(estimate.boundary));
  }
  return load;
}

// As feti::chooseForm() decides: the place in feti::dualForms(). Where nothing fits, what needs least.
std::size_t waysOf(const std::vector<RankLoad>& loads, const feti::DualOptions& options, int usualProducts,
                   bool mayLump) {
  std::vector<feti::FormPrediction> worst(feti::dualForms().size());
  for (const RankLoad& load : loads)
    for (std::size_t k = 0; k < worst.size(); ++k)
      for (auto member : {&feti::FormPrediction::setupSeconds, &feti::FormPrediction::productSeconds,
                          &feti::FormPrediction::relativeProducts, &feti::FormPrediction::bytes})
        worst[k].*member = std::max(worst[k].*member, load.predictions[k].*member);
  feti::FormLimits limits;
  limits.form = options.form;
  limits.preconditioner = options.preconditioner;
  limits.mayLump = mayLump;
  limits.products = options.expectedProducts > 0 ? options.expectedProducts : usualProducts;
  limits.budgetMiB = options.memoryBudgetMiB;
  if (const auto best = feti::bestOf(worst, limits))
    return *best;
  limits.memoryMiB = 1e-6;
  limits.budgetMiB = 0.0;
  return *feti::bestOf(worst, limits);
}

// Directions that conjugate gradients have room for: twenty, doubled when they do not do; see
// ConjugateDirections.
double directionsFor(const run::RunOptions& options, int products) {
  const bool keeps =
      options.method == "PCPG" || options.method == "PDAS" ||
      (options.method == "Auto" && options.dual.preconditioner != feti::PreconditionerKind::None);
  const qp::CgOptions cg = qp::CgOptions::fromList(options.methodLists.sublist("PCPG"));
  if (!keeps || cg.reorthogonalisation == qp::Reorthogonalisation::None)
    return 0.0;
  int capacity = 20;
  while (capacity < products)
    capacity *= 2;
  return std::min(capacity, cg.storedDirections);
}

// While the result file is written: fields that were recovered, and the largest array, see
// run::writeResult().
double resultBytes(const RankLoad& load, const PlanSurvey& survey, const run::RunOptions& options,
                   bool elastic) {
  const bool hasStress = elastic && options.writeStresses;
  const double kept = (hasStress ? 48.0 : 0.0) + (survey.inequalities > 0 ? 17.0 : 0.0);
  const double atNode = hasStress ? 56.0 : 24.0; // stress and that of von Mises; coordinates
  const double cells = elastic && options.cellFields.stress ? 96.0 * load.cells : 0.0; // twice
  return kept * load.nodes + cells + std::max(atNode * load.nodes, 8.0 * load.links + 9.0 * load.cells);
}

// Of rows, those that are at the rim of a cluster: within, nothing opens when it moves.
double rimOf(const PlanSurvey& survey, const feti::ClusterPrediction& clusters) {
  return std::pow(clusters.shape.size, -1.0 / survey.dimension);
}

// Bytes an item, from the sources named.
RankMemory memoryOf(const RankLoad& load, const PlanSurvey& survey, const run::RunOptions& options,
                    std::size_t way, bool elastic, double directions,
                    const feti::ClusterPrediction& clusters) {
  const feti::StepShape& shape = clusters.step;
  const DualForm form = feti::dualForms()[way].form;
  RankMemory memory;
  const bool hasPreconditioner = options.dual.preconditioner != feti::PreconditionerKind::None;
  // An entry of B is held by Constraints (16), and gathered and scattered by F and by M⁻¹ (16 each); a row
  // has its places in two maps with their tables, in Import's lists, and some twenty vectors.
  constexpr double perRow = 160.0 + 2.0 * 50.0;
  const double perEntry = 16.0 + 2.0 * 16.0 + (hasPreconditioner ? 2.0 * 16.0 : 0.0);
  memory.mesh =
      load.sharedBytes + load.ownBytes + perEntry * load.constraintEntries + perRow * load.touchedRows;
  memory.factors = load.predictions[way].factorBytes;
  memory.dense = load.predictions[way].bytes - memory.factors;
  // G̃ᵀ by rows, places of its pairs; A⁻, and another one on a face of PDAS.
  const double inverse = feti::coarseBytes(shape.coarse(), shape.isCoarseDistributed);
  const double rim = rimOf(survey, clusters);
  memory.coarse = rim * (12.0 * load.coarseEntries + 4.0 * load.coarsePairs) +
                  (survey.inequalities > 0 ? 2.0 : 1.0) * inverse;
  memory.joins = feti::joinCosts(clusters.shape).bytesHeld;
  memory.directions = 16.0 * directions * load.ownedRows;

  // While the largest S is inverted: S and S⁺, whole, and the stiffness matrix.
  const double b = form == DualForm::Condensed ? load.largestBoundary : 0.0;
  const double whileFactoring = 2.0 * 8.0 * b * b + load.largestStiffness;
  // Pairs of columns, in the order of rows and sorted; the factor that rows of the inverse are made with.
  const double whileCoarse =
      rim * 16.0 * load.coarsePairs + feti::coarseBytesOfSetup(shape.coarse(), shape.isCoarseDistributed);
  // Displacements; 32 right-hand sides at once.
  const double whileEnding = 2.0 * 8.0 * load.rows + 32.0 * 8.0 * load.largestRows +
                             (options.writeFields ? resultBytes(load, survey, options, elastic) : 0.0);
  memory.temporary = std::max({whileFactoring - memory.coarse - memory.directions,
                               whileCoarse - memory.directions, whileEnding, 0.0});
  return memory;
}

template<class Number>
double most(const std::vector<RankLoad>& loads, Number RankLoad::*member) {
  double result = 0.0;
  for (const RankLoad& load : loads)
    result = std::max(result, static_cast<double>(load.*member));
  return result;
}

std::vector<RankLoad> loadsOf(const PlanSurvey& survey, const run::RunOptions& options,
                              const feti::Rates& rates, int ranks) {
  std::vector<RankLoad> loads;
  const auto total = static_cast<long long>(survey.subdomains.size());
  for (int rank = 0; rank < ranks; ++rank)
    loads.push_back(loadOf(survey, options.dual.inversesFor(options.fixedTolerance()), rates.local,
                           scene::shareOf(rank, ranks, total)));
  return loads;
}

// A rank's share is about a square or a cube of subdomains: rows on its rim, and neighbours on all sides.
feti::StepShape shapeOf(const PlanSurvey& survey, const std::vector<RankLoad>& loads) {
  const auto total = static_cast<double>(survey.subdomains.size());
  const double d = survey.dimension, share = most(loads, &RankLoad::subdomains);
  double touched = 0.0;
  for (const SurveyedSubdomain& s : survey.subdomains)
    touched += s.touchedRows / total;
  feti::StepShape shape;
  shape.ranks = static_cast<int>(loads.size());
  shape.rows = most(loads, &RankLoad::ownedRows);
  shape.sharedRows = touched * std::pow(share, (d - 1.0) / d);
  shape.neighbours = static_cast<int>(std::min(std::pow(3.0, d), static_cast<double>(shape.ranks))) - 1;
  shape.coarseDimension = survey.kernelDimension;
  shape.ownMotions = most(loads, &RankLoad::motions);
  shape.motions = survey.kernelDimension / total;
  shape.sharedMotions = shape.motions * (std::pow(std::pow(share, 1.0 / d) + 2.0, d) - share);
  return shape;
}

// Clusters as asked for, or as a run chooses them; the coarse problem as a run decides, which has no factor
// then and takes all motions.
feti::ClusterPrediction clustersOf(const PlanSurvey& survey, const std::vector<RankLoad>& loads,
                                   const feti::DualOptions& options, double productSeconds, int usualProducts,
                                   const feti::StepRates& rates) {
  using Kind = feti::ClusterOptions::Kind;
  feti::UnjoinedRun run;
  run.step = shapeOf(survey, loads);
  run.subdomains = static_cast<double>(survey.subdomains.size());
  run.productSeconds = productSeconds;
  run.products = options.expectedProducts > 0 ? options.expectedProducts : usualProducts;
  run.clusters.subdomains = most(loads, &RankLoad::subdomains);
  run.clusters.distinct = most(loads, &RankLoad::classes);
  run.clusters.motions = survey.rigidBodyModes;
  for (const std::vector<int>& boundary : survey.boundaries)
    run.clusters.boundary += static_cast<double>(boundary.size()) / run.subdomains;
  // Ranks without subdomains have no shape.
  run.sides.shortest = run.clusters.subdomains;
  for (const RankLoad& load : loads)
    if (const feti::ShareSides sides = feti::sidesOf(load.centres, run.clusters.isInSpace());
        load.subdomains > 0) {
      run.sides.longest = std::max(run.sides.longest, sides.longest);
      run.sides.shortest = std::min(run.sides.shortest, sides.shortest);
    }
  const feti::ClusterOptions& asked = options.clusters;
  feti::ClusterPrediction result =
      asked.kind == Kind::Auto ? feti::chooseClusters(run, options.coarse, rates)
                               : feti::predictClusters(run, asked.kind, asked.size, options.coarse, rates);
  result.step.coarseDimension =
      std::max(0.0, result.step.coarseDimension - (survey.kernelDimension - survey.coarseDimension));
  if (result.clusters == 0)
    result.step.coarseEntries = survey.coarseFactorEntries;
  return result;
}

// Seconds of a factor go with the squares of columns of L.
double factorShare(const PlanSurvey& survey, const feti::StepShape& shape) {
  if (shape.clusterSize <= 1.0 || survey.coarseFactorEntries <= 0.0)
    return 1.0;
  if (shape.coarseDimension <= 0.0)
    return 0.0;
  const double entries = feti::coarseFactorEntries(shape.coarse()) / survey.coarseFactorEntries;
  return entries * entries * survey.coarseDimension / shape.coarseDimension;
}

} // namespace

ProductRange expectedProducts(const scene::Scene& scene, const run::RunOptions& options) {
  struct Range {
    double least, most;
  };
  constexpr Range membranes[] = {{1.0, 12.5}, {1.0, 15.5}, {3.0, 15.5}};
  constexpr Range elastic[] = {{2.5, 20.0}, {3.7, 26.0}, {8.5, 36.0}};
  // What the cost model chooses is not known yet: the few of the one, the many of the other.
  if (!options.dual.preconditioner) {
    run::RunOptions few = options, many = options;
    few.dual.preconditioner = feti::PreconditionerKind::Dirichlet;
    many.dual.preconditioner = feti::PreconditionerKind::Lumped;
    return {expectedProducts(scene, few).least, expectedProducts(scene, many).most};
  }
  const int kind = *options.dual.preconditioner == feti::PreconditionerKind::Dirichlet ? 0
                   : *options.dual.preconditioner == feti::PreconditionerKind::Lumped  ? 1
                                                                                       : 2;
  const Range& perDigit = (scene.physics == scene::Physics::Membrane ? membranes : elastic)[kind];
  const double digits = -std::log10(options.tolerance);
  return {static_cast<int>(std::ceil(perDigit.least * digits)),
          static_cast<int>(std::ceil(perDigit.most * digits))};
}

PlanRow planRow(const PlanSurvey& survey, const run::RunOptions& options, bool elastic, bool mayLump,
                const ProductRange& products, const feti::Rates& rates, double programBytes,
                double sceneBytes, int ranks) {
  PlanRow row;
  row.ranks = ranks;
  const std::vector<RankLoad> loads = loadsOf(survey, options, rates, ranks);
  row.leastSubdomains = loads.front().subdomains;
  for (const RankLoad& load : loads) {
    row.leastSubdomains = std::min(row.leastSubdomains, load.subdomains);
    row.mostSubdomains = std::max(row.mostSubdomains, load.subdomains);
    row.factorizations += load.classes;
  }
  const auto total = static_cast<double>(survey.subdomains.size());
  row.imbalance = static_cast<double>(row.mostSubdomains) * ranks / total;
  const std::size_t way =
      waysOf(loads, options.dual, feti::DualOptions::usualProducts(elastic, options.tolerance), mayLump);
  row.forms = feti::dualForms()[way];
  double productSeconds = 0.0;
  for (const RankLoad& load : loads)
    productSeconds = std::max(productSeconds, load.predictions[way].productSeconds);
  const feti::ClusterPrediction clusters =
      clustersOf(survey, loads, options.dual, productSeconds,
                 feti::DualOptions::usualProducts(elastic, options.tolerance), rates.step);
  row.clusters = clusters.clusters;
  row.productsGrowth = clusters.growth;
  row.clusterAspect = clusters.shape.aspect;
  row.shape = clusters.step;
  const double directions =
      directionsFor(options, static_cast<int>(std::ceil(clusters.growth * products.most)));
  for (std::size_t rank = 0; rank < loads.size(); ++rank) {
    RankMemory memory = memoryOf(loads[rank], survey, options, way, elastic, directions, clusters);
    // A run touches more of its libraries (BLAS, HDF5, MPI) than a plan does: 7 to 12 MiB on small runs.
    constexpr double libraries = 10.0 * 1048576.0;
    memory.program = programBytes + libraries + (rank == 0 ? sceneBytes : 0.0);
    row.totalMemory += memory.sum();
    if (memory.sum() > row.memory.sum())
      row.memory = memory;
    const feti::FormPrediction& prediction = loads[rank].predictions[way];
    row.factorization = std::max(row.factorization, prediction.setupSeconds);
    row.recovery = std::max(row.recovery, 2.0 * loads[rank].recoverySeconds);
  }
  row.product = productSeconds;
  row.factorization += clusters.setupSeconds;
  // What the survey measured, by what it goes with.
  const std::vector<RankLoad> surveyed = loadsOf(survey, options, rates, survey.ranks);
  const auto scaled = [&](double seconds, double RankLoad::*member) {
    const double before = most(surveyed, member);
    return before > 0.0 ? seconds * most(loads, member) / before : seconds;
  };
  row.mesh = scaled(survey.secondsOfMeshes, &RankLoad::nodes);
  row.assembly = scaled(survey.secondsOfAssembly, &RankLoad::assembledBytes);
  row.constraints = scaled(survey.secondsOfConstraints, &RankLoad::constraintEntries);
  const auto factored = [&](bool isFace) {
    return feti::coarseSetupSeconds(row.shape.coarse(), row.shape.isCoarseDistributed, isFace,
                                    factorShare(survey, row.shape) * survey.secondsOfCoarseFactor,
                                    rates.step);
  };
  row.coarseSetup =
      rimOf(survey, clusters) * scaled(survey.secondsOfCoarseRows, &RankLoad::coarsePairs) + factored(false);
  row.step = feti::predictStep(row.shape, rates.step);
  row.counts = feti::predictCounts(row.shape);
  // Active sets that the decks that come with Harmos take, and their refinements.
  constexpr double fewestFaces = 1.0, mostFaces = 14.0;
  row.face = survey.inequalities > 0 ? factored(true) : 0.0;
  const double leastProducts = clusters.growth * products.least,
               mostProducts = clusters.growth * products.most;
  row.least = row.setup() + fewestFaces * row.face + leastProducts * row.perStep();
  row.most = row.setup() + mostFaces * row.face + mostProducts * row.perStep();
  // Steps after the first take two products for their right-hand side and start from the solutions before:
  // the decks that come with Harmos, in twenty steps, took two products to half of those of the first.
  const auto later = static_cast<double>(survey.steps - 1);
  row.least += later * (0.5 * row.recovery + fewestFaces * row.face + (2.0 + 2.0) * row.perStep());
  row.most +=
      later * (0.5 * row.recovery + 0.5 * mostFaces * row.face + (2.0 + 0.5 * mostProducts) * row.perStep());
  return row;
}

} // namespace Harmos::plan
