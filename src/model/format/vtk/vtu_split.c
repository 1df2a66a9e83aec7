#include "model/format/vtk/vtu_split.h"

#include <stdlib.h>
#include <string.h>

/* XML besides the payloads: a few kB in practice. A parsed tree takes up to 50 times its text. */
enum { LARGEST_XML = 16 << 20, MAX_LINE_ENDS = 1 << 20 };

typedef struct splitter {
    const char *path;
    lar_error *error;
    lar_vtu_split *split;
    const char *at, *end;
    int line;
    bool in_array; /* between <DataArray> and </DataArray> */
    int inner;     /* elements open inside the array */
    bool done;     /* the appended data has been found */
} splitter;

void lar_vtu_split_clear(lar_vtu_split *split) {
    free(split->xml);
    free(split->payload);
    *split = (lar_vtu_split){0};
}

static lar_status bad_xml(const splitter *s, const char *cause) {
    return lar_fail(s->error, LAR_ERROR_FORMAT, "%s:%d: %s; write the file again", s->path, s->line,
                    cause);
}

static lar_status keep(splitter *s, const char *text, size_t length) {
    lar_vtu_split *split = s->split;
    if (length > LARGEST_XML || split->xml_length + length > LARGEST_XML)
        return bad_xml(s, "there is more XML around the data than any VTK file has");
    if (split->xml_length + length + 1 > split->xml_capacity) {
        size_t wanted = 2 * split->xml_capacity + length + 1024;
        char *grown = realloc(split->xml, wanted);
        if (!grown) return lar_fail_memory(s->error, wanted, s->path);
        split->xml = grown;
        split->xml_capacity = wanted;
    }
    memcpy(split->xml + split->xml_length, text, length);
    split->xml_length += length;
    split->xml[split->xml_length] = '\0';
    return LAR_OK;
}

static void count_lines(splitter *s, const char *from, const char *to) {
    while ((from = memchr(from, '\n', (size_t)(to - from)))) {
        s->line++;
        from++;
    }
}

/* Leaves only the line ends of [from, to) in the XML, so that the parser counts lines as we do. */
static lar_status drop(splitter *s, const char *from, const char *to) {
    int before = s->line;
    count_lines(s, from, to);
    if (s->split->xml_length > MAX_LINE_ENDS) return LAR_OK;
    lar_status status = LAR_OK;
    for (int i = before; i < s->line && i - before < MAX_LINE_ENDS && !status; i++)
        status = keep(s, "\n", 1);
    return status;
}

/* Text up to the next tag. */
static lar_status take_text(splitter *s) {
    const char *start = s->at;
    const char *stop = memchr(start, '<', (size_t)(s->end - start));
    s->at = stop = stop ? stop : s->end;
    lar_span text = lar_span_trim((lar_span){start, (size_t)(stop - start)});
    if (!s->in_array || s->inner > 0) {
        count_lines(s, start, stop);
        return keep(s, start, (size_t)(stop - start));
    }
    if (text.length > 0) {
        lar_vtu_payload *payload = &s->split->payload[s->split->payload_count - 1];
        if (payload->text.at) return bad_xml(s, "the data of an array is interrupted by a tag");
        payload->text = text;
        payload->line = s->line;
        for (const char *c = start; c < text.at; c++) payload->line += *c == '\n';
    }
    return drop(s, start, stop);
}

/* The '>' that ends the tag at s->at; one between quotes does not. */
static const char *tag_end(const splitter *s) {
    char quote = '\0';
    for (const char *c = s->at; c < s->end; c++) {
        if (quote) {
            if (*c == quote) quote = '\0';
        } else if (*c == '"' || *c == '\'') {
            quote = *c;
        } else if (*c == '>') {
            return c;
        }
    }
    return NULL;
}

static bool tag_named(const char *tag, const char *end, const char *name) {
    size_t length = strlen(name);
    if ((size_t)(end - tag) < length || memcmp(tag, name, length) != 0) return false;
    char next = tag[length];
    return next == '>' || next == '/' || next == ' ' || next == '\t' || next == '\n' ||
           next == '\r';
}

