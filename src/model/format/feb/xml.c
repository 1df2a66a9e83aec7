/* FEBio decks: the XML tree, messages with lines, values. See feb.h. */
#include "model/format/feb/feb.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <libxml/parser.h>
#include <libxml/parserInternals.h>
#include <libxml/xmlerror.h>

#include "model/format/xml_guard.h"

/* Called by libxml2 at <!DOCTYPE, before any entity is declared. */
static void stop_at_doctype(void *context, const xmlChar *name, const xmlChar *external,
                            const xmlChar *system) {
    (void)name, (void)external, (void)system;
    xmlParserCtxt *parser = context;
    *(int *)parser->_private = parser->input ? parser->input->line : 1;
    xmlStopParser(parser);
}

static lar_status parse_tree(lar_feb *feb, xmlParserCtxt *parser, const lar_bytes *bytes) {
    int doctype_line = 0;
    parser->_private = &doctype_line;
    parser->sax->internalSubset = stop_at_doctype;
    lar_xml_guard guard;
    lar_xml_guard_begin(&guard);
    feb->document =
        xmlCtxtReadMemory(parser, (const char *)bytes->data, (int)bytes->size, NULL, NULL,
                          XML_PARSE_NONET | XML_PARSE_NOERROR | XML_PARSE_NOWARNING |
                              XML_PARSE_NOCDATA | XML_PARSE_BIG_LINES);
    if (lar_xml_guard_end(&guard)) return lar_feb_no_memory(feb, "the deck");
    if (doctype_line)
        return lar_fail(feb->error, LAR_ERROR_FORMAT,
                        "%s:%d: a document type declaration (<!DOCTYPE) has no place in a FEBio "
                        "deck; remove it",
                        feb->path, doctype_line);
    if (feb->document) return LAR_OK;
    const xmlError *trouble = xmlCtxtGetLastError(parser);
    int length = trouble && trouble->message ? (int)strcspn(trouble->message, "\n") : 0;
    return lar_fail(feb->error, LAR_ERROR_FORMAT,
                    "%s:%d: not well-formed XML (%.*s); the file may be cut short or damaged, "
                    "export it again",
                    feb->path, trouble && trouble->line > 0 ? trouble->line : 1,
                    length ? length : 12, length ? trouble->message : "no root here");
}

static lar_status check_version(lar_feb *feb) {
    if (!lar_feb_is(feb->root, "febio_spec"))
        return lar_feb_fail(feb, feb->root, LAR_ERROR_FORMAT,
                            "the file begins with <%s> where a FEBio deck has <febio_spec>; is it "
                            "a FEBio input file?",
                            (const char *)feb->root->name);
    const char *version = "";
    lar_status status = lar_feb_need_attribute(feb, feb->root, "version", &version);
    if (status) return status;
    if (strcmp(version, "3.0") == 0 || strcmp(version, "4.0") == 0) return LAR_OK;
    if (strcmp(version, "2.5") == 0) return lar_feb_renew(feb);
    return lar_feb_fail(feb, feb->root, LAR_ERROR_UNSUPPORTED,
                        "format version %.20s of FEBio decks is not read; open the model in FEBio "
                        "Studio and save it as version 4.0",
                        version);
}

lar_status lar_feb_open(lar_feb *feb, const char *path, const lar_bytes *bytes, lar_error *error) {
    feb->path = path;
    feb->error = error;
    feb->constant_curve = -1;
    enum { SPARE_IDS = 1000000 };
    feb->ids_left = SPARE_IDS + (int64_t)(bytes->size < INT_MAX ? bytes->size : INT_MAX);
    if (bytes->size == 0 || bytes->size > INT_MAX)
        return lar_fail(error, LAR_ERROR_FORMAT,
                        "%s: %zu bytes are %s for a FEBio deck; check the file", path, bytes->size,
                        bytes->size ? "too many (2 GB at most)" : "too few");
    xmlInitParser();
    feb->strings = xmlDictCreate();
    xmlParserCtxt *parser = xmlNewParserCtxt();
    lar_status status = feb->strings && parser ? parse_tree(feb, parser, bytes)
                                               : lar_feb_no_memory(feb, "the XML parser");
    if (parser) xmlFreeParserCtxt(parser);
    if (status) return status;
    feb->root = xmlDocGetRootElement(feb->document);
    if (!feb->root)
        return lar_fail(error, LAR_ERROR_FORMAT, "%s:1: the file has no XML element; check it",
                        path);
    return check_version(feb);
}

