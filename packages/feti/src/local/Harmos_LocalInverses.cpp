// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_LocalInverses.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_InverseQuality.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <map>

namespace Harmos::feti {
namespace {

// Rounding of a row of K, some thousand times ε, as for the kernel itself.
constexpr double hiddenTolerance = 1e-12;

std::vector<int> touchedDofs(const SubdomainSystem& system, const Constraints& constraints,
                             const std::vector<int>& members) {
  std::vector<int> dofs;
  for (int i : members) {
    for (const Constraints::Entry& entry : constraints.entries(i))
      dofs.push_back(entry.dof);
    if (const auto& reserved = system.subdomain(i).reserved)
      dofs.insert(dofs.end(), reserved->begin(), reserved->end());
  }
  std::sort(dofs.begin(), dofs.end());
  dofs.erase(std::unique(dofs.begin(), dofs.end()), dofs.end());
  return dofs;
}

// Where rounding errors alone explain a bad inverse, in words.
std::string tooIllConditioned(const InverseQuality& quality, const LocalInverseOptions& options) {
  const bool single = options.precision == Precision::Single;
  return "the condition number of its matrix, " + scientific(quality.condition(), 0) +
         " or more, with rounding errors of " + (single ? "single" : "double") + " precision is the cause; " +
         (single ? "set \"Dual operator/Precision\" = \"double\", or " : "") +
         "use less thin cells, smaller material jumps or a Poisson's ratio further from 0.5";
}

// Of a matrix that seems to have a motion which its kernel does not contain; data() tells whether rounding
// may be all.
NumericalError hiddenMotion(const std::string& text, const LocalMatrix& matrix, const Kernel& kernel,
                            ErrorData data) {
  const HiddenMotion found = causeOfHiddenMotion(matrix, kernel);
  if (found.mayBeRounding)
    data.emplace_back("may be rounding", "yes");
  return NumericalError(text + found.cause, std::move(data));
}

void verify(const LocalMatrix& matrix, const Kernel& kernel, const InverseQuality& quality,
            const LocalInverseOptions& options, const std::string& number) {
  if (!(quality.resistance > hiddenTolerance))
    throw hiddenMotion(
        "subdomain " + number + " has a zero-energy mode outside its kernel of dimension " +
            std::to_string(kernel.columns) + ": ‖D⁻¹Kv‖/‖v‖ = " + scientific(quality.resistance) + "; ",
        matrix, kernel, {{"subdomain", number}, {"resistance", scientific(quality.resistance)}});
  const DefectLimit limit = defectLimit(quality, options);
  if (!(quality.defect <= limit.acceptable)) {
    const std::string found = "subdomain " + number + ": ‖KK⁺Kx − Kx‖/‖Kx‖ = " + scientific(quality.defect) +
                              ", at most " + scientific(limit.acceptable, 0) + " was expected; ";
    ErrorData data = {{"subdomain", number},
                      {"defect", scientific(quality.defect)},
                      {"condition", scientific(quality.condition())}};
    if (quality.defect > limit.rounding)
      throw hiddenMotion(found + "its material varies too much or its kernel of dimension " +
                             std::to_string(kernel.columns) + " is too small: ",
                         matrix, kernel, std::move(data));
    if (options.precision == Precision::Double)
      data.emplace_back("may be rounding", "yes");
    throw NumericalError(found + tooIllConditioned(quality, options), std::move(data));
  }
  if (options.checkNullPivots) {
    const int pivots = countNullPivots(matrix);
    if (pivots != kernel.columns)
      throw NumericalError(
          "subdomain " + number + ": MUMPS finds " + std::to_string(pivots) +
              " null pivots, its kernel has dimension " + std::to_string(kernel.columns) + "; " +
              (pivots > kernel.columns ? causeOfHiddenMotion(matrix, kernel).cause
                                       : "the check misses pivots where materials vary much"),
          {{"subdomain", number}, {"null pivots", std::to_string(pivots)}});
  }
}

InverseQuality verified(const LocalMatrix& matrix, const Kernel& kernel, const LocalInverse& inverse,
                        const LocalInverseOptions& options, const std::string& number) {
  const InverseQuality quality = inverseQuality(matrix, kernel, inverse);
  verify(matrix, kernel, quality, options, number);
  return quality;
}

// Beyond, rounding S to single precision would change more than a per cent of the spectrum that it makes.
constexpr double wellConditioned = 1e5;

// Verifies an inverse, and lets what its quality allows be rounded.
InverseQuality settled(const LocalMatrix& matrix, const Kernel& kernel, LocalInverse& inverse,
                       const LocalInverseOptions& options, const std::string& number) {
  const InverseQuality quality = verified(matrix, kernel, inverse, options, number);
  if (options.roundSchur && quality.condition() <= wellConditioned)
    inverse.roundSchurComplement();
  inverse.roundProducts(options.productError);
  return quality;
}

using Made = Details::MadeInverse;

// What a class's inverse is made of.
struct Place {
  const LocalMatrix& matrix;
  const Kernel& kernel;
  const CongruenceClass& item;
  std::string number;        ///< of its first subdomain
  const Kernel& firstKernel; ///< see SubdomainSystem
};

// With the subdomain's name and what may be wrong with it.
template<class Make>
void rethrowing(const LocalMatrix& matrix, const Kernel& kernel, const LocalInverseOptions& options,
                const std::string& number, Make&& make) {
  try {
    make();
  } catch (const NumericalError& error) {
    const std::string precision = options.precision == Precision::Single
                                      ? "its condition number is too large for single precision (check with "
                                        "\"Dual operator/Precision\" = \"double\"), or "
                                      : "";
    throw hiddenMotion("subdomain " + number + ": " + error.what() + "; " + precision, matrix, kernel,
                       {{"subdomain", number}});
  }
}

Made makeOnce(const Place& place, const LocalInverseOptions& options,
              const std::shared_ptr<FactorizationContext>& context) {
  const auto& [matrix, kernel, item, number, firstKernel] = place;
  Made made;
  rethrowing(matrix, kernel, options, number, [&, &boundary = item.boundary, &members = item.members] {
    made.inverse =
        options.form == DualForm::Implicit
            ? makeImplicitInverse(place.matrix, place.kernel, boundary, options, context, &place.firstKernel)
            : makeCondensedInverse(place.matrix, place.kernel, boundary, static_cast<int>(members.size()),
                                   options, context);
  });
  made.quality = settled(matrix, kernel, *made.inverse, options, number);
  return made;
}

// Condensed inverses are formed explicitly: where that has lost too much to rounding errors, solves take
// their place, which are exact to rounding errors of K.
template<class MakeCondensed>
Made madeOrReplaced(const Place& place, const LocalInverseOptions& options,
                    const std::shared_ptr<FactorizationContext>& context, MakeCondensed&& make) {
  if (options.form == DualForm::Implicit || options.precision == Precision::Single)
    return make();
  try {
    return make();
  } catch (const NumericalError&) {
    LocalInverseOptions exact = options;
    exact.form = DualForm::Implicit;
    exact.productError = 0.0;
    Made made = makeOnce(place, exact, context); // or the error of this one, which says more
    made.isReplaced = true;
    return made;
  }
}

} // namespace

std::vector<CongruenceClass> congruenceClasses(const SubdomainSystem& system, const Constraints& constraints,
                                               bool share, int fixingPlaces) {
  std::vector<CongruenceClass> classes;
  // A matrix that is equal but said to have another kernel is to be tried by itself. Kernels of one dimension
  // are the same space: each was seen to be one.
  std::map<std::pair<const LocalMatrix*, int>, std::size_t> known;
  for (int i = 0; i < system.size(); ++i) {
    const auto [place, isNew] =
        known.emplace(std::make_pair(&system.matrix(i), system.kernel(i).columns), classes.size());
    if (isNew || !share)
      classes.push_back({{i}, {}});
    else
      classes[place->second].members.push_back(i);
  }
  for (CongruenceClass& item : classes) {
    const int first = item.members.front();
    item.boundary = boundaryWithSupport(system.matrix(first), system.firstKernel(first),
                                        touchedDofs(system, constraints, item.members), fixingPlaces);
  }
  return classes;
}

LocalInverses::LocalInverses(std::vector<CongruenceClass> classes,
                             std::vector<std::unique_ptr<LocalInverse>> inverses)
    : classes_(std::move(classes)),
      inverses_(std::make_move_iterator(inverses.begin()), std::make_move_iterator(inverses.end())),
      isReplaced_(classes_.size(), 0),
      qualities_(classes_.size()) {
  HARMOS_REQUIRE(classes_.size() == inverses_.size(), "each class of subdomains needs one inverse");
}

double LocalInverses::bytes() const {
  double sum = 0.0;
  for (const auto& inverse : inverses_)
    sum += inverse->bytes();
  return joined_ ? sum + joined_->bytes() : sum;
}

int LocalInverses::roundedFactorizations() const {
  return static_cast<int>(std::count_if(inverses_.begin(), inverses_.end(),
                                        [](const auto& inverse) { return inverse->hasRoundedProducts(); }));
}

void LocalInverses::restoreProducts(const Teuchos::Comm<int>& comm) {
  agree(comm, [&] {
    for (const auto& inverse : inverses_)
      inverse->restoreProducts();
    if (joined_) // operators that were handed out have it
      *joined_ = ClusterInverse(joined_->sharedClusters(), groups());
    if (context_ != nullptr)
      context_->releaseWorkspace();
  });
}

int LocalInverses::replacedFactorizations() const {
  return static_cast<int>(std::count(isReplaced_.begin(), isReplaced_.end(), 1));
}

FactorizationCounts LocalInverses::counts() const {
  FactorizationCounts sum = spent_;
  for (const auto& inverse : inverses_)
    if (inverse)
      sum += inverse->counts();
  return sum;
}

void LocalInverses::take(CongruenceClass item, Details::MadeInverse made) {
  classes_.push_back(std::move(item));
  inverses_.push_back(std::move(made.inverse));
  isReplaced_.push_back(made.isReplaced ? 1 : 0);
  qualities_.push_back(made.quality);
}

void LocalInverses::judge() {
  condition_ = 1.0;
  defect_ = 0.0;
  for (const InverseQuality& quality : qualities_) {
    condition_ = std::max(condition_, quality.condition());
    defect_ = std::max(defect_, quality.defect);
  }
}

std::vector<ClusterInverse::Group> LocalInverses::groups() const {
  std::vector<ClusterInverse::Group> result;
  for (std::size_t c = 0; c < classes_.size(); ++c)
    result.push_back({classes_[c].members, classes_[c].boundary, &inverses_[c]->boundaryOperator()});
  return result;
}

// Operators that were handed out keep theirs.
void LocalInverses::join(const std::shared_ptr<const Clusters>& clusters) {
  if (clusters)
    joined_ = std::make_shared<ClusterInverse>(clusters, groups());
}

// What is left of them has been spent in vain.
void LocalInverses::forget() {
  spent_ = counts();
  inverses_.assign(classes_.size(), nullptr);
}

void LocalInverses::renew(const SubdomainSystem& system, const Constraints& constraints,
                          const LocalInverseOptions& options, const std::vector<char>& isSame) {
  const auto stays = [&](const CongruenceClass& item) {
    return !isSame.empty() && std::all_of(item.members.begin(), item.members.end(), [&](int member) {
      return isSame[static_cast<std::size_t>(member)] != 0;
    });
  };
  const auto place = [&](const CongruenceClass& item) -> Place {
    const int first = item.members.front();
    return {system.matrix(first), system.kernel(first), item, std::to_string(system.subdomain(first).number),
            system.firstKernel(first)};
  };
  // The same class with other matrices, by the analysis that is there.
  const auto refactored = [&](const Place& of, std::shared_ptr<LocalInverse>& inverse, bool wasReplaced) {
    const auto again = [&] {
      rethrowing(of.matrix, of.kernel, options, of.number, [&] { inverse->refactor(of.matrix, of.kernel); });
      const InverseQuality quality = settled(of.matrix, of.kernel, *inverse, options, of.number);
      return Made{std::move(inverse), quality, wasReplaced};
    };
    return wasReplaced ? again() : madeOrReplaced(of, options, context_, again);
  };
  agree(*system.comm(), [&] {
    if (!context_)
      context_ = options.context ? options.context : std::make_shared<FactorizationContext>();
    LocalInverses next;
    try {
      for (CongruenceClass& item :
           congruenceClasses(system, constraints, options.share, options.fixingPlaces)) {
        const auto before = std::find(classes_.begin(), classes_.end(), item);
        const auto k = static_cast<std::size_t>(before - classes_.begin());
        const Place of = place(item);
        Made made =
            before == classes_.end() || inverses_[k] == nullptr
                ? madeOrReplaced(of, options, context_, [&] { return makeOnce(of, options, context_); })
            : stays(item) ? Made{std::move(inverses_[k]), qualities_[k], isReplaced_[k] != 0}
                          : refactored(of, inverses_[k], isReplaced_[k] != 0);
        next.take(std::move(item), std::move(made));
      }
    } catch (...) {
      spent_ += next.counts();
      forget();
      throw;
    }
    forget();
    classes_ = std::move(next.classes_);
    inverses_ = std::move(next.inverses_);
    isReplaced_ = std::move(next.isReplaced_);
    qualities_ = std::move(next.qualities_);
    judge();
    join(options.clusters);
    context_->releaseWorkspace();
  });
}

RigidMotions motionsOf(const SubdomainSystem& system, const LocalInverses& inverses) {
  return inverses.joined() != nullptr ? inverses.joined()->clusters().motions() : RigidMotions(system);
}

LocalInverses makeLocalInverses(const SubdomainSystem& system, const Constraints& constraints,
                                const LocalInverseOptions& options) {
  LocalInverses result;
  result.renew(system, constraints, options);
  return result;
}

} // namespace Harmos::feti
