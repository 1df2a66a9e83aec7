/* How hard springs of contact beside a free body may be.
 *
 * A spring is fitted to the mass that it moves (mechanics/contact.h), of tissue a node's. Behind a
 * node of a rigid body is all of it: springs k on points with normals n bring it no more than the
 * step bears as long as
 *
 *     sum_i k_i g_i g_i^T <= k/m M,      g = (n, r x n),   M = diag(m, m, m, I),
 *
 * so the masses that springs count its nodes with may grow by one over the largest eigenvalue of
 * M^-1 sum_i m_i g_i g_i^T, of all nodes at once, pushed along the normals of all their faces: in a
 * hole that it fills it is pushed from everywhere. A cube of n^3 elements has some n times as much.
 *
 * With C = M^-1 sum, the largest is at most (tr C^16)^(1/16), by a factor of 6^(1/16) = 1.12.
 */
#ifndef LAR_STEP_RIGID_FIRM_H
#define LAR_STEP_RIGID_FIRM_H

#include "step/domain.h"

/* Tells the faces before tools which of them are free bodies', and how these yield there: of a unit
 * push along the normal g^T M^-1 g. Once. */
lar_status lar_free_bodies_yield(const lar_domain *domain, lar_tool_faces *faces, lar_error *error);

/* Fits the masses of free bodies' contact nodes, and of points of edges. Once, behind
 * lar_contact_surface_fit. */
void lar_free_bodies_firm(const lar_domain *domain, lar_contact_surface *surface);

#endif