void lar_feb_clear(lar_feb *feb) {
    if (feb->document) xmlFreeDoc(feb->document);
    if (feb->strings) xmlDictFree(feb->strings);
    free(feb->material);
    free(feb->controller);
    free(feb->holder);
    for (int b = 0; b < feb->body_count; b++) free(feb->body[b].tied);
    free(feb->body);
    free(feb->held);
    *feb = (lar_feb){0};
}

int lar_feb_line(const xmlNode *at) {
    long line = xmlGetLineNo(at);
    return line > 0 && line < INT_MAX ? (int)line : 0;
}

lar_status lar_feb_fail(const lar_feb *feb, const xmlNode *at, lar_status status,
                        const char *format, ...) {
    char sentence[sizeof feb->error->message];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    return lar_fail(feb->error, status, "%s:%d: %s", feb->path, lar_feb_line(at), sentence);
}

lar_status lar_feb_notice(const lar_feb *feb, const xmlNode *at, const char *format, ...) {
    if (!feb->model) return LAR_OK;
    char sentence[sizeof feb->error->message];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    return lar_model_notice(feb->model, feb->error, "%s:%d: %s", feb->path, lar_feb_line(at),
                            sentence);
}

lar_status lar_feb_no_memory(const lar_feb *feb, const char *what) {
    return lar_fail(feb->error, LAR_ERROR_MEMORY,
                    "%s: out of memory for %s; use a smaller model or a machine with more memory",
                    feb->path, what);
}

static xmlNode *element_from(xmlNode *node) {
    while (node && node->type != XML_ELEMENT_NODE) node = node->next;
    return node;
}

xmlNode *lar_feb_first(const xmlNode *parent) {
    return element_from(parent->children);
}

xmlNode *lar_feb_next(const xmlNode *element) {
    return element_from(element->next);
}

xmlNode *lar_feb_child(const xmlNode *parent, const char *name) {
    xmlNode *child = lar_feb_first(parent);
    while (child && !lar_feb_is(child, name)) child = lar_feb_next(child);
    return child;
}

bool lar_feb_is(const xmlNode *element, const char *name) {
    return strcmp((const char *)element->name, name) == 0;
}

const char *lar_feb_name(const xmlNode *element) {
    return element->_private ? element->_private : (const char *)element->name;
}

static bool is_among(const xmlChar *word, const char *names) {
    lar_span rest = {names, strlen(names)}, name;
    for (bool more = true; more;) {
        more = lar_span_split(rest, ' ', &name, &rest);
        if (lar_span_equal(name, (const char *)word)) return true;
    }
    return false;
}

bool lar_feb_is_any(const xmlNode *element, const char *names) {
    return is_among(element->name, names);
}

lar_status lar_feb_notice_others(const lar_feb *feb, const xmlNode *parent, const char *known) {
    /* how far augmentation goes; whether it is on is looked for in material.c */
    static const char augmentation[] = "laugon atol augtol minaug maxaug";
    const bool augments = lar_feb_is_any(parent, "material solid elastic SolidDomain");
    lar_status status = LAR_OK;
    for (xmlNode *child = lar_feb_first(parent); child && !status; child = lar_feb_next(child)) {
        const char *name = (const char *)child->name;
        if (!lar_feb_is_any(child, known) && !(augments && lar_feb_is_any(child, augmentation)))
            status = lar_feb_notice(feb, child, "<%s> in <%s> is not known and was left out", name,
                                    lar_feb_name(parent));
        else if (lar_feb_child(parent, name) != child && !lar_feb_is(child, "solid"))
            status = lar_feb_fail(feb, child, LAR_ERROR_FORMAT,
                                  "a second <%s> in one <%s>; remove one of them", name,
                                  lar_feb_name(parent));
    }
    return status;
}

/* Elements of which there is much. */
static const char many[] = "node n elem e quad4 pt";

lar_status lar_feb_refuse_files(lar_feb *feb, const xmlNode *parent) {
    lar_status status = LAR_OK;
    for (xmlNode *child = lar_feb_first(parent); child && !status; child = lar_feb_next(child)) {
        if (lar_feb_is_any(child, many)) continue;
        if (lar_feb_attribute(feb, child, "from"))
            return lar_feb_fail(feb, child, LAR_ERROR_UNSUPPORTED,
                                "<%s> stands in another file (from=\"...\"); put it into this one",
                                (const char *)child->name);
        status = lar_feb_refuse_files(feb, child);
    }
    return status;
}

/* Of what there is much of the reader needs the id, and misses it. A curve is looked for where one
 * can be followed, and refused at parameters. */
