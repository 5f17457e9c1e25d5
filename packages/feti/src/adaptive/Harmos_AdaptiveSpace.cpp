// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_AdaptiveSpace.hpp"

#include "Harmos_DualPreconditioner.hpp"

#include "Harmos_DualOperator.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_DominantModes.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FormChoice.hpp"
#include "Harmos_GlobalOrder.hpp"
#include "Harmos_JumpEnergy.hpp"
#include "Harmos_TrilinosVersion.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_MultiVector.hpp>
#include <Tpetra_Vector.hpp>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>

namespace Harmos::feti {
namespace {

// 1 for rows that are equalities whatever their forces are.
MultiVector equalityMask(const Constraints& constraints) {
  MultiVector mask(constraints.rowMap(), 1);
  const auto view = mask.getLocalViewHost(Tpetra::Access::OverwriteAll);
  for (std::size_t r = 0; r < view.extent(0); ++r)
    view(r, 0) = isUnconditional(constraints.rowType(static_cast<int>(r))) ? 1.0 : 0.0;
  return mask;
}

void applyMask(const MultiVector& mask, MultiVector& x) {
  const auto is = mask.getLocalViewHost(Tpetra::Access::ReadOnly);
  const auto view = x.getLocalViewHost(Tpetra::Access::ReadWrite);
  for (std::size_t c = 0; c < view.extent(1); ++c)
    for (std::size_t r = 0; r < view.extent(0); ++r)
      view(r, c) *= is(r, 0);
}

// x ← x − G_Eᵀ(G_EG_Eᵀ)⁻G_Ex for x on the rows E of the mask.
void projectOnFace(const Operator& rows, const qp::FaceGram<MultiVector>& face, const MultiVector& mask,
                   MultiVector& x) {
  for (int pass = 0; pass < 2; ++pass) { // the second for what rounding leaves
    for (std::size_t c = 0; c < x.getNumVectors(); ++c) {
      MultiVector w(rows.getRangeMap(), 1);
      rows.apply(*x.getVector(c), w);
      face.solve(w);
      rows.apply(w, *x.getVectorNonConst(c), Teuchos::TRANS, -1.0, 1.0);
    }
    applyMask(mask, x);
  }
}

// Where vectors are made: the stages, or those made for the vectors alone.
struct Workshop {
  const AdaptiveSpace::Stages& stages;
  const LocalInverses& inverses;
  const DualOperator& dual;
  const DualPreconditioner& preconditioner;
  MultiVector mask;
};

// Those of the subdomains of this rank that are to be vectors.
struct LocalModes {
  std::vector<DominantModes> of; // by subdomains
  double largest = 0.0;          // μ on any rank
};

LocalModes findModes(const Workshop& shop, double threshold) {
  constexpr int most = 200; // of a subdomain
  const SubdomainSystem& system = shop.stages.system;
  std::vector<std::vector<double>> energies =
      jumpEnergies(shop.inverses.classes(), shop.dual, shop.preconditioner, shop.mask);
  LocalModes result;
  result.of.resize(energies.size());
  agree(*system.comm(), [&] {
    for (std::size_t c = 0; c < shop.inverses.classes().size(); ++c) {
      const CongruenceClass& item = shop.inverses.classes()[c];
      for (int i : item.members) {
        const auto place = static_cast<std::size_t>(i);
        const Kernel& kernel = system.kernel(i);
        std::vector<double> onBoundary;
        for (int k = 0; k < kernel.columns; ++k)
          for (int dof : item.boundary)
            onBoundary.push_back(kernel.column(k)[dof]);
        result.of[place] =
            dominantModes(energies[place], *shop.dual.groups()[c].op, onBoundary, kernel.columns, threshold,
                          most, static_cast<std::uint64_t>(system.subdomain(i).number));
        energies[place] = std::vector<double>();
        if (!result.of[place].values.empty())
          result.largest = std::max(result.largest, result.of[place].values.front());
      }
    }
  });
  result.largest = globalMax(*system.comm(), result.largest);
  return result;
}

// Keeps so many of all ranks: those with the largest μ.
void keepLargest(const Teuchos::Comm<int>& comm, long long most, LocalModes& modes) {
  std::vector<double> mine;
  for (const DominantModes& item : modes.of)
    mine.insert(mine.end(), item.values.begin(), item.values.end());
  std::vector<double> all = gatherAll(comm, mine);
  if (static_cast<long long>(all.size()) <= most)
    return;
  std::sort(all.begin(), all.end(), std::greater<>());
  const double least =
      most > 0 ? all[static_cast<std::size_t>(most - 1)] : std::numeric_limits<double>::infinity();
  for (DominantModes& item : modes.of) {
    const std::size_t size = item.values.empty() ? 0 : item.vectors.size() / item.values.size();
    while (!item.values.empty() && item.values.back() < least)
      item.values.pop_back();
    item.vectors.resize(size * item.values.size());
  }
}

// Column of the first mode of each subdomain of this rank: numbered by subdomains, whatever ranks these are
// on.
struct Numbering {
  std::vector<int> first;
  int total = 0, subdomains = 0;
};

Numbering numberingOf(const SubdomainSystem& system, const LocalModes& modes) {
  struct Item {
    long long subdomain, modes;
    std::size_t place;
  };
  std::vector<Item> items;
  for (std::size_t i = 0; i < modes.of.size(); ++i)
    items.push_back(
        {system.subdomain(static_cast<int>(i)).number, static_cast<long long>(modes.of[i].values.size()), i});
  std::sort(items.begin(), items.end(),
            [](const Item& a, const Item& b) { return a.subdomain < b.subdomain; });
  std::vector<OrderKey> keys;
  std::vector<long long> counts;
  long long total = 0, subdomains = 0;
  for (const Item& item : items) {
    keys.push_back({item.subdomain, 0});
    counts.push_back(item.modes);
    total += item.modes;
    subdomains += item.modes > 0 ? 1 : 0;
  }
  const Teuchos::Comm<int>& comm = *system.comm();
  const std::vector<long long> firsts = sumsBefore(comm, keys, counts);
  Numbering result;
  result.first.resize(modes.of.size());
  for (std::size_t k = 0; k < items.size(); ++k)
    result.first[items[k].place] = static_cast<int>(firsts[k]);
  result.total = static_cast<int>(globalSum(comm, total));
  result.subdomains = static_cast<int>(globalSum(comm, subdomains));
  return result;
}

// B_sv for the modes of columns [begin, end).
MultiVector jumpsOf(const Workshop& shop, const LocalModes& modes, const Numbering& numbering, int begin,
                    int end) {
  const Constraints& constraints = shop.stages.constraints;
  const auto columns = static_cast<std::size_t>(end - begin);
  MultiVector overlap(constraints.overlapMap(), columns), jumps(constraints.rowMap(), columns);
  {
    const auto view = overlap.getLocalViewHost(Tpetra::Access::ReadWrite);
    for (std::size_t c = 0; c < shop.inverses.classes().size(); ++c) {
      const std::vector<int>& members = shop.inverses.classes()[c].members;
      const SubdomainSum::Group& group = shop.dual.groups()[c];
      const int size = group.op->size();
      for (const SubdomainSum::Entry& entry : group.entries) {
        const auto i = static_cast<std::size_t>(members[static_cast<std::size_t>(entry.place / size)]);
        const int first = numbering.first[i];
        const int last = std::min(end, first + static_cast<int>(modes.of[i].values.size()));
        for (int k = std::max(begin, first); k < last; ++k)
          view(static_cast<std::size_t>(entry.row), static_cast<std::size_t>(k - begin)) +=
              entry.value *
              modes.of[i].vectors[static_cast<std::size_t>(k - first) * static_cast<std::size_t>(size) +
                                  static_cast<std::size_t>(entry.place % size)];
      }
    }
  }
  jumps.doExport(overlap, *constraints.importer(), Tpetra::ADD);
  applyMask(shop.mask, jumps);
  return jumps;
}

// MB_sv, a column for each mode.
Teuchos::RCP<MultiVector> imagesOf(const Workshop& shop, const LocalModes& modes,
                                   const Numbering& numbering) {
  constexpr int batch = 32;
  const auto result = Teuchos::rcp(
      new MultiVector(shop.stages.constraints.rowMap(), static_cast<std::size_t>(numbering.total)));
  for (int begin = 0; begin < numbering.total; begin += batch) {
    const int end = std::min(begin + batch, numbering.total);
    const MultiVector jumps = jumpsOf(shop, modes, numbering, begin, end);
    const Teuchos::RCP<MultiVector> part = result->subViewNonConst(Teuchos::Range1D(begin, end - 1));
    shop.preconditioner.apply(jumps, *part);
  }
  shop.preconditioner.rethrowFailure();
  return result;
}

constexpr double mebi = 1048576.0;

// Bytes of N of all subdomains, and of what is made for the vectors alone, on the rank that needs most.
double bytesNeeded(const SubdomainSystem& system, const LocalInverses& inverses, bool isImplicit) {
  double bytes = 0.0;
  for (const CongruenceClass& item : inverses.classes()) {
    const auto n = static_cast<double>(item.boundary.size());
    bytes += 8.0 * n * n * (static_cast<double>(item.members.size()) + (isImplicit ? 2.0 : 1.0));
  }
  return globalMax(*system.comm(), bytes);
}

} // namespace

AdaptiveSpace::AdaptiveSpace(Stages stages, Forms forms, const AdaptiveOptions& options)
    : stages_(std::move(stages)), forms_(std::move(forms)), options_(options) {}

// Returns what is to be said of them.
std::string AdaptiveSpace::makeVectors() {
  const Teuchos::Comm<int>& comm = *stages_.system.comm();
  const bool isImplicit = forms_.inverses.form == DualForm::Implicit;
  // A quarter of what there is for N, and as much for U and W.
  const double room = 0.25 * machineMemoryMiB(comm) * mebi;
  if (const double needed = bytesNeeded(stages_.system, stages_.inverses, isImplicit); needed > room)
    return "No adaptive coarse vectors: their eigenproblems need " + scientific(needed / mebi, 1) +
           " MiB on a rank (more subdomains or ranks need less)";
  std::optional<LocalInverses> inverses;
  std::optional<DualOperator> dual;
  std::optional<DualPreconditioner> preconditioner;
  if (isImplicit) {
    LocalInverseOptions condensed = forms_.inverses;
    condensed.form = DualForm::Condensed;
    condensed.precision = Precision::Double;
    condensed.productError = 0.0;
    condensed.context.reset();
    condensed.keepSchur = forms_.preconditioner == PreconditionerKind::Dirichlet;
    inverses.emplace(makeLocalInverses(stages_.system, stages_.constraints, condensed));
    dual.emplace(stages_.constraints, *inverses);
    preconditioner.emplace(stages_.system, stages_.constraints, *inverses, forms_.preconditioner,
                           forms_.scaling);
  }
  const Workshop shop = {
      stages_, isImplicit ? *inverses : stages_.inverses, isImplicit ? *dual : stages_.dual,
      isImplicit ? *preconditioner : *stages_.preconditioner, equalityMask(stages_.constraints)};
  LocalModes modes = findModes(shop, options_.threshold);
  const auto rows = static_cast<double>(globalMax(comm, static_cast<long long>(shop.mask.getLocalLength())));
  keepLargest(comm, static_cast<long long>(room / (16.0 * std::max(rows, 1.0))), modes);
  const Numbering numbering = numberingOf(stages_.system, modes);
  if (numbering.total > 0) {
    const Teuchos::RCP<const Operator> equalities = stages_.coarse.equalityRows();
    const auto face = equalities.is_null() ? Teuchos::null : stages_.coarse.faceGram()->build(shop.mask);
    deflation_.emplace(shop.dual, stages_.coarse, imagesOf(shop, modes, numbering), [&](MultiVector& x) {
      applyMask(shop.mask, x);
      if (!equalities.is_null())
        projectOnFace(*equalities, *face, shop.mask, x);
    });
  }
  if (deflation_ && deflation_->dimension() == 0)
    deflation_.reset();
  if (!deflation_)
    return "No adaptive coarse vectors: no mode above " + scientific(options_.threshold, 0);
  return std::to_string(deflation_->dimension()) + " adaptive coarse vectors of " +
         std::to_string(numbering.total) + " modes in " + std::to_string(numbering.subdomains) +
         " subdomains, the worst at " + scientific(modes.largest, 0) + "; " +
         scientific(globalSum(comm, deflation_->bytes()) / mebi, 0) + " MiB";
}

void AdaptiveSpace::make(const Log& log) {
  HARMOS_REQUIRE(isPossible(), "adaptive vectors need a preconditioner");
  const auto start = std::chrono::steady_clock::now();
  const std::string text = makeVectors();
  isMade_ = true;
  seconds_ = globalMax(*stages_.system.comm(),
                       std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  log.info(text + "; " + scientific(seconds_, 1) + " s");
}

} // namespace Harmos::feti
