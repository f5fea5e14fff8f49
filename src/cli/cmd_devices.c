/* stiction devices: what is connected, what to type for it, and what stops it from opening. */
#include "../../drivers/hid/hid_sysfs.h"
#include "../../drivers/scan.h"
#include "../io/json.h"
#include "cli.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define RULE_FILE "70-stiction.rules"
#define RELOAD "sudo udevadm control --reload && sudo udevadm trigger"
#define FOLDER_MAX 400 /* bytes of --root */

static const stic_cli_usage usage = {
  "devices", "[OPTION...]",
  "Lists the HID devices and serial ports that are there, which driver each is for and the text to give to\n"
  "--device, and the drivers with their keys. Opens nothing.\n",
  0, 0};

typedef struct findings {
  int count;
  stic_scan_device devices[STIC_SCAN_MAX];
} findings;

/* ---- for people -------------------------------------------------------------------------- */

static const char *name_of(const stic_scan_device *d)
{
  if (d->node.product_name[0])
    return d->node.product_name;
  return d->certain || !d->driver ? "(no name)" : "serial port";
}

static void print_device(const stic_scan_device *d)
{
  char ids[16] = "";

  if (d->node.vendor || d->node.product)
    snprintf(ids, sizeof ids, " %04x:%04x", (unsigned)d->node.vendor, (unsigned)d->node.product);
  printf("  %-12s %s  (%s%s, %s)\n", d->driver ? d->driver->name : "-", name_of(d), d->node.bus, ids,
         d->node.path);
  if (d->driver)
    printf("  %-12s --device %s\n", "", d->spec);
  if (d->driver && d->state == STIC_SCAN_NO_PERMISSION)
    printf("  %-12s no permission to open it, see below\n", "");
  if (d->driver && d->state == STIC_SCAN_NO_NODE)
    printf(
      "  %-12s there is nothing at that path: udev has not made it, or it is not shared with this container\n",
      "");
}

/* Those that are, or are not, for a driver for certain; how many. */
static int print_some(const findings *f, const char *title, bool driven, bool certain)
{
  int count = 0;

  for (int i = 0; i < f->count; i++) {
    const stic_scan_device *d = &f->devices[i];

    if ((d->driver != NULL) != driven || (driven && d->certain != certain))
      continue;
    if (count++ == 0)
      printf("%s\n", title);
    print_device(d);
  }
  if (count > 0)
    printf("\n");
  return count;
}

/* Once for all, whatever the number of devices. */
static void print_permissions(const findings *f, bool certain)
{
  const stic_scan_device *last = NULL;

  for (int i = 0; i < f->count; i++) {
    const stic_scan_device *d = &f->devices[i];

    if (!d->driver || d->certain != certain || d->state != STIC_SCAN_NO_PERMISSION)
      continue;
    printf("%s%s", last ? ", " : "No permission for ", d->node.path);
    last = d;
  }
  if (!last)
    return;
  if (certain)
    printf(". Put the file " RULE_FILE " (drivers/ in the sources, lib/udev/rules.d where\n"
           "stiction is installed) into /etc/udev/rules.d, then run\n    " RELOAD "\n\n");
  else
    printf(". Join the group of serial ports and log in again:\n    sudo usermod -aG %s $USER\n\n",
           last->group[0] ? last->group : "dialout");
}

static void print_drivers(bool keys)
{
  printf("Drivers%s\n", keys ? "" : " (with their keys: --drivers)");
  for (int i = 0; stic_driver_at(i); i++) {
    const stic_driver *d = stic_driver_at(i);

    printf("  %-12s %s\n", d->name, d->about);
    for (const stic_spec_key *key = d->keys; keys && key->name; key++)
      printf("    %-10s %s%s\n", key->name, key->flag ? "(alone) " : "", key->about);
  }
}

static void print_findings(const findings *f)
{
  const int trackers = print_some(f, "Connected", true, true);
  const int ports = print_some(f, "Serial ports, which do not say what is behind them", true, false);

  print_some(f, "Not for any driver", false, false);
  if (trackers == 0)
    printf("No tracker is connected%s. Plug one in and ask again, or go on without one:\n"
           "    stiction run SCENE --device trace:file=TRACE   a recorded hand\n"
           "    stiction run SCENE --device mouse --view       the mouse as the hand\n"
           "    stiction monitor --device sample               a hand that moves by itself\n\n",
           ports > 0 ? ", unless one is behind a serial port" : "");
  print_permissions(f, true);
  print_permissions(f, false);
}

/* ---- for scripts ------------------------------------------------------------------------- */

static const char *state_name(stic_scan_state state)
{
  switch (state) {
  case STIC_SCAN_NO_NODE: return "no node";
  case STIC_SCAN_NO_PERMISSION: return "no permission";
  case STIC_SCAN_READY: break;
  }
  return "ready";
}

