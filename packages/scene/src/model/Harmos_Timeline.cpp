// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Timeline.hpp"

#include "Harmos_Effect.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace Harmos::scene {
namespace {

const char* const ramp = "ramp";
const char* const constant = "constant";
constexpr double leastSmallest = 1e-6; // times of parts stay apart

void requireRising(const std::vector<double>& times) {
  for (std::size_t k = 0; k < times.size(); ++k) {
    if (!std::isfinite(times[k]))
      throw InputError("time number " + std::to_string(k + 1) + " is not finite");
    if (k > 0 && !(times[k] > times[k - 1]))
      throw InputError("times must increase, but " + scientific(times[k]) + " comes after " +
                       scientific(times[k - 1]));
  }
}

// The fault with the place in the deck.
template<class Make>
auto at(const std::string& path, Make&& make) {
  try {
    return make();
  } catch (const InputError& error) {
    throw InputError("\"" + path + "\": " + error.what(), {{"path", path}});
  }
}

std::vector<double> numbersIn(const Teuchos::ParameterList& list, const std::string& name) {
  return list.get<Teuchos::Array<double>>(name).toVector();
}

void addTransientTo(ParameterSpec& steps) {
  steps.choice("Time integration", "static",
               {{"static", "bodies are in equilibrium at every time"},
                {"Newmark", "bodies have inertia, by the densities of their materials: generalised-α"}},
               "Whether steps are of time. With inertia magnitudes without a \"History\" are constant.");
  steps.real("Spectral radius", 0.9, Range::within(0.0, 1.0),
             "Newmark: what each step leaves of unresolved motions. 1: all of their energy, 0: nothing.");
  steps.real("Time error", 0.0, Range::within(0.0, 1.0),
             "Newmark: relative error of periods above which a step is halved. 0: steps are as given.");
}

} // namespace

History::History(std::vector<double> times, std::vector<double> values)
    : times_(std::move(times)), values_(std::move(values)) {
  if (times_.empty())
    throw InputError("a history needs at least one time and value");
  if (times_.size() != values_.size())
    throw InputError("a history needs a value for each time, but has " + std::to_string(times_.size()) +
                     " times and " + std::to_string(values_.size()) + " values");
  requireRising(times_);
  for (double value : values_)
    if (!std::isfinite(value))
      throw InputError("a value is not finite");
}

double History::operator()(double time) const {
  const auto next = std::upper_bound(times_.begin(), times_.end(), time);
  if (next == times_.begin())
    return values_.front();
  if (next == times_.end())
    return values_.back();
  const auto k = static_cast<std::size_t>(next - times_.begin());
  const double share = (time - times_[k - 1]) / (times_[k] - times_[k - 1]);
  return (1.0 - share) * values_[k - 1] + share * values_[k];
}

Timeline::Timeline(std::vector<double> ends, double smallest) : ends_(std::move(ends)), smallest_(smallest) {
  if (ends_.empty())
    throw InputError("a run needs at least one step");
  requireRising(ends_);
  if (!(ends_.front() > 0.0))
    throw InputError("the first step must end after time 0, but ends at " + scientific(ends_.front()));
  if (!(smallest_ >= leastSmallest && smallest_ <= 1.0))
    throw InputError("the smallest part of a step is a share of it, at least " +
                     scientific(leastSmallest, 0) + " and at most 1, not " + scientific(smallest_));
}

void Timeline::addTo(ParameterSpec& deck, bool mayBeTransient) {
  ParameterSpec steps("Steps", "Load steps, each from the state before. Number = 1: one static state.");
  steps.integer("Number", 1, 1, 10000000, "Number of steps of equal length.");
  steps.real("End time", 1.0, Range::above(0.0), "End of the last step, with \"Number\".");
  steps.series("Times", Range::above(0.0),
               "Ends of the steps, rising, instead of \"Number\" and \"End time\". The first step begins at "
               "time 0.");
  steps.real("Smallest step", defaultSmallest, Range::within(leastSmallest, 1.0),
             "Least part of a step, as a share of it. A step without convergence is halved, down to "
             "this part; then the run ends.");
  if (mayBeTransient)
    addTransientTo(steps);
  ParameterSpec histories("Histories", "Factors over time, by names of your choice.");
  ParameterSpec history("<history>",
                        "A factor over time. Piecewise linear; constant before the first time and after the "
                        "last. Built in are \"ramp\", 0 to 1 over the run, and \"constant\", 1.");
  history.series("Times", Range(), "Times, rising. Required.");
  history.series("Values", Range(), "Values of the factor, one for each time. Required.");
  histories.family(std::move(history));
  steps.list(std::move(histories));
  deck.list(std::move(steps));
}

