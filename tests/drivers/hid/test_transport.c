/* What all HID drivers share: finding, choosing, refusing. And the system's own transport as far as a machine
 * without devices can show it. */
#include "fake_hid.h"

#include "../../../drivers/hid/hid_sysfs.h"
#include "../../../src/io/timing.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void test_list_has_each_path_once(void **state)
{
  stic_fake_hid hid;
  stic_hid_node nodes[FAKE_NODES];

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x046d, 0xc626, 0x01, 0x08);
  hid.nodes[0].usages = 3; /* two vendor-defined ones come first */
  stic_fake_plug(&hid, 2, 0x1532, 0x0300, 0x01, 0x05);
  assert_int_equal(stic_hid_list(&hid.transport, nodes, FAKE_NODES), 2);
  assert_int_equal(nodes[0].usage.page, 0x01);
  assert_int_equal(nodes[0].usage.id, 0x08);
  assert_string_equal(nodes[0].path, "/dev/fake0");
  assert_string_equal(nodes[1].path, "/dev/fake2");
  assert_string_equal(stic_hid_driver_for(&nodes[0])->name, "spacemouse");
  assert_string_equal(stic_hid_driver_for(&nodes[1])->name, "hydra");
  assert_int_equal(stic_hid_list(&hid.transport, nodes, 1), 1);
}

static void test_choice(void **state)
{
  stic_fake_hid hid;
  stic_device *device;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x256f, 0xc652, 0x00, 0x00); /* of unknown use */
  stic_fake_plug(&hid, 1, 0x256f, 0xc652, 0x01, 0x02); /* a mouse */
  stic_fake_plug(&hid, 2, 0x256f, 0xc652, 0x01, 0x08);
  device = stic_fake_open(&hid, "spacemouse");
  assert_true(hid.nodes[2].open);
  stic_device_close(device);
  device = stic_fake_open(&hid, "spacemouse:serial=SN0");
  assert_true(hid.nodes[0].open);
  stic_device_close(device);
  device = stic_fake_open(&hid, "spacemouse:path=/dev/fake0");
  assert_true(hid.nodes[0].open);
  stic_device_close(device);
  /* No path that is not in the list ever reaches open(). */
  stic_fake_open_fails(&hid, "spacemouse:path=/dev/null", STIC_NO_DEVICE,
                       "no spacemouse found by fake at /dev/null");
  stic_fake_open_fails(&hid, "spacemouse:path=/dev/fake1", STIC_NO_DEVICE, "no spacemouse found");
  stic_fake_open_fails(&hid, "spacemouse:serial=SN9", STIC_NO_DEVICE, "with serial number SN9");
}

static void test_wrong_keys(void **state)
{
  stic_fake_hid hid;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x046d, 0xc626, 0x01, 0x08);
  stic_fake_plug(&hid, 1, 0x1532, 0x0300, 0x01, 0x00);
  stic_fake_open_fails(&hid, "spacemouse:speed=-1", STIC_USAGE, "speed is '-1'");
  stic_fake_open_fails(&hid, "spacemouse:turn=nan", STIC_USAGE, "turn is 'nan'");
  stic_fake_open_fails(&hid, "spacemouse:hand=left", STIC_USAGE, "unknown key 'hand'");
  stic_fake_open_fails(&hid, "hydra:hand=both", STIC_USAGE, "hand is 'both'; expected left or right");
  stic_fake_open_fails(&hid, "gamepad", STIC_NO_DEVICE, "no gamepad found");
  stic_fake_open_fails(&hid, "keyboard", STIC_USAGE, "'keyboard' is no driver of HID devices");
  stic_fake_open_fails(&hid, "spacemouse:raw=/nonexistent/x", STIC_CANNOT_WRITE, "");
}

/* The whole advice fits one message. */
static void test_no_permission(void **state)
{
  stic_fake_hid hid;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x046d, 0xc626, 0x01, 0x08);
  hid.nodes[0].forbidden = true;
  stic_fake_open_fails(&hid, "spacemouse", STIC_NO_DEVICE, "no permission to open /dev/fake0");
  stic_fake_open_fails(&hid, "spacemouse", STIC_NO_DEVICE,
                       "ATTRS{idVendor}==\"046d\", ATTRS{idProduct}==\"c626\", TAG+=\"uaccess\"");
  stic_fake_open_fails(&hid, "spacemouse", STIC_NO_DEVICE,
                       "sudo udevadm control --reload && sudo udevadm trigger");
}

/* The Hydra takes any usage; a node that is listed for two of them is still one. */
static void test_node_opens_once(void **state)
{
  stic_fake_hid hid;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x1532, 0x0300, 0x01, 0x00);
  hid.nodes[0].usages = 2;
  stic_device_close(stic_fake_open(&hid, "hydra"));
}

