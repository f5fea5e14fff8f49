/* A HID transport for tests: nodes that a test plugs in and out, reports that it queues, and a clock that
 * moves only when somebody waits. */
#ifndef STIC_TEST_FAKE_HID_H
#define STIC_TEST_FAKE_HID_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "../../../drivers/hid/hid.h"
#include "../../../drivers/hid/hid_drivers.h"

#define FAKE_NODES 4
#define FAKE_REPORTS 512
#define FAKE_SENT 16

typedef struct stic_fake_report {
  int64_t t_ns; /* when it comes */
  size_t length;
  uint8_t data[STIC_HID_REPORT_MAX];
} stic_fake_report;

typedef struct stic_fake_node {
  stic_hid_node node;
  int usages;     /* how often it is listed, 0: not plugged in */
  bool forbidden; /* open() has no permission */
  bool open;
  bool gone;      /* pulled out while open */
  int head, tail; /* of the queue */
  stic_fake_report reports[FAKE_REPORTS];
} stic_fake_node;

typedef struct stic_fake_hid stic_fake_hid;

struct stic_hid_handle {
  stic_fake_hid *hid;
  int node;
};

/* What a driver sent. */
typedef struct stic_fake_sent {
  int node;
  bool feature;
  size_t length;
  uint8_t data[STIC_HID_REPORT_MAX];
} stic_fake_sent;

struct stic_fake_hid {
  stic_hid_transport transport;
  int64_t now_ns;
  bool interrupt; /* the next wait is cut short by a signal */
  stic_fake_node nodes[FAKE_NODES];
  stic_hid_handle handles[FAKE_NODES];
  int sent_count; /* all; the first FAKE_SENT are kept */
  stic_fake_sent sent[FAKE_SENT];
  int features_got;
  int waits; /* read() calls that had to wait */
  /* Called on each feature report that arrives; may queue reports. NULL: nothing happens. */
  void (*on_feature)(stic_fake_hid *hid, int node, const uint8_t *data, size_t length);
};

/* A device-less system at 1000 s. `hid` must not be moved. */
void stic_fake_init(stic_fake_hid *hid);

/* Plugs a device into slot `node`, "/dev/fake<node>". */
void stic_fake_plug(stic_fake_hid *hid, int node, uint16_t vendor, uint16_t product, uint16_t usage_page,
                    uint16_t usage);
void stic_fake_unplug(stic_fake_hid *hid, int node);

/* Queues a report that comes `after_ns` after now; times must not decrease in a queue. */
void stic_fake_send(stic_fake_hid *hid, int node, int64_t after_ns, const void *data, size_t length);

/* Opens SPEC over it with the driver it names; fails the test if that fails. */
stic_device *stic_fake_open(stic_fake_hid *hid, const char *spec_text);
/* Opens it expecting this refusal. */
void stic_fake_open_fails(stic_fake_hid *hid, const char *spec_text, stic_status expected, const char *part);

/* Polls until `after_ns` from now. */
int stic_fake_poll(stic_fake_hid *hid, stic_device *device, int64_t after_ns, stic_device_sample *samples,
                   int capacity);

#define STIC_MS INT64_C(1000000)

#endif
