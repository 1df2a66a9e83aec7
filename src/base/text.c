#include "base/text.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == '\v';
}

lar_text lar_text_from(const lar_bytes *bytes) {
    static const char MARK[] = "\xef\xbb\xbf";
    const char *at = (const char *)bytes->data, *end = at + bytes->size;
    if (bytes->size >= 3 && memcmp(at, MARK, 3) == 0) at += 3;
    return (lar_text){at, end, 1};
}

lar_status lar_text_open(const char *path, const lar_bytes *bytes, lar_text *text,
                         lar_error *error) {
    *text = lar_text_from(bytes);
    const char *zero = memchr(bytes->data, 0, bytes->size);
    if (!zero) return LAR_OK;
    int line = 1;
    for (const char *c = (const char *)bytes->data; c < zero; c++) line += *c == '\n';
    return lar_fail(error, LAR_ERROR_FORMAT,
                    "%s:%d: a byte is 0, which no text has; save the file as plain text (UTF-8)",
                    path, line);
}

bool lar_text_skip_space(lar_text *text) {
    while (text->at < text->end && is_space(*text->at)) {
        if (*text->at == '\n') text->line++;
        text->at++;
    }
    return text->at < text->end;
}

bool lar_text_word(lar_text *text, lar_span *word) {
    if (!lar_text_skip_space(text)) return false;
    const char *start = text->at;
    while (text->at < text->end && !is_space(*text->at)) text->at++;
    *word = (lar_span){start, (size_t)(text->at - start)};
    return true;
}

bool lar_text_line(lar_text *text, lar_span *line) {
    if (text->at >= text->end) return false;
    const char *start = text->at;
    const char *stop = memchr(start, '\n', (size_t)(text->end - start));
    text->at = stop ? stop + 1 : text->end;
    if (!stop) stop = text->end;
    if (text->at > stop) text->line++;
    if (stop > start && stop[-1] == '\r') stop--;
    *line = (lar_span){start, (size_t)(stop - start)};
    return true;
}

void lar_text_show(char *text) {
    for (unsigned char *c = (unsigned char *)text; c && *c; c++) {
        if (*c < ' ' || *c == 0x7f) *c = '?';
        if (c[0] == 0xc2 && c[1] >= 0x80 && c[1] <= 0x9f) c[0] = c[1] = '?';
    }
}

/* Whether a character of UTF-8 goes on there. */
static bool goes_on(char c) {
    return ((unsigned char)c & 0xc0) == 0x80;
}

/* `text` without so much of its middle that it fits. A third of the room is for the beginning. */
static void leave_out(const char *text, char *to, size_t size) {
    static const char GAP[] = "...";
    size_t length = strlen(text), gap = sizeof GAP - 1;
    size_t head = size / 3, tail = length - (size - 1 - gap - head);
    while (head > 0 && goes_on(text[head])) head--;
    while (goes_on(text[tail])) tail++;
    memcpy(to, text, head);
    memcpy(to + head, GAP, gap);
    memcpy(to + head + gap, text + tail, length - tail + 1);
}

void lar_text_print(char *to, size_t size, const char *format, va_list args) {
    va_list again;
    va_copy(again, args);
    int length = vsnprintf(to, size, format, args);
    char *whole = length > 0 && (size_t)length >= size ? lar_calloc((size_t)length + 1, 1) : NULL;
    if (whole) {
        vsnprintf(whole, (size_t)length + 1, format, again);
        leave_out(whole, to, size);
        free(whole);
    }
    va_end(again);
}

void lar_text_list(const char *const *name, int count, char *to, size_t size) {
    size_t used = 0;
    if (size > 0) to[0] = '\0';
    for (int i = 0; i < count && used < size; i++) {
        const char *before = i == 0 ? "" : i + 1 < count ? ", " : " and ";
        used += (size_t)snprintf(to + used, size - used, "%s%s", before, name[i]);
    }
}

lar_time_text lar_text_time(double seconds) {
    static const char *const unit[] = {"us", "ms", "s"};
    lar_time_text out;
    double count = 1e6 * seconds;
    int i = 0;
    for (; count >= 999.5 && i < 2; i++) count /= 1000;
    snprintf(out.text, sizeof out.text, "%.3g %s", count, unit[i]);
    return out;
}