Timeline Timeline::fromDeck(const Teuchos::ParameterList& deck) {
  const Teuchos::ParameterList& steps = deck.sublist("Steps");
  const std::vector<double> times = numbersIn(steps, "Times");
  const int number = steps.get<int>("Number");
  std::vector<double> ends = times;
  if (times.empty()) {
    const double end = steps.get<double>("End time");
    for (int k = 1; k <= number; ++k)
      ends.push_back(k == number ? end : end * k / number);
  } else if (number != 1) {
    throw InputError("contradictory parameters: \"Steps/Number\" = " + std::to_string(number) +
                         " and \"Steps/Times\" with " + std::to_string(times.size()) +
                         " entries; give one of the two",
                     {{"path", "Steps/Times"}});
  }
  Timeline timeline =
      at("Steps/Times", [&] { return Timeline(std::move(ends), steps.get<double>("Smallest step")); });
  timeline.isGiven_ = !times.empty();
  if (steps.isParameter("Time integration") && steps.get<std::string>("Time integration") == "Newmark") {
    timeline.integrate(steps.get<double>("Spectral radius"));
    timeline.keepWithin(steps.get<double>("Time error"));
    timeline.bringUp();
  }
  const Teuchos::ParameterList& histories = steps.sublist("Histories");
  for (auto item = histories.begin(); item != histories.end(); ++item) {
    const std::string& name = histories.name(item);
    at("Steps/Histories/" + name, [&] {
      const Teuchos::ParameterList& list = histories.sublist(name);
      timeline.add(name, History(numbersIn(list, "Times"), numbersIn(list, "Values")));
    });
  }
  return timeline;
}

void Timeline::add(const std::string& name, History history) {
  if (name == ramp || name == constant)
    throw InputError("the history \"" + name + "\" exists already; use another name");
  if (!histories_.emplace(name, std::move(history)).second)
    throw InputError("there are two histories of the name \"" + name + "\"");
}

void Timeline::follow(const Effect& effect, const std::string& history) {
  if (!history.empty())
    followed_[&effect] = history;
}

void Timeline::check(const std::vector<std::shared_ptr<const Effect>>& effects) const {
  std::vector<std::string> known = {constant, ramp};
  for (const auto& item : histories_)
    known.push_back(item.first);
  for (const auto& effect : effects) {
    const auto found = followed_.find(effect.get());
    if (found == followed_.end())
      continue;
    const std::string& name = found->second;
    if (!effect->hasMagnitude())
      throw InputError(effect->label() + " follows the history \"" + name +
                           "\", but has no magnitude to scale; give it one, or no history",
                       {{"history", name}});
    if (std::find(known.begin(), known.end(), name) != known.end())
      continue;
    const std::string nearest = nearestName(name, known);
    std::string all;
    for (const std::string& other : known)
      all += (all.empty() ? "\"" : ", \"") + other + "\"";
    throw InputError(effect->label() + " follows the history \"" + name + "\", which is not defined" +
                         (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?") +
                         " (available: " + all + "; define others in \"Steps/Histories\")",
                     {{"history", name}});
  }
}

std::string Timeline::historyOf(const Effect& effect) const {
  const auto found = followed_.find(&effect);
  if (found != followed_.end())
    return found->second;
  return hasSteps() && effect.hasMagnitude() && !isTransient() ? ramp : constant;
}

double Timeline::factor(const std::string& history, double time) const {
  if (history == constant)
    return 1.0;
  if (history == ramp)
    return time / end();
  const auto found = histories_.find(history);
  HARMOS_REQUIRE(found != histories_.end(), "there is no history \"" + history + "\"");
  return found->second(time);
}

std::vector<std::string> Timeline::names() const {
  std::vector<std::string> names;
  for (const auto& item : histories_)
    names.push_back(item.first);
  return names;
}

std::vector<double> Timeline::corners() const {
  std::set<double> times = {0.0, end()};
  for (const auto& item : histories_)
    for (double time : item.second.times())
      if (time > 0.0 && time < end())
        times.insert(time);
  return {times.begin(), times.end()};
}

} // namespace Harmos::scene
