/* Blocks that stand on each other, side over side or nearly so, at rest.
 *
 *          |      |            A node on the edge of the upper block that sinks in goes down along
 *          |      |            the other's side, which would be the closest face, at distance 0 or
 *     -----o------o            nearly: nothing would push it up. As long as a node has not parted
 *          |      |            from the block that it is flush with, it does not see those of its
 *          |      |            faces that its own body's faces go on in, or go on a little within
 *                              and turned, and stands on what is left. So it is with one that
 *                              begins straight before the block, or comes there again.
 *
 * Points of edges are flush as the nodes are of which they are made. What becomes of it in a run is
 * in body_contact.h, offsets.
 */
#ifndef LAR_CONTACT_HISTORY_FLUSH_H
#define LAR_CONTACT_HISTORY_FLUSH_H

#include "contact/contact_surface.h"

/* Who is nearer to a body than this part of a face has not parted from it. */
#define LAR_FLUSH_NEAR 0.05

/* Finds what is flush: sets surface->flush. The list is that of a search at rest; what is no
 * farther from a plane than `rounding` [m] is in it. */
lar_status lar_flush_find(lar_contact_surface *surface, const lar_contact_list *list,
                          double rounding, lar_error *error);

/* The bodies that a node or point is flush with, one after the other: *at from 0 and *body from -1
 * on. False: there is none left. */
bool lar_flush_next_body(const lar_contact_surface *surface, int32_t node, int32_t *at,
                         int32_t *body);

/* Whether it is flush with a body. */
bool lar_flush_at_rest(const lar_contact_surface *surface, int32_t node, int32_t body);

/* Whether a face is one that it does not see as long as it is flush. */
bool lar_flush_hides(const lar_contact_surface *surface, int32_t node, int32_t face);

#endif
