#include <stdio.h>
#include <stiction.h>
#include <string.h>

/* Reads the scene that it is given; succeeds if header and library are of one version. */
int main(int argc, char **argv)
{
  stic_scene scene;
  stic_error error;

  if (argc != 2 || stic_scene_read(argv[1], NULL, 0, &scene, &error))
    return 1;
  printf("%s %d surfaces\n", stic_version(), scene.surface_count);
  return strcmp(stic_version(), STIC_VERSION) != 0;
}
