#include "fake_hid.h"

#include "../../../src/error.h"

#include <stdio.h>
#include <string.h>

static int fake_enumerate(void *context, stic_hid_node *nodes, int capacity)
{
  const stic_fake_hid *hid = context;
  int count = 0;

  for (int i = 0; i < FAKE_NODES; i++) {
    for (int usage = 0; usage < hid->nodes[i].usages && count < capacity; usage++) {
      nodes[count] = hid->nodes[i].node;
      /* The device's own usage comes last, after vendor-defined ones. */
      if (usage + 1 < hid->nodes[i].usages) {
        nodes[count].usage = (stic_hid_usage){0xff00, (uint16_t)(usage + 1)};
      }
      count++;
    }
  }
  return count;
}

static stic_status fake_open(void *context, const stic_hid_node *node, stic_hid_handle **handle,
                             stic_error *err)
{
  stic_fake_hid *hid = context;

  for (int i = 0; i < FAKE_NODES; i++) {
    stic_fake_node *fake = &hid->nodes[i];

    if (fake->usages == 0 || strcmp(fake->node.path, node->path) != 0)
      continue;
    if (fake->forbidden)
      return stic_hid_no_permission(node, err);
    assert_false(fake->open);
    fake->open = true;
    fake->gone = false;
    hid->handles[i].hid = hid;
    hid->handles[i].node = i;
    *handle = &hid->handles[i];
    return STIC_OK;
  }
  return stic_error_set(err, STIC_NO_DEVICE, NULL, 0, "cannot open %.100s", node->path);
}

static int fake_read(stic_hid_handle *handle, uint8_t *report, size_t size, int64_t until_ns, int64_t *t_ns)
{
  stic_fake_hid *hid = handle->hid;
  stic_fake_node *fake = &hid->nodes[handle->node];
  const stic_fake_report *next = &fake->reports[fake->head];
  size_t length;

  assert_true(fake->open);
  if (fake->gone)
    return STIC_DRIVER_LOST;
  if (fake->head == fake->tail || next->t_ns > hid->now_ns) {
    const int64_t end_ns = fake->head < fake->tail && next->t_ns < until_ns ? next->t_ns : until_ns;

    hid->waits++;
    if (hid->interrupt) {
      hid->interrupt = false;
      return 0;
    }
    if (end_ns > hid->now_ns)
      hid->now_ns = end_ns;
    if (fake->head == fake->tail || next->t_ns > hid->now_ns)
      return 0;
  }
  length = next->length < size ? next->length : size;
  memcpy(report, next->data, length);
  *t_ns = hid->now_ns;
  fake->head++;
  return (int)length;
}

static int fake_send(stic_hid_handle *handle, bool feature, const uint8_t *data, size_t length)
{
  stic_fake_hid *hid = handle->hid;

  assert_true(length <= STIC_HID_REPORT_MAX);
  if (hid->nodes[handle->node].gone)
    return STIC_DRIVER_LOST;
  if (hid->sent_count < FAKE_SENT) {
    stic_fake_sent *sent = &hid->sent[hid->sent_count];

    sent->node = handle->node;
    sent->feature = feature;
    sent->length = length;
    memcpy(sent->data, data, length);
  }
  hid->sent_count++;
  if (feature && hid->on_feature)
    hid->on_feature(hid, handle->node, data, length);
  return 0;
}

static int fake_write(stic_hid_handle *handle, const uint8_t *data, size_t length)
{
  return fake_send(handle, false, data, length);
}

static int fake_set_feature(stic_hid_handle *handle, const uint8_t *data, size_t length)
{
  return fake_send(handle, true, data, length);
}

static int fake_get_feature(stic_hid_handle *handle, uint8_t *data, size_t size)
{
  handle->hid->features_got++;
  memset(data + 1, 0, size - 1);
  return (int)size;
}

static void fake_close(stic_hid_handle *handle)
{
  stic_fake_node *fake = &handle->hid->nodes[handle->node];

  assert_true(fake->open);
  fake->open = false;
  fake->head = fake->tail = 0;
}

static int64_t fake_now(void *context)
{
  return ((const stic_fake_hid *)context)->now_ns;
}

void stic_fake_init(stic_fake_hid *hid)
{
  memset(hid, 0, sizeof *hid);
  hid->now_ns = INT64_C(1000000000000);
  hid->transport = (stic_hid_transport){.name = "fake",
                                        .context = hid,
                                        .enumerate = fake_enumerate,
                                        .open = fake_open,
                                        .read = fake_read,
                                        .write = fake_write,
                                        .set_feature = fake_set_feature,
                                        .get_feature = fake_get_feature,
                                        .close = fake_close,
                                        .now = fake_now};
}

void stic_fake_plug(stic_fake_hid *hid, int node, uint16_t vendor, uint16_t product, uint16_t usage_page,
                    uint16_t usage)
{
  stic_fake_node *fake = &hid->nodes[node];

  assert_int_equal(fake->usages, 0);
  snprintf(fake->node.path, sizeof fake->node.path, "/dev/fake%d", node);
  strcpy(fake->node.product_name, "Fake");
  snprintf(fake->node.serial, sizeof fake->node.serial, "SN%d", node);
  fake->node.bus = "usb";
  fake->node.vendor = vendor;
  fake->node.product = product;
  fake->node.usage = (stic_hid_usage){usage_page, usage};
  fake->usages = 1;
  fake->head = fake->tail = 0;
}

void stic_fake_unplug(stic_fake_hid *hid, int node)
{
  hid->nodes[node].usages = 0;
  hid->nodes[node].gone = true;
}

void stic_fake_send(stic_fake_hid *hid, int node, int64_t after_ns, const void *data, size_t length)
{
  stic_fake_node *fake = &hid->nodes[node];
  stic_fake_report *report = &fake->reports[fake->tail];

  assert_true(fake->tail < FAKE_REPORTS && length <= sizeof report->data);
  report->t_ns = hid->now_ns + after_ns;
  report->length = length;
  if (length > 0)
    memcpy(report->data, data, length);
  fake->tail++;
}

static stic_status open_spec(stic_fake_hid *hid, const char *spec_text, stic_device **device, stic_error *err)
{
  stic_device_spec spec;

  assert_int_equal(stic_spec_parse(spec_text, &spec, err), STIC_OK);
  return stic_hid_open_over(&hid->transport, &spec, device, err);
}

stic_device *stic_fake_open(stic_fake_hid *hid, const char *spec_text)
{
  stic_device *device = NULL;
  stic_error err = {.status = STIC_OK};
  const stic_status status = open_spec(hid, spec_text, &device, &err);

  if (status != STIC_OK)
    fail_msg("%s: %s", spec_text, err.message);
  return device;
}

void stic_fake_open_fails(stic_fake_hid *hid, const char *spec_text, stic_status expected, const char *part)
{
  stic_device *device = NULL;
  stic_error err = {.status = STIC_OK};

  assert_int_equal(open_spec(hid, spec_text, &device, &err), expected);
  assert_null(device);
  if (!strstr(err.message, part))
    fail_msg("expected '%s' in '%s'", part, err.message);
  for (int i = 0; i < FAKE_NODES; i++)
    assert_false(hid->nodes[i].open);
}

int stic_fake_poll(stic_fake_hid *hid, stic_device *device, int64_t after_ns, stic_device_sample *samples,
                   int capacity)
{
  return stic_device_poll(device, hid->now_ns + after_ns, samples, capacity);
}