static lar_status begin_array(splitter *s, bool closed) {
    lar_vtu_split *split = s->split;
    if (s->in_array) return bad_xml(s, "an array stands inside another array");
    if (!LAR_GROW(split->payload, split->payload_capacity, split->payload_count))
        return lar_fail_memory(s->error, sizeof *split->payload, s->path);
    split->payload[split->payload_count++] = (lar_vtu_payload){{NULL, 0}, s->line};
    s->in_array = !closed;
    s->inner = 0;
    return LAR_OK;
}

/* The data begins behind the first '_'; nothing but white space stands before it. */
static lar_status begin_appended(splitter *s) {
    lar_span rest = lar_span_trim((lar_span){s->at, (size_t)(s->end - s->at)});
    if (rest.length == 0 || rest.at[0] != '_')
        return bad_xml(s, "the appended data does not begin with an underscore");
    s->split->appended = (lar_span){rest.at + 1, (size_t)(s->end - rest.at) - 1};
    s->done = true;
    static const char closing[] = "</AppendedData></VTKFile>";
    return keep(s, closing, sizeof closing - 1);
}

static lar_status take_tag(splitter *s) {
    const char *close = tag_end(s);
    if (!close) return bad_xml(s, "the file ends inside a tag");
    const char *tag = s->at + 1;
    bool closed = close[-1] == '/';
    lar_status status = LAR_OK;
    if (*tag == '/') {
        if (s->in_array && s->inner > 0)
            s->inner--;
        else
            s->in_array = false;
    } else if (tag_named(tag, s->end, "DataArray") || tag_named(tag, s->end, "Array")) {
        status = begin_array(s, closed);
    } else if (s->in_array && !closed) {
        s->inner++;
    }
    bool appended = !s->in_array && !closed && tag_named(tag, s->end, "AppendedData");
    if (!status) status = keep(s, s->at, (size_t)(close + 1 - s->at));
    count_lines(s, s->at, close);
    s->at = close + 1;
    return status || !appended ? status : begin_appended(s);
}

/* <!-- --> is dropped, <? ?> kept; other declarations are refused. */
static lar_status take_markup(splitter *s) {
    size_t left = (size_t)(s->end - s->at);
    bool comment = left >= 4 && memcmp(s->at, "<!--", 4) == 0;
    bool instruction = left >= 2 && s->at[1] == '?';
    if (!comment && !instruction) {
        if (left >= 2 && s->at[1] == '!')
            return lar_fail(s->error, LAR_ERROR_FORMAT,
                            "%s:%d: the file holds an XML declaration (<!DOCTYPE, <!ENTITY or "
                            "<![CDATA[), which has no place in a VTK file; remove it",
                            s->path, s->line);
        return take_tag(s);
    }
    const char *mark = comment ? "-->" : "?>";
    size_t skip = comment ? 4 : 2;
    const char *close = memmem(s->at + skip, left - skip, mark, strlen(mark));
    if (!close) return bad_xml(s, "the file ends inside a comment");
    close += strlen(mark);
    const char *from = s->at;
    s->at = close;
    if (comment) return drop(s, from, close);
    count_lines(s, from, close);
    return keep(s, from, (size_t)(close - from));
}

lar_status lar_vtu_split_file(const char *path, const lar_bytes *bytes, lar_vtu_split *split,
                              lar_error *error) {
    *split = (lar_vtu_split){0};
    const char *data = (const char *)bytes->data;
    splitter s = {.path = path,
                  .error = error,
                  .split = split,
                  .at = data,
                  .end = data + bytes->size,
                  .line = 1};
    lar_status status = LAR_OK;
    while (!status && !s.done && s.at < s.end)
        status = *s.at == '<' ? take_markup(&s) : take_text(&s);
    if (!status && split->xml && memchr(split->xml, '\0', split->xml_length))
        status = lar_fail(error, LAR_ERROR_FORMAT,
                          "%s: this is no XML text in UTF-8 or ASCII, so no .vtu file; check the "
                          "file or its extension",
                          path);
    if (status) lar_vtu_split_clear(split);
    return status;
}