/* Of two nodes one of which is forbidden, none stays open. */
static void test_half_open(void **state)
{
  stic_fake_hid hid;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x1532, 0x0300, 0x01, 0x00);
  stic_fake_plug(&hid, 1, 0x1532, 0x0300, 0x01, 0x05);
  hid.nodes[1].forbidden = true;
  stic_fake_open_fails(&hid, "hydra", STIC_NO_DEVICE, "/dev/fake1");
}

static void test_signal_ends_wait(void **state)
{
  stic_fake_hid hid;
  stic_device *device;
  stic_device_sample sample;
  int64_t before;

  (void)state;
  stic_fake_init(&hid);
  stic_fake_plug(&hid, 0, 0x046d, 0xc626, 0x01, 0x08);
  device = stic_fake_open(&hid, "spacemouse");
  before = hid.now_ns;
  hid.interrupt = true;
  assert_int_equal(stic_fake_poll(&hid, device, 1000 * STIC_MS, &sample, 1), 0);
  assert_int_equal(hid.now_ns, before);
  assert_int_equal(device->state, STIC_CONNECTION_RUNNING);
  stic_device_close(device);
}

static void test_sequence(void **state)
{
  stic_hid_sequence sequence = {0};
  int64_t gaps = 0;

  (void)state;
  stic_hid_count(&sequence, 254, &gaps);
  assert_int_equal(sequence.total, 1);
  stic_hid_count(&sequence, 255, &gaps);
  stic_hid_count(&sequence, 0, &gaps);
  assert_int_equal(sequence.total, 3);
  assert_int_equal(gaps, 0);
  stic_hid_count(&sequence, 4, &gaps); /* 1, 2 and 3 are lost */
  assert_int_equal(sequence.total, 7);
  assert_int_equal(gaps, 1);
  stic_hid_count(&sequence, 4, &gaps); /* twice the same */
  assert_int_equal(sequence.total, 8);
  assert_int_equal(gaps, 2);
}

static void test_usages(void **state)
{
  /* a mouse with a nested collection, a long item, and a multi-axis controller with a 32-bit usage */
  static const uint8_t two[] = {0x05, 0x01, 0x09, 0x02, 0xa1, 0x01, 0x09, 0x01, 0xa1, 0x00, 0xc0, 0xc0, 0xfe,
                                0x02, 0x10, 0xa1, 0x01, 0x0b, 0x08, 0x00, 0x01, 0x00, 0xa1, 0x01, 0xc0};
  stic_hid_usage usages[4];

  (void)state;
  assert_int_equal(stic_hid_usages(two, sizeof two, usages, 4), 2);
  assert_int_equal(usages[0].page, 0x01);
  assert_int_equal(usages[0].id, 0x02);
  assert_int_equal(usages[1].page, 0x01);
  assert_int_equal(usages[1].id, 0x08);
  assert_int_equal(stic_hid_usages(two, sizeof two, usages, 1), 1);
  for (size_t length = 0; length < sizeof two; length++) {
    uint8_t *cut = malloc(length > 0 ? length : 1);

    assert_non_null(cut);
    memcpy(cut, two, length);
    assert_int_equal(stic_hid_usages(cut, length, usages, 4), length < 6 ? 0 : length < 24 ? 1 : 2);
    free(cut);
  }
}

/* ---- sysfs ------------------------------------------------------------------------------- */

static char root[] = "/tmp/stiction-sysfs-XXXXXX";

static void make_attribute(const char *node, const char *name, const void *data, size_t length)
{
  char path[200];
  FILE *file;

  snprintf(path, sizeof path, "%s/%s", root, node);
  mkdir(path, 0700);
  snprintf(path, sizeof path, "%s/%s/device", root, node);
  mkdir(path, 0700);
  snprintf(path, sizeof path, "%s/%s/device/%s", root, node, name);
  file = fopen(path, "wb");
  assert_non_null(file);
  assert_int_equal(fwrite(data, 1, length, file), length);
  assert_int_equal(fclose(file), 0);
}

static void remove_nodes(const char *const *names, size_t count)
{
  static const char *const entries[] = {"device/uevent", "device/report_descriptor", "device", ""};
  char path[200];

  for (size_t i = 0; i < count; i++) {
    for (size_t j = 0; j < sizeof entries / sizeof entries[0]; j++) {
      snprintf(path, sizeof path, "%s/%s/%s", root, names[i], entries[j]);
      remove(path);
    }
  }
  assert_int_equal(rmdir(root), 0);
}

