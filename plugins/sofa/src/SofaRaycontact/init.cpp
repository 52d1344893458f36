// SPDX-License-Identifier: MIT OR Apache-2.0
// What SOFA's plugin manager asks of a plugin.
#include <SofaRaycontact/RaycontactForceField.h>
#include <SofaRaycontact/RaycontactNarrowPhase.h>
#include <sofa/core/ObjectFactory.h>
#include <sofa/helper/system/PluginManager.h>

namespace sofaraycontact {

extern "C" {
SOFARAYCONTACT_API void initExternalModule();
SOFARAYCONTACT_API const char* getModuleName();
SOFARAYCONTACT_API const char* getModuleVersion();
SOFARAYCONTACT_API const char* getModuleLicense();
SOFARAYCONTACT_API const char* getModuleDescription();
SOFARAYCONTACT_API void registerObjects(sofa::core::ObjectFactory* factory);
}

void initExternalModule() {
  static bool is_first = true;
  if (is_first) sofa::helper::system::PluginManager::getInstance().registerPlugin(MODULE_NAME);
  is_first = false;
}

const char* getModuleName() { return MODULE_NAME; }

const char* getModuleVersion() { return MODULE_VERSION; }

const char* getModuleLicense() { return "MIT OR Apache-2.0"; }

const char* getModuleDescription() {
  return "Ray-traced contact between deformable bodies, however deep they overlap.";
}

void registerObjects(sofa::core::ObjectFactory* factory) {
  factory->registerObjects(sofa::core::ObjectRegistrationData(
                               "Narrow phase that finds contacts between closed triangle surfaces, however deep "
                               "they overlap, by rays along their inward normals.")
                               .add<RaycontactNarrowPhase>());
  factory->registerObjects(
      sofa::core::ObjectRegistrationData("Contact forces and friction between the triangle models of a "
                                         "RaycontactNarrowPhase, at the end of each step.")
          .add<RaycontactForceField>());
}

}  // namespace sofaraycontact
