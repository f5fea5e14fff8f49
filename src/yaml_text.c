#include "yaml_text.h"

#include "error.h"
#include "number.h"

#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define FILE_MAX_BYTES (1 << 20)
/* Our files need six levels; libyaml's time grows with the square of the depth. */
#define NESTING_MAX 32

static void tell(const stic_yaml *y, stic_status status, int64_t line, const char *format, ...)
  STIC_PRINTF(4, 5);

static void tell(const stic_yaml *y, stic_status status, int64_t line, const char *format, ...)
{
  char message[480];
  va_list args;

  va_start(args, format);
  vsnprintf(message, sizeof message, format, args);
  va_end(args);
  y->problem(y->context, status, line, message);
}

#define BAD(y, line, ...) tell(y, STIC_BAD_INPUT, line, __VA_ARGS__)

/* ---- nodes ------------------------------------------------------------------------------- */

int64_t stic_yaml_line(const yaml_node_t *node)
{
  return (int64_t)node->start_mark.line + 1;
}

const char *stic_yaml_found(const yaml_node_t *node, char *out, size_t out_size)
{
  char text[48];

  switch (node->type) {
  case YAML_SCALAR_NODE:
    if (node->data.scalar.length == 0)
      snprintf(out, out_size, "nothing");
    else
      snprintf(
        out, out_size, "'%s'%s",
        stic_error_quote((const char *)node->data.scalar.value, node->data.scalar.length, text, sizeof text),
        node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE ? "" : " in quotes");
    break;
  case YAML_SEQUENCE_NODE: snprintf(out, out_size, "a list of %d", stic_yaml_count(node)); break;
  case YAML_MAPPING_NODE: snprintf(out, out_size, "a mapping"); break;
  case YAML_NO_NODE: snprintf(out, out_size, "nothing"); break;
  }
  return out;
}

bool stic_yaml_number(const yaml_node_t *node, double *value)
{
  return node->type == YAML_SCALAR_NODE && node->data.scalar.style == YAML_PLAIN_SCALAR_STYLE &&
         stic_number_parse((const char *)node->data.scalar.value, node->data.scalar.length, value) ==
           STIC_NUMBER_OK;
}

int stic_yaml_count(const yaml_node_t *node)
{
  return (int)(node->data.sequence.items.top - node->data.sequence.items.start);
}

const yaml_node_t *stic_yaml_node(const stic_yaml *yaml, int id)
{
  /* The library's function only looks, but takes no const. */
  const yaml_document_t *document = &yaml->document;

  return id > 0 && document->nodes.start + id <= document->nodes.top ? document->nodes.start + id - 1 : NULL;
}

const yaml_node_t *stic_yaml_item(const stic_yaml *yaml, const yaml_node_t *node, int i)
{
  return stic_yaml_node(yaml, node->data.sequence.items.start[i]);
}

const yaml_node_t *stic_yaml_root(stic_yaml *yaml)
{
  return yaml_document_get_root_node(&yaml->document);
}

/* ---- documents --------------------------------------------------------------------------- */

static int64_t line_at(const char *text, size_t offset)
{
  int64_t line = 1;

  for (size_t i = 0; i < offset; i++)
    line += text[i] == '\n';
  return line;
}

static bool starts_with_tab(const stic_yaml *y, int64_t line)
{
  size_t at = 0;

  for (; at < y->length && line > 1; at++)
    line -= y->text[at] == '\n';
  while (at < y->length && y->text[at] == ' ')
    at++;
  return at < y->length && y->text[at] == '\t';
}

/* The library does not always say so. */
static bool lacks_memory(const yaml_parser_t *parser)
{
  return parser->error == YAML_MEMORY_ERROR || parser->error == YAML_NO_ERROR;
}

static void syntax_error(const stic_yaml *y)
{
  const yaml_parser_t *parser = &y->parser;

  if (lacks_memory(parser)) {
    tell(y, STIC_NO_MEMORY, 0, "out of memory");
  } else if (parser->error == YAML_READER_ERROR) {
    const size_t at = parser->problem_offset < y->length ? parser->problem_offset : y->length;

    BAD(y, line_at(y->text, at), "not valid text: %s; expected YAML in UTF-8", parser->problem);
  } else if (starts_with_tab(y, (int64_t)parser->problem_mark.line + 1)) {
    BAD(y, (int64_t)parser->problem_mark.line + 1, "the line is indented with a tab; YAML expects spaces");
  } else {
    BAD(y, (int64_t)parser->problem_mark.line + 1, "not valid YAML: %s%s%s",
        parser->problem ? parser->problem : "unknown problem", parser->context ? ", " : "",
        parser->context ? parser->context : "");
  }
}

static bool begin_parser(stic_yaml *y)
{
  if (!yaml_parser_initialize(&y->parser)) {
    tell(y, STIC_NO_MEMORY, 0, "out of memory");
    return false;
  }
  yaml_parser_set_input_string(&y->parser, (const unsigned char *)y->text, y->length);
  return true;
}

