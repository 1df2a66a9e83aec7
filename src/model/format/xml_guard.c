#include "model/format/xml_guard.h"

#include <libxml/globals.h>

#if LIBXML_VERSION >= 21200
typedef const xmlError *told_error;
#else
typedef xmlError *told_error;
#endif

static void note(void *context, told_error error) {
    lar_xml_guard *guard = context;
    guard->starved = guard->starved || error->code == XML_ERR_NO_MEMORY;
}

void lar_xml_guard_begin(lar_xml_guard *guard) {
    *guard = (lar_xml_guard){false, xmlStructuredError, xmlStructuredErrorContext};
    xmlSetStructuredErrorFunc(guard, note);
}

bool lar_xml_guard_end(lar_xml_guard *guard) {
    xmlSetStructuredErrorFunc(guard->context, guard->handler);
    return guard->starved;
}