static void test_sysfs(void **state)
{
  static const char cap[] =
    "DRIVER=hid-generic\nHID_ID=0003:0000046D:0000C626\nHID_NAME=3Dconnexion Space\xc3\xa9\n"
    "HID_PHYS=usb-1\nHID_UNIQ=SN1\n";
  static const char pad[] = "HID_ID=0005:0000054C:00000CE6\nHID_NAME=Pad\nHID_UNIQ=\n";
  static const uint8_t cap_descriptor[] = {0x05, 0x01, 0x09, 0x08, 0xa1, 0x01, 0xc0};
  static const uint8_t pad_descriptor[] = {0x05, 0x01, 0x09, 0x05, 0xa1, 0x01,
                                           0xc0, 0x09, 0x06, 0xa1, 0x01, 0xc0};
  stic_hid_node nodes[8];

  (void)state;
  assert_int_equal(stic_hid_sysfs_enumerate("/nonexistent", nodes, 8), 0);
  assert_non_null(mkdtemp(root));
  make_attribute("hidraw10", "uevent", cap, sizeof cap - 1);
  make_attribute("hidraw10", "report_descriptor", cap_descriptor, sizeof cap_descriptor);
  make_attribute("hidraw2", "uevent", pad, sizeof pad - 1);
  make_attribute("hidraw2", "report_descriptor", pad_descriptor, sizeof pad_descriptor);
  make_attribute("hidraw3", "uevent", pad, sizeof pad - 1); /* is just going away */
  make_attribute("hidraw4", "report_descriptor", pad_descriptor, sizeof pad_descriptor);
  make_attribute("hidraw5", "uevent", "", 0);
  make_attribute("hidraw5", "report_descriptor", pad_descriptor, sizeof pad_descriptor);
  assert_int_equal(stic_hid_sysfs_enumerate(root, nodes, 8), 3);
  assert_string_equal(nodes[0].path, "/dev/hidraw2");
  assert_string_equal(nodes[0].bus, "bluetooth");
  assert_int_equal(nodes[0].usage.id, 0x05);
  assert_string_equal(nodes[1].path, "/dev/hidraw2");
  assert_int_equal(nodes[1].usage.id, 0x06);
  assert_string_equal(nodes[2].path, "/dev/hidraw10");
  assert_string_equal(nodes[2].bus, "usb");
  assert_string_equal(nodes[2].product_name, "3Dconnexion Space??");
  assert_string_equal(nodes[2].serial, "SN1");
  assert_int_equal(nodes[2].vendor, 0x046d);
  assert_int_equal(nodes[2].product, 0xc626);
  assert_int_equal(stic_hid_sysfs_enumerate(root, nodes, 1), 1);
  remove_nodes((const char *const[]){"hidraw10", "hidraw2", "hidraw3", "hidraw4", "hidraw5"}, 5);
}

/* hidapi 0.13 crashes if it is given a path that is no HID device; ours must not. */
static void test_system_refuses_strange_paths(void **state)
{
  static const char *const paths[] = {"/dev/null", "/nonexistent", "/dev", ""};
  stic_hid_node nodes[STIC_HID_NODES_MAX];
  const int count = stic_hid_list(&stic_hid_system, nodes, STIC_HID_NODES_MAX);

  (void)state;
  assert_true(count >= 0);
  for (size_t i = 0; i < sizeof paths / sizeof paths[0]; i++) {
    stic_hid_node node = {.bus = "usb"};
    stic_hid_handle *handle = NULL;
    stic_error err = {.status = STIC_OK};

    strcpy(node.path, paths[i]);
    assert_int_equal(stic_hid_system.open(stic_hid_system.context, &node, &handle, &err), STIC_NO_DEVICE);
    assert_null(handle);
    assert_true(strlen(err.message) > 0);
  }
  assert_true(stic_clock_ns() - stic_hid_system.now(NULL) < 1000 * STIC_MS);
}

/* The drivers as the program opens them ask the system, and only for what it lists. */
static void test_system_drivers(void **state)
{
  static const char *const names[] = {"spacemouse", "hydra", "gamepad"};

  (void)state;
  for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
    stic_device *device = NULL;
    stic_error err;
    char spec[80], words[120];

    snprintf(spec, sizeof spec, "%s:path=/dev/null", names[i]);
    snprintf(words, sizeof words, "no %s found by %s at /dev/null", names[i], stic_hid_system.name);
    assert_int_equal(stic_device_open(spec, &device, &err), STIC_NO_DEVICE);
    assert_null(device);
    assert_non_null(strstr(err.message, words));
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_list_has_each_path_once),
                                     cmocka_unit_test(test_choice),
                                     cmocka_unit_test(test_wrong_keys),
                                     cmocka_unit_test(test_no_permission),
                                     cmocka_unit_test(test_node_opens_once),
                                     cmocka_unit_test(test_half_open),
                                     cmocka_unit_test(test_signal_ends_wait),
                                     cmocka_unit_test(test_sequence),
                                     cmocka_unit_test(test_usages),
                                     cmocka_unit_test(test_sysfs),
                                     cmocka_unit_test(test_system_refuses_strange_paths),
                                     cmocka_unit_test(test_system_drivers)};

  return cmocka_run_group_tests(tests, NULL, NULL);
}
