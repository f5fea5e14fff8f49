#include "hid.h"

#include "../../src/error.h"

#include <assert.h>
#include <stdio.h>
#include <string.h>

#define GENERIC_DESKTOP 0x01
#define BUS_USB_NUMBER 3 /* as in linux/input.h */
#define BUS_BLUETOOTH_NUMBER 5
#define RATE_MAX 100.0 /* m/s, rad/s */

static stic_hid_node *find_path(stic_hid_node *nodes, int count, const char *path)
{
  for (int i = 0; i < count; i++) {
    if (strcmp(nodes[i].path, path) == 0)
      return &nodes[i];
  }
  return NULL;
}

int stic_hid_list(const stic_hid_transport *transport, stic_hid_node *nodes, int capacity)
{
  stic_hid_node all[STIC_HID_NODES_MAX];
  const int found = transport->enumerate(transport->context, all, STIC_HID_NODES_MAX);
  int count = 0;

  for (int i = 0; i < found; i++) {
    stic_hid_node *same = find_path(nodes, count, all[i].path);

    if (same) {
      if (same->usage.page != GENERIC_DESKTOP && all[i].usage.page == GENERIC_DESKTOP)
        *same = all[i];
    } else if (count < capacity) {
      nodes[count++] = all[i];
    }
  }
  return count;
}

stic_device_id stic_hid_id(const stic_hid_node *node)
{
  const stic_device_id id = {.bus = node->bus,
                             .vendor = node->vendor,
                             .product = node->product,
                             .usage_page = node->usage.page,
                             .usage = node->usage.id,
                             .path = node->path,
                             .product_name = node->product_name};

  return id;
}

static bool wanted(const stic_driver *driver, const stic_device_spec *spec, const stic_hid_node *node)
{
  const char *path = stic_spec_text(spec, "path", NULL);
  const char *serial = stic_spec_text(spec, "serial", NULL);
  const stic_device_id id = stic_hid_id(node);

  return driver->match(&id) && (!path || strcmp(path, node->path) == 0) &&
         (!serial || strcmp(serial, node->serial) == 0);
}

/* Unknown usages last: a backend that tells none may list a device's keyboard or mouse side too. */
static unsigned rank(const stic_hid_node *node)
{
  return node->usage.page == 0 ? 0x10000u : node->usage.id;
}

/* Moves what is wanted to the front, each path once and by rank. Returns how many there are. */
static int keep_wanted(const stic_driver *driver, const stic_device_spec *spec, stic_hid_node *nodes,
                       int count)
{
  int kept = 0;

  for (int i = 0; i < count; i++) {
    const stic_hid_node node = nodes[i];
    int at = kept;

    if (!wanted(driver, spec, &node) || find_path(nodes, kept, node.path))
      continue;
    for (; at > 0 && rank(&nodes[at - 1]) > rank(&node); at--)
      nodes[at] = nodes[at - 1];
    nodes[at] = node;
    kept++;
  }
  return kept;
}

static stic_status none_found(const stic_driver *driver, const stic_device_spec *spec,
                              const stic_hid_transport *transport, stic_error *err)
{
  const char *path = stic_spec_text(spec, "path", NULL);
  const char *serial = stic_spec_text(spec, "serial", NULL);

  return stic_error_set(err, STIC_NO_DEVICE, NULL, 0, "no %s found by %s%s%.100s%s%.60s", driver->name,
                        transport->name, path ? " at " : "", path ? path : "",
                        serial ? " with serial number " : "", serial ? serial : "");
}

static stic_status open_nodes(const stic_hid_transport *transport, const stic_hid_node *nodes, int node_count,
                              stic_hid_link *links, int capacity, int *count, stic_error *err)
{
  for (int i = 0; i < node_count && *count < capacity; i++) {
    stic_hid_link *link = &links[*count];
    stic_status status;

    if (nodes[i].vendor != nodes[0].vendor || nodes[i].product != nodes[0].product)
      continue;
    link->transport = transport;
    link->node = nodes[i];
    link->first = links;
    link->raw = NULL;
    status = transport->open(transport->context, &nodes[i], &link->handle, err);
    if (status != STIC_OK)
      return status;
    (*count)++;
  }
  return STIC_OK;
}

