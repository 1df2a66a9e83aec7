/* Out of memory inside libxml2: it goes on without what it could not hold, and says at the end that
 * the file is damaged. */
#ifndef LAR_MODEL_FORMAT_XML_GUARD_H
#define LAR_MODEL_FORMAT_XML_GUARD_H

#include <libxml/xmlerror.h>
#include <stdbool.h>

/* What is done with libxml2 on this thread between the two calls. */
typedef struct lar_xml_guard {
    bool starved;
    xmlStructuredErrorFunc handler; /* whom it told before, */
    void *context;                  /* and with what */
} lar_xml_guard;

void lar_xml_guard_begin(lar_xml_guard *guard);
/* True when memory was lacking meanwhile: what was made is not whole, whatever it looks like. */
bool lar_xml_guard_end(lar_xml_guard *guard);

#endif