locale_t lar_text_locale(void) {
    static locale_t shared; /* made by the first thread that is here */
    locale_t known = __atomic_load_n(&shared, __ATOMIC_ACQUIRE);
    if (known) return known;
    locale_t fresh = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!fresh) return fresh;
    if (__atomic_compare_exchange_n(&shared, &known, fresh, false, __ATOMIC_ACQ_REL,
                                    __ATOMIC_ACQUIRE))
        return fresh;
    freelocale(fresh);
    return known;
}

static double parse_double(const char *start, char **stop) {
    locale_t c_locale = lar_text_locale();
    return c_locale ? strtod_l(start, stop, c_locale) : strtod(start, stop);
}

bool lar_span_double(lar_span span, double *value) {
    enum { LONGEST = 64 };
    char copy[LONGEST + 1];
    if (span.length == 0 || span.length > LONGEST) return false;
    for (size_t i = 0; i < span.length; i++) {
        char c = span.at[i];
        if (c == 'x' || c == 'X' || is_space(c)) return false;
        copy[i] = c == 'd' || c == 'D' ? 'e' : c;
    }
    copy[span.length] = '\0';
    char *stop;
    double parsed = parse_double(copy, &stop);
    if (stop != copy + span.length) return false;
    *value = parsed;
    return true;
}

bool lar_span_int64(lar_span span, int64_t *value) {
    enum { LONGEST = 24 };
    char copy[LONGEST + 1];
    if (span.length == 0 || span.length > LONGEST || is_space(span.at[0])) return false;
    memcpy(copy, span.at, span.length);
    copy[span.length] = '\0';
    char *stop;
    errno = 0;
    long long parsed = strtoll(copy, &stop, 10);
    if (errno != 0 || stop != copy + span.length) return false;
    *value = parsed;
    return true;
}

bool lar_text_double(lar_text *text, double *value) {
    lar_text ahead = *text;
    lar_span word;
    if (!lar_text_word(&ahead, &word)) return false;
    if (!lar_span_double(word, value)) {
        lar_text_skip_space(text);
        return false;
    }
    *text = ahead;
    return true;
}

bool lar_text_int64(lar_text *text, int64_t *value) {
    lar_text ahead = *text;
    lar_span word;
    if (!lar_text_word(&ahead, &word)) return false;
    if (!lar_span_int64(word, value)) {
        lar_text_skip_space(text);
        return false;
    }
    *text = ahead;
    return true;
}

lar_span lar_span_trim(lar_span span) {
    while (span.length > 0 && is_space(span.at[0])) span.at++, span.length--;
    while (span.length > 0 && is_space(span.at[span.length - 1])) span.length--;
    return span;
}

bool lar_span_split(lar_span span, char separator, lar_span *head, lar_span *rest) {
    const char *found = span.length ? memchr(span.at, separator, span.length) : NULL;
    if (!found) {
        *head = span;
        *rest = (lar_span){span.at + span.length, 0};
        return false;
    }
    size_t before = (size_t)(found - span.at);
    *head = (lar_span){span.at, before};
    *rest = (lar_span){found + 1, span.length - before - 1};
    return true;
}

bool lar_span_equal(lar_span span, const char *word) {
    return strlen(word) == span.length && memcmp(span.at, word, span.length) == 0;
}

bool lar_span_equal_nocase(lar_span span, const char *word) {
    return strlen(word) == span.length && strncasecmp(span.at, word, span.length) == 0;
}

int lar_utf8_length(const unsigned char *text, size_t length) {
    if (length == 0) return 0;
    int bytes = text[0] < 0x80             ? 1
                : (text[0] & 0xe0) == 0xc0 ? 2
                : (text[0] & 0xf0) == 0xe0 ? 3
                : (text[0] & 0xf8) == 0xf0 ? 4
                                           : 0;
    if (bytes == 0 || (size_t)bytes > length) return 0;
    uint32_t code = bytes == 1 ? text[0] : text[0] & (0x7fu >> bytes);
    for (int i = 1; i < bytes; i++) {
        if ((text[i] & 0xc0) != 0x80) return 0;
        code = code << 6 | (text[i] & 0x3fu);
    }
    static const uint32_t min[] = {0, 0, 0x80, 0x800, 0x10000};
    bool surrogate = code >= 0xd800 && code <= 0xdfff;
    return code < min[bytes] || code > 0x10ffff || surrogate ? 0 : bytes;
}
