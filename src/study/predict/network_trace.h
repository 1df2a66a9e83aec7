/* The course of a predicted step in files: figures 5.2 to 5.4 of the thesis, and who waits when.
 *
 *     CSV    kind,processor,thread,peer,begin_us,end_us     a line per span, of a later step
 *     SVG    occupation of the network in the first step, which all begin together, as the thesis
 *            draws it; below, a bar per thread in a later step
 *
 * Readable in black and white: computing is grey, exchanging black, waiting empty.
 */
#ifndef LAR_STUDY_PREDICT_NETWORK_TRACE_H
#define LAR_STUDY_PREDICT_NETWORK_TRACE_H

#include "study/predict/network.h"

/* Both want a recorded result. The file is whole or not there. */
lar_status lar_network_write_csv(const char *path, const lar_network_result *result,
                                 lar_error *error);
/* `title`: a line above. */
lar_status lar_network_write_svg(const char *path, const lar_network_result *result,
                                 const char *title, lar_error *error);

#endif
