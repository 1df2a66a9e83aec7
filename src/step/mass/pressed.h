/* Elements that tools press on.
 *
 * Springs of tools take a part of a step beside the elements that they act on, harder ones a larger
 * part (docs/theory.md 10). So a pressed element needs that besides, in parts of steps or, where
 * it may be heavier (heavier.h), with more mass; the others need nothing of it. The springs of a
 * face are counted for the element that it belongs to.
 *
 *     mark      after the tools have pressed: elements of loaded faces
 *     need      while strained elements are measured
 *     list      those of them that are not strained
 *
 * An element and its faces are one thread's, so nobody waits for anybody.
 */
#ifndef LAR_STEP_MASS_PRESSED_H
#define LAR_STEP_MASS_PRESSED_H

#include "contact/interactions.h"
#include "layout/state.h"
#include "step/domain.h"

enum { LAR_PRESSED = 1, LAR_PRESSED_MEASURED = 2 };

/* In a step in which elements are measured. Only where state->needs is there. */
void lar_pressed_mark(const lar_domain *domain, const lar_interactions *interactions,
                      lar_state *state);

/* An element needs so much, (omega dt / 2)^2, and what springs take beside it: reported where that
 * is more than a whole step has room for. */
void lar_pressed_need(const lar_domain *domain, lar_gid e, double need, lar_state *state);

/* Those that have not been measured need what they do at rest; nobody is marked any more. How fast
 * nodes are is reported with it all. */
void lar_pressed_list(const lar_domain *domain, const lar_interactions *interactions,
                      lar_state *state);

#endif
