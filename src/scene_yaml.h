/* Scene files: reading with all problems told, for `check`. stic_scene_read() is in stiction.h. Internal. */
#ifndef STIC_SCENE_YAML_H
#define STIC_SCENE_YAML_H

#include "stiction.h"

/* Told about each problem in turn. A warning does not refuse the scene. */
typedef void stic_scene_report(void *context, bool warning, const stic_error *problem);

/* As stic_scene_read(), but goes on after a problem and reports all of them and the warnings.
 * `*scene` is set if the return value is STIC_OK, which is when no error was reported; otherwise
 * the return value is the first error's status. `*text`, if `text` is not NULL, is the file's text for those who have to
 * read other sections of it, for the caller to free; NULL if it cannot be read. Real-time: no. */
stic_status stic_scene_read_all(const char *path, const stic_override *overrides, int override_count,
                                stic_scene *scene, char **text, stic_scene_report *report, void *context);

/* As stic_scene_read(), with the text as above. */
stic_status stic_scene_read_text(const char *path, const stic_override *overrides, int override_count,
                                 stic_scene *scene, char **text, stic_error *err);

#endif