static stic_status begin_raw(stic_hid_link *first, const char *path, bool again, stic_error *err)
{
  stic_raw_device about = {.bus = strcmp(first->node.bus, "bluetooth") == 0 ? BUS_BLUETOOTH_NUMBER
                                                                            : BUS_USB_NUMBER,
                           .vendor = first->node.vendor,
                           .product = first->node.product};

  snprintf(about.name, sizeof about.name, "%s", first->node.product_name);
  snprintf(about.place, sizeof about.place, "%.100s", first->node.path);
  return stic_raw_create(path, STIC_RAW_HID, &about, again, &first->raw, err);
}

stic_status stic_hid_connect(const stic_hid_transport *transport, const stic_driver *driver,
                             const stic_device_spec *spec, stic_hid_link *links, int capacity, int *count,
                             stic_error *err)
{
  stic_hid_node nodes[STIC_HID_NODES_MAX];
  const int found =
    keep_wanted(driver, spec, nodes, transport->enumerate(transport->context, nodes, STIC_HID_NODES_MAX));
  const char *raw = stic_spec_text(spec, "raw", NULL);
  stic_status status;

  assert(capacity >= 1);
  *count = 0;
  if (found == 0)
    return none_found(driver, spec, transport, err);
  status = open_nodes(transport, nodes, found, links, capacity, count, err);
  if (status == STIC_OK && raw)
    status = begin_raw(links, raw, spec->again, err);
  if (status != STIC_OK)
    stic_hid_disconnect(links, *count);
  return status;
}

void stic_hid_disconnect(stic_hid_link *links, int count)
{
  if (count > 0)
    stic_raw_finish(links->raw, NULL);
  for (int i = 0; i < count; i++)
    links[i].transport->close(links[i].handle);
}

static void record(const stic_hid_link *link, stic_device *device, const uint8_t *report, size_t length,
                   int64_t t_ns)
{
  stic_hid_link *first = link->first;

  if (first->raw &&
      stic_raw_write(first->raw, (int)(link - first), t_ns, report, length, &device->error) != STIC_OK) {
    stic_raw_finish(first->raw, NULL);
    first->raw = NULL;
  }
}

/* The transport's read(), with the device told if it is over. */
static int read_report(stic_hid_link *link, stic_device *device, uint8_t *report, size_t size,
                       int64_t until_ns, int64_t *t_ns)
{
  const int length = link->transport->read(link->handle, report, size, until_ns, t_ns);

  assert(length <= (int)size);
  if (length == STIC_DRIVER_END) {
    device->state = STIC_CONNECTION_CLOSED;
  } else if (length < 0) {
    device->state = STIC_CONNECTION_LOST;
    stic_error_set(&device->error, STIC_NO_DEVICE, NULL, 0, "%s at %.100s has been unplugged or has failed",
                   device->driver->name, link->node.path);
  }
  return length;
}

int stic_hid_drain(stic_hid_link *link, stic_device *device, stic_hid_take take, int64_t until_ns,
                   stic_device_sample *samples, int capacity)
{
  uint8_t report[STIC_HID_REPORT_MAX];
  int count = 0, reports = 0;

  while (count < capacity && reports < STIC_HID_DRAIN_MAX) {
    int64_t t_ns = 0;
    const int length = read_report(link, device, report, sizeof report, count > 0 ? 0 : until_ns, &t_ns);

    if (length < 0)
      return count > 0 ? count : length; /* the next call says so again */
    if (length == 0)
      break;
    reports++;
    stic_device_show_raw(device, report, (size_t)length);
    record(link, device, report, (size_t)length, t_ns);
    if (take(device, link, report, (size_t)length, t_ns, &samples[count]))
      count++;
  }
  if (count > 0 && reports >= STIC_HID_QUEUE)
    device->counters.overruns++;
  return count;
}

int64_t stic_hid_now(const stic_hid_link *link)
{
  return link->transport->now(link->transport->context);
}