lar_status lar_feb_notice_attributes(const lar_feb *feb, const xmlNode *parent) {
    static const char known[] = "id name type node_set surface elem_set mat bc extend surface_pair";
    static const char with_curve[] =
        "value scale force traction pressure x y z T0 dtmax prescribed";
    static const char loads[] = "nodal_load surface_load body_load";
    static const char not_looked_at[] = "Module Globals MeshData Output";
    lar_status status = LAR_OK;
    for (xmlNode *child = lar_feb_first(parent); child && !status; child = lar_feb_next(child)) {
        if (lar_feb_is_any(child, not_looked_at) || lar_feb_is_any(child, many)) continue;
        const bool curve = lar_feb_is_any(child, with_curve);
        for (const xmlAttr *one = child->properties; one && !status; one = one->next) {
            const char *name = (const char *)one->name;
            const bool follows = strcmp(name, "lc") == 0;
            if (is_among(one->name, known) || (curve && follows)) continue;
            if (follows && (lar_feb_is_any(child, loads) || lar_feb_child(child, "dof")))
                return lar_feb_fail(feb, child, LAR_ERROR_UNSUPPORTED,
                                    "the load curve of this <%s> is not followed; name it where "
                                    "its size stands",
                                    lar_feb_name(child));
            status = lar_feb_notice(
                feb, child, "the attribute %s of <%s> is not known and was left out",
                strcmp(name, LAR_FEB_OLD_TYPE) == 0 ? "type" : name, lar_feb_name(child));
        }
        if (!status) status = lar_feb_notice_attributes(feb, child);
    }
    return status;
}

/* Hands a string of libxml2 over to feb->strings. "" when memory is refused. */
static const char *keep(lar_feb *feb, xmlChar *text) {
    const xmlChar *kept = text ? xmlDictLookup(feb->strings, text, -1) : NULL;
    xmlFree(text);
    return kept ? (const char *)kept : "";
}

const char *lar_feb_attribute(lar_feb *feb, const xmlNode *element, const char *name) {
    const xmlAttr *attribute = xmlHasProp(element, (const xmlChar *)name);
    if (!attribute) return NULL;
    const xmlNode *value = attribute->children;
    if (!value) return "";
    if (!value->next && value->type == XML_TEXT_NODE)
        return value->content ? (const char *)value->content : "";
    return keep(feb, xmlNodeListGetString(feb->document, value, 1));
}

lar_status lar_feb_need_attribute(lar_feb *feb, const xmlNode *element, const char *name,
                                  const char **value) {
    const char *found = lar_feb_attribute(feb, element, name);
    if (!found || !*found)
        return lar_feb_fail(feb, element, LAR_ERROR_FORMAT,
                            "<%s> has no attribute %s; add %s=\"...\"", lar_feb_name(element), name,
                            name);
    *value = found;
    return LAR_OK;
}

lar_status lar_feb_id_attribute(lar_feb *feb, const xmlNode *element, const char *name,
                                int64_t *value) {
    const char *text = "";
    lar_status status = lar_feb_need_attribute(feb, element, name, &text);
    if (status) return status;
    lar_span span = lar_span_trim((lar_span){text, strlen(text)});
    if (lar_span_int64(span, value)) return LAR_OK;
    return lar_feb_fail(feb, element, LAR_ERROR_FORMAT,
                        "<%s> has %s=\"%.40s\", which is no whole number; write its number there",
                        (const char *)element->name, name, text);
}

/* The text of an element is one node unless comments cut it into pieces. */
static const char *whole_text(lar_feb *feb, const xmlNode *element) {
    const xmlNode *only = NULL;
    for (const xmlNode *child = element->children; child; child = child->next) {
        if (child->type != XML_TEXT_NODE && child->type != XML_CDATA_SECTION_NODE) continue;
        if (only) return keep(feb, xmlNodeGetContent(element));
        only = child;
    }
    return only && only->content ? (const char *)only->content : "";
}

lar_span lar_feb_text(lar_feb *feb, const xmlNode *element) {
    const char *text = whole_text(feb, element);
    return lar_span_trim((lar_span){text, strlen(text)});
}

const char *lar_feb_word(lar_feb *feb, const xmlNode *element) {
    const lar_span text = lar_feb_text(feb, element);
    return (const char *)xmlDictLookup(feb->strings, (const xmlChar *)text.at, (int)text.length);
}

lar_feb_list lar_feb_list_of(lar_feb *feb, const xmlNode *element) {
    const char *text = whole_text(feb, element);
    return (lar_feb_list){text, text + strlen(text), lar_feb_line(element)};
}

