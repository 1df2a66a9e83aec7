/* The laws of material, in one list. Adding one is a file and two lines here: docs/architecture.md
 * has the walk. The order is that of the numbers that model hashes and checkpoints have: a new law
 * goes to the end. */
#ifndef LAR_LAW_LIST_H
#define LAR_LAW_LIST_H

#define LAR_LAWS(X)                                                                                \
    X(neo_hookean)                                                                                 \
    X(coupled_neo_hookean)                                                                         \
    X(mooney_rivlin)                                                                               \
    X(yeoh)                                                                                        \
    X(arruda_boyce)                                                                                \
    X(veronda_westmann)                                                                            \
    X(holmes_mow)                                                                                  \
    X(ogden)

#endif

/* Their files, for law/lanes.h and no one else. */
#ifdef LAR_LAW_FILES
#include "law/arruda_boyce.h"
#include "law/coupled_neo_hookean.h"
#include "law/holmes_mow.h"
#include "law/mooney_rivlin.h"
#include "law/neo_hookean.h"
#include "law/ogden.h"
#include "law/veronda_westmann.h"
#include "law/yeoh.h"
#endif
