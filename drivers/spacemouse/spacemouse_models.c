#include "spacemouse_models.h"

#include <stddef.h>
#include <string.h>

#define LOGITECH 0x046d /* the maker's parent, whose number the older models carry */
#define THREEDCONNEXION 0x256f
#define PRO_KEY_1 12 /* the Pro family has MENU at bit 0 */

static const stic_spacemouse_model models[] = {
  {LOGITECH, 0xc623, "SpaceTraveler", STIC_SPACEMOUSE_SPLIT, 0},
  {LOGITECH, 0xc625, "SpacePilot", STIC_SPACEMOUSE_SPLIT, 0},
  {LOGITECH, 0xc626, "SpaceNavigator", STIC_SPACEMOUSE_SPLIT, 0},
  {LOGITECH, 0xc627, "SpaceExplorer", STIC_SPACEMOUSE_SPLIT, 0},
  {LOGITECH, 0xc628, "SpaceNavigator for Notebooks", STIC_SPACEMOUSE_SPLIT, 0},
  {LOGITECH, 0xc629, "SpacePilot Pro", STIC_SPACEMOUSE_SPLIT, PRO_KEY_1},
  {LOGITECH, 0xc62b, "SpaceMouse Pro", STIC_SPACEMOUSE_SPLIT, PRO_KEY_1},
  {THREEDCONNEXION, 0xc62e, "SpaceMouse Wireless (cable)", STIC_SPACEMOUSE_COMBINED, 0},
  {THREEDCONNEXION, 0xc62f, "SpaceMouse Wireless (receiver)", STIC_SPACEMOUSE_COMBINED, 0},
  {THREEDCONNEXION, 0xc631, "SpaceMouse Pro Wireless (cable)", STIC_SPACEMOUSE_COMBINED, PRO_KEY_1},
  {THREEDCONNEXION, 0xc632, "SpaceMouse Pro Wireless (receiver)", STIC_SPACEMOUSE_COMBINED, PRO_KEY_1},
  {THREEDCONNEXION, 0xc633, "SpaceMouse Enterprise", STIC_SPACEMOUSE_COMBINED, PRO_KEY_1},
  {THREEDCONNEXION, 0xc635, "SpaceMouse Compact", STIC_SPACEMOUSE_SPLIT, 0},
  {THREEDCONNEXION, 0xc636, "SpaceMouse Module", STIC_SPACEMOUSE_COMBINED, 0},
  {THREEDCONNEXION, 0xc638, "SpaceMouse Pro Wireless Bluetooth", STIC_SPACEMOUSE_COMBINED, PRO_KEY_1},
  {THREEDCONNEXION, 0xc63a, "SpaceMouse Wireless Bluetooth", STIC_SPACEMOUSE_COMBINED, 0},
  /* Any cap may be behind the universal receiver; most have two keys. */
  {THREEDCONNEXION, 0xc652, "3Dconnexion Universal Receiver", STIC_SPACEMOUSE_COMBINED, 0},
};

#define MODEL_COUNT ((int)(sizeof models / sizeof models[0]))

/* By a part of the name; the first that fits, so that the more telling ones come first. */
static const stic_spacemouse_model families[] = {
  {0, 0, "SpaceMouse Pro", STIC_SPACEMOUSE_COMBINED, PRO_KEY_1},
  {0, 0, "SpaceMouse Enterprise", STIC_SPACEMOUSE_COMBINED, PRO_KEY_1},
  {0, 0, "SpacePilot Pro", STIC_SPACEMOUSE_SPLIT, PRO_KEY_1},
  {0, 0, "SpaceMouse", STIC_SPACEMOUSE_COMBINED, 0},
  {0, 0, "SpaceNavigator", STIC_SPACEMOUSE_SPLIT, 0},
  {0, 0, "SpaceExplorer", STIC_SPACEMOUSE_SPLIT, 0},
  {0, 0, "SpacePilot", STIC_SPACEMOUSE_SPLIT, 0},
  {0, 0, "SpaceTraveler", STIC_SPACEMOUSE_SPLIT, 0},
};

/* CadMouse, keyboards, numeric pads, receivers of these; c641 is said to be one of them. */
static const uint16_t never[] = {0xc62c, 0xc641, 0xc650, 0xc651, 0xc654, 0xc655,
                                 0xc656, 0xc657, 0xc658, 0xc664, 0xc665, 0xc668};

const stic_spacemouse_model *stic_spacemouse_model_at(int index)
{
  return index >= 0 && index < MODEL_COUNT ? &models[index] : NULL;
}

const stic_spacemouse_model *stic_spacemouse_find(uint16_t vendor, uint16_t product)
{
  for (int i = 0; i < MODEL_COUNT; i++) {
    if (models[i].vendor == vendor && models[i].product == product)
      return &models[i];
  }
  return NULL;
}

static bool may_go_by_name(uint16_t vendor, uint16_t product)
{
  return vendor == THREEDCONNEXION ? !stic_spacemouse_never(vendor, product) : vendor == 0 && product == 0;
}

const stic_spacemouse_model *stic_spacemouse_identify(uint16_t vendor, uint16_t product, const char *name)
{
  const stic_spacemouse_model *model = stic_spacemouse_find(vendor, product);

  if (model || !name || !may_go_by_name(vendor, product))
    return model;
  for (size_t i = 0; i < sizeof families / sizeof families[0]; i++) {
    if (strstr(name, families[i].name))
      return &families[i];
  }
  return NULL;
}

bool stic_spacemouse_never(uint16_t vendor, uint16_t product)
{
  for (size_t i = 0; i < sizeof never / sizeof never[0]; i++) {
    if (vendor == THREEDCONNEXION && never[i] == product)
      return true;
  }
  return false;
}