bool lar_feb_list_next(lar_feb_list *list, lar_span *item) {
    static const char separators[] = ", \t\r\n";
    while (list->at < list->end && strchr(separators, *list->at)) {
        if (*list->at == '\n') list->line++;
        list->at++;
    }
    if (list->at >= list->end) return false;
    item->at = list->at;
    item->length = strcspn(list->at, separators);
    list->at += item->length;
    return true;
}

lar_feb_id_list lar_feb_id_list_of(lar_feb *feb, const xmlNode *set) {
    return (lar_feb_id_list){.text = lar_feb_list_of(feb, set), .last = -1, .step = 1};
}

/* first, first:last or first:last:step. */
static bool parse_range(lar_span item, lar_feb_id_list *range) {
    int64_t value[3] = {0, 0, 1};
    int count = 0;
    for (bool more = true; more; count++) {
        lar_span one;
        if (count == 3) return false;
        more = lar_span_split(item, ':', &one, &item);
        if (!lar_span_int64(one, &value[count])) return false;
    }
    range->next = value[0];
    range->last = value[count > 1];
    range->step = value[2];
    return range->step > 0 && range->next >= 0 && (count == 1 || range->last >= range->next);
}

lar_status lar_feb_next_id(lar_feb *feb, lar_feb_id_list *list, int64_t *id, bool *found) {
    lar_span item;
    *found = list->next <= list->last;
    if (!*found) {
        *found = lar_feb_list_next(&list->text, &item);
        if (!*found) return LAR_OK;
        if (!parse_range(item, list))
            return lar_fail(feb->error, LAR_ERROR_FORMAT,
                            "%s:%d: '%.*s' in a set is no id; write whole numbers separated by "
                            "commas, or first:last:step",
                            feb->path, list->text.line, (int)(item.length < 40 ? item.length : 40),
                            item.at);
        int64_t more = (list->last - list->next) / list->step;
        if (more > feb->ids_left)
            return lar_fail(feb->error, LAR_ERROR_FORMAT,
                            "%s:%d: '%.*s' names more ids than such a deck can have; correct it",
                            feb->path, list->text.line, (int)(item.length < 40 ? item.length : 40),
                            item.at);
        feb->ids_left -= more;
    }
    *id = list->next;
    if (list->last - list->next < list->step)
        list->next = 0, list->last = -1;
    else
        list->next += list->step;
    return LAR_OK;
}

/* `count` values by `parse` (which returns false for a bad one). */
static lar_status read_values(lar_feb *feb, const xmlNode *element, int count, const char *kind,
                              bool (*parse)(lar_span, void *, int), void *out) {
    lar_feb_list list = lar_feb_list_of(feb, element);
    lar_span item;
    int found = 0;
    for (; lar_feb_list_next(&list, &item); found++) {
        if (found >= count) continue;
        if (!parse(item, out, found))
            return lar_fail(feb->error, LAR_ERROR_FORMAT,
                            "%s:%d: '%.*s' in <%s> is no %s; correct it", feb->path, list.line,
                            (int)(item.length < 40 ? item.length : 40), item.at,
                            (const char *)element->name, kind);
    }
    if (found == count) return LAR_OK;
    return lar_feb_fail(feb, element, LAR_ERROR_FORMAT,
                        "<%s> holds %d values where %d belong; correct the line",
                        (const char *)element->name, found, count);
}

static bool parse_double(lar_span item, void *out, int i) {
    double *value = out;
    return lar_span_double(item, &value[i]) && isfinite(value[i]);
}

static bool parse_id(lar_span item, void *out, int i) {
    int64_t *id = out;
    return lar_span_int64(item, &id[i]);
}

lar_status lar_feb_doubles(lar_feb *feb, const xmlNode *element, double *value, int count) {
    return read_values(feb, element, count, "finite number", parse_double, value);
}

lar_status lar_feb_ids(lar_feb *feb, const xmlNode *element, int64_t *id, int count) {
    return read_values(feb, element, count, "whole number", parse_id, id);
}

lar_status lar_feb_flag(lar_feb *feb, const xmlNode *parent, const char *name, bool fallback,
                        bool *value) {
    *value = fallback;
    const xmlNode *child = lar_feb_child(parent, name);
    if (!child) return LAR_OK;
    double number = 0.0;
    lar_status status = lar_feb_doubles(feb, child, &number, 1);
    *value = number != 0.0;
    if (status || number == *value) return status;
    return lar_feb_fail(feb, child, LAR_ERROR_FORMAT, "<%s> is %g; write 1 for yes or 0 for no",
                        name, number);
}
