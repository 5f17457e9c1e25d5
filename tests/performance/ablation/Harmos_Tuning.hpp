// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

/// Constants of the QP layer that an ablation changes while a program runs. Only the copy of the sources that
/// ablation.py makes has any: there each constant is a Knob, by the name of its file and its own.
///
///     HARMOS_TUNE="PdasSolver_def.slow=30"     changes it from the start
///     HARMOS_TUNE_ASKED=FILE               appends the names of those that were asked for, at the end
namespace Harmos::tuning {

struct Knob {
  double standard, value;
  bool isAsked = false;
};

class Knobs {
 public:
  static Knobs& all() {
    static Knobs knobs;
    return knobs;
  }

  Knob& knob(const std::string& name, double standard) {
    const auto [place, isNew] = knobs_.try_emplace(name, Knob{standard, standard});
    if (const char* given = std::getenv("HARMOS_TUNE"); isNew && given != nullptr) {
      const std::string text = given, begin = name + "=";
      if (text.compare(0, begin.size(), begin) == 0)
        place->second.value = std::stod(text.substr(begin.size()));
    }
    return place->second;
  }

  std::map<std::string, Knob>& map() { return knobs_; }

  ~Knobs() {
    const char* const file = std::getenv("HARMOS_TUNE_ASKED");
    if (file == nullptr)
      return;
    std::ofstream out(file, std::ios::app);
    for (const auto& [name, knob] : knobs_)
      if (knob.isAsked)
        out << name << "\n";
  }

 private:
  Knobs() = default;
  std::map<std::string, Knob> knobs_;
};

inline double read(Knob& knob) {
  knob.isAsked = true;
  return knob.value;
}

/// In the place of a constant of a class.
template<class Number>
class Constant {
 public:
  Constant(const char* name, Number standard)
      : knob_(Knobs::all().knob(name, static_cast<double>(standard))) {}
  operator Number() const { return static_cast<Number>(read(knob_)); }

 private:
  Knob& knob_;
};

} // namespace Harmos::tuning

/// In the place of a constant of a function. A switch is a constant of zero.
#define HARMOS_TUNED(name, standard)                                                                         \
  static_cast<decltype(standard)>(::Harmos::tuning::read([]() -> ::Harmos::tuning::Knob& {                   \
    static ::Harmos::tuning::Knob& knob =                                                                    \
        ::Harmos::tuning::Knobs::all().knob(name, static_cast<double>(standard));                            \
    return knob;                                                                                             \
  }()))
