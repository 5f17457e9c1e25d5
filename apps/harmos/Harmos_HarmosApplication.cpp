// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_HarmosApplication.hpp"

#include "Harmos_AutomaticContact.hpp"
#include "Harmos_DeckScene.hpp"
#include "Harmos_Effects.hpp"

namespace Harmos::app {

Application harmosApplication(KinematicsChoice kinematics) {
  const auto registry = std::make_shared<scene::EffectRegistry>();
  effects::registerEffects(*registry);
  registry->add(kindOfAutomaticContact());
  Application application;
  application.name = "harmos";
  application.description = "contact of elastic bodies, from a deck alone";
  application.addParameters = [registry, kinematics](ParameterSpec& deck) {
    addSceneParameters(deck, *registry, kinematics);
  };
  application.makeScene = [registry](const DeckContext& context) {
    return sceneFromDeck(context, *registry);
  };
  application.effects = registry;
  application.mayBeTransient = kinematics == KinematicsChoice::Offered;
  application.mayAdapt = kinematics == KinematicsChoice::Offered;
  return application;
}

} // namespace Harmos::app
