#include "hid_sysfs.h"

#include <dirent.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define FILE_MAX 4096 /* bytes: a page is the most that such files hold */
#define USAGES_MAX 8  /* of one node that are listed */

/* Reads ROOT/NODE/device/NAME: its length, -1 if there is none. */
static int read_attribute(const char *root, const char *node, const char *name, uint8_t *out, size_t size)
{
  char path[PATH_MAX];
  int file, length = 0;
  ssize_t n;

  if (snprintf(path, sizeof path, "%s/%s/device/%s", root, node, name) >= (int)sizeof path)
    return -1;
  file = open(path, O_RDONLY | O_CLOEXEC);
  if (file < 0)
    return -1;
  while ((n = read(file, out + length, size - (size_t)length)) > 0)
    length += (int)n;
  close(file);
  return n < 0 ? -1 : length;
}

static void copy_ascii(const char *from, char *to, size_t size)
{
  size_t n = 0;

  for (; from[n] && n + 1 < size; n++)
    to[n] = from[n];
  to[n] = '\0';
  for (char *c = to; *c; c++) {
    if (*c < 0x20 || *c > 0x7e)
      *c = '?';
  }
}

/* Takes one line KEY=value in; true if it was the identity. */
static bool take_line(const char *line, stic_hid_node *node)
{
  unsigned bus, vendor, product;

  if (sscanf(line, "HID_ID=%x:%x:%x", &bus, &vendor, &product) == 3) {
    node->bus = bus == 3 ? "usb" : bus == 5 ? "bluetooth" : "hid";
    node->vendor = (uint16_t)vendor;
    node->product = (uint16_t)product;
    return true;
  }
  if (strncmp(line, "HID_NAME=", 9) == 0)
    copy_ascii(line + 9, node->product_name, sizeof node->product_name);
  else if (strncmp(line, "HID_UNIQ=", 9) == 0)
    copy_ascii(line + 9, node->serial, sizeof node->serial);
  return false;
}

static bool read_identity(const char *root, const char *name, stic_hid_node *node)
{
  uint8_t text[FILE_MAX + 1];
  const int length = read_attribute(root, name, "uevent", text, FILE_MAX);
  bool known = false;
  char *line, *rest;

  if (length <= 0)
    return false;
  text[length] = '\0';
  for (line = strtok_r((char *)text, "\n", &rest); line; line = strtok_r(NULL, "\n", &rest))
    known = take_line(line, node) || known;
  return known;
}

/* Adds a node, once for every usage: how many entries. */
static int add_node(const char *root, const char *name, stic_hid_node *nodes, int capacity)
{
  uint8_t descriptor[FILE_MAX];
  stic_hid_usage usages[USAGES_MAX] = {{0, 0}};
  stic_hid_node node = {.bus = "hid"};
  int length, count;

  if (!read_identity(root, name, &node))
    return 0;
  length = read_attribute(root, name, "report_descriptor", descriptor, sizeof descriptor);
  if (length < 0)
    return 0;
  snprintf(node.path, sizeof node.path, "/dev/%.100s", name);
  count = stic_hid_usages(descriptor, (size_t)length, usages, USAGES_MAX);
  count = count > 0 ? count : 1; /* without a collection its use is unknown */
  for (int i = 0; i < count && i < capacity; i++) {
    nodes[i] = node;
    nodes[i].usage = usages[i];
  }
  return count < capacity ? count : capacity;
}

static int compare_numbers(const void *a, const void *b)
{
  const int x = *(const int *)a, y = *(const int *)b;

  return (x > y) - (x < y);
}

int stic_hid_sysfs_enumerate(const char *root, stic_hid_node *nodes, int capacity)
{
  int numbers[STIC_HID_NODES_MAX];
  int number_count = 0, count = 0;
  const struct dirent *entry;
  DIR *folder = opendir(root);

  if (!folder)
    return 0;
  while (number_count < STIC_HID_NODES_MAX && (entry = readdir(folder)) != NULL) {
    if (sscanf(entry->d_name, "hidraw%d", &numbers[number_count]) == 1)
      number_count++;
  }
  closedir(folder);
  qsort(numbers, (size_t)number_count, sizeof numbers[0], compare_numbers);
  for (int i = 0; i < number_count && count < capacity; i++) {
    char name[32];

    snprintf(name, sizeof name, "hidraw%d", numbers[i]);
    count += add_node(root, name, nodes + count, capacity - count);
  }
  return count;
}
