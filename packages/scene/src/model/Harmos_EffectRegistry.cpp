// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_EffectRegistry.hpp"

#include "Harmos_Errors.hpp"

namespace Harmos::scene {

void EffectRegistry::add(EffectKind kind) {
  for (const EffectKind& other : kinds_)
    HARMOS_REQUIRE(other.name != kind.name, "two effects are registered by the name \"" + kind.name + "\"");
  HARMOS_REQUIRE(static_cast<bool>(kind.make), "the effect \"" + kind.name + "\" cannot be made");
  kinds_.push_back(std::move(kind));
}

ParameterSpec EffectRegistry::spec() const {
  ParameterSpec list("Effects",
                     "Loads, supports and conditions between bodies, each by a name of your choice.");
  for (const EffectKind& kind : kinds_) {
    ParameterSpec ofKind(kind.name, "Effects of this kind, by names of your choice.");
    ofKind.family(parametersOf(kind));
    list.list(std::move(ofKind));
  }
  return list;
}

ParameterSpec EffectRegistry::parametersOf(const EffectKind& kind) {
  ParameterSpec spec = kind.parameters;
  if (kind.hasMagnitude)
    spec.text("History", "",
              "Factor of the magnitude over the steps: \"ramp\", \"constant\" or one of \"Steps/Histories\". "
              "Empty: "
              "\"ramp\" with several steps, else \"constant\".");
  else
    spec.absent(
        "History",
        "effects of the kind \"" + kind.name +
            "\" have no magnitude to scale by a history; use it for a load or a prescribed displacement");
  return spec;
}

void EffectRegistry::addParameters(ParameterSpec& deck) const {
  deck.list(spec());
}

Teuchos::ParameterList EffectRegistry::defaultsOf(const std::string& kind) const {
  for (const EffectKind& known : kinds_)
    if (known.name == kind)
      return parametersOf(known).defaults();
  throw InternalError("no effect of the kind \"" + kind + "\" is registered");
}

void EffectRegistry::addEffects(const Teuchos::ParameterList& deck, Scene& scene) const {
  for (const EffectKind& kind : kinds_) {
    const Teuchos::ParameterList& list = deck.sublist("Effects").sublist(kind.name);
    for (auto item = list.begin(); item != list.end(); ++item) {
      const std::string& name = list.name(item);
      if (name.find('/') != std::string::npos)
        throw InputError("the effect \"" + name + "\" of \"Effects/" + kind.name +
                             "\" has a slash in its name, the separator of lists; use another character",
                         {{"path", "Effects/" + kind.name}});
      const Teuchos::ParameterList& parameters = list.sublist(name);
      scene.effects.push_back(kind.make(parameters, "Effects/" + kind.name + "/" + name, scene));
      if (kind.hasMagnitude)
        scene.timeline.follow(*scene.effects.back(), parameters.get<std::string>("History"));
    }
  }
}

void EffectRegistry::write(std::ostream& out) const {
  spec().writeText(out);
}

std::string nameIn(const std::string& path) {
  return path.substr(path.rfind('/') + 1);
}

} // namespace Harmos::scene