/* How a token changes the depth of nesting. */
static int nesting_step(yaml_token_type_t type)
{
  switch (type) {
  case YAML_FLOW_SEQUENCE_START_TOKEN:
  case YAML_FLOW_MAPPING_START_TOKEN:
  case YAML_BLOCK_SEQUENCE_START_TOKEN:
  case YAML_BLOCK_MAPPING_START_TOKEN: return 1;
  case YAML_FLOW_SEQUENCE_END_TOKEN:
  case YAML_FLOW_MAPPING_END_TOKEN:
  case YAML_BLOCK_END_TOKEN: return -1;
  default: return 0;
  }
}

/* Anchors, aliases and tags leave no mark in a loaded document, so they are looked for in the
 * tokens. Syntax errors are left to the loader. */
static bool has_only_plain_features(stic_yaml *y)
{
  yaml_token_t token;
  bool good = true, more = true;
  int depth = 0;

  if (!begin_parser(y))
    return false;
  while (good && more && yaml_parser_scan(&y->parser, &token)) {
    const int64_t line = (int64_t)token.start_mark.line + 1;

    more = token.type != YAML_STREAM_END_TOKEN && token.type != YAML_NO_TOKEN;
    depth += nesting_step(token.type);
    good = false;
    if (depth > NESTING_MAX)
      BAD(y, line, "lists and mappings are nested deeper than %d; expected a %s", NESTING_MAX, y->what);
    else if (token.type == YAML_ALIAS_TOKEN)
      BAD(y, line, "found an alias (*%.40s); expected the value itself", token.data.alias.value);
    else if (token.type == YAML_ANCHOR_TOKEN)
      BAD(y, line, "found an anchor (&%.40s); expected a plain value", token.data.anchor.value);
    else if (token.type == YAML_TAG_TOKEN || token.type == YAML_TAG_DIRECTIVE_TOKEN)
      BAD(y, line, "found a tag; expected a plain value");
    else
      good = true;
    yaml_token_delete(&token);
  }
  if (good && more && lacks_memory(&y->parser)) { /* what was not looked at may hold them */
    syntax_error(y);
    good = false;
  }
  yaml_parser_delete(&y->parser);
  return good;
}

bool stic_yaml_begin(stic_yaml *y, const char *text, size_t length)
{
  y->text = text;
  y->length = length;
  if (!has_only_plain_features(y) || !begin_parser(y))
    return false;
  if (yaml_parser_load(&y->parser, &y->document))
    return true;
  syntax_error(y);
  yaml_parser_delete(&y->parser);
  return false;
}

void stic_yaml_refuse_more(stic_yaml *y)
{
  yaml_document_t second;
  const yaml_node_t *root;

  if (!yaml_parser_load(&y->parser, &second)) {
    syntax_error(y);
    return;
  }
  root = yaml_document_get_root_node(&second);
  if (root)
    BAD(y, stic_yaml_line(root), "found a second document; expected one %s in a file", y->what);
  yaml_document_delete(&second);
}

void stic_yaml_end(stic_yaml *y)
{
  yaml_document_delete(&y->document);
  yaml_parser_delete(&y->parser);
}

/* ---- files ------------------------------------------------------------------------------- */

static bool read_all(int fd, char *text, size_t *length)
{
  *length = 0;
  while (*length <= FILE_MAX_BYTES) {
    const ssize_t n = read(fd, text + *length, (size_t)FILE_MAX_BYTES + 1 - *length);

    if (n < 0) /* also by a signal: only a pipe can be interrupted, and it may never be written to */
      return false;
    if (n == 0)
      break;
    *length += (size_t)n;
  }
  return true;
}

static bool text_is_usable(const stic_yaml *y, const char *text, size_t length)
{
  const char *zero = memchr(text, '\0', length);

  if (length > FILE_MAX_BYTES)
    BAD(y, 0, "the file has more than %d bytes; expected a %s", FILE_MAX_BYTES, y->what);
  else if (length >= 2 && (memcmp(text, "\xff\xfe", 2) == 0 || memcmp(text, "\xfe\xff", 2) == 0))
    BAD(y, 1, "the file is UTF-16; expected UTF-8");
  else if (zero)
    BAD(y, line_at(text, (size_t)(zero - text)), "found a zero byte; expected text");
  else
    return true;
  return false;
}

char *stic_yaml_read_file(const stic_yaml *y, const char *path, size_t *length)
{
  char *text = malloc(FILE_MAX_BYTES + 1);
  const int fd = text ? open(path, O_RDONLY | O_CLOEXEC) : -1;
  bool good = false;

  if (!text)
    tell(y, STIC_NO_MEMORY, 0, "out of memory");
  else if (fd < 0)
    BAD(y, 0, "cannot open the %s: %s", y->what, strerror(errno));
  else if (!read_all(fd, text, length))
    BAD(y, 0, "cannot read the %s: %s", y->what, strerror(errno));
  else
    good = text_is_usable(y, text, *length);
  if (fd >= 0)
    close(fd);
  if (!good) {
    free(text);
    return NULL;
  }
  text[*length] = '\0';
  return text;
}
