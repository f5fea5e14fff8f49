#define _XOPEN_SOURCE 700 /* realpath() */
#include "scan.h"

#include <dirent.h>
#include <errno.h>
#include <grp.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define TTY_FOLDER "/sys/class/tty"

const stic_scan_places stic_scan_system = {&stic_hid_system, TTY_FOLDER, "/dev", access};

/* ---- serial ports ------------------------------------------------------------------------ */

/* First line of FOLDER/NAME; false if there is none. */
static bool read_attribute(const char *folder, const char *name, char *out, int size)
{
  char path[PATH_MAX];
  FILE *file;
  bool read;

  if (snprintf(path, sizeof path, "%s/%s", folder, name) >= (int)sizeof path)
    return false;
  file = fopen(path, "r");
  if (!file)
    return false;
  read = fgets(out, size, file) != NULL;
  fclose(file);
  if (!read)
    return false;
  out[strcspn(out, "\n")] = '\0';
  for (char *c = out; *c; c++)
    *c = (char)(*c < 0x20 || *c > 0x7e ? '?' : *c);
  return true;
}

/* Numbers and name from the nearest USB device above the port, if it is an adapter. */
static void read_adapter(char *folder, stic_hid_node *node)
{
  char text[16];
  char *slash;

  while ((slash = strrchr(folder, '/')) != NULL && slash != folder) {
    if (read_attribute(folder, "idVendor", text, sizeof text)) {
      node->vendor = (uint16_t)strtoul(text, NULL, 16);
      if (read_attribute(folder, "idProduct", text, sizeof text))
        node->product = (uint16_t)strtoul(text, NULL, 16);
      read_attribute(folder, "product", node->product_name, sizeof node->product_name);
      read_attribute(folder, "serial", node->serial, sizeof node->serial);
      return;
    }
    *slash = '\0';
  }
}

/* Consoles and pseudo terminals have no device; ports that the mainboard has only room for are of type 0. */
static bool take_port(const stic_scan_places *places, const char *name, stic_hid_node *node)
{
  char path[PATH_MAX], folder[PATH_MAX], type[16];

  memset(node, 0, sizeof *node);
  node->bus = "serial";
  if (snprintf(path, sizeof path, "%s/%s/device", places->tty, name) >= (int)sizeof path ||
      !realpath(path, folder) ||
      snprintf(node->path, sizeof node->path, "%s/%s", places->dev, name) >= (int)sizeof node->path)
    return false;
  *strrchr(path, '/') = '\0';
  if (read_attribute(path, "type", type, sizeof type) && strcmp(type, "0") == 0)
    return false;
  read_adapter(folder, node);
  return true;
}

static int compare_names(const struct dirent **a, const struct dirent **b)
{
  const size_t x = strlen((*a)->d_name), y = strlen((*b)->d_name);

  return x != y ? (x > y) - (x < y) : strcmp((*a)->d_name, (*b)->d_name);
}

static int list_ports(const stic_scan_places *places, stic_hid_node *nodes, int capacity)
{
  struct dirent **entries;
  const int found = scandir(places->tty, &entries, NULL, compare_names);
  int count = 0;

  for (int i = 0; i < found; i++) {
    if (entries[i]->d_name[0] != '.' && count < capacity &&
        take_port(places, entries[i]->d_name, &nodes[count]))
      count++;
    free(entries[i]);
  }
  if (found >= 0)
    free(entries);
  return count;
}

/* ---- drivers ----------------------------------------------------------------------------- */

static void find_driver(stic_scan_device *d)
{
  const stic_device_id id = stic_hid_id(&d->node);

  for (int i = 0; stic_driver_at(i) && !d->driver; i++) {
    if (stic_driver_at(i)->match && stic_driver_at(i)->match(&id))
      d->driver = stic_driver_at(i);
  }
  d->certain = d->driver && strcmp(d->node.bus, "serial") != 0;
}

static void look_at_node(const stic_scan_places *places, stic_scan_device *d)
{
  struct stat about;
  const struct group *group;

  if (d->node.path[0] != '/') /* the libusb backend's are no files */
    return;
  if (places->access(d->node.path, R_OK | W_OK) != 0)
    d->state = errno == EACCES || errno == EPERM ? STIC_SCAN_NO_PERMISSION : STIC_SCAN_NO_NODE;
  if (stat(d->node.path, &about) == 0 && (group = getgrgid(about.st_gid)) != NULL)
    snprintf(d->group, sizeof d->group, "%s", group->gr_name);
}

/* Nodes of one device, as a Hydra has two: alike but for their use. */
static bool is_same_device(const stic_hid_node *a, const stic_hid_node *b)
{
  return strcmp(a->path, b->path) == 0 ||
         (a->vendor == b->vendor && a->product == b->product && strcmp(a->serial, b->serial) == 0 &&
          (a->usage.page != b->usage.page || a->usage.id != b->usage.id));
}

static bool has_rival(const stic_scan_device *devices, int count, const stic_scan_device *d)
{
  for (int i = 0; i < count; i++) {
    if (devices[i].driver == d->driver && !is_same_device(&devices[i].node, &d->node))
      return true;
  }
  return false;
}

/* The driver's name alone opens the first that fits; of several each must be told apart. */
static void make_spec(const stic_scan_device *devices, int count, stic_scan_device *d)
{
  const bool serial_port = !d->certain;
  char quoted[2 * STIC_HID_PATH_MAX];

  if (!d->driver)
    return;
  if (!serial_port && !has_rival(devices, count, d)) {
    snprintf(d->spec, sizeof d->spec, "%s", d->driver->name);
    return;
  }
  stic_spec_quote(!serial_port && d->node.serial[0] ? d->node.serial : d->node.path, quoted, sizeof quoted);
  snprintf(d->spec, sizeof d->spec, "%.40s:%s=%.460s", d->driver->name,
           serial_port         ? "port"
           : d->node.serial[0] ? "serial"
                               : "path",
           quoted);
}

int stic_scan(const stic_scan_places *places, stic_scan_device *devices)
{
  stic_hid_node nodes[STIC_SCAN_MAX];
  int count = stic_hid_list(places->hid, nodes, STIC_HID_NODES_MAX);

  count += list_ports(places, nodes + count, STIC_SCAN_MAX - count);
  for (int i = 0; i < count; i++) {
    memset(&devices[i], 0, sizeof devices[i]);
    devices[i].node = nodes[i];
    find_driver(&devices[i]);
    look_at_node(places, &devices[i]);
  }
  for (int i = 0; i < count; i++)
    make_spec(devices, count, &devices[i]);
  return count;
}
