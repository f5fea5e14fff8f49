/* guest-exit N: ends the qemu around us with exit code 2 N + 1, through its isa-debug-exit device. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/io.h>

#define DEBUG_PORT 0xf4

int main(int argc, char **argv)
{
  if (argc != 2)
    return 2;
  if (ioperm(DEBUG_PORT, 1, 1) != 0) {
    perror("ioperm");
    return 1;
  }
  outb((unsigned char)strtoul(argv[1], NULL, 10), DEBUG_PORT);
  return 0;
}
