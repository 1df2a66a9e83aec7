#include "model/format/xml_starved.h"

#include <libxml/globals.h>

#if LIBXML_VERSION >= 21200
typedef const xmlError *told_error;
#else
typedef xmlError *told_error;
#endif

static void note(void *context, told_error error) {
    lar_xml_watch *watch = context;
    watch->starved = watch->starved || error->code == XML_ERR_NO_MEMORY;
}

void lar_xml_watch_begin(lar_xml_watch *watch) {
    *watch = (lar_xml_watch){false, xmlStructuredError, xmlStructuredErrorContext};
    xmlSetStructuredErrorFunc(watch, note);
}

bool lar_xml_watch_end(lar_xml_watch *watch) {
    xmlSetStructuredErrorFunc(watch->context, watch->handler);
    return watch->starved;
}
