/* YAML files of ours: one plain document of at most 1 MiB, without anchors, aliases and tags, every value
 * with its line. Shared by the readers of scenes and trackers. Internal; nothing here is real-time. */
#ifndef STIC_YAML_TEXT_H
#define STIC_YAML_TEXT_H

#include "stiction.h"

#include <yaml.h>

/* Told about each problem in turn; line 0: about the whole. */
typedef void stic_yaml_problem(void *context, stic_status status, int64_t line, const char *message);

typedef struct stic_yaml {
  const char *what; /* "scene": for messages */
  stic_yaml_problem *problem;
  void *context;
  yaml_document_t document; /* while one is loaded */
  yaml_parser_t parser;
  const char *text; /* being read */
  size_t length;
} stic_yaml;

/* Reads a whole file, once, as it may be a pipe; NULL after telling why not. Ends with a zero byte and has no other. To
 * be freed. */
char *stic_yaml_read_file(const stic_yaml *yaml, const char *path, size_t *length);

/* Loads the first document of a text, which must stay until stic_yaml_end(); false after telling why not, with
 * nothing to end. */
bool stic_yaml_begin(stic_yaml *yaml, const char *text, size_t length);
/* Complains about a second document. */
void stic_yaml_refuse_more(stic_yaml *yaml);
void stic_yaml_end(stic_yaml *yaml);

/* The document's root, NULL if it is empty. */
const yaml_node_t *stic_yaml_root(stic_yaml *yaml);
const yaml_node_t *stic_yaml_node(const stic_yaml *yaml, int id);

/* Line of a node, from 1. */
int64_t stic_yaml_line(const yaml_node_t *node);
/* What a node is, for a message: its text in quotes, or its kind. Returns out. */
const char *stic_yaml_found(const yaml_node_t *node, char *out, size_t out_size);
/* Whether a node is a plain scalar that is a number. */
bool stic_yaml_number(const yaml_node_t *node, double *value);
/* Of a list: its length and its items. */
int stic_yaml_count(const yaml_node_t *node);
const yaml_node_t *stic_yaml_item(const stic_yaml *yaml, const yaml_node_t *node, int i);

#endif