static json_t *device_json(const stic_scan_device *d)
{
  return json_pack("{s:s, s:s, s:i, s:i, s:s, s:s, s:s?, s:s?, s:b, s:s}", "path", d->node.path, "bus",
                   d->node.bus, "vendor", d->node.vendor, "product", d->node.product, "name",
                   d->node.product_name, "serial", d->node.serial, "driver",
                   d->driver ? d->driver->name : NULL, "device", d->driver ? d->spec : NULL, "certain",
                   d->certain, "state", state_name(d->state));
}

static json_t *driver_json(const stic_driver *driver)
{
  json_t *keys = json_array();

  for (const stic_spec_key *key = driver->keys; key->name; key++)
    keys = stic_json_append(
      keys, json_pack("{s:s, s:b, s:s}", "name", key->name, "flag", key->flag, "about", key->about));
  return json_pack("{s:s, s:s, s:o}", "name", driver->name, "about", driver->about, "keys", keys);
}

static int print_json(const findings *f, bool drivers_only)
{
  json_t *devices = drivers_only ? NULL : json_array(), *drivers = json_array(), *all;
  int result;

  for (int i = 0; i < f->count; i++)
    devices = stic_json_append(devices, device_json(&f->devices[i]));
  for (int i = 0; stic_driver_at(i); i++)
    drivers = stic_json_append(drivers, driver_json(stic_driver_at(i)));
  if (!devices && !drivers_only) { /* no memory */
    json_decref(drivers);
    drivers = NULL;
  }
  all = json_pack("{s:o*, s:o}", "devices", devices, "drivers", drivers);
  result = all ? json_dumpf(all, stdout, JSON_INDENT(1) | JSON_ENSURE_ASCII) : -1;
  json_decref(all);
  printf("\n");
  if (result != 0 && !ferror(stdout)) {
    stic_cli_say("devices: out of memory");
    return STIC_NO_MEMORY;
  }
  return STIC_OK;
}

/* ---- the command ------------------------------------------------------------------------- */

static int find_under(void *context, stic_hid_node *nodes, int capacity)
{
  const char *root = context;
  char folder[FOLDER_MAX + 40];
  int count;

  snprintf(folder, sizeof folder, "%.*s" STIC_HID_SYSFS, FOLDER_MAX, root);
  count = stic_hid_sysfs_enumerate(folder, nodes, capacity);
  for (int i = 0; i < count; i++) {
    char path[STIC_HID_PATH_MAX];

    snprintf(path, sizeof path, "%.100s%.100s", root, nodes[i].path);
    memcpy(nodes[i].path, path, sizeof path);
  }
  return count;
}

/* `root` NULL: the system's devices; else those in a copy of /sys and /dev, for tests. */
static void find(const char *root, findings *f)
{
  char tty[FOLDER_MAX + 40], dev[FOLDER_MAX + 40];
  const stic_hid_transport hid = {
    .name = "copy", .context = (void *)(uintptr_t)root, .enumerate = find_under};
  const stic_scan_places places = {&hid, tty, dev, access};

  if (root) {
    snprintf(tty, sizeof tty, "%.*s/sys/class/tty", FOLDER_MAX, root);
    snprintf(dev, sizeof dev, "%.*s/dev", FOLDER_MAX, root);
  }
  f->count = stic_scan(root ? &places : &stic_scan_system, f->devices);
}

static int show(const char *root, bool drivers, bool json)
{
  findings *f = calloc(1, sizeof *f);
  int code = STIC_OK;

  if (!f) {
    stic_cli_say("devices: out of memory");
    return STIC_NO_MEMORY;
  }
  if (!drivers)
    find(root, f);
  if (json) {
    code = print_json(f, drivers);
  } else {
    if (!drivers)
      print_findings(f);
    print_drivers(drivers);
  }
  free(f);
  return code;
}

int stic_cmd_devices(int argc, const char **argv)
{
  int drivers = 0, json = 0;
  char *root = NULL;
  const struct poptOption table[] = {
    {"drivers", '\0', POPT_ARG_NONE, &drivers, 0, "Only the drivers, with all keys of --device", NULL},
    {"json", '\0', POPT_ARG_NONE, &json, 0, "As JSON, for scripts", NULL},
    {"root", '\0', POPT_ARG_STRING | POPT_ARGFLAG_DOC_HIDDEN, &root, 0, NULL, NULL},
    POPT_TABLEEND};
  stic_cli_args args;
  int code = stic_cli_parse(&usage, table, argc, argv, &args);

  if (code < 0)
    code = show(root, drivers != 0, json != 0);
  stic_cli_args_free(&args);
  free(root);
  return code;
}