void stic_hid_describe(const stic_hid_link *link, const char *name, char *out, size_t out_size)
{
  snprintf(out, out_size, "%s %04x:%04x at %s (%s)", name, (unsigned)link->node.vendor,
           (unsigned)link->node.product, link->node.path, link->transport->name);
}

stic_status stic_hid_no_permission(const stic_hid_node *node, stic_error *err)
{
  return stic_error_set(
    err, STIC_NO_DEVICE, NULL, 0,
    "no permission to open %.80s; put KERNEL==\"hidraw*\", ATTRS{idVendor}==\"%04x\", "
    "ATTRS{idProduct}==\"%04x\", TAG+=\"uaccess\" into /etc/udev/rules.d/70-stiction.rules "
    "(or install stiction's file of that name), then run: "
    "sudo udevadm control --reload && sudo udevadm trigger",
    node->path, (unsigned)node->vendor, (unsigned)node->product);
}

/* ---- what reports have in common --------------------------------------------------------- */

void stic_hid_clear_sample(stic_device_sample *sample, int64_t t_ns, uint64_t sequence, unsigned flags)
{
  memset(sample, 0, sizeof *sample);
  sample->t_ns = t_ns;
  sample->source_ns = t_ns;
  sample->sequence = sequence;
  sample->orientation[3] = 1;
  sample->flags = flags;
}

void stic_hid_count(stic_hid_sequence *sequence, uint8_t count, int64_t *gaps)
{
  const uint8_t step = (uint8_t)(count - sequence->last);

  if (sequence->begun && step != 1)
    ++*gaps;
  sequence->total += sequence->begun && step > 0 ? step : 1;
  sequence->last = count;
  sequence->begun = true;
}

stic_status stic_hid_read_rates(const stic_device_spec *spec, stic_hid_rates *rates, stic_error *err)
{
  stic_status status;

  rates->speed = 0.25;
  rates->turn = 1.5;
  status = stic_spec_number(spec, "speed", 0, RATE_MAX, &rates->speed, err);
  return status == STIC_OK ? stic_spec_number(spec, "turn", 0, RATE_MAX, &rates->turn, err) : status;
}

/* ---- report descriptors ------------------------------------------------------------------ */

/* An item of a report descriptor; its prefix without the two bits of size says what it is. */
enum { ITEM_USAGE_PAGE = 0x04, ITEM_USAGE = 0x08, ITEM_COLLECTION = 0xa0, ITEM_END = 0xc0, ITEM_LONG = 0xfc };

typedef struct item {
  unsigned kind;
  unsigned long value;
  size_t size; /* of the value */
} item;

/* Takes the item at `*at` and moves on; false if the descriptor ends within it. */
static bool next_item(const uint8_t *descriptor, size_t length, size_t *at, item *out)
{
  const uint8_t prefix = descriptor[(*at)++];

  out->kind = prefix & 0xfcu;
  out->size = (prefix & 3) == 3 ? 4 : prefix & 3u;
  out->value = 0;
  if (out->size > length - *at)
    return false;
  for (size_t i = 0; i < out->size; i++)
    out->value |= (unsigned long)descriptor[*at + i] << (8 * i);
  *at += out->size;
  if (out->kind == ITEM_LONG) { /* its first byte is the length of its data */
    if ((out->value & 0xff) > length - *at)
      return false;
    *at += out->value & 0xff;
  }
  return true;
}

int stic_hid_usages(const uint8_t *descriptor, size_t length, stic_hid_usage *usages, int capacity)
{
  stic_hid_usage usage = {0, 0};
  size_t at = 0;
  int count = 0, depth = 0;
  item i;

  while (at < length && next_item(descriptor, length, &at, &i)) {
    switch (i.kind) {
    case ITEM_USAGE_PAGE: usage.page = (uint16_t)i.value; break;
    case ITEM_USAGE:
      usage.id = (uint16_t)i.value;
      if (i.size == 4) /* carries its own page */
        usage.page = (uint16_t)(i.value >> 16);
      break;
    case ITEM_COLLECTION:
      if (depth++ == 0 && count < capacity)
        usages[count++] = usage;
      break;
    case ITEM_END: depth--; break;
    default: break;
    }
  }
  return count;
}
