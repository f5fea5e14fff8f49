/* Raw recordings: what a device sent, byte for byte, to be decoded again later. Two text formats:
 *
 *   serial   "# stiction-serial 1", then lines "t_ns hex hex ...": when the last of these bytes came, in
 *            ns of any clock, never decreasing, and the bytes
 *   HID      as of hid-recorder(1): "D: n" the device that the following lines are about, "R: length hex ..." its
 *            report descriptor, "N: name", "P: place", "I: bus vendor product" (hexadecimal), then events
 *            "E: sec.usec length hex ..." with whole reports; several devices may take turns
 *
 * Lines that start with # are comments. Both are read and written line by line in constant memory. */
#ifndef STIC_RAW_RECORDING_H
#define STIC_RAW_RECORDING_H

#include "../src/stiction.h"

#define STIC_RAW_FORMAT "# stiction-serial 1"
#define STIC_RAW_BYTES_MAX 4096 /* in one line */
#define STIC_RAW_DEVICES_MAX 8
#define STIC_RAW_DESCRIPTOR_MAX 4096 /* bytes; the kernel's own limit */

typedef enum stic_raw_kind { STIC_RAW_SERIAL, STIC_RAW_HID } stic_raw_kind;

/* What a recording tells of one HID device. */
typedef struct stic_raw_device {
  char name[128];           /* "" if not told; longer ones are cut */
  char place[128];          /* P:, ditto */
  int bus;                  /* as in linux/input.h, 3 is USB; 0: not told */
  int vendor, product;      /* 0: not told */
  size_t descriptor_length; /* 0: not told */
  uint8_t descriptor[STIC_RAW_DESCRIPTOR_MAX];
} stic_raw_device;

typedef struct stic_raw_record {
  int64_t t_ns;
  int device;           /* index from 0 as in D: lines; 0 for serial */
  size_t length;        /* of bytes, >= 1 */
  const uint8_t *bytes; /* valid until the next call */
} stic_raw_record;

/* ---- reading ----------------------------------------------------------------------------- */

typedef struct stic_raw_reader stic_raw_reader;

typedef enum stic_raw_status {
  STIC_RAW_RECORD, /* `*record` is set */
  STIC_RAW_END,
  STIC_RAW_WAIT, /* nothing yet: a slow pipe; ask again */
  STIC_RAW_BAD /* `*err` says which line and what was expected, or that a signal came while it waited; the reader can
                  * only be closed */
} stic_raw_status;

/* Opens a recording, "-" for standard input; its first line decides the kind. The caller owns `*reader`.
 * Errors: STIC_BAD_INPUT, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_raw_open(const char *path, stic_raw_reader **reader, stic_error *err);
void stic_raw_close(stic_raw_reader *reader); /* NULL allowed */

/* From now on bad lines after the first good one are passed over; `report` (may be NULL) is told about each. */
void stic_raw_be_lenient(stic_raw_reader *reader, void (*report)(void *context, const stic_error *problem),
                         void *context);

/* The next record. At most one read() in a call. A last line without its end is dropped. A recording
 * without any record is bad. Real-time: no. */
stic_raw_status stic_raw_next(stic_raw_reader *reader, stic_raw_record *record, stic_error *err);

/* The same, to be given out by stic_raw_next() once more: for whoever must know the kind first. */
stic_raw_status stic_raw_peek(stic_raw_reader *reader, stic_raw_record *record, stic_error *err);

/* Known after the first record. */
stic_raw_kind stic_raw_reader_kind(const stic_raw_reader *reader);
/* What has been told so far of device 0..STIC_RAW_DEVICES_MAX - 1; lives as long as the reader. */
const stic_raw_device *stic_raw_reader_device(const stic_raw_reader *reader, int device);

/* ---- writing ----------------------------------------------------------------------------- */

typedef struct stic_raw_writer stic_raw_writer;

/* Creates a recording, which replaces an existing file at its first record; each line is one write(), so that all but
 * the last survive a crash. `device` describes device 0 of a HID recording, NULL for serial. "-" is standard output. `again`:
 * goes on with a recording of the same kind that this program made, its times on the same clock; what is no such
 * recording is replaced. Errors: STIC_CANNOT_WRITE, STIC_NO_MEMORY. Real-time: no. */
stic_status stic_raw_create(const char *path, stic_raw_kind kind, const stic_raw_device *device, bool again,
                            stic_raw_writer **writer, stic_error *err);
/* Appends a record of 1..STIC_RAW_BYTES_MAX bytes. HID times are kept to 1 us, from the first one on. A device
 * other than the last one's gets a D: line. Does not allocate, but may wait for the disk. */
stic_status stic_raw_write(stic_raw_writer *writer, int device, int64_t t_ns, const uint8_t *bytes,
                           size_t length, stic_error *err);
/* Ends the recording and frees the writer, also after an error; NULL allowed. */
stic_status stic_raw_finish(stic_raw_writer *writer, stic_error *err);

#endif
